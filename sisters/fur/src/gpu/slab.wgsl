// The strand that a fragment of a layer shows, for other renderers, too: `casca_fur::shader` says what it asks for.

// A pixel is at least so wide, in object space: 0, in the eye itself, has no logarithm.
const LEAST_WIDTH: f32 = 1e-12;
// A ray climbs at least so fast, in heights of the fur: one that neither rises nor bends leaves its slab far away, and
// not nowhere.
const LEAST_CLIMB: f32 = 1e-6;
// The foot of a ray goes at least so fast along the skin: that of a ray along the normal stays, and has no curve.
const LEAST_SPEED: f32 = 1e-20;

// Of so many layers one casts the shadows of all, through a slab as thick: strands show less in shadows.
const SHADOW_LAYERS: u32 = 4u;

/// The strand that a fragment shows, if any: its random number, and where on it the fragment is (0 root, 1 tip).
struct Seen {
    found: bool,
    own: f32,
    along: f32,
    // The height of the layer there.
    height: f32,
    // From the skin below the fragment to the root; the normal there.
    root: vec3f,
    normal: vec3f,
}

/// How skin and layer change from pixel to pixel: those of the skin, of its normal, and of the layer.
struct Change {
    base: array<vec3f, 2>,
    normal: array<vec3f, 2>,
    shell: array<vec3f, 2>,
}

/// The layers in shadow maps, of so many: the lowest.
fn shadow_layers(layers: u32) -> u32 {
    return (layers + SHADOW_LAYERS - 1u) / SHADOW_LAYERS;
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

/// A fragment as if its tuft stood upright.
fn swayed(in: Shell) -> Shell {
    let normal = normalize(in.normal);
    let to = sway(look, in.base, height_of(in.which) * in.coat.w);
    var out = in;
    out.base -= (to.way - normal * dot(to.way, normal)) * look.height;
    out.bend += to.bend;
    return out;
}

/// Must be called by all fragments.
fn change(in: Shell) -> Change {
    let normal = normalize(in.normal);
    let shell = in.base + extrusion(bent(in.bend), normal, in.coat.w * height_of(in.which));
    return Change(
        array(dpdx(in.base), dpdy(in.base)), array(dpdx(normal), dpdy(normal)), array(dpdx(shell), dpdy(shell)),
    );
}

/// How many pixels to the right and down a place on the skin is, `way` from the base: what a fragment adds of its colours'
/// changes to have those at a root.
fn pixels_to(in: Shell, c: Change, way: vec3f) -> vec2f {
    let across = cross(c.base[0], c.base[1]);
    let area = dot(across, across);
    if area == 0.0 {
        return vec2f(0.0);
    }
    // Colours do not go on changing so far beyond the triangle.
    let near = way * min(1.0, length(in.corner - in.base) / max(length(way), 1e-30));
    return vec2f(dot(near, cross(c.base[1], across)), dot(near, cross(across, c.base[0]))) / area;
}

fn skin_of(base: vec3f, normal: vec3f, c: Change) -> Skin {
    let across = cross(c.base[0], c.base[1]);
    let area = dot(across, across);
    var slope = mat3x3f();
    var plane = vec3f(0.0);
    if area > 0.0 {
        let u = cross(c.base[1], across) / area;
        let v = cross(across, c.base[0]) / area;
        slope = mat3x3f(
            c.normal[0] * u.x + c.normal[1] * v.x, c.normal[0] * u.y + c.normal[1] * v.y,
            c.normal[0] * u.z + c.normal[1] * v.z,
        );
        plane = across * (sign(dot(across, normal)) / sqrt(area));
    }
    return Skin(base, normal, plane, slope);
}

/// A random number for a place and a layer, the same for all places of about a pixel: hashed alpha, Wyman and McGuire 2017.
fn dither(base: vec3f, width: f32, layer: u32) -> vec4u {
    let cell = vec3i(floor(base / exp2(ceil(log2(max(width, LEAST_WIDTH))))));
    return hash(vec4u(bitcast<vec3u>(cell), layer));
}

/// How far a ray goes that leaves a shell with a slope and a bulge, until it is a slab lower or higher, or back.
fn through_slab(rise: f32, bulge: f32, thick: f32) -> f32 {
    let down = rise < 0.0;
    let square = rise * rise + select(2.0, -2.0, down) * bulge * thick;
    if down && square < 0.0 {
        return -2.0 * rise / bulge;
    }
    return 2.0 * thick / max(abs(rise) + sqrt(max(square, 0.0)), LEAST_CLIMB);
}

/// The strand in a fragment of a shell. `width` is that of a pixel, `ray` the unit direction of looking or of light, both in object space.
fn seen(in: Shell, c: Change, normal: vec3f, width: f32, ray: vec3f) -> Seen {
    let t = height_of(in.which);
    let long = in.coat.w;
    let height = t * long;
    let nothing = Seen(false, 0.0, 0.0, 0.0, vec3f(0.0), normal);
    if long < SHORTEST {
        return nothing;
    }
    // Strands thinner than a pixel cannot be told apart: what shows is their share of the skin.
    // A comparison with the uniform itself ends the software adapter of Mesa 22.3 in passes without colours.
    let thin = width / look.fine - 1.0;
    if thin > 0.0 {
        let word = dither(in.base, width, in.which.y);
        if unit(word.x) < thin {
            return Seen(unit(word.y) < mean_cover(look, t), unit(word.z), t, height, vec3f(0.0), normal);
        }
    }
    return strand_met(in, c, skin_of(in.base, normal, c), ray);
}
