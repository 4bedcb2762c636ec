// Light in voxels: direct light, the bounce between voxels, and the directional mips (thesis 2.2, 2.3.1, 2.5; digest S4 to S7).

@group(0) @binding(40) var<storage, read_write> direct: array<vec2u>;
@group(0) @binding(41) var<storage, read_write> bounced: array<vec2u>;
@group(0) @binding(42) var base_out: texture_storage_3d<rgba16float, write>;

struct Mip { axis: u32, is_against: u32, level: u32, is_listed: u32 }
@group(0) @binding(43) var<uniform> mip: Mip;
@group(0) @binding(44) var finer: texture_3d<f32>;
@group(0) @binding(45) var coarser: texture_storage_3d<rgba16float, write>;

fn packed(light: vec3f) -> vec2u {
  let l = min(light, vec3f(LARGEST_HALF));
  return vec2u(pack2x16float(l.xy), pack2x16float(vec2f(l.z, 0.0)));
}

fn unpacked(light: vec2u) -> vec3f { return vec3f(unpack2x16float(light.x), unpack2x16float(light.y).x); }

struct Surface { albedo: vec3f, emission: vec3f, normal: vec3f, has_normal: bool }

fn surface_of(s: vec4u) -> Surface {
  let y = unpack2x16float(s.y);
  let n = unpack4x8snorm(s.w);
  let has_normal = n.w > 0.5;
  return Surface(vec3f(unpack2x16float(s.x), y.x), vec3f(y.y, unpack2x16float(s.z)), select(vec3f(0.0), normalize(n.xyz), has_normal), has_normal);
}

// Direct light of all lights at a voxel. Surfaces look alike from both sides: light comes to the side that faces it, and the ray to the light
// starts there. Where normals cancel, the mean cosine of all directions counts.
fn lit(centre: vec3f, s: Surface) -> vec3f {
  var sum = vec3f(0.0);
  for (var i = 0u; i < volume.light_count; i++) {
    let light = incident(lights[i], centre);
    var normal = light.direction;
    var cosine = 0.5;
    if (s.has_normal) {
      cosine = dot(s.normal, light.direction);
      normal = select(s.normal, -s.normal, cosine < 0.0);
      cosine = abs(cosine);
    }
    if (cosine <= 0.0 || all(light.irradiance <= vec3f(0.0))) { continue; }
    let away = push_off(normal);
    let start = centre + away;
    let way = incident(lights[i], start);
    // A light that touches a surface must not be hidden by it.
    if (walk(start, way.direction, way.distance - length(away)).w == 0) { sum += light.irradiance * cosine; }
  }
  return sum * s.albedo / PI;
}

// The voxel of a thread: each group takes an eighth of a brick of the list.
struct Voxel { is_there: bool, cell: u32, centre: vec3f, surface: Surface }

fn voxel(group: vec3u, groups: vec3u, thread: u32) -> Voxel {
  let item = group_number(group, groups) * 64u + thread;
  var found: Voxel;
  if (item / 512u >= arrayLength(&list)) { return found; }
  let brick = list[item / 512u];
  let slot = table[brick] - 1u;
  let local = item % 512u;
  found.is_there = is_occupied(slot, local);
  found.cell = slot * 512u + local;
  found.centre = vec3f(8u * brick_place(brick) + local_place(local)) + 0.5;
  found.surface = surface_of(surfaces[found.cell]);
  return found;
}

@compute @workgroup_size(64)
fn shade(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) thread: u32) {
  let v = voxel(group, groups, thread);
  if (v.is_there) { direct[v.cell] = packed(v.surface.emission + lit(v.centre, v.surface)); }
}

// Light from other voxels, by cones from the front: the second bounce.
@compute @workgroup_size(64)
fn bounce(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) thread: u32) {
  let v = voxel(group, groups, thread);
  if (!v.is_there) { return; }
  let s = v.surface;
  var light = vec3f(0.0);
  if (s.has_normal && any(s.albedo > vec3f(0.0))) {
    light = s.albedo * hemisphere(v.centre + push_off(s.normal), s.normal).radiance;
  }
  bounced[v.cell] = packed(light);
}

fn inject(number: u32, thread: u32, with_bounce: bool) {
  let brick = list[number];
  let entry = table[brick];
  for (var local = thread; local < 512u; local += 64u) {
    var value = vec4f(0.0);
    if (entry != 0u && is_occupied(entry - 1u, local)) {
      let cell = (entry - 1u) * 512u + local;
      var light = unpacked(direct[cell]);
      if (with_bounce) { light += unpacked(bounced[cell]); }
      value = vec4f(min(light, vec3f(LARGEST_HALF)), 1.0);
    }
    textureStore(base_out, 8u * brick_place(brick) + local_place(local), value);
  }
}

@compute @workgroup_size(64)
fn inject_direct(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) thread: u32) {
  let number = group_number(group, groups);
  if (number < arrayLength(&list)) { inject(number, thread, false); }
}

@compute @workgroup_size(64)
fn inject_all(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) thread: u32) {
  let number = group_number(group, groups);
  if (number < arrayLength(&list)) { inject(number, thread, true); }
}

// A cell as rays along the axis of this mip see it. Surfaces emit from their front: otherwise the far side of a small ball of light would be
// added to the near side, and it would be up to twice as bright.
fn seen_along(value: vec4f, cell: vec3u) -> vec4f {
  if (mip.level != 1u || value.a == 0.0) { return value; }
  let entry = table[brick_number(cell >> vec3u(3u))];
  if (entry == 0u) { return value; }
  let s = surface_of(surfaces[(entry - 1u) * 512u + local_number(cell)]);
  let along = select(s.normal[mip.axis], -s.normal[mip.axis], mip.is_against != 0u);
  return select(value, vec4f(max(value.rgb - s.emission, vec3f(0.0)), value.a), s.has_normal && along > 0.0);
}

// Front to back in pairs, then the mean of four (thesis 1.7.4.5). The texels of the bricks listed, or all.
@compute @workgroup_size(64)
fn reduce(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) thread: u32) {
  let number = group_number(group, groups) * 64u + thread;
  let size = textureDimensions(coarser);
  var texel: vec3u;
  if (mip.is_listed != 0u) {
    let edge = 8u >> mip.level;
    let item = number / (edge * edge * edge);
    if (item >= arrayLength(&list)) { return; }
    let rest = number % (edge * edge * edge);
    texel = brick_place(list[item]) * edge + vec3u(rest % edge, rest / edge % edge, rest / (edge * edge));
  } else {
    texel = vec3u(number % size.x, number / size.x % size.y, number / (size.x * size.y));
    // The list has to be used on both ways, or there would be no binding for it.
    if (texel.z >= size.z || arrayLength(&list) == 0u) { return; }
  }
  var sum = vec4f(0.0);
  for (var i = 0u; i < 4u; i++) {
    var front = vec3u(0u);
    front[(mip.axis + 1u) % 3u] = i & 1u;
    front[(mip.axis + 2u) % 3u] = i >> 1u;
    var back = front;
    front[mip.axis] = mip.is_against;
    back[mip.axis] = 1u - mip.is_against;
    let near = seen_along(textureLoad(finer, texel * 2u + front, 0), texel * 2u + front);
    let far = seen_along(textureLoad(finer, texel * 2u + back, 0), texel * 2u + back);
    sum += near + far * (1.0 - near.a);
  }
  textureStore(coarser, texel, 0.25 * sum);
}
