//! The shaders' skinning and leaning against those of casca-fur, vertex by vertex.

use casca_stage::gpu::Gpu;
use casca_stage::wgpu::BufferUsages;
use glam::{Mat3, Quat, Vec3, Vec4};

use crate::gpu::compute::{Given, computed};
use crate::gpu::records::rows_of;
use crate::samples::dice;
use crate::skin::{Channel, Clip, Ending, Interpolation, Joint, Pose, Skeleton, Track, Weights};
use crate::strands::Lean;

const POSE: &str = include_str!("pose.wgsl");
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

/// The shader's results for each vertex: its place, a way taken back, the bend.
fn place(gpu: &Gpu, joints: &[[[f32; 4]; 3]], given: &[[u32; 16]]) -> Vec<[Vec4; 3]> {
    let given_at = |place, bytes| Given { place, usage: BufferUsages::STORAGE, bytes };
    let buffers =
        [given_at((0, 0), bytemuck::cast_slice(given)), given_at((1, 2), bytemuck::cast_slice(joints))];
    let found = ((0, 1), 48 * given.len());
    let bytes = computed(gpu, [POSE, VERTICES].concat(), &buffers, found, given.len());
    let rows: Vec<[[f32; 4]; 3]> = bytemuck::pod_collect_to_vec(&bytes);
    rows.into_iter().map(|rows| rows.map(Vec4::from_array)).collect()
}

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
    for (v, [at, back, bend]) in place(&gpu, &rows, &given).into_iter().enumerate() {
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
