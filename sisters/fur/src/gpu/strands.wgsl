// Where strands stand and how they are lit: the twin of `Fur` in casca-fur, in single precision.

// Half the slab around the skin in which points are roots, in cells; as in casca-fur.
const HALF_SLAB: f32 = 0.25;
// Normals that lean more belong to another surface; as in casca-fur.
const LEAST_LEAN: f32 = 0.1;
// A coat shorter than this share of the full length is bald: a step of a colour of 8 bits.
const SHORTEST: f32 = 0.004;
// The sun's least height over the skin; as in casca-fur.
const LEAST_RISE: f32 = 0.15;
// Cells after which strands repeat, and what makes lengths of their bytes; as in casca-fur.
const PERIOD: u32 = 16u;
const SPREAD: u32 = 0x9e3779b1u;
// Tufts and curls; as in casca-fur.
const TUFT: f32 = 9.0;
const CLUMPED: f32 = 0.1;
const CURLED: f32 = 0.045;
const TURNS: f32 = 16.0;

struct Look {
    // See `Fur` in casca-fur.
    bend: vec3f,
    height: f32,
    spacing: f32,
    radius: f32,
    taper: f32,
    variation: f32,
    clump: f32,
    curl: f32,
    per_cell: u32,
    seed: u32,
    // From this width of a pixel to its double strands give way to their mean.
    fine: f32,
    exponent: f32,
    wrap: f32,
    dark: f32,
    ambient: f32,
    diffuse: f32,
    specular: f32,
    vary: f32,
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
    return 1.0 - look.variation * unit(id * SPREAD);
}

/// A point of a cell, from its least corner, and its random byte: the twin of `Fur::point`.
struct Point {
    place: vec3f,
    id: u32,
}

fn point_of(look: Look, cell: vec3f, k: u32) -> Point {
    let number = bitcast<vec3u>(vec3i(cell)) % vec3u(PERIOD);
    let word = hash(vec4u(number, look.seed * 4u + k));
    return Point((vec3f(word.xyz >> vec3u(25u)) + 0.5) / 128.0, word.w >> 24u);
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

/// The part of the bend along the skin.
fn bend_at(look: Look, normal: vec3f) -> vec3f {
    return look.bend - normal * dot(look.bend, normal);
}

/// How strands of a tuft go aside at a height, besides their bend: how far, in heights of the fur, and the bend that has
/// the same slope there. The twin of `Fur::sway`.
struct Sway {
    way: vec3f,
    bend: vec3f,
}

fn sway(look: Look, base: vec3f, height: f32) -> Sway {
    let tuft = TUFT * look.spacing;
    let at = base * (6.2831853 / tuft);
    let wave = sin(at + 2.0 * sin(0.61 * at.yzx));
    let angle = TURNS * height + 2.0 * wave.x + vec3f(0.0, 2.0943951, 4.1887902);
    let tufts = tuft / max(look.height, 1e-30);
    let clump = wave * (look.clump * CLUMPED * tufts);
    let curl = look.curl * CURLED * tufts;
    return Sway(
        (clump + curl * cos(angle)) * (height * height),
        clump + curl * (cos(angle) - (0.5 * TURNS * height) * sin(angle)),
    );
}

/// The way in the mesh at rest that becomes `way`; nowhere for matrices that flatten.
fn taken_back(axes: mat3x3f, way: vec3f) -> vec3f {
    let adjugate = mat3x3f(cross(axes[1], axes[2]), cross(axes[2], axes[0]), cross(axes[0], axes[1]));
    let det = dot(axes[0], adjugate[0]);
    return (way * adjugate) * (sign(det) / max(abs(det), 1e-30));
}

/// From a point of the skin to the layer at a height.
fn extrusion(look: Look, normal: vec3f, height: f32) -> vec3f {
    return (normal * height + bend_at(look, normal) * (height * height)) * look.height;
}

/// The direction of strands at a height.
fn strand_tangent(look: Look, normal: vec3f, height: f32) -> vec3f {
    return normalize(normal + bend_at(look, normal) * (2.0 * height));
}

/// Where a ray enters a strand: how many cells along it, and where on the strand, 0 to 1.
struct Cone {
    found: bool,
    way: f32,
    along: f32,
}

/// A strand along a tangent, which rises by `lean` for each cell. `away` leads from its middle at a height to the
/// beginning of the ray.
fn into_cone(look: Look, away: vec3f, ray: vec3f, tangent: vec3f, lean: f32, height: f32, length: f32, far: f32) -> Cone {
    // From here on x is at the beginning of the ray, and y what a cell of its way adds.
    let back = vec2f(dot(away, tangent), dot(ray, tangent));
    let rise = lean * look.spacing / max(look.height * length, 1e-30);
    let along = vec2f(height / length, 0.0) + back * rise;
    let radius = look.radius * (vec2f(1.0, 0.0) - look.taper * along);
    let aside = away - tangent * back.x;
    let going = ray - tangent * back.y;
    // Inside of the cone a way² + 2 b way + c is below 0.
    let a = dot(going, going) - radius.y * radius.y;
    let b = dot(aside, going) - radius.x * radius.y;
    let c = dot(aside, aside) - radius.x * radius.x;
    let square = b * b - a * c;
    let q = -(b + select(-1.0, 1.0, b >= 0.0) * sqrt(max(square, 0.0)));
    let sides = vec2f(min(q / a, c / q), max(q / a, c / q));
    let ends = (vec2f(0.0, 1.0) - along.x) / along.y;
    var first = max(0.0, min(ends.x, ends.y));
    var last = min(far, max(ends.x, ends.y));
    if a > 0.0 {
        first = max(first, sides.x);
        last = min(last, sides.y);
    } else if radius.y > 0.0 {
        // Steeper than the cone, towards the root...
        first = max(first, sides.y);
    } else {
        // ...and towards the tip.
        last = min(last, sides.x);
    }
    return Cone(square >= 0.0 && first <= last, first, clamp(along.x + along.y * first, 0.0, 1.0));
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
    // Strands of four lengths stand for all: how wide each is from here on, times how far it goes.
    let lengths = max(long, 1e-30) * (1.0 - look.variation * (vec4f(0.5, 1.5, 2.5, 3.5) / 4.0));
    let shadows = max(lengths - height, vec4f(0.0)) * (2.0 - look.taper * (1.0 + height / lengths));
    // The bend halfway up.
    let met = dot(shadows, vec4f(0.25)) * length(slope - bend_at(look, normal) * (height + long));
    let strands = 0.5 * f32(look.per_cell) / look.spacing;
    return exp(-met * look.height * look.radius * strands);
}

/// The diffuse and the specular share of the light of a strand along `along`: Kajiya and Kay 1989.
fn kajiya_kay(along: vec3f, to_light: vec3f, to_eye: vec3f, exponent: f32) -> vec2f {
    let tl = dot(along, to_light);
    let te = dot(along, to_eye);
    let sines = sqrt(max(vec2f(1.0 - tl * tl, 1.0 - te * te), vec2f(0.0)));
    return vec2f(sines.x, pow(saturate(sines.x * sines.y - tl * te), exponent));
}
