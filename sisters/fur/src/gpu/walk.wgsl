// The strand that a fragment's ray meets first, for studies: cones on skin that bends, found cell by cell below the ray.

// Skin that turns farther than this, as the square of the sine, is not what the skin at the base says of it.
const MOST_TURN: f32 = 0.3;
// The most blocks of cells that a ray visits: eight cells, and one to seven more for each next block. Only rays along the
// skin under tall fur with few layers take as many: 4 layers of 10% leave an error of 0.0732, as with 64 blocks.
const STEPS: u32 = 24u;
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
    let cone = into_cone(look, -middle, path.ray, tangent, dot(tangent, normal), h, length, path.far);
    met.found = cone.found;
    met.way = cone.way;
    met.along = cone.along;
    met.height = met.along * length;
    return met;
}

/// The strand that a ray meets first, in at most `STEPS` blocks of cells.
fn strand_along(look: Look, path: Path) -> Met {
    let place = path.skin.base / look.spacing;
    var best = Met(false, 0u, 1e30, 0.0, 0.0, vec3f(0.0), vec3f(0.0));
    var way = 0.0;
    var foot = vec3f(0.0);
    var before = vec3f(1e30);
    for (var i = 0u; i < STEPS; i++) {
        // All strands that reach the ray here have their points in these eight cells.
        let at = place + foot;
        let first = floor(at - 0.5);
        for (var corner = 0u; corner < 8u; corner++) {
            let cell = first + vec3f(f32(corner & 1u), f32((corner >> 1u) & 1u), f32(corner >> 2u));
            if all(cell >= before) && all(cell <= before + 1.0) {
                continue;
            }
            for (var k = 0u; k < look.per_cell; k++) {
                let point = point_of(look, cell, k);
                let met = entered(look, path, (cell - place) + point.place, point.id);
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

/// The strand that a ray meets between this shell and the next one: shells seen from the side do not come apart.
fn strand_met(in: Shell, c: Change, skin: Skin, ray: vec3f) -> Seen {
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
    return Seen(met.found, f32(met.id) / 255.0, met.along, met.height, met.root * cell, met.normal);
}
