// The way of a ray through the cells that list triangles. It skips bricks without any.

struct CascaWalk {
    origin: vec3f,
    direction: vec3f,
    inverse: vec3f,
    // Distances: where it enters the grid, and where it leaves the grid or ends.
    enter: f32,
    leave: f32,
    // Hits nearer or farther than these are none.
    least: f32,
    most: f32,
    // Where it leaves the last cell that was found.
    exit: f32,
    // The range of triangles in that cell.
    first: u32,
    end: u32,
    // The cell to look at next, and whether there is none.
    cell: vec3i,
    done: bool,
    steps: i32,
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
    let cell = clamp(vec3i(floor(origin + direction * enter)), vec3i(0), casca_grid.dims - 1);
    return CascaWalk(origin, direction, inverse, enter, leave, least, most, enter, 0u, 0u, cell, enter > leave, 0);
}

// Goes on to the next cell that lists triangles; false if there is none.
fn casca_on(walk: ptr<function, CascaWalk>) -> bool {
    let ahead = (*walk).inverse > vec3f(0.0);
    while !(*walk).done && (*walk).steps < MOST_WALK {
        (*walk).steps++;
        let cell = (*walk).cell;
        let b = cell >> vec3u(2u);
        let brick = 3 * ((b.z * casca_grid.bricks.y + b.y) * casca_grid.bricks.x + b.x);
        let is_empty = (casca_cells[brick] | casca_cells[brick + 1]) == 0u;
        let low = select(cell, b << vec3u(2u), is_empty);
        let high = low + select(1, 4, is_empty);
        let ends = (vec3f(select(low, high, ahead)) - (*walk).origin) * (*walk).inverse;
        let exit = casca_least(ends);
        // Along the other axes it stays beside the brick that it leaves.
        var next = clamp(vec3i(floor((*walk).origin + (*walk).direction * exit)), low, high - 1);
        let beyond = select(low - 1, high, ahead);
        if ends.x == exit { next.x = beyond.x; } else if ends.y == exit { next.y = beyond.y; } else { next.z = beyond.z; }
        (*walk).exit = exit;
        (*walk).cell = next;
        (*walk).done = exit >= (*walk).leave || any(next < vec3i(0)) || any(next >= casca_grid.dims);
        if is_empty { continue; }
        let at = casca_occupied(cell);
        if at < 0 { continue; }
        (*walk).first = casca_cells[casca_grid.firsts + u32(at)];
        (*walk).end = casca_cells[casca_grid.firsts + u32(at) + 1u];
        return true;
    }
    return false;
}
