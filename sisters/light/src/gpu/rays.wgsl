// Rays that read the states around their hits.

struct Gloss {
    // In metres.
    eye: vec3f,
    rays: u32,
    // Up, and the radiance at the zenith, at the horizon and at the nadir.
    sky: array<vec4f, 4>,
    // Pixels of a workgroup along both axes, and threads that share the rays of each.
    tile: vec2u,
    lanes: u32,
    // Directions that are weighed for each ray.
    tries: u32,
}

@group(0) @binding(5) var<uniform> gloss: Gloss;

// The pixel that a thread of a workgroup sends rays for.
fn casca_pixel(group: vec2u, index: u32) -> vec2u {
    let in_tile = index / gloss.lanes;
    return group * gloss.tile + vec2u(in_tile % gloss.tile.x, in_tile / gloss.tile.x);
}

// What a triangle scatters of its irradiance by steradian, what it emits, and its unit normal.
struct CascaSkin { share: vec4f, emission: vec4f, normal: vec4f }

@group(1) @binding(9) var<storage, read> casca_stored: array<vec4f>;
@group(1) @binding(10) var<storage, read> casca_skins: array<CascaSkin>;

// The light of a state that is averaged, also that of lights and lamps.
fn casca_held(state: u32) -> vec3f { return casca_indirect[state].rgb + casca_stored[state].rgb; }

// The triangle that a ray meets first, at which distance, and up to which distance the ray is LIFT
// away from all that it meets.
struct CascaHit { triangle: u32, distance: f32, clear: f32 }

// The error of a distance grows with the slope, and may swap two walls in their corner. So light is
// not asked for at the hit, but at the last point of the ray that is LIFT above every surface there:
// no wall is between, and its height errs by an eighth of LIFT whatever the slope.
fn casca_first(origin: vec3f, direction: vec3f) -> CascaHit {
    var hit = CascaHit(NONE, FAR, FAR);
    var walk = casca_walk(origin, direction, FAR);
    while casca_on(&walk) {
        for (var k = walk.first; k < walk.end; k++) {
            let number = casca_cells[k];
            let distance = casca_meet(number, origin, direction);
            if distance < walk.least || distance > walk.most { continue; }
            let cosine = abs(dot(casca_skins[number].normal.xyz, direction));
            hit.clear = min(hit.clear, distance - LIFT / max(cosine, LEAST_COSINE));
            // Of equal distances the first triangle counts.
            if distance < hit.distance || (distance == hit.distance && number < hit.triangle) {
                hit.triangle = number;
                hit.distance = distance;
            }
        }
        // What is farther, but so near that the ray is not LIFT away from it at the hit, counts.
        casca_end(&walk, hit.distance + LIFT / LEAST_COSINE);
    }
    return hit;
}

fn casca_sky(direction: vec3f) -> vec3f {
    let height = clamp(dot(direction, gloss.sky[0].xyz), -1.0, 1.0);
    let end = select(gloss.sky[3].rgb, gloss.sky[1].rgb, height > 0.0);
    return mix(gloss.sky[2].rgb, end, abs(height));
}

// The radiance along a ray, and 1 unless it hits what no state stands for. Lamps count if `lamps` is
// 1, and not if it is 0.
fn casca_along(spot: vec3f, direction: vec3f, lamps: f32) -> vec4f {
    let walk = casca_walk(spot, direction, FAR);
    if walk.done { return vec4f(casca_sky(direction), 1.0); }
    // Distances from far away would be too rough.
    let origin = spot + direction * walk.enter;
    let hit = casca_first(origin, direction);
    if hit.triangle == NONE { return vec4f(casca_sky(direction), 1.0); }
    let skin = casca_skins[hit.triangle];
    let facing = select(skin.normal.xyz, -skin.normal.xyz, dot(skin.normal.xyz, direction) > 0.0);
    let stored = casca_around(origin + direction * max(hit.clear, 0.0), facing);
    return vec4f(lamps * skin.emission.rgb + skin.share.rgb * stored.rgb, stored.w);
}
