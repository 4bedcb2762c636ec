//! The functions of shaders, run alone, against the processor's: strands and light point by point,
//! rays along their way, skinning and leaning vertex by vertex.

use casca_stage::gpu::Gpu;
use casca_stage::kernel::{Bound, Kernel, among, filled};
use casca_stage::wgpu::{self, BufferUsages};
use glam::{Mat3, Quat, Vec3, Vec4};

use crate::gpu::look::Look;
use crate::gpu::records::rows_of;
use crate::samples::dice;
use crate::shading::kajiya_kay;
use crate::skin::{Channel, Clip, Ending, Interpolation, Joint, Pose, Skeleton, Track, Weights};
use crate::strands::{Fur, Lean, Skin, hash, unit};

/// The bytes that `threads` threads of an entry of a shader, in groups of 64, write into a buffer of
/// so many: its binding comes with it, as with those that the shader reads.
fn computed(
    gpu: &Gpu,
    (source, entry): (String, &'static str),
    given: &[Bound],
    (found, bytes): (u32, usize),
    threads: usize,
) -> Vec<u8> {
    let source = wgpu::ShaderSource::Wgsl(source.into());
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let written = gpu.buffer(bytes as u64, BufferUsages::STORAGE).unwrap();
    let bound = [given, &[(found, &written)]].concat();
    let bindings: Vec<u32> = bound.iter().map(|bound| bound.0).collect();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let groups = [threads.div_ceil(64) as u32, 1];
    Kernel::new(gpu, &module, entry, &bindings).run(gpu, &mut encoder, groups, &among(&bound));
    gpu.queue.submit([encoder.finish()]);
    gpu.read_buffer(&written).unwrap()
}

const STRANDS: &str = include_str!("strands.wgsl");
const POINTS: &str = "
@group(0) @binding(0) var<uniform> look: Look;
@group(0) @binding(1) var<storage, read> points: array<array<vec4f, 3>>;
@group(0) @binding(2) var<storage, read_write> found: array<array<vec4u, 3>>;

@compute @workgroup_size(64)
fn look_up(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&points) {
        return;
    }
    let base = points[id.x][0];
    let normal = points[id.x][1];
    let bent = points[id.x][2];
    // Skin that bends like a ball, in a plane that leans.
    let slope = mat3x3f(bent.w, 0.0, 0.0, 0.0, bent.w, 0.0, 0.0, 0.0, bent.w);
    let strand = strand_at(look, Skin(base.xyz, normal.xyz, bent.xyz, slope), base.w, normal.w);
    let word = hash(bitcast<vec4u>(base)).w;
    found[id.x][0] = vec4u(u32(strand.found), strand.id, bitcast<u32>(strand.offset), bitcast<u32>(strand.along));
    let lobes = kajiya_kay(normal.xyz, normalize(base.xyz), normalize(base.yzx), 24.0);
    found[id.x][1] = vec4u(word, bitcast<vec2u>(lobes), bitcast<u32>(extrusion(look, normal.xyz, base.w).y));
    let through = sun_through(look, normal.xyz, base.w, normal.w, normalize(base.yzx));
    found[id.x][2] = vec4u(bitcast<u32>(through), 0u, 0u, 0u);
}
";

