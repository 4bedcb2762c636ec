// The strand that a fragment of a layer shows, for other renderers, too: `casca_fur::shader` says what it asks for.

// A pixel is at least so wide, in object space: 0, in the eye itself, has no logarithm.
const LEAST_WIDTH: f32 = 1e-12;
// A ray climbs at least so fast, in heights of the fur: one that neither rises nor bends leaves its slab far away, and
// not nowhere.
const LEAST_CLIMB: f32 = 1e-6;
// The foot of a ray goes at least so fast along the skin: that of a ray along the normal stays, and has no curve.
const LEAST_SPEED: f32 = 1e-20;

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

/// Must be called by all fragments.
fn change(in: Shell) -> Change {
    let normal = normalize(in.normal);
    let shell = in.base + extrusion(bent(in.bend), normal, in.coat.w * height_of(in.which));
    return Change(
        array(dpdx(in.base), dpdy(in.base)), array(dpdx(normal), dpdy(normal)), array(dpdx(shell), dpdy(shell)),
    );
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

/// The strand that a ray meets between this shell and the next one: shells seen from the side do not come apart.
fn along_ray(in: Shell, c: Change, skin: Skin, ray: vec3f) -> Seen {
    let there = bent(in.bend);
    let height = height_of(in.which) * in.coat.w;
    let up = (skin.normal + bend_at(there, skin.normal) * (2.0 * height)) * look.height;
    let across = cross(c.shell[0], c.shell[1]);
    let det = dot(across, up);
    let x = dot(cross(ray, c.shell[1]), up) / det;
    let y = dot(cross(c.shell[0], ray), up) / det;
    let side = c.base[0] * x + c.base[1] * y;
    let turn = c.normal[0] * x + c.normal[1] * y;
    let rise = dot(across, ray) / det;
    if rise > 0.0 && in.which.y >= in.which.z {
        // Nothing is above the highest shell.
        return Seen(false, 0.0, 0.0, 0.0, vec3f(0.0), skin.normal);
    }
    // The skin bends away from the ray, so that the height is a parabola. Beyond the triangle it goes by the normal and
    // not by the triangle.
    let bulge = dot(ray, turn) / look.height;
    let climb = dot(ray, skin.normal) / look.height;
    let far = through_slab(select(rise, climb, climb * rise >= 0.0), bulge, in.coat.w / f32(max(in.which.z, 1u)));
    // In cells from here on.
    let cell = look.spacing;
    let speed = length(side);
    let curve = dot(side, turn) / max(speed, LEAST_SPEED);
    let narrowing = curve / max(speed, LEAST_SPEED) * look.height;
    var path: Path;
    path.skin = skin;
    path.skin.slope = skin.slope * cell;
    path.corner = (in.corner - in.base) / cell;
    // Between vertices a shell is as much lower as the mean of their normals is shorter.
    path.start = extrusion(there, skin.normal, height * length(in.normal)) / cell;
    path.ray = ray;
    path.far = far / cell;
    path.side = side;
    path.curve = curve * cell;
    path.slowing = narrowing * rise / (1.0 + narrowing * height) * cell;
    path.height = height;
    path.rise = rise * cell;
    path.bulge = bulge * cell * cell;
    path.long = in.coat.w;
    let met = strand_along(there, path);
    return Seen(met.found, f32(met.id & 255u) / 255.0, met.along, met.height, met.root * cell, met.normal);
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
    let word = dither(in.base, width, in.which.y);
    if unit(word.x) < saturate((width - look.fine) / (look.coarse - look.fine)) {
        return Seen(unit(word.y) < mean_cover(look, t), unit(word.z), t, height, vec3f(0.0), normal);
    }
    let skin = skin_of(in.base, normal, c);
    if look.steps <= 1u {
        return strand_here(bent(in.bend), skin, height, long);
    }
    return along_ray(in, c, skin, ray);
}
