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
@group(1) @binding(3) var strands: texture_3d<u32>;

struct Shell {
    @builtin(position) screen: vec4f,
    // In the mesh at rest: on the skin, before the layer moves it; the normal there.
    @location(0) base: vec3f,
    @location(1) normal: vec3f,
    // Colour of the coat; the share of the full length.
    @location(2) coat: vec4f,
    // Record, layer, layers.
    @location(3) @interpolate(flat) which: vec3u,
    // The place in the shadow map; the scale from the mesh at rest to the world.
    @location(4) lit: vec4f,
    // In the mesh at rest, of any length: the way of looking or of light, and the way to the sun.
    @location(5) ray: vec3f,
    @location(6) sun: vec3f,
    // The bend of strands, in the mesh at rest.
    @location(7) bend: vec3f,
    // A corner of the triangle, in the mesh at rest.
    @location(8) @interpolate(flat) corner: vec3f,
}

struct Corner {
    // Record; layer and layers.
    @location(0) which: vec2u,
    @location(1) base: vec3f,
    @location(2) normal: vec3f,
    @location(3) coat: vec4f,
}

/// The strand next to a texel of the table.
fn strand_near(texel: vec3i) -> u32 {
    return textureLoad(strands, texel, 0).x;
}

/// A vertex of a layer; `rows` go from the mesh at rest to the world.
fn shell(corner: Corner, rows: array<vec4f, 3>, by_sun: bool) -> Shell {
    var out: Shell;
    out.which = vec3u(corner.which.x, corner.which.y & 0xffffu, corner.which.y >> 16u);
    if by_sun {
        out.which.z = shadow_layers(out.which.z);
    }
    out.base = corner.base;
    out.corner = corner.base;
    out.normal = corner.normal;
    out.coat = corner.coat;
    let axes = transpose(mat3x3f(rows[0].xyz, rows[1].xyz, rows[2].xyz));
    out.bend = leaning(look.bend, records[corner.which.x].lean, axes);
    let t = height_of(out.which);
    let at = transformed(rows, vec4f(corner.base + extrusion(bent(out.bend), corner.normal, corner.coat.w * t), 1.0));
    let scale = pow(abs(determinant(axes)), 1.0 / 3.0);
    // The fur's own height and two texels towards the outside: fur must not shade itself by the map.
    let up = axes * corner.normal / max(length(axes * corner.normal), 1e-30);
    let lift = look.height * corner.coat.w * scale * (1.0 - t) + 2.0 * frame.shadow.x;
    let lifted = at + up * lift + frame.sun.xyz * 2.0 * frame.shadow.x;
    out.lit = vec4f((frame.sun_clip * vec4f(lifted, 1.0)).xyz, scale);
    out.sun = frame.sun.xyz * axes;
    if by_sun {
        out.ray = taken_back(axes, -frame.sun.xyz);
        // Nowhere, for the layers that cast none.
        out.screen = select(frame.sun_clip * vec4f(at, 1.0), vec4f(2.0, 2.0, 2.0, 1.0), out.which.y > out.which.z);
    } else {
        out.ray = taken_back(axes, at - frame.eye.xyz);
        out.screen = to_screen(at);
    }
    return out;
}

/// From the mesh at rest to the world, for a vertex that follows joints.
fn posed(record: u32, follows: vec4u, shares: vec4f) -> array<vec4f, 3> {
    return chained(records[record].rows, blended(records[record].pose.xy, follows, shares));
}

@vertex
fn shell_corner(corner: Corner) -> Shell {
    return shell(corner, records[corner.which.x].rows, false);
}

@vertex
fn shell_shadow_corner(corner: Corner) -> Shell {
    return shell(corner, records[corner.which.x].rows, true);
}

@vertex
fn posed_shell_corner(corner: Corner, @location(4) follows: vec4u, @location(5) shares: vec4f) -> Shell {
    return shell(corner, posed(corner.which.x, follows, shares), false);
}

