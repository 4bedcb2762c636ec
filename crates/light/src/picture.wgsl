// Pictures: the triangle in each pixel, then its light, then colours (thesis 2.4; digest S8 and S9, with its defects avoided).

struct Eye {
  to_clip: mat4x4f,
  position: vec3f, layer: u32,
  // The ray of a pixel: corner + x right + y down.
  corner: vec3f, width: u32,
  right: vec3f, height: u32,
  down: vec3f, exposure: f32,
}
@group(0) @binding(50) var<uniform> eye: Eye;
@group(0) @binding(51) var items: texture_2d<u32>;
@group(0) @binding(52) var<storage, read_write> light_out: array<vec4f>;
@group(0) @binding(53) var<storage, read> light_in: array<vec4f>;

struct Corner { @builtin(position) position: vec4f, @location(0) @interpolate(flat) triangle: u32 }

@vertex
fn item_corner(@builtin(vertex_index) index: u32) -> Corner {
  let triangle = triangles[index / 3u];
  var at = triangle.a;
  if (index % 3u == 1u) { at = triangle.b; }
  if (index % 3u == 2u) { at = triangle.c; }
  return Corner(eye.to_clip * vec4f(at, 1.0), index / 3u + 1u);
}

@fragment
fn item(corner: Corner) -> @location(0) u32 { return corner.triangle; }

// Light of all lights, with soft shadows by cones to them.
fn lamps(at: vec3f, normal: vec3f, view: vec3f, material: Material) -> vec3f {
  var sum = vec3f(0.0);
  let start = at + push_off(normal);
  for (var i = 0u; i < volume.light_count; i++) {
    let light = incident(lights[i], at);
    let cosine = dot(normal, light.direction);
    if (cosine <= 0.0 || all(light.irradiance <= vec3f(0.0))) { continue; }
    let way = incident(lights[i], start);
    let far = way.distance - length(start - at);
    var open: f32;
    if (way.spread > 0.0) { open = cone(start, way.direction, way.spread, far).open; }
    else { open = f32(walk(start, way.direction, far).w == 0); }
    sum += light.irradiance * (cosine * open) * (material.albedo / PI + highlight(light.direction, normal, view, material));
  }
  return sum;
}

// The exponent of Phong's lobe.
fn exponent(material: Material) -> f32 { return exp2(11.0 * material.gloss + 1.0); }

// Phong's lobe around the mirror direction, of as much light as falls in.
fn highlight(to_light: vec3f, normal: vec3f, view: vec3f, material: Material) -> vec3f {
  let power = exponent(material);
  let cosine = max(dot(reflect(-to_light, normal), view), 0.0);
  return material.specular * ((power + 2.0) / (2.0 * PI) * pow(cosine, power));
}

fn voxel_at(ray: vec3f) -> vec4f {
  // From outside the grid the walk starts where the ray enters it.
  let along = select(ray, vec3f(TINY * TINY), abs(ray) < vec3f(TINY * TINY));
  let low = -eye.position / along;
  let high = (vec3f(volume.dims) - eye.position) / along;
  let enters = min(low, high);
  let leaves = max(low, high);
  let way = max(max(enters.x, max(enters.y, enters.z)), 0.0);
  if (way >= min(leaves.x, min(leaves.y, leaves.z))) { return vec4f(volume.sky, 0.0); }
  let start = clamp(eye.position + ray * way, vec3f(TOUCH), vec3f(volume.dims) - TOUCH);
  let hit = walk(start, ray, FAR);
  if (hit.w == 0) { return vec4f(volume.sky, 0.0); }
  return textureLoad(base, vec3u(hit.xyz), 0);
}

@compute @workgroup_size(8, 8)
fn gather(@builtin(global_invocation_id) pixel: vec3u) {
  if (pixel.x >= eye.width || pixel.y >= eye.height) { return; }
  let number = pixel.x + eye.width * pixel.y;
  let ray = normalize(eye.corner + eye.right * (f32(pixel.x) + 0.5) + eye.down * (f32(pixel.y) + 0.5));
  if (eye.layer == VOXELS) {
    light_out[number] = voxel_at(ray);
    return;
  }
  let item = textureLoad(items, pixel.xy, 0).x;
  if (item == 0u) {
    light_out[number] = vec4f(volume.sky, 0.0);
    return;
  }
  let triangle = triangles[item - 1u];
  let material = materials[triangle.material];
  var normal = normalize(cross(triangle.b - triangle.a, triangle.c - triangle.a));
  // Surfaces look alike from both sides.
  if (dot(normal, ray) > 0.0) { normal = -normal; }
  let cosine = min(dot(normal, ray), -TINY);
  let at = eye.position + ray * max(dot(normal, triangle.a - eye.position) / cosine, 0.0);
  light_out[number] = vec4f(light_of(at, normal, ray, material), 1.0);
}

fn light_of(at: vec3f, normal: vec3f, ray: vec3f, material: Material) -> vec3f {
  if (eye.layer == ALBEDO) { return material.albedo + material.specular; }
  if (eye.layer == NORMALS) { return 0.5 * normal + 0.5; }
  var light = vec3f(0.0);
  if (eye.layer == PICTURE || eye.layer == DIRECT) { light += material.emission + lamps(at, normal, -ray, material); }
  if (eye.layer == DIRECT) { return light; }
  let start = at + push_off(normal);
  if (any(material.albedo > vec3f(0.0)) || eye.layer == OCCLUSION) {
    let found = hemisphere(start, normal);
    if (eye.layer == OCCLUSION) { return vec3f(1.0 - found.near); }
    light += material.albedo * found.radiance;
  }
  if (any(material.specular > vec3f(0.0))) {
    // The cone has the solid angle of the lobe: 1 - cos = 1 / (exponent + 1).
    let power = exponent(material);
    let slope = max(sqrt(2.0 * power + 1.0) / power, volume.specular_floor);
    let found = cone(start, reflect(ray, normal), slope, volume.reach);
    light += material.specular * (found.radiance + found.open * volume.sky);
  }
  return light;
}

@vertex
fn screen_corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
  return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// Colours as a screen shows them: exposed, cut off at 1, by the curve of sRGB (IEC 61966-2-1).
@fragment
fn screen_colour(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let number = u32(position.x) + eye.width * u32(position.y);
  var light = light_in[number].rgb;
  if (eye.layer == PICTURE || eye.layer == DIRECT || eye.layer == INDIRECT || eye.layer == VOXELS) {
    light = clamp(light * eye.exposure, vec3f(0.0), vec3f(1.0));
    light = select(1.055 * pow(light, vec3f(1.0 / 2.4)) - 0.055, 12.92 * light, light < vec3f(0.0031308));
  }
  return vec4f(light, 1.0);
}
