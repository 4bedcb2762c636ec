// The grid of voxels, the exact walk through its cells, and cones. Lengths are in cells from the grid's least corner.
// Constants in capitals come from numeric.rs.

struct Volume {
  dims: vec3u, cone_count: u32,
  bricks: vec3u, light_count: u32,
  // Radiance where nothing is hit.
  sky: vec3f, pad: f32,
  // Steps in texels, how far cones gather, edge of a cell in metres.
  step: f32, reach: f32, cell: f32, specular_floor: f32,
  // Directions around the normal (z), with the tangent of half the angle, and shares of the hemisphere.
  cones: array<vec4f, 16>,
  shares: array<vec4f, 16>,
}

// Directional: position is where it comes from. Angles are cosines; radius is that of the ball, or the tangent of half the angle.
struct Light { position: vec3f, kind: u32, color: vec3f, radius: f32, axis: vec3f, inner: f32, falloff: vec3f, outer: f32 }

struct Triangle { a: vec3f, material: u32, b: vec3f, share: f32, c: vec3f, pad_c: u32 }
struct Material { albedo: vec3f, gloss: f32, specular: vec3f, pad: f32, emission: vec3f, pad_e: f32 }

@group(0) @binding(0) var<uniform> volume: Volume;
// By brick: 0, or one more than its slot. By slot: 512 bits.
@group(0) @binding(1) var<storage, read> table: array<u32>;
@group(0) @binding(2) var<storage, read> occupancy: array<u32>;
@group(0) @binding(3) var<storage, read> surfaces: array<vec4u>;
@group(0) @binding(5) var<storage, read> lights: array<Light>;
@group(0) @binding(6) var<storage, read> list: array<u32>;
@group(0) @binding(7) var base: texture_3d<f32>;
// Radiance and opacity for rays that travel along +x, -x, +y, -y, +z, -z.
@group(0) @binding(8) var along_x: texture_3d<f32>;
@group(0) @binding(9) var against_x: texture_3d<f32>;
@group(0) @binding(10) var along_y: texture_3d<f32>;
@group(0) @binding(11) var against_y: texture_3d<f32>;
@group(0) @binding(12) var along_z: texture_3d<f32>;
@group(0) @binding(13) var against_z: texture_3d<f32>;
@group(0) @binding(14) var smooth_sampler: sampler;
@group(0) @binding(20) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(21) var<storage, read> materials: array<Material>;

fn brick_number(brick: vec3u) -> u32 {
  return brick.x + volume.bricks.x * (brick.y + volume.bricks.y * brick.z);
}

fn brick_place(number: u32) -> vec3u {
  let row = number / volume.bricks.x;
  return vec3u(number % volume.bricks.x, row % volume.bricks.y, row / volume.bricks.y);
}

// Number of a cell in its brick.
fn local_number(cell: vec3u) -> u32 {
  let c = cell & vec3u(7u);
  return c.x + 8u * (c.y + 8u * c.z);
}

fn local_place(number: u32) -> vec3u {
  return vec3u(number & 7u, (number >> 3u) & 7u, number >> 6u);
}

fn is_occupied(slot: u32, local: u32) -> bool {
  return ((occupancy[slot * 16u + (local >> 5u)] >> (local & 31u)) & 1u) != 0u;
}

// How far along the normal a point must leave a cell's centre so that no cell of the same plane touches it, nor the filter: PUSH_OFF.
fn push_off(normal: vec3f) -> vec3f {
  return normal * (PUSH_OFF * (abs(normal.x) + abs(normal.y) + abs(normal.z)));
}

// The first occupied cell on a ray, w = 1; or w = 0. Exact: every cell that the ray passes is looked at, and bricks without triangles
// are skipped whole (Amanatides & Woo 1987, on two levels).
fn walk(start: vec3f, direction: vec3f, far: f32) -> vec4i {
  var cell = vec3i(floor(start));
  let forward = direction > vec3f(0.0);
  for (var i = 0u; i < MOST_STEPS; i++) {
    if (any(cell < vec3i(0)) || any(cell >= vec3i(volume.dims))) { break; }
    let slot = table[brick_number(vec3u(cell) >> vec3u(3u))];
    var size = 8;
    if (slot != 0u) {
      size = 1;
      if (is_occupied(slot - 1u, local_number(vec3u(cell)))) { return vec4i(cell, 1); }
    }
    let low = cell & vec3i(-size);
    let high = low + vec3i(size - 1);
    let planes = vec3f(select(low, high + 1, forward));
    let ways = select((planes - start) / direction, vec3f(FAR), direction == vec3f(0.0));
    let way = min(ways.x, min(ways.y, ways.z));
    if (way >= far) { break; }
    let beyond = select(low - 1, high + 1, forward);
    var next = clamp(vec3i(floor(start + direction * way)), low, high);
    if (ways.x == way) { next.x = beyond.x; } else if (ways.y == way) { next.y = beyond.y; } else { next.z = beyond.z; }
    cell = next;
  }
  return vec4i(0);
}

// Light that reaches a point, and from where: xyz to the light, w its distance; black if there is none.
struct Incident { direction: vec3f, distance: f32, irradiance: vec3f, spread: f32 }

fn incident(light: Light, at: vec3f) -> Incident {
  if (light.kind == DIRECTIONAL) { return Incident(light.position, FAR, light.color, light.radius); }
  let way = light.position - at;
  let distance = max(length(way), TINY);
  let direction = way / distance;
  let metres = distance * volume.cell;
  // No light where the falloff is not positive, as in Falloff::at of casca-lab.
  let falloff = dot(light.falloff, vec3f(1.0, metres, metres * metres));
  var irradiance = select(vec3f(0.0), min(light.color / falloff, vec3f(BRIGHTEST)), falloff > 0.0);
  if (light.kind == SPOT) { irradiance *= smoothstep(light.outer, light.inner, dot(light.axis, -direction)); }
  return Incident(direction, distance, irradiance, light.radius / distance);
}