@vertex
fn posed_shell_shadow_corner(corner: Corner, @location(4) follows: vec4u, @location(5) shares: vec4f) -> Shell {
    return shell(corner, posed(corner.which.x, follows, shares), true);
}

fn unit_vector(v: vec3f) -> vec3f {
    return v / max(length(v), 1e-30);
}

/// How much of the sun the skin gets: light wraps around it.
fn facing(normal: vec3f, to_sun: vec3f) -> f32 {
    return saturate((dot(normal, to_sun) + look.wrap) / (1.0 + look.wrap));
}

/// The light of a strand, by the shares of the light from everywhere and of the sun's that reach it: the twin of
/// `Material::shade_by` in casca-fur.
fn strand_light(
    colour: vec3f, tangent: vec3f, normal: vec3f, to_sun: vec3f, to_eye: vec3f, sky: f32, sun: f32,
) -> vec3f {
    let lobes = kajiya_kay(tangent, to_sun, to_eye, look.exponent);
    let direct = facing(normal, to_sun) * sun;
    let matt = colour * (sky * look.ambient + look.diffuse * (0.5 + 0.5 * lobes.x) * direct);
    return matt + look.specular * lobes.y * direct;
}

@fragment
fn skin_colour(in: Shell) -> @location(0) vec4f {
    let normal = normalize(in.normal);
    let to_sun = unit_vector(in.sun);
    // The skin below fur is as dark as the roots, bald skin is not.
    let furry = smoothstep(0.0, 0.2, in.coat.w);
    let colour = in.coat.rgb * records[in.which.x].root.rgb;
    let sun = facing(normal, to_sun) * sunlight(in.lit.xyz);
    let through = sun_through(bent(in.bend), normal, 0.0, in.coat.w, to_sun);
    // Bald skin, as of eyes and noses, is wet: Blinn's highlight.
    let half = unit_vector(to_sun - unit_vector(in.ray));
    let wet = WET * (1.0 - furry) * pow(saturate(dot(normal, half)), WET_EXPONENT);
    let sky = mix(1.0, look.dark, furry) * look.ambient;
    return stored(colour * (sky + through * look.diffuse * sun) + wet * sun, length(in.ray) * in.lit.w);
}

@fragment
fn shell_colour(given: Shell) -> @location(0) vec4f {
    let c = change(given);
    // How the coat's colour changes from pixel to pixel.
    let right = dpdx(given.coat.rgb);
    let down = dpdy(given.coat.rgb);
    let in = swayed(given);
    let far = length(in.ray);
    let ray = in.ray / max(far, 1e-30);
    let hit = seen(in, c, normalize(in.normal), frame.eye.w * far, ray);
    if !hit.found {
        discard;
    }
    let record = in.which.x;
    let own = 1.0 + look.vary * (2.0 * hit.own - 1.0);
    let tint = mix(records[record].root.rgb, records[record].tip.rgb, hit.along);
    // The colour of a strand is that of the coat at its root.
    let pixels = pixels_to(in, c, hit.root);
    let colour = own * saturate(in.coat.rgb + right * pixels.x + down * pixels.y) * tint;
    let there = bent(in.bend);
    let to_sun = unit_vector(in.sun);
    let along = strand_tangent(there, hit.normal, hit.height);
    let sky = mix(look.dark, 1.0, hit.along);
    let sun = sun_through(there, hit.normal, hit.height, in.coat.w, to_sun) * sunlight(in.lit.xyz);
    return stored(strand_light(colour, along, hit.normal, to_sun, -ray, sky, sun), far * in.lit.w);
}

@fragment
fn shell_shadow(given: Shell) {
    let c = change(given);
    let in = swayed(given);
    // The ray is the sun's: whoever looks changes no shadow.
    if !seen(in, c, normalize(in.normal), frame.shadow.x / in.lit.w, unit_vector(in.ray)).found {
        discard;
    }
}
