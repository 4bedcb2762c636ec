// The picture: lines with or without light and occlusion.

struct Look {
    background: vec3f,
    // As the enum `Look`.
    kind: u32,
    strength: f32,
    // Whether lines have the colours of `colours`.
    coloured: u32,
    padding_0: u32,
    padding_1: u32,
}

// The complement of the nearest segment.
@group(0) @binding(9) var<storage, read> owners: array<u32>;
// The depth and the shade of the context in each pixel.
@group(0) @binding(10) var surfaces: texture_2d<f32>;
@group(0) @binding(13) var shades: texture_2d<f32>;
@group(0) @binding(12) var<storage, read> fragments: array<Fragment>;
@group(0) @binding(17) var<storage, read> occlusion: array<f32>;
@group(0) @binding(18) var<uniform> look: Look;
// The layers of the fragments of samples, as in thick.wgsl.
@group(0) @binding(28) var<storage, read> layers: array<u32>;
// The colours of the ends of each segment, and the ways along its line to them.
@group(0) @binding(23) var<storage, read> colours: array<vec4u>;

@vertex
fn whole(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// A pale colour for each line, so that lines that cross can be told apart.
fn colour_of(line: u32) -> vec3f {
    let mixed = (line * 0x9e3779b1u) ^ ((line * 0x85ebca6bu) >> 13u);
    let t = f32(mixed >> 16u) / 65535.0;
    return mix(mix(vec3f(0.95, 0.72, 0.42), vec3f(0.92, 0.86, 0.70), saturate(2.0 * t)), vec3f(0.55, 0.76, 0.90), saturate(2.0 * t - 1.0));
}

// The colour of a line between the ends of a segment, or its pale one.
fn own_colour(segment: u32, fragment: Fragment) -> vec3f {
    if look.coloured == 0u { return colour_of(fragment.line); }
    let ends = colours[segment];
    let ways = bitcast<vec2f>(ends.zw);
    let t = select(0.0, saturate((fragment.along - ways.x) / (ways.y - ways.x)), ways.y > ways.x);
    return mix(unpack4x8unorm(ends.x).rgb, unpack4x8unorm(ends.y).rgb, t);
}

// Light on a tube: the side that is turned to the viewer, lit from the upper left, with a highlight.
fn lit(colour: vec3f, normal: vec3f, to_eye: vec3f, open: f32) -> vec3f {
    let to_light = normalize(vec3f(-0.45, 0.7, 0.6));
    let diffuse = max(dot(normal, to_light), 0.0);
    let shine = pow(max(dot(normal, normalize(to_light + to_eye)), 0.0), 24.0);
    return colour * open * (0.45 + 0.6 * diffuse) + vec3f(0.25 * shine * open);
}

// The colour of a fragment of a segment, with this number.
fn tone(number: u32, segment: u32) -> vec3f {
    let fragment = fragments[number];
    let open = saturate(1.0 - look.strength * occlusion[number]);
    let away = away_at(fragment.position);
    let normal = pole_of(fragment.tangent, away);
    let plain = own_colour(segment, fragment);
    switch look.kind {
        case 0u: { return plain; }
        case 1u: { return lit(plain, normal, -away, 1.0); }
        case 2u: { return lit(plain, normal, -away, open); }
        default: { return vec3f(open); }
    }
}

// The colour where there is no line.
fn behind_lines(at: vec2u) -> vec3f {
    let is_context = textureLoad(surfaces, at, 0).x < FAR_AWAY;
    return select(look.background, textureLoad(shades, at, 0).rgb, is_context);
}

@fragment
fn paint(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let place = min(vec2u(at.xy), lens.size - 1u);
    let pixel = pixel_number(place);
    if fragments[pixel].line == NONE { return vec4f(behind_lines(place), 1.0); }
    return vec4f(tone(pixel, ~owners[pixel]), 1.0);
}

// The mean of the samples of a pixel, in the bytes of the picture, as a picture is scaled down; the nearest line by the area that it covers.
@fragment
fn paint_samples(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let size = lens.size / 2u;
    let place = min(vec2u(at.xy), size - 1u);
    let pixel = place.y * size.x + place.x;
    let word = layers[pixel];
    var tones: array<vec3f, 4>;
    // Layers are numbered as their first samples follow each other.
    var count = 0u;
    // The nearest line has the share of the pixel that it covers, the other samples have the rest.
    let front = word >> 28u;
    var nearest = vec3f(0.0);
    var others = 0.0;
    var sum = vec3f(0.0);
    for (var i = 0u; i < 4u; i++) {
        let sample = 2u * place + vec2u(i & 1u, i >> 1u);
        let layer = word >> (4u * i) & 15u;
        if layer >= 4u {
            sum += behind_lines(sample);
            others += 1.0;
            continue;
        }
        if layer == count {
            tones[layer] = tone(layer * size.x * size.y + pixel, ~owners[pixel_number(sample)]);
            count++;
        }
        if layer == front {
            nearest = tones[layer];
            continue;
        }
        sum += tones[layer];
        others += 1.0;
    }
    let share = select(f32(word >> 16u & 4095u) / 4095.0, 0.0, front >= 4u);
    return vec4f(mix(sum / others, nearest, share), 1.0);
}

const FAR_AWAY: f32 = 1e38;
