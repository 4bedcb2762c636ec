// The way of a ray through the tree of boxes around triangles. Its parts stand in the order in which
// a walk meets them, and each knows where the walk goes on if it misses the box: no stack is needed.

struct CascaWalk {
    inverse: vec3f,
    // Distances: where it enters the grid, and where it leaves the grid or ends.
    enter: f32,
    leave: f32,
    // Hits nearer or farther than these are none.
    least: f32,
    most: f32,
    // Where it enters the grid, and how far from there boxes are looked at.
    near: vec3f,
    limit: f32,
    // The part to look at next, and the range of triangles in the last leaf that was found.
    next: u32,
    first: u32,
    end: u32,
    // Whether it misses the grid.
    done: bool,
}

fn casca_least(v: vec3f) -> f32 { return min(v.x, min(v.y, v.z)); }

fn casca_walk(origin: vec3f, direction: vec3f, reach: f32) -> CascaWalk {
    let way = select(direction, vec3f(NO_WAY), abs(direction) < vec3f(NO_WAY));
    let inverse = 1.0 / way;
    let one = -origin * inverse;
    let other = (vec3f(casca_grid.dims) - origin) * inverse;
    let enter = max(-casca_least(-min(one, other)), 0.0);
    let beyond = casca_least(max(one, other));
    let leave = min(beyond, reach);
    // What is outside of the grid does not exist.
    let least = max(enter - GROW, 0.0);
    let most = min(beyond + GROW, reach);
    let near = origin + direction * enter;
    return CascaWalk(inverse, enter, leave, least, most, near, leave - enter + BOX, 0u, 0u, 0u, enter > leave);
}

// Looks at no box farther than a distance from the origin, if it did.
fn casca_end(walk: ptr<function, CascaWalk>, distance: f32) {
    (*walk).limit = min((*walk).limit, distance - (*walk).enter + BOX);
}

// Goes on to the next leaf on the way; false if there is none.
fn casca_on(walk: ptr<function, CascaWalk>) -> bool {
    while !(*walk).done && (*walk).next < casca_grid.parts {
        let at = casca_grid.tree + 8u * (*walk).next;
        let low = bitcast<vec3f>(vec3u(casca_cells[at], casca_cells[at + 1u], casca_cells[at + 2u]));
        let high = bitcast<vec3f>(vec3u(casca_cells[at + 3u], casca_cells[at + 4u], casca_cells[at + 5u]));
        let one = (low - (*walk).near) * (*walk).inverse;
        let other = (high - (*walk).near) * (*walk).inverse;
        let enter = max(-casca_least(-min(one, other)), 0.0);
        let leave = min(casca_least(max(one, other)), (*walk).limit);
        if enter > leave {
            (*walk).next = casca_cells[at + 6u];
            continue;
        }
        (*walk).next++;
        let leaf = casca_cells[at + 7u];
        if leaf == 0u { continue; }
        (*walk).first = casca_grid.list + leaf / LEAVES;
        (*walk).end = (*walk).first + leaf % LEAVES;
        return true;
    }
    return false;
}

// Whether a ray meets no triangle on its way.
fn casca_open(origin: vec3f, direction: vec3f, reach: f32) -> bool {
    var walk = casca_walk(origin, direction, reach);
    while casca_on(&walk) {
        for (var k = walk.first; k < walk.end; k++) {
            let distance = casca_meet(casca_cells[k], origin, direction);
            if distance >= walk.least && distance <= walk.most { return false; }
        }
    }
    return true;
}

// Whether the segment between two points meets no triangle.
fn casca_free(origin: vec3f, to: vec3f) -> bool {
    let way = to - origin;
    let reach = length(way);
    if reach <= 0.0 { return true; }
    return casca_open(origin, way / reach, reach);
}
