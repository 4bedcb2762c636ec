// Triangle meshes among the lines: their depth and shade in each pixel.

struct Corner {
    @builtin(position) at: vec4f,
    @location(0) eye: vec3f,
    @location(1) normal: vec3f,
    @location(2) colour: vec3f,
}

struct Shaded {
    @location(0) depth: f32,
    @location(1) colour: vec4f,
}

@vertex
fn corner(@location(0) position: vec3f, @location(1) normal: vec3f, @location(2) colour: vec4f) -> Corner {
    let eye = to_eye(position);
    let p = project(eye);
    let size = vec2f(lens.size);
    let range = lens.far - lens.near;
    let along = (-eye.z - lens.near) / range;
    var made: Corner;
    made.at = vec4f(p.x * 2.0 / size.x - p.z, p.z - p.y * 2.0 / size.y, select(along, along * lens.far, lens.perspective == 1u), p.z);
    made.eye = eye;
    made.normal = vec3f(dot(lens.right, normal), dot(lens.up, normal), dot(lens.back, normal));
    made.colour = colour.rgb;
    return made;
}

// Both sides of a mesh look alike.
@fragment
fn shade(corner: Corner) -> Shaded {
    let flat = cross(dpdx(corner.eye), dpdy(corner.eye));
    let long = length(corner.normal);
    let normal = select(normalize(flat), corner.normal / max(long, LEAST_NORMAL), long > LEAST_NORMAL);
    let away = away_at(corner.eye);
    let turned = select(normal, -normal, dot(normal, away) > 0.0);
    let light = max(dot(turned, normalize(vec3f(-0.45, 0.7, 0.6))), 0.0);
    return Shaded(-corner.eye.z, vec4f(corner.colour * (0.55 + 0.45 * light), 1.0));
}
