// Draws solids by casting a ray through each pixel, and meshes as triangles. All
// positions are taken relative to the eye, so that the eye is exact.

struct Eye {
    right: vec4f,
    up: vec4f,
    forward: vec4f,
    position: vec4f,
    // Half the picture over its distance, as in the projection matrix: x, y; near plane; near over far plane.
    lens: vec4f,
    // Width and height in pixels.
    size: vec4f,
}

@group(0) @binding(0) var<uniform> eye: Eye;

const SKY: vec3f = vec3f(0.83, 0.88, 0.93);
const SUN: vec3f = vec3f(0.45, 0.80, 0.40);

struct Instance {
    // A sphere: centre and radius. A box: least corner and a negative number.
    // A mesh: the first row of its transform.
    @location(1) a: vec4f,
    // A box: greatest corner. A mesh: the second row.
    @location(2) b: vec4f,
    // A mesh: the third row.
    @location(3) c: vec4f,
    @location(4) colour: vec4f,
    @location(5) id: u32,
}

struct Fragment {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) a: vec4f,
    @location(1) @interpolate(flat) b: vec4f,
    @location(2) @interpolate(flat) colour: vec4f,
    @location(3) @interpolate(flat) id: u32,
    // A mesh: position relative to the eye.
    @location(4) relative: vec3f,
}

// View space, from a position relative to the eye: x, y and depth.
fn view(p: vec3f) -> vec3f {
    return vec3f(dot(eye.right.xyz, p), dot(eye.up.xyz, p), dot(eye.forward.xyz, p));
}

// Depth is near / distance along the view axis: as precise far away as nearby.
fn clip(p: vec3f) -> vec4f {
    let v = view(p);
    return vec4f(v.xy * eye.lens.xy, eye.lens.z, v.z);
}

// The ray through a pixel, one metre deep for each unit.
fn ray(pixel: vec2f) -> vec3f {
    let ndc = vec2f(2.0 * pixel.x / eye.size.x - 1.0, 1.0 - 2.0 * pixel.y / eye.size.y);
    let at = ndc / eye.lens.xy;
    return eye.forward.xyz + eye.right.xyz * at.x + eye.up.xyz * at.y;
}

fn shade(colour: vec3f, normal: vec3f, distance: f32) -> vec4f {
    let sun = max(dot(normal, normalize(SUN)), 0.0);
    let sky = 0.5 + 0.5 * normal.y;
    let lit = colour * (0.36 + 0.26 * sky + 0.46 * sun);
    return vec4f(mix(SKY, lit, exp(-distance * eye.size.z)), 1.0);
}

// Solids: boxes and spheres. The box around each is drawn slightly enlarged,
// by its back faces, and decides only which pixels ask.

fn lower(i: Instance) -> vec3f {
    return select(i.a.xyz, i.a.xyz - i.a.w, i.a.w >= 0.0) - eye.position.xyz;
}

fn upper(i: Instance) -> vec3f {
    return select(i.b.xyz, i.a.xyz + i.a.w, i.a.w >= 0.0) - eye.position.xyz;
}

@vertex
fn solid_corner(@builtin(vertex_index) index: u32, i: Instance) -> Fragment {
    // Two triangles for each side: counter-clockwise seen from outside.
    let side = index / 6u;
    let axis = side >> 1u;
    var quad = array<vec2f, 6>(
        vec2f(0.0, 0.0), vec2f(1.0, 0.0), vec2f(1.0, 1.0), vec2f(0.0, 0.0), vec2f(1.0, 1.0), vec2f(0.0, 1.0),
    );
    var q = quad[index % 6u];
    let high = f32(side & 1u);
    if high == 0.0 {
        q = q.yx;
    }
    var corner = vec3f(high, q.x, q.y);
    if axis == 1u {
        corner = vec3f(q.y, high, q.x);
    } else if axis == 2u {
        corner = vec3f(q.x, q.y, high);
    }
    let lo = lower(i);
    let hi = upper(i);
    let margin = 1e-3 * (hi - lo) + 1e-4 * max(length(lo), length(hi));
    let p = mix(lo - margin, hi + margin, corner);
    var out: Fragment;
    out.position = clip(p);
    // Neither the near nor the far plane may clip it: the ray decides.
    out.position.z = 0.5 * out.position.w;
    out.a = i.a;
    out.b = i.b;
    out.colour = i.colour;
    out.id = i.id;
    return out;
}

struct Hit {
    // Along the ray; negative if it misses.
    t: f32,
    normal: vec3f,
}

fn hit_sphere(c: vec3f, radius: f32, d: vec3f) -> Hit {
    let dd = dot(d, d);
    let middle = dot(d, c) / dd;
    let off = c - d * middle;
    let room = radius * radius - dot(off, off);
    if room < 0.0 {
        return Hit(-1.0, d);
    }
    let t = middle - sqrt(room / dd);
    return Hit(t, normalize(d * t - c));
}