/// What a shader with a look makes of points: so many bytes of each.
fn of_points<const N: usize>(
    gpu: &Gpu,
    shader: (String, &'static str),
    look: &Look,
    points: &[[Vec4; N]],
    bytes: usize,
) -> Vec<u8> {
    let flat: Vec<f32> = points.iter().flatten().flat_map(|v| v.to_array()).collect();
    let look = filled(gpu, &[look.record()], BufferUsages::UNIFORM).unwrap();
    let flat = filled(gpu, &flat, BufferUsages::STORAGE).unwrap();
    computed(gpu, shader, &[(0, &look), (1, &flat)], (2, bytes * points.len()), points.len())
}

/// Relative errors of sums of a few products in single precision.
const ROUNDING: f32 = 1e-5;

#[test]
fn shaders_find_the_strands_that_the_processor_finds() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // Evenly spread over a ball, at all heights and lengths.
    let number = |i: u32, k: u32| unit(hash([i, k, 0, 0])[0]);
    let points: Vec<[Vec4; 3]> = (0..20_000)
        .map(|i| {
            let way = Vec3::from_array([0, 1, 2].map(|k| number(i, k) - 0.5)).normalize_or(Vec3::Y);
            let lean = Vec3::from_array([5, 6, 7].map(|k| 0.4 * number(i, k) - 0.2));
            [
                way.extend(number(i, 3) * number(i, 4)),
                way.extend(number(i, 4)),
                (way + lean).normalize_or_zero().extend(3.0 * number(i, 8) - 1.0),
            ]
        })
        .collect();
    for (bend, density) in [(Vec3::ZERO, 0.15), (Vec3::new(0.4, -0.7, 0.1), 0.9)] {
        let fur = Fur { bend, seed: 9, ..Fur::for_radius(1.0, 0.1, density).unwrap() };
        let bytes = of_points(&gpu, ([STRANDS, POINTS].concat(), "look_up"), &Look::new(fur), &points, 48);
        // Strand and hash, lobes, extrusion, the sun's share.
        let answers: Vec<[[u32; 4]; 3]> = bytemuck::pod_collect_to_vec(&bytes);
        let (mut strands, mut others, mut shaded) = (0, 0, 0);
        for ([base, normal, bent], [strand, more, light]) in points.iter().zip(answers) {
            let (at, up) = (base.truncate(), normal.truncate());
            assert_eq!(
                more[0],
                hash(base.to_array().map(f32::to_bits))[3],
                "the hash is the same to the bit"
            );
            let sun = Vec3::new(at.y, at.z, at.x).normalize();
            let lobes = kajiya_kay(up, at.normalize(), sun, 24.0);
            let extruded = (fur.extruded(at, up, base.w) - at).y;
            for (word, want) in [(more[1], lobes.diffuse), (more[2], lobes.specular), (more[3], extruded)] {
                // Powers multiply the error of their base.
                assert!((f32::from_bits(word) - want).abs() < 100.0 * ROUNDING, "{at}: {word} {want}");
            }
            let through = fur.sun_through(up, base.w, normal.w, sun);
            let (got, error) = (f32::from_bits(light[0]), 100.0 * ROUNDING);
            assert!((got - through).abs() < error, "{at}: sun {got} {through}");
            shaded += usize::from(through < 0.9);
            let slope = Mat3::from_diagonal(Vec3::splat(bent.w));
            let skin = Skin { position: at, normal: up, plane: bent.truncate(), slope };
            let want = fur.strand_at(&skin, base.w, normal.w);
            strands += usize::from(want.is_some());
            let same = match want {
                None => strand[0] == 0,
                Some(want) => {
                    strand[0] == 1
                        && strand[1] == want.id
                        && (f32::from_bits(strand[2]) - want.offset).abs() < 100.0 * ROUNDING
                        && (f32::from_bits(strand[3]) - want.along).abs() < ROUNDING
                }
            };
            others += usize::from(!same);
        }
        println!("density {density}: {strands} points in strands, {others} of {} differ", points.len());
        // Points on the border of a strand may fall to either side.
        assert!(strands > 500 && others <= 4 && shaded > 5000, "{strands} {others} {shaded}");
    }
}

const RAYS: &str = "
@group(0) @binding(0) var<uniform> look: Look;
@group(0) @binding(1) var<storage, read> rays: array<array<vec4f, 4>>;
@group(0) @binding(2) var<storage, read_write> found: array<vec4u>;

@compute @workgroup_size(64)
fn follow(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&rays) {
        return;
    }
    let base = rays[id.x][0];
    let ray = rays[id.x][1];
    let side = rays[id.x][2];
    let terms = rays[id.x][3];
    // The skin of a ball of radius 1, by its tangent plane.
    let slope = mat3x3f(look.spacing, 0.0, 0.0, 0.0, look.spacing, 0.0, 0.0, 0.0, look.spacing);
    var path: Path;
    path.skin = Skin(base.xyz, base.xyz, base.xyz, slope);
    path.start = extrusion(look, base.xyz, base.w) / look.spacing;
    path.ray = ray.xyz;
    path.far = ray.w;
    path.side = side.xyz;
    path.curve = length(side.xyz) * look.spacing;
    path.slowing = side.w;
    path.height = base.w;
    path.rise = terms.x;
    path.bulge = terms.y;
    path.long = terms.z;
    let met = strand_along(look, path);
    found[id.x] = vec4u(u32(met.found), met.id, bitcast<u32>(met.way), bitcast<u32>(met.along));
}
";

/// A ray over a ball of radius 1.
struct Ray {
    base: Vec3,
    height: f32,
    way: Vec3,
    /// In cells.
    far: f32,
    long: f32,
}

