//! The functions of shaders, run alone, against the processor's: strands and light point by point,
//! rays along their way, skinning and leaning vertex by vertex.

use casca_scenes::random::Dice;
use casca_stage::gpu::Gpu;
use casca_stage::kernel::{Bound, Kernel, among, filled};
use casca_stage::wgpu::{self, BufferUsages};
use glam::{Mat3, Quat, Vec3, Vec4};

use crate::gpu::look::Look;
use crate::gpu::pipelines::WALK;
use crate::gpu::records::rows_of;
use crate::samples::ball;
use crate::shader::{LOOKUP, SLAB, STRANDS};
use crate::shading::kajiya_kay;
use crate::skin::{Channel, Clip, Interpolation, Joint, Pose, Skeleton, Track, Weights};
use crate::strands::{Fur, Lean, Root, hash, roots, unit};

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

const POINTS: &str = "
@group(0) @binding(0) var<uniform> look: Look;
@group(0) @binding(1) var<storage, read> points: array<array<vec4f, 2>>;
@group(0) @binding(2) var<storage, read_write> found: array<array<vec4f, 4>>;

@compute @workgroup_size(64)
fn look_up(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&points) {
        return;
    }
    let base = points[id.x][0];
    let normal = points[id.x][1];
    let point = point_of(look, floor(base.xyz * 100.0), id.x & 1u);
    found[id.x][0] = vec4f(point.place, f32(point.id));
    let lobes = kajiya_kay(normal.xyz, normalize(base.xyz), normalize(base.yzx), 24.0);
    found[id.x][1] = vec4f(lobes, extrusion(look, normal.xyz, base.w).y,
        sun_through(look, normal.xyz, base.w, normal.w, normalize(base.yzx)));
    let swayed = sway(look, base.xyz, base.w);
    found[id.x][2] = vec4f(swayed.way, 0.0);
    found[id.x][3] = vec4f(swayed.bend, 0.0);
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
    let table = filled(gpu, &look.fur.table(), BufferUsages::STORAGE).unwrap();
    let look = filled(gpu, &look.words(), BufferUsages::UNIFORM).unwrap();
    let flat = filled(gpu, &flat, BufferUsages::STORAGE).unwrap();
    let bound = [(0, &look), (1, &flat), (3, &table)];
    let bound = if shader.0.contains(LOOKUP) { &bound[..] } else { &bound[..2] };
    computed(gpu, shader, bound, (2, bytes * points.len()), points.len())
}

/// Relative errors of sums of a few products in single precision.
const ROUNDING: f32 = 1e-5;

#[test]
fn shaders_compute_what_the_processor_computes() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // Evenly spread over a ball, at all heights and lengths.
    let number = |i: u32, k: u32| unit(hash([i, k, 0, 0])[0]);
    let points: Vec<[Vec4; 2]> = (0..20_000)
        .map(|i| {
            let way = Vec3::from_array([0, 1, 2].map(|k| number(i, k) - 0.5)).normalize_or(Vec3::Y);
            [way.extend(number(i, 3) * number(i, 4)), way.extend(number(i, 4))]
        })
        .collect();
    for (bend, density) in [(Vec3::ZERO, 0.15), (Vec3::new(0.4, -0.7, 0.1), 0.9)] {
        let fur = Fur { bend, seed: 9, clump: 0.7, curl: 0.5, ..Fur::for_radius(1.0, 0.1, density).unwrap() };
        let bytes = of_points(&gpu, ([STRANDS, POINTS].concat(), "look_up"), &Look::new(fur), &points, 64);
        let answers: Vec<[[f32; 4]; 4]> = bytemuck::pod_collect_to_vec(&bytes);
        let mut shaded = 0;
        for (i, ([base, normal], got)) in (0..).zip(points.iter().zip(answers)) {
            let (at, up) = (base.truncate(), normal.truncate());
            let (place, id) = fur.point((at * 100.0).floor().as_ivec3(), i & 1);
            assert_eq!(got[0], place.extend(id as f32).to_array(), "points are the same to the bit");
            let sun = Vec3::new(at.y, at.z, at.x).normalize();
            let lobes = kajiya_kay(up, at.normalize(), sun, 24.0);
            let extruded = (fur.extruded(at, up, base.w) - at).y;
            let through = fur.sun_through(up, base.w, normal.w, sun);
            shaded += usize::from(through < 0.9);
            let [way, bend] = fur.sway(at, base.w);
            let want = [lobes.diffuse, lobes.specular, extruded, through];
            let want = want.into_iter().chain(way.extend(0.0).to_array()).chain(bend.to_array());
            // Powers, sines and exponentials multiply the error of what they are taken of.
            let differs = |(got, want): (&f32, f32)| (got - want).abs() > 100.0 * ROUNDING;
            let other = got[1..].as_flattened().iter().zip(want).position(differs);
            assert_eq!(other, None, "{at}: {got:?}");
        }
        assert!(shaded > 5000, "{shaded}");
    }
}

