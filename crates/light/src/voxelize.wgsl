// Triangles become voxels: sums, counts and maxima by integer atomics, whose order does not matter (thesis 2.1; digest S1, with its defects
// avoided).

@group(0) @binding(22) var<storage, read> pairs: array<vec2u>;
// By cell: three sums of albedo, the greatest emission by channel (as bits), three sums of normals and a count. A lamp that shares a cell with the
// ceiling shines as bright as elsewhere.
@group(0) @binding(23) var<storage, read_write> colours: array<atomic<u32>>;
@group(0) @binding(24) var<storage, read_write> normals: array<atomic<u32>>;

// Whether a triangle, relative to a cell's centre, touches the cell: the separating axes of Akenine-Möller 2001.
fn touches(a: vec3f, b: vec3f, c: vec3f) -> bool {
  let half = vec3f(0.5 + TOUCH);
  if (any(min(a, min(b, c)) > half) || any(max(a, max(b, c)) < -half)) { return false; }
  var edges = array(b - a, c - b, a - c);
  let normal = cross(edges[0], edges[2]);
  let rounding = NORMAL_ROUNDING * length(edges[0]) * length(edges[2]) * dot(abs(a), vec3f(1.0));
  if (abs(dot(normal, a)) > dot(abs(normal), half) + rounding) { return false; }
  for (var i = 0; i < 3; i++) {
    for (var j = 0; j < 3; j++) {
      var unit = vec3f(0.0);
      unit[j] = 1.0;
      let axis = cross(edges[i], unit);
      let p = vec3f(dot(axis, a), dot(axis, b), dot(axis, c));
      let room = dot(abs(axis), half);
      if (min(p.x, min(p.y, p.z)) > room || max(p.x, max(p.y, p.z)) < -room) { return false; }
    }
  }
  return true;
}

fn add(cell: u32, material: Material, share: f32, normal: vec3f) {
  let albedo = vec3u(round(clamp(material.albedo, vec3f(0.0), vec3f(1.0)) * UNIT));
  // The bits of numbers that are not negative have their order; the mask takes the sign of a zero away.
  let emission = bitcast<vec3u>(min(share * material.emission, vec3f(LARGEST_HALF))) & vec3u(0x7fffffffu);
  // Negative numbers are added as what they are modulo 2^32.
  let direction = bitcast<vec3u>(vec3i(round(normal * UNIT_NORMAL)));
  for (var i = 0u; i < 3u; i++) {
    atomicAdd(&colours[cell * 6u + i], albedo[i]);
    atomicMax(&colours[cell * 6u + 3u + i], emission[i]);
    atomicAdd(&normals[cell * 4u + i], direction[i]);
  }
  atomicAdd(&normals[cell * 4u + 3u], 1u);
}

// A pair is a triangle and a brick of its layer (x: triangle; y: number of the brick's sums, and list[y] the brick). A thread takes a slice.
@compute @workgroup_size(8, 8)
fn voxelize(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_id) local: vec3u) {
  let number = group_number(group, groups) * 8u + local.y;
  // A single pair leaves room for another in the least buffer, of zeros. A true pair of zeros comes first.
  if (number >= arrayLength(&pairs) || (number > 0u && all(pairs[number] == vec2u(0u)))) { return; }
  let pair = pairs[number];
  let triangle = triangles[pair.x];
  let corner = vec3f(8u * brick_place(list[pair.y]));
  let low = vec3i(max(floor(min(triangle.a, min(triangle.b, triangle.c)) - corner - TOUCH), vec3f(0.0)));
  let high = vec3i(min(floor(max(triangle.a, max(triangle.b, triangle.c)) - corner + TOUCH), vec3f(7.0)));
  let z = i32(local.x);
  if (z < low.z || z > high.z) { return; }
  let cross_product = cross(triangle.b - triangle.a, triangle.c - triangle.a);
  let normal = select(vec3f(0.0), normalize(cross_product), dot(cross_product, cross_product) > 0.0);
  for (var y = low.y; y <= high.y; y++) {
    for (var x = low.x; x <= high.x; x++) {
      let centre = corner + vec3f(f32(x), f32(y), f32(z)) + 0.5;
      if (touches(triangle.a - centre, triangle.b - centre, triangle.c - centre)) {
        add(pair.y * 512u + local_number(vec3u(u32(x), u32(y), u32(z))), materials[triangle.material], triangle.share, normal);
      }
    }
  }
}

