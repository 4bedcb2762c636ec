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
fn own_colour(pixel: u32, fragment: Fragment) -> vec3f {
    if look.coloured == 0u { return colour_of(fragment.line); }
    let ends = colours[~owners[pixel]];
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

@fragment
fn paint(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = pixel_number(min(vec2u(at.xy), lens.size - 1u));
    let fragment = fragments[pixel];
    var colour = look.background;
    if fragment.line != NONE {
        let open = saturate(1.0 - look.strength * occlusion[pixel]);
        let away = away_at(fragment.position);
        let normal = pole_of(fragment.tangent, away);
        let plain = own_colour(pixel, fragment);
        switch look.kind {
            case 0u: { colour = plain; }
            case 1u: { colour = lit(plain, normal, -away, 1.0); }
            case 2u: { colour = lit(plain, normal, -away, open); }
            default: { colour = vec3f(open); }
        }
    } else if textureLoad(surfaces, vec2u(at.xy), 0).x < FAR_AWAY {
        colour = textureLoad(shades, vec2u(at.xy), 0).rgb;
    }
    return vec4f(colour, 1.0);
}

const FAR_AWAY: f32 = 1e38;
