// Shells: instance k of a mesh is its layer k, layer 0 the skin.

// The highlight of bald skin; as in the reference.
const WET: f32 = 0.7;
const WET_EXPONENT: f32 = 140.0;

struct Record {
    // Object space to world space.
    rows: array<vec4f, 3>,
    // Colours that multiply those of the mesh.
    root: vec4f,
    tip: vec4f,
    // How all strands lean, in the world; the longest bend, 0 for no lean.
    lean: vec4f,
    // The first joint, and how many there are.
    pose: vec4u,
}

@group(1) @binding(0) var<uniform> look: Look;
@group(1) @binding(1) var<storage, read> records: array<Record>;

struct Shell {
    @builtin(position) screen: vec4f,
    // In the mesh at rest: on the skin, before the layer moves it; the normal there.
    @location(0) base: vec3f,
    @location(1) normal: vec3f,
    // Colour of the coat; the share of the full length.
    @location(2) coat: vec4f,
    // Record, layer, layers.
    @location(3) @interpolate(flat) which: vec3u,
    // World space, on the layer; the scale from the mesh at rest to the world.
    @location(4) at: vec4f,
    // The way of looking or of light, in the mesh at rest, of any length.
    @location(5) ray: vec3f,
    // The axes of the mesh at rest in the world.
    @location(6) x: vec3f,
    @location(7) y: vec3f,
    @location(8) z: vec3f,
    // The bend of strands, in the mesh at rest.
    @location(9) bend: vec3f,
    // A corner of the triangle, in the mesh at rest.
    @location(10) @interpolate(flat) corner: vec3f,
}

struct Corner {
    // Record; layer and layers.
    @location(0) which: vec2u,
    @location(1) base: vec3f,
    @location(2) normal: vec3f,
    @location(3) coat: vec4f,
}

/// From the mesh at rest to the world.
fn turned(in: Shell, v: vec3f) -> vec3f {
    return normalize(in.x * v.x + in.y * v.y + in.z * v.z);
}

fn height_of(which: vec3u) -> f32 {
    return f32(which.y) / f32(max(which.z, 1u));
}

/// The fur as it is bent here.
fn bent(bend: vec3f) -> Look {
    var there = look;
    there.bend = bend;
    return there;
}

/// A vertex of a layer; `rows` go from the mesh at rest to the world, rays start at `eye` (w = 1) or run along it (w = 0).
fn shell(corner: Corner, rows: array<vec4f, 3>, eye: vec4f) -> Shell {
    var out: Shell;
    out.which = vec3u(corner.which.x, corner.which.y & 0xffffu, corner.which.y >> 16u);
    out.base = corner.base;
    out.corner = corner.base;
    out.normal = corner.normal;
    out.coat = corner.coat;
    let axes = transpose(mat3x3f(rows[0].xyz, rows[1].xyz, rows[2].xyz));
    out.x = axes[0];
    out.y = axes[1];
    out.z = axes[2];
    out.bend = leaning(look.bend, records[corner.which.x].lean, axes);
    let above = extrusion(bent(out.bend), corner.normal, corner.coat.w * height_of(out.which));
    let at = transformed(rows, vec4f(corner.base + above, 1.0));
    out.at = vec4f(at, pow(abs(determinant(axes)), 1.0 / 3.0));
    out.ray = taken_back(axes, at * eye.w - eye.xyz);
    return out;
}

fn seen_by_eye(corner: Corner, rows: array<vec4f, 3>) -> Shell {
    var out = shell(corner, rows, vec4f(frame.eye.xyz, 1.0));
    out.screen = to_screen(out.at.xyz);
    return out;
}

fn seen_by_sun(corner: Corner, rows: array<vec4f, 3>) -> Shell {
    var out = shell(corner, rows, vec4f(frame.sun.xyz, 0.0));
    out.screen = frame.sun_clip * vec4f(out.at.xyz, 1.0);
    return out;
}

/// From the mesh at rest to the world, for a vertex that follows joints.
fn posed(record: u32, follows: vec4u, shares: vec4f) -> array<vec4f, 3> {
    return chained(records[record].rows, blended(records[record].pose.xy, follows, shares));
}

@vertex
fn shell_corner(corner: Corner) -> Shell {
    return seen_by_eye(corner, records[corner.which.x].rows);
}

@vertex
fn shell_shadow_corner(corner: Corner) -> Shell {
    return seen_by_sun(corner, records[corner.which.x].rows);
}