@group(0) @binding(25) var<storage, read> fixed_colours: array<u32>;
@group(0) @binding(26) var<storage, read> fixed_normals: array<u32>;
@group(0) @binding(27) var<storage, read> moving_colours: array<u32>;
@group(0) @binding(28) var<storage, read> moving_normals: array<u32>;
// By brick: 0, or one more than the number of its sums in the moving layer.
@group(0) @binding(29) var<storage, read> moving_table: array<u32>;
@group(0) @binding(30) var<storage, read_write> new_surfaces: array<vec4u>;
@group(0) @binding(31) var<storage, read_write> new_occupancy: array<u32>;

var<workgroup> words: array<atomic<u32>, 16>;

// Both layers as one: means of what they hold, and which cells hold anything. The slots of the fixed layer come first.
@compute @workgroup_size(64)
fn merge(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) thread: u32) {
  let number = group_number(group, groups);
  if (number >= arrayLength(&list)) { return; }
  let brick = list[number];
  let slot = table[brick] - 1u;
  let moving = moving_table[brick];
  for (var i = 0u; i < 8u; i++) {
    let local = i * 64u + thread;
    var albedo = vec3u(0u); var emission = vec3u(0u); var normal = vec3u(0u); var count = 0u;
    if (slot * 512u < arrayLength(&fixed_normals) / 4u) {
      let cell = slot * 512u + local;
      albedo += vec3u(fixed_colours[cell * 6u], fixed_colours[cell * 6u + 1u], fixed_colours[cell * 6u + 2u]);
      emission = vec3u(fixed_colours[cell * 6u + 3u], fixed_colours[cell * 6u + 4u], fixed_colours[cell * 6u + 5u]);
      normal += vec3u(fixed_normals[cell * 4u], fixed_normals[cell * 4u + 1u], fixed_normals[cell * 4u + 2u]);
      count += fixed_normals[cell * 4u + 3u];
    }
    if (moving != 0u) {
      let cell = (moving - 1u) * 512u + local;
      albedo += vec3u(moving_colours[cell * 6u], moving_colours[cell * 6u + 1u], moving_colours[cell * 6u + 2u]);
      emission = max(emission, vec3u(moving_colours[cell * 6u + 3u], moving_colours[cell * 6u + 4u], moving_colours[cell * 6u + 5u]));
      normal += vec3u(moving_normals[cell * 4u], moving_normals[cell * 4u + 1u], moving_normals[cell * 4u + 2u]);
      count += moving_normals[cell * 4u + 3u];
    }
    new_surfaces[slot * 512u + local] = surface(albedo, emission, bitcast<vec3i>(normal), count);
    if (count > 0u) { atomicOr(&words[local >> 5u], 1u << (local & 31u)); }
  }
  workgroupBarrier();
  if (thread < 16u) { new_occupancy[slot * 16u + thread] = atomicLoad(&words[thread]); }
}

// A cell as it is stored: albedo, emission, and the normal where the normals in the cell do not cancel (then w = 1).
fn surface(albedo: vec3u, emission: vec3u, normal: vec3i, count: u32) -> vec4u {
  if (count == 0u) { return vec4u(0u); }
  let scale = 1.0 / (f32(count) * UNIT);
  let a = vec3f(albedo) * scale;
  let e = bitcast<vec3f>(emission);
  let mean = vec3f(normal) / (f32(count) * UNIT_NORMAL);
  let size = length(mean);
  var n = vec4f(0.0);
  if (size > CANCELLED) { n = vec4f(mean / size, 1.0); }
  return vec4u(pack2x16float(a.xy), pack2x16float(vec2f(a.z, e.x)), pack2x16float(e.yz), pack4x8snorm(n));
}