fn hit_box(lo: vec3f, hi: vec3f, d: vec3f) -> Hit {
    let safe = select(d, vec3f(1e-20), abs(d) < vec3f(1e-20));
    let t0 = lo / safe;
    let t1 = hi / safe;
    let first = min(t0, t1);
    let last = max(t0, t1);
    let enter = max(first.x, max(first.y, first.z));
    // Borders count: boxes that abut leave no gap.
    if enter > min(last.x, min(last.y, last.z)) {
        return Hit(-1.0, d);
    }
    let face = step(vec3f(enter), first);
    return Hit(enter, -sign(d) * normalize(face));
}

fn hit(f: Fragment) -> Hit {
    let d = ray(f.position.xy);
    let origin = f.a.xyz - eye.position.xyz;
    if f.a.w >= 0.0 {
        return hit_sphere(origin, f.a.w, d);
    }
    return hit_box(origin, f.b.xyz - eye.position.xyz, d);
}

// Solids are seen from outside only, between the planes.
fn seen(f: Fragment) -> Hit {
    let h = hit(f);
    if h.t < eye.lens.z || eye.lens.z / h.t < eye.lens.w {
        discard;
    }
    return h;
}

struct Picture {
    @location(0) colour: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn solid_colour(f: Fragment) -> Picture {
    let h = seen(f);
    return Picture(shade(f.colour.rgb, h.normal, h.t), eye.lens.z / h.t);
}

struct Item {
    @location(0) id: u32,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn solid_item(f: Fragment) -> Item {
    let h = seen(f);
    return Item(f.id, eye.lens.z / h.t);
}

@vertex
fn mesh_corner(@location(0) position: vec3f, i: Instance) -> Fragment {
    let p = vec4f(position, 1.0);
    var out: Fragment;
    out.relative = vec3f(dot(i.a, p), dot(i.b, p), dot(i.c, p)) - eye.position.xyz;
    out.position = clip(out.relative);
    out.colour = i.colour;
    out.id = i.id;
    return out;
}

@fragment
fn mesh_colour(f: Fragment) -> @location(0) vec4f {
    // The triangle's own normal, towards the eye: meshes are seen from both sides.
    let across = cross(dpdx(f.relative), dpdy(f.relative));
    let normal = -across * sign(dot(across, f.relative)) / max(length(across), 1e-20);
    if f.position.z < eye.lens.w {
        discard;
    }
    return shade(f.colour.rgb, normal, length(f.relative));
}

@fragment
fn mesh_item(f: Fragment) -> @location(0) u32 {
    if f.position.z < eye.lens.w {
        discard;
    }
    return f.id;
}

// Marks: lines some pixels wide, and translucent triangles.

struct Mark {
    @builtin(position) position: vec4f,
    @location(0) colour: vec4f,
}

@vertex
fn line_corner(
    @builtin(vertex_index) index: u32,
    @location(0) start: vec3f,
    @location(1) width: f32,
    @location(2) end: vec3f,
    @location(3) colour: vec4f,
) -> Mark {
    var from_eye = view(start - eye.position.xyz);
    var to_eye = view(end - eye.position.xyz);
    let near = eye.lens.z * 1.01;
    var out: Mark;
    out.colour = colour;
    if max(from_eye.z, to_eye.z) <= near {
        out.position = vec4f(2.0, 2.0, 0.0, 1.0);
        return out;
    }
    // What lies before the near plane is cut off.
    let way = to_eye - from_eye;
    if from_eye.z < near {
        from_eye += way * ((near - from_eye.z) / way.z);
    }
    if to_eye.z < near {
        to_eye -= way * ((to_eye.z - near) / way.z);
    }
    let a = from_eye.xy * eye.lens.xy / from_eye.z * eye.size.xy * 0.5;
    let b = to_eye.xy * eye.lens.xy / to_eye.z * eye.size.xy * 0.5;
    let along = (b - a) / max(length(b - a), 1e-6);
    let across = vec2f(-along.y, along.x) * width * 0.5;
    let is_end = index == 1u || index == 2u || index == 4u;
    let left = index == 0u || index == 1u || index == 3u;
    let middle = select(from_eye, to_eye, is_end);
    let pixel = select(a, b, is_end) + select(-across, across, left);
    let ndc = pixel / (eye.size.xy * 0.5);
    out.position = vec4f(ndc * middle.z, eye.lens.z, middle.z);
    return out;
}

@vertex
fn fill_corner(@location(0) position: vec3f, @location(1) colour: vec4f) -> Mark {
    var out: Mark;
    out.position = clip(position - eye.position.xyz);
    out.colour = colour;
    return out;
}

@fragment
fn mark_colour(m: Mark) -> @location(0) vec4f {
    return m.colour;
}

// What is behind other things shows through faintly.
@fragment
fn mark_behind(m: Mark) -> @location(0) vec4f {
    return vec4f(m.colour.rgb, m.colour.a * 0.22);
}