impl Ray {
    fn random(i: u32, fur: &Fur) -> Self {
        let number = |k: u32| unit(hash([i, k, 7, 0])[0]);
        let point = |k: u32| Vec3::new(number(k), number(k + 1), number(k + 2)) - 0.5;
        let base = point(0).normalize_or(Vec3::Y);
        let long = 0.3 + 0.7 * number(3);
        // Half of them go along the skin.
        let flat = base.cross(point(4)).normalize_or(base.any_orthonormal_vector());
        let steep = if i.is_multiple_of(2) { 0.2 } else { 3.0 };
        let way = (flat + base * (steep * (number(7) - 0.7))).normalize();
        let height = long * number(8);
        let mut ray = Self { base, height, way, far: 4.0 * number(9), long };
        // Down to the skin at most.
        while ray.place(fur, ray.far).1 < 0.0 {
            ray.far *= 0.9;
        }
        ray
    }

    /// The base and the height of a point of the ray, so many cells along it.
    fn place(&self, fur: &Fur, cells: f32) -> (Vec3, f32) {
        let start = fur.extruded(self.base, self.base, self.height);
        let at = start + self.way * (cells * fur.spacing);
        let (mut base, mut height) = (at.normalize(), 0.0);
        for _ in 0..20 {
            let side = fur.extruded(Vec3::ZERO, base, height) - base * (fur.height * height);
            let below = at - side;
            (base, height) = (below.normalize(), (below.length() - 1.0) / fur.height);
        }
        (base, height)
    }

    fn words(&self, fur: &Fur) -> [Vec4; 4] {
        let (n, h, cell) = (self.base, self.height, fur.spacing);
        let up = self.way.dot(n);
        let rise = up / fur.height;
        let level = self.way - n * up;
        let bend = (fur.bend - n * fur.bend.dot(n)) * (2.0 * h * up);
        let wider = 1.0 + fur.height * h * (1.0 - h * fur.bend.dot(n));
        let bulge = level.length_squared() / ((1.0 + fur.height * h) * fur.height);
        [
            n.extend(h),
            self.way.extend(self.far),
            ((level - bend) / wider).extend(up / wider * cell),
            Vec4::new(rise * cell, bulge * cell * cell, self.long, 0.0),
        ]
    }

    /// The first strand that contains a point of the ray, and how many cells away that is.
    fn first(&self, fur: &Fur) -> Option<(u32, f32)> {
        let steps = (self.far / STEP).ceil() as u32;
        (0..=steps).map(|i| (i as f32 * STEP).min(self.far)).find_map(|cells| {
            let (base, height) = self.place(fur, cells);
            let skin = Skin { position: base, normal: base, plane: base, slope: Mat3::IDENTITY };
            fur.strand_at(&skin, height.max(0.0), self.long).map(|strand| (strand.id, cells))
        })
    }
}

/// Between the points that are looked up, in cells.
const STEP: f32 = 0.01;

#[test]
fn rays_meet_the_strand_in_which_their_points_first_lie() {
    let Some(gpu) = Gpu::for_tests() else { return };
    for (bend, density) in [(Vec3::ZERO, 0.15), (Vec3::new(0.4, -0.7, 0.1), 0.5)] {
        let fur = Fur { bend, seed: 4, ..Fur::for_radius(1.0, 0.06, density).unwrap() };
        let rays: Vec<Ray> = (0..1500).map(|i| Ray::random(i, &fur)).collect();
        let words: Vec<[Vec4; 4]> = rays.iter().map(|ray| ray.words(&fur)).collect();
        let source = [STRANDS, include_str!("rays.wgsl"), RAYS].concat();
        let bytes = of_points(&gpu, (source, "follow"), &Look::new(fur), &words, 16);
        let answers: Vec<[u32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
        let (mut met, mut differ, mut far) = (0, 0, 0);
        for (ray, [found, id, way, _]) in rays.iter().zip(answers) {
            let want = ray.first(&fur);
            let way = f32::from_bits(way);
            met += u32::from(want.is_some());
            far += u32::from(want.is_some_and(|(_, way)| way > 0.5));
            let same = match want {
                None => found == 0,
                Some((strand, cells)) => found == 1 && strand == id && (way - cells).abs() < 0.1,
            };
            differ += u32::from(!same);
        }
        println!(
            "density {density}: {met} of {} rays meet strands, {far} after half a cell, {differ} differ",
            rays.len()
        );
        // Where strands touch or end the first point may lie in another one.
        assert!(met > 400 && far > 100 && 25 * differ < rays.len() as u32, "{met} {far} {differ}");
    }
}

const VERTICES: &str = "
struct Given { follows: vec4u, shares: vec4f, way: vec4f, lean: vec4f }
@group(0) @binding(0) var<storage, read> given: array<Given>;
@group(0) @binding(1) var<storage, read_write> found: array<array<vec4f, 3>>;

@compute @workgroup_size(64)
fn place(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&given) {
        return;
    }
    let g = given[id.x];
    let rows = blended(vec2u(1u, arrayLength(&joints) - 2u), g.follows, g.shares);
    let axes = transpose(mat3x3f(rows[0].xyz, rows[1].xyz, rows[2].xyz));
    found[id.x][0] = vec4f(transformed(rows, vec4f(g.way.xyz, 1.0)), 0.0);
    found[id.x][1] = vec4f(taken_back(axes, g.way.xyz), 0.0);
    found[id.x][2] = vec4f(leaning(vec3f(0.5, -0.2, 0.1), g.lean, axes), 0.0);
}
";