@vertex
fn posed_shell_corner(corner: Corner, @location(4) follows: vec4u, @location(5) shares: vec4f) -> Shell {
    return seen_by_eye(corner, posed(corner.which.x, follows, shares));
}

@vertex
fn posed_shell_shadow_corner(corner: Corner, @location(4) follows: vec4u, @location(5) shares: vec4f) -> Shell {
    return seen_by_sun(corner, posed(corner.which.x, follows, shares));
}

fn strand_here(there: Look, skin: Skin, height: f32, long: f32) -> Seen {
    let hit = strand_at(there, skin, height, long);
    // The upper bits give the length: the lower ones are for the colour.
    return Seen(hit.found, f32(hit.id & 255u) / 255.0, hit.along, height, hit.root, skin.normal);
}

/// How much of the sun the skin gets: light wraps around it.
fn facing(normal: vec3f) -> f32 {
    return saturate((dot(normal, frame.sun.xyz) + look.wrap) / (1.0 + look.wrap));
}

/// The share of the sun that other strands let through to a height in the mesh at rest.
fn between_strands(in: Shell, normal: vec3f, height: f32) -> f32 {
    let sun = vec3f(dot(frame.sun.xyz, in.x), dot(frame.sun.xyz, in.y), dot(frame.sun.xyz, in.z));
    let there = sun / max(length(sun), 1e-30);
    return sun_through(bent(in.bend), normal, height, in.coat.w, there);
}

/// The light of a strand, by the shares of the light from everywhere and of the sun's that reach it: the twin of
/// `Material::shade_by` in casca-fur.
fn strand_light(colour: vec3f, tangent: vec3f, normal: vec3f, to_eye: vec3f, sky: f32, sun: f32) -> vec3f {
    let lobes = kajiya_kay(tangent, frame.sun.xyz, to_eye, look.exponent);
    let direct = facing(normal) * sun;
    let matt = colour * (sky * look.ambient + look.diffuse * (0.5 + 0.5 * lobes.x) * direct);
    return matt + look.specular * lobes.y * direct;
}

@fragment
fn shell_colour(in: Shell) -> @location(0) vec4f {
    let c = change(in);
    let paint = paint_of(in);
    let record = in.which.x;
    let normal = normalize(in.normal);
    let scale = in.at.w;
    let t = height_of(in.which);
    let at = in.at.xyz;
    let out = turned(in, normal);
    let fur = look.height * in.coat.w * scale;
    // The fur's own height and two texels towards the outside: fur must not shade itself by the map.
    let lifted = at + out * (fur * (1.0 - t) + 2.0 * frame.shadow.x) + frame.sun.xyz * 2.0 * frame.shadow.x;
    if in.which.y == 0u {
        // The skin below fur is as dark as the roots, bald skin is not.
        let skin = mix(1.0, look.dark, smoothstep(0.0, 0.2, in.coat.w));
        let colour = colour_at(in, c, paint, vec3f(0.0)) * records[record].root.rgb;
        let sun = facing(out) * sunlight(lifted);
        let through = between_strands(in, normal, 0.0);
        // Bald skin, as of eyes and noses, is wet: Blinn's highlight.
        let half = normalize(frame.sun.xyz + normalize(frame.eye.xyz - at));
        let wet = WET * (1.0 - smoothstep(0.0, 0.2, in.coat.w)) * pow(saturate(dot(out, half)), WET_EXPONENT);
        return stored(colour * (skin * look.ambient + through * look.diffuse * sun) + wet * sun, at);
    }
    let width = frame.eye.w * distance(at, frame.eye.xyz) / scale;
    let hit = seen(in, c, normal, width, normalize(in.ray));
    if !hit.found {
        discard;
    }
    let own = 1.0 + look.vary * (2.0 * hit.own - 1.0);
    let colour = own * colour_at(in, c, paint, hit.root) * mix(records[record].root.rgb, records[record].tip.rgb, hit.along);
    let along = turned(in, strand_tangent(bent(in.bend), hit.normal, hit.height));
    let to_eye = normalize(frame.eye.xyz - at);
    let sky = mix(look.dark, 1.0, hit.along);
    let sun = between_strands(in, hit.normal, hit.height) * sunlight(lifted);
    return stored(strand_light(colour, along, turned(in, hit.normal), to_eye, sky, sun), at);
}

@fragment
fn shell_shadow(in: Shell) {
    let c = change(in);
    if in.which.y > 0u {
        // The ray is the sun's: whoever looks changes no shadow.
        if !seen(in, c, normalize(in.normal), frame.shadow.x / in.at.w, normalize(in.ray)).found {
            discard;
        }
    }
}
