//! Streams of the reference encoder (`draco3dgltf` 1.5.7), of what `torus` and `fan` say.

use std::f64::consts::TAU;

use casca_draco::{Unpacked, unpacked};
use peak_alloc::PeakAlloc;

#[path = "../../../tests/damage/mod.rs"]
mod damage;

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

/// Tori: by Edgebreaker at speeds 0 and 7, and in sequence. Positions, normals and places in a
/// texture are their attributes 0, 1 and 2.
const TORI: [&[u8]; 3] = [
    include_bytes!("torus.valence.drc"),
    include_bytes!("torus.standard.drc"),
    include_bytes!("torus.sequential.drc"),
];
/// A fan of 260 points that are integers, with joints as attribute 1; in sequence.
const FAN: &[u8] = include_bytes!("fan.drc");
/// Cells of the torus around its hole, and around its tube.
const CELLS: [u32; 2] = [12, 8];
/// Half a step of 11 bits over the width of the torus, which is 5.5, and of 10 bits over 1; and what
/// floats round.
const STEPS: [f32; 2] = [5.5 / 2047.0 * 0.501, 1.0 / 1023.0 * 0.501];
/// More than any of these unpacks to.
const MOST: usize = 1 << 24;
/// Types of components.
const U8: u32 = 5121;
const I16: u32 = 5122;
const F32: u32 = 5126;

/// The points of the torus by rows, with its seams twice: where they are, and where in a texture.
fn torus() -> Vec<[f32; 5]> {
    let [n, m] = CELLS;
    let point = |i: u32, j: u32| {
        let [a, b] = [(i % n, n), (j % m, m)].map(|(k, of)| TAU * f64::from(k) / f64::from(of));
        let ring = 2.0 + 0.75 * b.cos();
        let [x, y, z] = [ring * a.cos(), 0.75 * b.sin(), ring * a.sin()].map(|x| x as f32);
        [x, y, z, i as f32 / n as f32, j as f32 / m as f32]
    };
    (0..=n).flat_map(|i| (0..=m).map(move |j| point(i, j))).collect()
}

/// Its triangles.
fn triangles_of_torus() -> Vec<[usize; 3]> {
    let [n, m] = CELLS.map(|cells| cells as usize);
    let cell = |i: usize, j: usize| {
        let (p, q) = (i * (m + 1) + j, (i + 1) * (m + 1) + j);
        [[p, p + 1, q], [q, p + 1, q + 1]]
    };
    sorted((0..n).flat_map(|i| (0..m).flat_map(move |j| cell(i, j))).collect())
}

/// Triangles from their least corner on, in order.
fn sorted(mut triangles: Vec<[usize; 3]>) -> Vec<[usize; 3]> {
    for t in &mut triangles {
        let least = (0..3).min_by_key(|&corner| t[corner]).unwrap();
        t.rotate_left(least);
    }
    triangles.sort_unstable();
    triangles
}

fn floats(mesh: &Unpacked, number: u32, components: usize) -> Vec<f32> {
    let bytes = mesh.values(number, F32, components).unwrap();
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect()
}

fn triangles(mesh: &Unpacked) -> Vec<[usize; 3]> {
    let indices = mesh.indices();
    let corners: Vec<usize> =
        indices.chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().unwrap()) as usize).collect();
    assert_eq!(corners.len(), mesh.corners());
    corners.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect()
}

// One test: another one beside it would count memory, too.
#[test]
fn streams_are_unpacked_and_damaged_ones_are_refused() {
    all_triangles_of_tori_are_there_within_their_step();
    integers_are_as_they_were();
    let whole: Vec<Vec<u8>> = TORI.iter().chain([&FAN]).map(|stream| stream.to_vec()).collect();
    let (mut read, mut refused) = (0, 0);
    damage::survive(&HEAP, "draco", &whole, 20_000, &|_| (), &mut |bytes| match unpacked(bytes, MOST) {
        Ok(mesh) => {
            read += 1;
            _ = (mesh.indices(), mesh.values(0, F32, 3), mesh.values(0, I16, 3), mesh.values(2, F32, 2));
        }
        Err(_) => refused += 1,
    });
    assert!(read > 1000 && refused > 1000, "{read} {refused}");
    let told = |stream, most| unpacked(stream, most).err().expect("must be refused");
    // Of the fan, values fit, but not its 258 triangles; of the torus, values do not.
    assert_eq!(told(FAN, 3000), "it unpacks to too much");
    assert_eq!(told(TORI[0], 3000), "it unpacks to too much");
    assert!(told(&TORI[0][..500], MOST).starts_with("it is damaged, or is no mesh ("));
}

fn all_triangles_of_tori_are_there_within_their_step() {
    let expected = torus();
    for stream in TORI {
        let mesh = unpacked(stream, MOST).unwrap();
        let (places, coordinates) = (floats(&mesh, 0, 3), floats(&mesh, 2, 2));
        let points: Vec<usize> = (places.chunks_exact(3).zip(coordinates.chunks_exact(2)))
            .map(|(place, at)| {
                let off =
                    |a: &[f32], b: &[f32]| a.iter().zip(b).fold(0.0f32, |o, (a, b)| o.max((a - b).abs()));
                let is_it = |p: &[f32; 5]| off(&p[..3], place) <= STEPS[0] && off(&p[3..], at) <= STEPS[1];
                expected.iter().position(is_it).expect("a point of the torus")
            })
            .collect();
        assert_eq!(points.len(), mesh.points());
        let found = triangles(&mesh).into_iter().map(|t| t.map(|point| points[point])).collect();
        assert_eq!(sorted(found), triangles_of_torus());
        for (number, component, components) in [(3, F32, 3), (0, F32, 2), (0, I16, 3)] {
            assert!(mesh.values(number, component, components).is_none());
        }
    }
}

fn integers_are_as_they_were() {
    let mesh = unpacked(FAN, MOST).unwrap();
    let places: Vec<u8> = (0..260i16)
        .flat_map(|i| if i == 0 { [0; 3] } else { [i, i % 16, i * 4 - 500] })
        .flat_map(i16::to_le_bytes)
        .collect();
    assert_eq!(mesh.values(0, I16, 3), Some(places));
    let joints = (0..260u32).flat_map(|i| [(i % 3) as u8, 1, 0, 0]).collect();
    assert_eq!(mesh.values(1, U8, 4), Some(joints));
    assert_eq!(triangles(&mesh), (1..259).map(|i| [0, i, i + 1]).collect::<Vec<_>>());
}
