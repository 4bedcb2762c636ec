//! The shaders' rules against those of casca-fur, point by point.

use crate::shading::kajiya_kay;
use crate::strands::{Fur, Skin, hash};
use casca_stage::gpu::Gpu;
use casca_stage::wgpu::BufferUsages;
use glam::{Vec3, Vec4};

use crate::gpu::compute::{Given, computed};
use crate::gpu::look::Look;

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

/// The shader's values for each point: strand and hash, lobes, extrusion, the sun's share.
fn look_up(gpu: &Gpu, look: &Look, points: &[[Vec4; 3]]) -> Vec<[[u32; 4]; 3]> {
    let flat: Vec<f32> = points.iter().flatten().flat_map(|v| v.to_array()).collect();
    let record = look.record();
    let given = |binding, usage, bytes| Given { place: (0, binding), usage, bytes };
    let given = [
        given(0, BufferUsages::UNIFORM, bytemuck::bytes_of(&record)),
        given(1, BufferUsages::STORAGE, bytemuck::cast_slice(&flat)),
    ];
    let found = ((0, 2), 48 * points.len());
    let bytes = computed(gpu, [STRANDS, POINTS].concat(), &given, found, points.len());
    bytemuck::pod_collect_to_vec(&bytes)
}

/// Relative errors of sums of a few products in single precision.
const ROUNDING: f32 = 1e-5;

#[test]
fn shaders_find_the_strands_that_the_processor_finds() {
    let Some(gpu) = Gpu::for_tests() else { return };
    // Evenly spread over a ball, at all heights and lengths.
    let number = |i: u32, k: u32| crate::strands::unit(hash([i, k, 0, 0])[0]);
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
        let answers = look_up(&gpu, &Look::new(fur), &points);
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
            let slope = glam::Mat3::from_diagonal(Vec3::splat(bent.w));
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
