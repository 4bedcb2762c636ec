// The strand that a ray meets first: strands are cones on skin that bends, found cell by cell below the ray.

// Skin that turns farther than this, as the square of the sine, is not what the skin at the base says of it.
const MOST_TURN: f32 = 0.3;
// Past the border of a cell, in cells: far more than rounding, far less than a strand.
const PAST_BORDER: f32 = 0.01;

/// A ray through fur. All lengths are in cells, those of the skin's place in object space.
struct Path {
    // Below the beginning of the ray; its slope is for each cell.
    skin: Skin,
    // From the base to a corner of its triangle.
    corner: vec3f,
    // From the base to the beginning of the ray; its unit direction, and how far it goes.
    start: vec3f,
    ray: vec3f,
    far: f32,
    // How its foot moves along the skin, how the normal turns there in radians, and how much slower feet get as the ray
    // rises, for each cell of its way.
    side: vec3f,
    curve: f32,
    slowing: f32,
    // Its height at the beginning, and a parabola's terms for each cell; the length of the coat.
    height: f32,
    rise: f32,
    bulge: f32,
    long: f32,
}

/// The strand that a ray meets, if any.
struct Met {
    found: bool,
    id: u32,
    // How far that is, in cells.
    way: f32,
    along: f32,
    height: f32,
    // From the base to the strand's root, in cells; the normal there.
    root: vec3f,
    normal: vec3f,
}

/// From the base to the skin below a ray that has gone `way`: an arc.
fn foot_of(path: Path, way: f32) -> vec3f {
    let reach = way / max(1.0 + path.slowing * way, 0.1);
    let turn = path.curve * reach;
    let long = sqrt(1.0 + turn * turn);
    return (path.side * reach - path.skin.normal * (length(path.side) * reach * turn / (1.0 + long))) / long;
}

/// How high a point of the plane of the triangle lies below the skin. Within the triangle it is the skin; around it the
/// skin bends as its normals do, and passes through the corner.
fn bend_beyond(path: Path, x: vec3f) -> f32 {
    let slope = path.skin.slope;
    let beyond = dot(path.skin.normal, path.corner - x)
        + 0.5 * (dot(path.corner, slope * path.corner) - dot(x, slope * x));
    let bowed = sign(slope[0].x + slope[1].y + slope[2].z);
    return bowed * min(bowed * beyond, 0.0);
}

/// Where a ray enters the strand of a point, which is `way` from the base, if the point is a root.
fn entered(look: Look, path: Path, way: vec3f, id: u32) -> Met {
    var met = Met(false, id, 1e30, 0.0, 0.0, vec3f(0.0), vec3f(0.0));
    let flat = way - path.skin.normal * dot(way, path.skin.normal);
    let turn = path.skin.slope * flat;
    let turned = dot(turn, turn);
    let normal = normalize(turn + path.skin.normal * sqrt(max(1.0 - turned, 0.0)));
    let plane = path.skin.plane;
    let over = dot(way, plane);
    let above = (over - bend_beyond(path, way - plane * over)) / max(dot(normal, plane), LEAST_LEAN);
    if abs(above) >= HALF_SLAB || turned > MOST_TURN {
        return met;
    }
    met.root = way - normal * above;
    met.normal = normal;
    // A cone along the strand where the ray passes it.
    let passes = clamp(dot(flat, path.side) / max(dot(path.side, path.side), 1e-12), 0.0, path.far);
    let h = clamp(path.height + passes * (path.rise + 0.5 * path.bulge * passes), 0.0, path.long);
    let tangent = strand_tangent(look, normal, h);
    let middle = met.root + extrusion(look, normal, h) / look.spacing - path.start;
    let length = path.long * share(look, id);
    // From here on x is at the beginning of the ray, and y what a cell of its way adds.
    let back = vec2f(-dot(middle, tangent), dot(path.ray, tangent));
    let rise = dot(tangent, normal) * look.spacing / max(look.height * length, 1e-30);
    let along = vec2f(h / length, 0.0) + back * rise;
    let radius = look.radius * (vec2f(1.0, 0.0) - look.taper * along);
    let away = -middle - tangent * back.x;
    let going = path.ray - tangent * back.y;
    // Inside of the cone a way² + 2 b way + c is below 0.
    let a = dot(going, going) - radius.y * radius.y;
    let b = dot(away, going) - radius.x * radius.y;
    let c = dot(away, away) - radius.x * radius.x;
    let square = b * b - a * c;
    let q = -(b + select(-1.0, 1.0, b >= 0.0) * sqrt(max(square, 0.0)));
    let sides = vec2f(min(q / a, c / q), max(q / a, c / q));
    let ends = (vec2f(0.0, 1.0) - along.x) / along.y;
    var first = max(0.0, min(ends.x, ends.y));
    var last = min(path.far, max(ends.x, ends.y));
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
    met.found = square >= 0.0 && first <= last;
    met.way = first;
    met.along = clamp(along.x + along.y * first, 0.0, 1.0);
    met.height = met.along * length;
    return met;
}

/// The strand that a ray meets first, in at most `look.steps` blocks of cells.
fn strand_along(look: Look, path: Path) -> Met {
    let place = path.skin.base / look.spacing;
    var best = Met(false, 0u, 1e30, 0.0, 0.0, vec3f(0.0), vec3f(0.0));
    var way = 0.0;
    var foot = vec3f(0.0);
    var before = vec3f(1e30);
    for (var i = 0u; i < look.steps; i++) {
        // All strands that reach the ray here have their points in these eight cells.
        let at = place + foot;
        let first = floor(at - 0.5);
        for (var corner = 0u; corner < 8u; corner++) {
            let cell = first + vec3f(f32(corner & 1u), f32((corner >> 1u) & 1u), f32(corner >> 2u));
            if all(cell >= before) && all(cell <= before + 1.0) {
                continue;
            }
            let number = bitcast<vec3u>(vec3i(cell));
            for (var k = 0u; k < look.per_cell; k++) {
                let word = hash(vec4u(number, look.seed * 4u + k));
                let point = (cell - place) + vec3f(unit(word.x), unit(word.y), unit(word.z));
                let met = entered(look, path, point, word.w);
                if met.found && met.way < best.way {
                    best = met;
                }
            }
        }
        if way >= path.far || way > best.way {
            break;
        }
        // To where the next eight are others.
        before = first;
        let speed = 2.0 * (foot_of(path, way + 0.5) - foot);
        let border = first + 0.5 + select(vec3f(0.0), vec3f(1.0), speed > vec3f(0.0));
        let next = select(vec3f(1e30), (border - at) / speed, abs(speed) > vec3f(1e-6));
        way = min(way + max(min(next.x, min(next.y, next.z)), 0.0) + PAST_BORDER, path.far);
        foot = foot_of(path, way);
    }
    return best;
}