const RAYS: &str = "
struct Shell { base: vec3f, normal: vec3f, corner: vec3f, coat: vec4f, which: vec3u, bend: vec3f }
@group(0) @binding(0) var<uniform> look: Look;
@group(0) @binding(1) var<storage, read> rays: array<array<vec4f, 2>>;
@group(0) @binding(2) var<storage, read_write> found: array<vec4f>;
@group(0) @binding(3) var<storage, read> strands: array<u32>;

fn strand_near(texel: vec3i) -> u32 {
    return strands[texel.x + 64 * (texel.y + 64 * texel.z)];
}

@compute @workgroup_size(64)
fn follow(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&rays) {
        return;
    }
    let base = rays[id.x][0].xyz;
    let ray = rays[id.x][1].xyz;
    let which = vec3u(0u, u32(rays[id.x][1].w), u32(rays[id.x][0].w));
    // The skin of a ball of radius 1, by its tangent plane.
    let x = normalize(cross(base, base.yzx + vec3f(0.0, 1.0, 2.0)));
    let flat = array(x, cross(base, x));
    let wider = 1.0 + look.height * height_of(which) * (1.0 - height_of(which) * dot(look.bend, base));
    let c = Change(flat, flat, array(flat[0] * wider, flat[1] * wider));
    let shell = Shell(base, base, base, vec4f(1.0), which, look.bend);
    let met = strand_met(shell, c, skin_of(base, base, c), ray);
    found[id.x] = vec4f(f32(met.found), met.own * 255.0, met.along, met.height);
}
";

/// A ray from a layer over a ball of radius 1, down to the next one.
struct Ray {
    base: Vec3,
    layer: f32,
    layers: f32,
    way: Vec3,
}

impl Ray {
    fn random(i: u32, layers: f32) -> Self {
        let number = |k: u32| unit(hash([i, k, 7, 0])[0]);
        let point = |k: u32| Vec3::new(number(k), number(k + 1), number(k + 2)) - 0.5;
        let base = point(0).normalize_or(Vec3::Y);
        let flat = base.cross(point(4)).normalize_or(base.any_orthonormal_vector());
        let way = (flat - base * (0.3 + 3.0 * number(7))).normalize();
        Self { base, layer: 1.0 + (number(8) * layers).floor(), layers, way }
    }

    /// The byte of the strand of a ball that it meets first, and where on it.
    fn first(&self, fur: &Fur, roots: &[Root]) -> Option<(u32, f32)> {
        let start = fur.extruded(self.base, self.base, self.layer / self.layers);
        let floor = 1.0 + fur.height * (self.layer - 1.0) / self.layers;
        let tall = fur.reach(1.0) + 2.0 * fur.spacing;
        let near: Vec<&Root> = roots.iter().filter(|root| root.position.distance(start) < tall).collect();
        let points = (0..).map(|i| start + self.way * (i as f32 * STEP * fur.spacing));
        points.take_while(|at| at.length() >= floor).find_map(|at| {
            let height = (at.length() - 1.0) / fur.height;
            near.iter().find_map(|root| {
                let way = at - root.point(fur, height / root.share);
                let tangent = fur.tangent(root.direction, height);
                let back = way.dot(tangent);
                let along = height / root.share + back * tangent.dot(root.direction) / root.length(fur);
                let within = (way - tangent * back).length() < fur.radius_along(along.max(0.0));
                (within && (0.0..=1.0).contains(&along)).then_some((root.id, along))
            })
        })
    }
}

