// Light as colours of a screen.

@group(0) @binding(1) var light: texture_2d<f32>;
// What light is multiplied by: found for a picture, and read to show it.
@group(0) @binding(2) var<storage, read_write> found_exposure: f32;
@group(0) @binding(3) var<storage, read> own_exposure: f32;

// Pixels by their brightness: so many steps for a factor of two, from 2^-24 to 2^24.
const STEPS: f32 = 8.0;
const BINS: u32 = 384u;
var<workgroup> bins: array<atomic<u32>, BINS>;

// The picture's own exposure: the geometric mean of the light of surfaces becomes middle grey. The
// darkest tenth of them and the brightest do not count: they are holes and lamps.
@compute @workgroup_size(256)
fn expose(@builtin(local_invocation_index) thread: u32) {
    let size = textureDimensions(light);
    for (var i = thread; i < size.x * size.y; i += 256u) {
        let found = textureLoad(light, vec2u(i % size.x, i / size.x), 0);
        // Rec. 709.
        let bright = dot(found.rgb, vec3f(0.2126, 0.7152, 0.0722));
        if found.w == 1.0 && bright > 0.0 {
            atomicAdd(&bins[u32(clamp((log2(bright) + 24.0) * STEPS, 0.0, f32(BINS - 1u)))], 1u);
        }
    }
    workgroupBarrier();
    if thread > 0u { return; }
    var total = 0.0;
    for (var i = 0u; i < BINS; i++) { total += f32(atomicLoad(&bins[i])); }
    var before = 0.0;
    var sum = 0.0;
    for (var i = 0u; i < BINS; i++) {
        let count = f32(atomicLoad(&bins[i]));
        let counted = min(before + count, 0.9 * total) - max(before, 0.1 * total);
        sum += max(counted, 0.0) * ((f32(i) + 0.5) / STEPS - 24.0);
        before += count;
    }
    found_exposure = select(1.0, GREY / exp2(sum / (0.8 * total)), total > 0.0);
}

@vertex
fn corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// Exposed, cut off at 1, by the curve of sRGB (IEC 61966-2-1).
@fragment
fn colour(@builtin(position) position: vec4f) -> @location(0) vec4f {
    var found = textureLoad(light, vec2u(position.xy), 0).rgb;
    if eye.layer != ALBEDO && eye.layer != NORMALS {
        let exposure = select(own_exposure, eye.exposure, eye.exposure > 0.0);
        found = clamp(found * exposure, vec3f(0.0), vec3f(1.0));
        found = select(1.055 * pow(found, vec3f(1.0 / 2.4)) - 0.055, 12.92 * found, found < vec3f(0.0031308));
    }
    return vec4f(found, 1.0);
}
