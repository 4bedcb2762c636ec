// The camera, the sun and its shadows, and boxes: ground and walls.

struct Frame {
    clip: mat4x4f,
    sun_clip: mat4x4f,
    // Position; the height of a pixel at distance 1.
    eye: vec4f,
    // The direction towards it; 1 if there are shadows.
    sun: vec4f,
    // Colour; the share of it at distance 1 of the way.
    sky: vec4f,
    // The width of a texel in the world and in the map.
    shadow: vec4f,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var shadow_map: texture_depth_2d;
@group(0) @binding(2) var shadow_sampler: sampler_comparison;

/// World space to the screen: depth 1 at the near plane, 0 at the far one.
fn to_screen(at: vec3f) -> vec4f {
    let clip = frame.clip * vec4f(at, 1.0);
    return vec4f(clip.xy, clip.w - clip.z, clip.w);
}

/// The share of the sun that reaches a place of the shadow map: the mean of four texels.
fn sunlight(there: vec3f) -> f32 {
    if frame.sun.w == 0.0 || any(abs(there.xy) >= vec2f(1.0)) || there.z >= 1.0 {
        return 1.0;
    }
    return textureSampleCompareLevel(shadow_map, shadow_sampler, there.xy * vec2f(0.5, -0.5) + 0.5, there.z);
}

/// The same for walls and the ground, whose borders of shadows nothing else softens.
fn soft_sunlight(there: vec3f) -> f32 {
    let half = frame.shadow.y;
    return 0.25 * (sunlight(there + vec3f(-half, -half, 0.0)) + sunlight(there + vec3f(half, -half, 0.0))
        + sunlight(there + vec3f(-half, half, 0.0)) + sunlight(there + vec3f(half, half, 0.0)));
}

/// Linear light as it is stored, with so much haze before it.
fn stored(light: vec3f, away: f32) -> vec4f {
    let share = exp(-frame.sky.w * away);
    return vec4f(pow(saturate(mix(frame.sky.rgb, light, share)), vec3f(1.0 / 2.2)), 1.0);
}

struct Wall {
    @builtin(position) screen: vec4f,
    @location(0) at: vec3f,
    @location(1) @interpolate(flat) normal: vec3f,
    @location(2) @interpolate(flat) paint: u32,
}

/// Corner `i` of 36 of a box.
fn corner(i: u32, low: vec3f, high: vec3f, screen: bool, paint: u32) -> Wall {
    let side = i / 6u;
    let axis = side >> 1u;
    let positive = (side & 1u) == 1u;
    // Two triangles: 0 1 2, 2 1 3.
    let k = array<u32, 6>(0u, 1u, 2u, 2u, 1u, 3u)[i % 6u];
    var share = vec3f(f32(positive), f32(k & 1u), f32(k >> 1u));
    var normal = vec3f(select(-1.0, 1.0, positive), 0.0, 0.0);
    if axis == 1u {
        share = share.zxy;
        normal = normal.zxy;
    } else if axis == 2u {
        share = share.yzx;
        normal = normal.yzx;
    }
    var wall: Wall;
    wall.at = mix(low, high, share);
    wall.screen = select(frame.sun_clip * vec4f(wall.at, 1.0), to_screen(wall.at), screen);
    wall.normal = normal;
    wall.paint = paint;
    return wall;
}

@vertex
fn block_corner(
    @builtin(vertex_index) i: u32,
    @location(0) low: vec3f, @location(1) paint: u32, @location(2) high: vec3f,
) -> Wall {
    return corner(i, low, high, true, paint);
}

@vertex
fn block_shadow(
    @builtin(vertex_index) i: u32,
    @location(0) low: vec3f, @location(1) paint: u32, @location(2) high: vec3f,
) -> @builtin(position) vec4f {
    return corner(i, low, high, false, paint).screen;
}

/// A number from 0 to 1 for each cell of a lattice.
fn speck(cell: vec3i) -> f32 {
    var h = (bitcast<u32>(cell.x) * 0x8da6b343u) ^ (bitcast<u32>(cell.y) * 0xd8163841u) ^ (bitcast<u32>(cell.z) * 0xcb1ab31fu);
    h = (h ^ (h >> 15u)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12u)) * 0x297a2d39u;
    return f32((h ^ (h >> 15u)) >> 8u) / 16777216.0;
}

/// Even noise on a plane.
fn noise(at: vec2f) -> f32 {
    let cell = floor(at);
    let f = smoothstep(vec2f(0.0), vec2f(1.0), at - cell);
    let c = vec3i(vec2i(cell), 0);
    let low = mix(speck(c), speck(c + vec3i(1, 0, 0)), f.x);
    return mix(low, mix(speck(c + vec3i(0, 1, 0)), speck(c + vec3i(1, 1, 0)), f.x), f.y);
}

@fragment
fn block_colour(wall: Wall) -> @location(0) vec4f {
    var colour = vec3f(0.0);
    if wall.paint == 0u {
        let patches = noise(wall.at.xz * 0.7) * 0.6 + noise(wall.at.xz * 5.3) * 0.4;
        colour = mix(vec3f(0.13, 0.19, 0.06), vec3f(0.27, 0.26, 0.11), patches);
    } else {
        // Bricks of 0.5 by 0.2, every other row shifted.
        let across = select(wall.at.x, wall.at.z, abs(wall.normal.x) > 0.5);
        let up = select(wall.at.y, wall.at.z, abs(wall.normal.y) > 0.5);
        let row = floor(up / 0.2);
        let column = across / 0.5 + 0.5 * (row - 2.0 * floor(row / 2.0));
        let brick = vec3f(0.42, 0.19, 0.12) * (0.75 + 0.5 * speck(vec3i(vec2i(vec2f(floor(column), row)), 7)));
        let joint = min(fract(column) * 0.5, fract(up / 0.2) * 0.2);
        colour = mix(vec3f(0.42, 0.40, 0.37), brick, smoothstep(0.008, 0.016, joint));
    }
    // Half a texel to the side and two towards the sun: a flat side must not shade itself.
    let lifted = wall.at + (wall.normal + frame.sun.xyz) * 2.0 * frame.shadow.x;
    let direct = max(dot(wall.normal, frame.sun.xyz), 0.0) * soft_sunlight((frame.sun_clip * vec4f(lifted, 1.0)).xyz);
    let ambient = 0.35 * (0.7 + 0.3 * wall.normal.y);
    return stored(colour * (ambient + 1.3 * direct), distance(wall.at, frame.eye.xyz));
}