/// Between the points that are looked up, in cells.
const STEP: f32 = 0.01;

#[test]
fn rays_meet_the_strand_in_which_their_points_first_lie() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let mesh = ball(5);
    for (bend, density) in [(Vec3::ZERO, 0.25), (Vec3::new(0.4, -0.7, 0.1), 0.5)] {
        let fur = Fur { bend, seed: 4, ..Fur::for_radius(1.0, 0.06, density).unwrap() };
        let roots = roots(&mesh, &fur).unwrap();
        let rays: Vec<Ray> = (0..800).map(|i| Ray::random(i, 8.0)).collect();
        let wanted: Vec<_> = rays.iter().map(|ray| ray.first(&fur, &roots)).collect();
        let words: Vec<[Vec4; 2]> =
            rays.iter().map(|ray| [ray.base.extend(ray.layers), ray.way.extend(ray.layer)]).collect();
        for (text, most) in [(WALK, 0.04), (LOOKUP, 0.12)] {
            let source = [STRANDS, text, SLAB, RAYS].concat();
            let bytes = of_points(&gpu, (source, "follow"), &Look::new(fur), &words, 16);
            let answers: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
            let differ = |(want, got): &(&Option<(u32, f32)>, [f32; 4])| match want {
                None => got[0] != 0.0,
                Some((id, along)) => got[0] != 1.0 || got[1] != *id as f32 || (got[2] - along).abs() > 0.1,
            };
            let met = wanted.iter().flatten().count();
            let differ = wanted.iter().zip(answers).filter(differ).count() as f64 / wanted.len() as f64;
            println!("density {density}: {met} of {} rays meet strands, {differ} differ", rays.len());
            // Where strands touch or end the first point may lie in another one.
            assert!(met > 100 && differ < most, "{met} {differ}");
        }
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
    let mut random = Dice::new(21, 0);
    let joints = (0..6).map(|i: usize| Joint::at(i.checked_sub(1), random.ball())).collect();
    let skeleton = Skeleton::new(joints).unwrap();
    let channels = (0..6).flat_map(|joint| {
        let turn = Quat::from_axis_angle(random.ball().normalize(), random.range(0.0, 3.0));
        let (size, how) = (Vec3::ONE + random.ball() * 0.4, Interpolation::Step);
        [
            (joint, Channel::Rotation(Track::new(vec![0.0], vec![turn], how).unwrap())),
            (joint, Channel::Scale(Track::new(vec![0.0], vec![size], how).unwrap())),
        ]
    });
    let clip = Clip::new(channels.collect(), &skeleton).unwrap();
    let mut pose = Pose::rest(&skeleton);
    pose.set(&skeleton, &clip, 0.0);
    let vertices = 2000;
    let of: Vec<[u32; 4]> = (0..vertices).map(|_| [0; 4].map(|_| random.range(0.0, 6.0) as u32)).collect();
    let shares: Vec<[f32; 4]> = (0..vertices).map(|_| [0; 4].map(|_| random.range(0.0, 1.0))).collect();
    let weights = Weights::new(&of, &shares, &skeleton).unwrap();
    let leans: Vec<Lean> = (0..vertices)
        .map(|i| Lean {
            towards: random.ball() * 3.0,
            most: if i % 5 == 0 { 0.0 } else { 2.0 * random.range(0.0, 1.0) },
        })
        .collect();
    let ways: Vec<Vec3> = (0..vertices).map(|_| random.ball() * 2.0).collect();
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
    let source = [STRANDS, include_str!("pose.wgsl"), VERTICES].concat().replace("@group(1)", "@group(0)");
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
