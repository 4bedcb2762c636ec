// The twin of `strand_at` in casca-fur: the same steps in the same order, in single precision.

// Half the slab around the skin in which points are roots, in cells; as in casca-fur.
const HALF_SLAB: f32 = 0.25;
// Normals that lean more belong to another surface; as in casca-fur.
const LEAST_LEAN: f32 = 0.1;
// A coat shorter than this share of the full length is bald: a step of a colour of 8 bits.
const SHORTEST: f32 = 0.004;
// Steps of the sun's way through fur, and its least height over the skin; as in casca-fur.
const LIGHT_STEPS: u32 = 8;
const LEAST_RISE: f32 = 0.15;

struct Look {
    // See `Fur` in casca-fur.
    bend: vec3f,
    height: f32,
    spacing: f32,
    radius: f32,
    taper: f32,
    variation: f32,
    per_cell: u32,
    seed: u32,
    // The most steps of a fragment through its slab.
    steps: u32,
    // Between these widths of a pixel strands give way to their mean.
    fine: f32,
    coarse: f32,
    exponent: f32,
    wrap: f32,
    dark: f32,
    ambient: f32,
    diffuse: f32,
    specular: f32,
    vary: f32,
}

struct Strand {
    found: bool,
    id: u32,
    offset: f32,
    along: f32,
    // From the point on the skin to the strand's root.
    root: vec3f,
}

fn mixed(words: vec4u) -> vec4u {
    var v = words;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

fn hash(words: vec4u) -> vec4u {
    var v = mixed(words * 1664525u + 1013904223u);
    v ^= v >> vec4u(16u);
    return mixed(v);
}

fn unit(word: u32) -> f32 {
    return f32(word >> 8u) * (1.0 / 16777216.0);
}

fn share(look: Look, id: u32) -> f32 {
    return 1.0 - look.variation * unit(id);
}

/// The skin below a point of a layer.
struct Skin {
    base: vec3f,
    normal: vec3f,
    // The unit normal of its triangle; zero if it is that of the skin.
    plane: vec3f,
    // How the normal changes along the skin, for each unit of the way.
    slope: mat3x3f,
}

/// The strand at a point of a layer; `height` and `long` are 0 to 1.
fn strand_at(look: Look, skin: Skin, height: f32, long: f32) -> Strand {
    let place = skin.base * (1.0 / look.spacing);
    let first = floor(place - 0.5);
    let lean = dot(skin.normal, skin.plane);
    let lift = select(skin.normal, skin.plane / lean, lean > LEAST_LEAN);
    // In cells from here on.
    let tall = look.height / look.spacing;
    let slope = skin.slope * look.spacing;
    // How far a turn of the normal moves the layer; along the bend, too.
    let turned = tall * height * (1.0 - height * dot(look.bend, skin.normal));
    let tangent = strand_tangent(look, skin.normal, height);
    let rise = dot(tangent, skin.normal) / max(tall, 1e-30);
    var best = Strand(false, 0u, 1.0, 0.0, vec3f(0.0));
    for (var corner = 0u; corner < 8u; corner++) {
        let cell = first + vec3f(f32(corner & 1u), f32((corner >> 1u) & 1u), f32(corner >> 2u));
        let number = bitcast<vec3u>(vec3i(cell));
        for (var k = 0u; k < look.per_cell; k++) {
            let word = hash(vec4u(number, look.seed * 4u + k));
            let way = (cell - place) + vec3f(unit(word.x), unit(word.y), unit(word.z));
            let above = dot(way, lift);
            let side = way - skin.normal * above;
            // From here to the middle of the strand at this height.
            let away = side + (slope * side) * (turned - above);
            let back = dot(away, tangent);
            let along = max(height - back * rise, 0.0) / (long * share(look, word.w));
            let radius = look.radius * (1.0 - look.taper * along);
            let offset = length(away - tangent * back) / radius;
            if abs(above) < HALF_SLAB && along <= 1.0 && radius > 0.0 && offset < best.offset {
                best = Strand(true, word.w, offset, along, side * look.spacing);
            }
        }
    }
    return best;
}

/// The part of the bend along the skin.
fn bend_at(look: Look, normal: vec3f) -> vec3f {
    return look.bend - normal * dot(look.bend, normal);
}

/// From a point of the skin to the layer at a height.
fn extrusion(look: Look, normal: vec3f, height: f32) -> vec3f {
    return (normal * height + bend_at(look, normal) * (height * height)) * look.height;
}

/// The direction of strands at a height.
fn strand_tangent(look: Look, normal: vec3f, height: f32) -> vec3f {
    return normalize(normal + bend_at(look, normal) * (2.0 * height));
}

/// The share of the skin that strands cover at a share of the coat's length: the mean over strands of all lengths, which overlap
/// at random.
fn mean_cover(look: Look, t: f32) -> f32 {
    var area = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let along = t / (1.0 - look.variation * (f32(i) + 0.5) / 4.0);
        let width = look.radius * max(1.0 - look.taper * along, 0.0);
        area += select(0.0, width * width, along <= 1.0);
    }
    // Half of the points in cells are roots.
    return 1.0 - exp(-0.5 * f32(look.per_cell) * 3.14159265 * area / 4.0);
}

/// The mean share of sunlight that reaches a height in a coat of a length: the twin of `sun_through` in casca-fur.
fn sun_through(look: Look, normal: vec3f, height: f32, long: f32, to_sun: vec3f) -> f32 {
    let up = dot(normal, to_sun);
    let slope = (to_sun - normal * up) / max(up, LEAST_RISE);
    let side = bend_at(look, normal);
    let step = max(long - height, 0.0) / f32(LIGHT_STEPS);
    // Strands of four lengths stand for all.
    let lengths = max(long, 1e-30) * (1.0 - look.variation * (vec4f(0.5, 1.5, 2.5, 3.5) / 4.0));
    var met = 0.0;
    for (var i = 0u; i < LIGHT_STEPS; i++) {
        let there = height + (f32(i) + 0.5) * step;
        let along = vec4f(there) / lengths;
        let wide = select(vec4f(0.0), 2.0 * (1.0 - look.taper * along), along <= vec4f(1.0));
        met += dot(wide, vec4f(0.25)) * length(slope - side * (2.0 * there));
    }
    let strands = 0.5 * f32(look.per_cell) / look.spacing;
    return exp(-met * step * look.height * look.radius * strands);
}

/// The diffuse and the specular share of the light of a strand along `along`: Kajiya and Kay 1989.
fn kajiya_kay(along: vec3f, to_light: vec3f, to_eye: vec3f, exponent: f32) -> vec2f {
    let tl = dot(along, to_light);
    let te = dot(along, to_eye);
    let sines = sqrt(max(vec2f(1.0 - tl * tl, 1.0 - te * te), vec2f(0.0)));
    return vec2f(sines.x, pow(saturate(sines.x * sines.y - tl * te), exponent));
}