// What a cone meets in the length of a texel: light, premultiplied, and opacity; and the opacities along each axis.
struct Met { light: vec4f, along: vec3f }

// Opacities along the axes are the coverage by faces across each; along a direction d the opacity
// is the root of the sum of (coverage d)^2. That is exact for a thin wall, through which a slanted cone has a longer way, and for a ball. (The
// thesis' weights, squares of the components, let half of the light through a wall at 60 degrees.)
fn meet(at: vec3f, direction: vec3f, level: f32) -> Met {
  let place = at / vec3f(volume.dims);
  let mip = max(level - 1.0, 0.0);
  var met = Met(vec4f(0.0), vec3f(0.0));
  if (level > 0.0) {
    var x: vec4f; var y: vec4f; var z: vec4f;
    if (direction.x > 0.0) { x = textureSampleLevel(along_x, smooth_sampler, place, mip); }
    else { x = textureSampleLevel(against_x, smooth_sampler, place, mip); }
    if (direction.y > 0.0) { y = textureSampleLevel(along_y, smooth_sampler, place, mip); }
    else { y = textureSampleLevel(against_y, smooth_sampler, place, mip); }
    if (direction.z > 0.0) { z = textureSampleLevel(along_z, smooth_sampler, place, mip); }
    else { z = textureSampleLevel(against_z, smooth_sampler, place, mip); }
    met.along = vec3f(x.a, y.a, z.a);
    let weight = direction * direction * met.along;
    let opacity = sqrt(dot(weight, met.along));
    met.light = vec4f((weight.x * x.rgb + weight.y * y.rgb + weight.z * z.rgb) / max(opacity, TINY), opacity);
  }
  if (level < 1.0) {
    let finest = textureSampleLevel(base, smooth_sampler, place, 0.0);
    met = Met(mix(finest, met.light, level), mix(finest.aaa, met.along, level));
  }
  return met;
}

struct Gathered { radiance: vec3f, open: f32, near: f32 }

// Marches a cone to the end of the grid or of its reach. There are two bounds for what a step hides, and the greater one counts.
// Opacities of the samples along a texel's length are parts of one coverage, so that they are added: a wall that lies between two samples hides by
// the share that each sees, and no light passes for any step up to a texel. But texels widen on the way: a wall at the far side of its texel is
// in sight too early, as a part of smaller texels. So what is covered whole along an axis is hidden as soon as a sample sees it, by the law of
// layers that lie one behind the other, of which a step crosses its length along that axis.
// `near` is the occlusion by what is close, for ambient occlusion.
fn cone(start: vec3f, direction: vec3f, slope: f32, far: f32) -> Gathered {
  var found = Gathered(vec3f(0.0), 1.0, 0.0);
  let borders = select(vec3f(0.0), vec3f(volume.dims), direction > vec3f(0.0));
  let ways = select((borders - start) / direction, vec3f(FAR), direction == vec3f(0.0));
  let end = min(far, min(ways.x, min(ways.y, ways.z)));
  var way = 0.0;
  for (var i = 0u; i < MOST_STEPS && found.open > 0.0; i++) {
    // A texel is half as wide as the cone, or as wide as there are.
    let texel = clamp(slope * way, 1.0, exp2(f32(LEVELS)));
    // The last step ends where the cone does, so that a wall at the border counts whole.
    let step = min(volume.step * texel, end - way);
    let at = way + 0.5 * step;
    let place = start + direction * at;
    if (step <= 0.0 || any(place < vec3f(0.0)) || any(place > vec3f(volume.dims))) { break; }
    let met = meet(place, direction, log2(texel));
    let length = step / texel;
    if (met.light.a > 0.0) {
      let layers = abs(direction) * length;
      let passing = select(exp2(layers * log2(max(1.0 - met.along, vec3f(TINY)))), vec3f(0.0), (met.along >= vec3f(1.0)) & (layers > vec3f(0.0)));
      let behind = found.open * min(passing.x, min(passing.y, passing.z));
      let hidden = max(min(found.open, met.light.a * length), found.open - behind);
      found.radiance += met.light.rgb * (hidden / met.light.a);
      found.near += hidden / (1.0 + at * at * NEAR_FADE / (volume.reach * volume.reach));
      found.open -= hidden;
    }
    way += step;
  }
  return found;
}

// Light from the hemisphere around a normal, weighted by the cosine; `open` is the share of it where nothing is hit, `near` the occlusion.
fn hemisphere(start: vec3f, normal: vec3f) -> Gathered {
  let side = normalize(cross(normal, select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(normal.x) > 0.7)));
  let up = cross(side, normal);
  var sum = Gathered(vec3f(0.0), 0.0, 0.0);
  for (var i = 0u; i < volume.cone_count; i++) {
    let c = volume.cones[i];
    let share = volume.shares[i].x;
    let found = cone(start, side * c.x + up * c.y + normal * c.z, c.w, volume.reach);
    sum.radiance += share * (found.radiance + found.open * volume.sky);
    sum.open += share * found.open;
    sum.near += share * found.near;
  }
  return sum;
}

// Groups are numbered along x, then y: there may be more than one dimension holds.
fn group_number(group: vec3u, groups: vec3u) -> u32 { return group.x + groups.x * group.y; }