#[test]
fn shaders_place_vertices_where_the_processor_does() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mut random = dice(21);
    let joints = (0..6).map(|i: usize| Joint::at(i.checked_sub(1), random.point())).collect();
    let skeleton = Skeleton::new(joints).unwrap();
    let channels = (0..6).flat_map(|joint| {
        let turn = Quat::from_axis_angle(random.direction(), (3.0 * random.next()) as f32);
        let (size, how) = (Vec3::ONE + random.point() * 0.4, Interpolation::Step);
        [
            (joint, Channel::Rotation(Track::new(vec![0.0], vec![turn], how).unwrap())),
            (joint, Channel::Scale(Track::new(vec![0.0], vec![size], how).unwrap())),
        ]
    });
    let clip = Clip::new(channels.collect(), &skeleton).unwrap();
    let mut pose = Pose::rest(&skeleton);
    pose.set(&skeleton, &clip, 0.0, Ending::Loop);
    let vertices = 2000;
    let of: Vec<[u32; 4]> = (0..vertices).map(|_| [0; 4].map(|_| (6.0 * random.next()) as u32)).collect();
    let shares: Vec<[f32; 4]> = (0..vertices).map(|_| [0; 4].map(|_| random.next() as f32)).collect();
    let weights = Weights::new(&of, &shares, &skeleton).unwrap();
    let leans: Vec<Lean> = (0..vertices)
        .map(|i| Lean {
            towards: random.point() * 3.0,
            most: if i % 5 == 0 { 0.0 } else { 2.0 * random.next() as f32 },
        })
        .collect();
    let ways: Vec<Vec3> = (0..vertices).map(|_| random.point() * 2.0).collect();
    let given: Vec<[u32; 16]> = (0..vertices)
        .map(|v| {
            let lean = leans[v].towards.extend(leans[v].most);
            let words =
                weights.shares()[v].into_iter().chain(ways[v].extend(0.0).to_array()).chain(lean.to_array());
            let words: Vec<u32> = of[v].into_iter().chain(words.map(f32::to_bits)).collect();
            words.try_into().unwrap()
        })
        .collect();
    // A joint of another animal before and behind.
    let other = [[f32::NAN; 4]; 3];
    let rows: Vec<_> =
        [other].into_iter().chain(pose.matrices().iter().map(rows_of)).chain([other]).collect();
    let mut taken_back = 0;
    // In one group.
    let source = [include_str!("pose.wgsl"), VERTICES].concat().replace("@group(1)", "@group(0)");
    let buffers = [bytemuck::cast_slice::<_, u32>(&given), bytemuck::cast_slice(&rows)]
        .map(|words| filled(&gpu, words, BufferUsages::STORAGE).unwrap());
    let bound = [(0, &buffers[0]), (2, &buffers[1])];
    let bytes = computed(&gpu, (source, "place"), &bound, (1, 48 * vertices), vertices);
    // Its place, a way taken back, the bend.
    let found: Vec<[[f32; 4]; 3]> = bytemuck::pod_collect_to_vec(&bytes);
    for (v, found) in found.into_iter().enumerate() {
        let [at, back, bend] = found.map(Vec4::from_array);
        let m = weights.blend(v, &pose);
        assert!(at.truncate().distance(m.transform_point3(ways[v])) < 1e-4, "vertex {v}");
        let want = leans[v].bend(Vec3::new(0.5, -0.2, 0.1), Mat3::from(m.matrix3));
        assert!(bend.truncate().distance(want) < 1e-4, "vertex {v}: {bend} {want}");
        // Blends that nearly flatten have no inverse to speak of.
        if m.matrix3.determinant().abs() > 0.05 {
            let again = m.transform_vector3(back.truncate());
            assert!(again.distance(ways[v]) < 1e-3, "vertex {v}: {again} {}", ways[v]);
            taken_back += 1;
        }
    }
    println!("{taken_back} of {vertices} ways taken back");
    assert!(taken_back > vertices / 2);
}
