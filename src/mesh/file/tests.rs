//! Round trips, and files that are refused.

use std::io::{self, Read};
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{Affine3A, Vec3};

use super::{CHECKSUM, FLAGS, HEADER, OPEN, PARTS, PATCHES, POSITIONS, SIDES, TRIANGLES, VERSION, checksum};
use crate::error::FileError;
use crate::geometry::Sphere;
use crate::mesh::instance::Instance;
use crate::mesh::surface::PatchIndex;
use crate::mesh::{Facing, MeshOptions, TriMesh};
use crate::object::ObjectDesc;
use crate::query::Query;
use crate::scene::Scene;
use crate::view::View;

/// A floor and a wall that share an edge: two patches, with a seam and open sides.
fn corner() -> TriMesh {
    let positions = vec![
        Vec3::new(1.0, 1.0, 1.0),
        Vec3::new(5.0, 1.0, 1.0),
        Vec3::new(5.0, 1.0, 5.0),
        Vec3::new(1.0, 1.0, 5.0),
        Vec3::new(1.0, 6.0, 1.0),
        Vec3::new(5.0, 6.0, 1.0),
    ];
    TriMesh::new(positions, vec![[0, 2, 1], [0, 3, 2], [0, 1, 5], [0, 5, 4]]).unwrap()
}

/// A ball, so coarse that outlines leave the edges of triangles; closed unless rings are left out.
fn ball(center: Vec3, rings: std::ops::Range<u32>, how: &MeshOptions) -> TriMesh {
    let point = |ring: u32, step: u32| {
        let (tilt, angle) = (ring as f32 * 0.196_349_55, (step % 24) as f32 * 0.261_799_4);
        let flat = if ring.is_multiple_of(16) { 0.0 } else { tilt.sin() };
        center + Vec3::new(flat * angle.cos(), tilt.cos(), flat * angle.sin()) * 2.0
    };
    let positions = (0..=16).flat_map(|r| (0..24).map(move |s| point(r, s))).collect();
    let at = |r: u32, s: u32| r * 24 + s % 24;
    let quad = |(r, s)| {
        let (a, b, c, d) = (at(r, s), at(r, s + 1), at(r + 1, s + 1), at(r + 1, s));
        [[a, b, c], [a, c, d]]
    };
    let triangles = rings.flat_map(|r| (0..24).map(move |s| (r, s))).flat_map(quad).collect();
    TriMesh::prepare(positions, triangles, how, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// A flat disc, whose outline leaves its edges.
fn disc() -> TriMesh {
    let rim = |i: u32| {
        let (sin, cos) = (i as f32 * 0.261_799_4).sin_cos();
        Vec3::new(8.0 + 3.0 * cos, 8.0 + 3.0 * sin, 8.0)
    };
    let positions = (0..24).map(rim).chain([Vec3::splat(8.0)]).collect();
    let triangles = (0..24).map(|i| [i, (i + 1) % 24, 24]).collect();
    let how = MeshOptions::default().tolerance(0.3);
    TriMesh::prepare(positions, triangles, &how, &mut |_| ControlFlow::Continue(())).unwrap()
}

fn meshes() -> Vec<TriMesh> {
    let front = MeshOptions { facing: Facing::Front, tolerance: Some(0.1), ..MeshOptions::default() };
    let scaled = |s: f32| {
        let positions = corner().positions.iter().map(|&p| (p - 3.5) * s).collect();
        TriMesh::new(positions, corner().triangles.to_vec()).unwrap()
    };
    vec![
        corner(),
        disc(),
        ball(Vec3::splat(8.0), 0..16, &MeshOptions::default()),
        ball(Vec3::new(3.0, 8.0, 8.0), 0..11, &front),
        // Nothing to hide with, the zeros of both signs, and the largest and least numbers.
        TriMesh::new(vec![Vec3::ONE; 3], vec![[0, 1, 2]]).unwrap(),
        TriMesh::new(vec![Vec3::ZERO, -Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 2, 3], [1, 3, 2]]).unwrap(),
        scaled(f32::MAX / 4.0),
        scaled(1e-45),
    ]
}

fn bytes(mesh: &TriMesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    mesh.write(&mut bytes).unwrap();
    bytes
}

fn read(mut bytes: &[u8]) -> Result<TriMesh, FileError> {
    TriMesh::read(&mut bytes)
}

/// Makes length and checksum those of changed contents.
fn mend(bytes: &mut Vec<u8>) {
    bytes.truncate(bytes.len() - CHECKSUM);
    let length = (bytes.len() - HEADER) as u64;
    bytes[HEADER - 8..HEADER].copy_from_slice(&length.to_le_bytes());
    bytes.extend(checksum(bytes).to_le_bytes());
}

/// Where the count of each section is.
fn places(bytes: &[u8]) -> [usize; 7] {
    let mut at = HEADER;
    [12, 12, 3, 17, 76, 12, 0].map(|size| {
        let here = at;
        at += 8 + size * u64::from_le_bytes(*bytes[at..].first_chunk().unwrap()) as usize;
        here
    })
}

/// What can be seen of some objects around a mesh that is placed twice.
fn seen(mesh: TriMesh) -> Vec<Vec<usize>> {
    let mut scene = Scene::new(1.0).unwrap();
    let mesh = Arc::new(mesh);
    let fixed = ObjectDesc::fixed(mesh.clone()).occluder(mesh.clone());
    let mut ids = vec![scene.insert(fixed).unwrap()];
    if let Ok(moved) = Instance::new(mesh, Affine3A::from_rotation_x(0.3)) {
        let desc = ObjectDesc::dynamic(moved.clone()).occluder(moved);
        ids.push(scene.insert(desc).unwrap());
        scene.translate(ids[1], Vec3::new(7.0, 1.0, 6.0)).ok();
    }
    for i in 0..216 {
        let center = Vec3::new((i % 6) as f32, (i / 6 % 6) as f32, (i / 36) as f32) * 2.5 + 1.5;
        ids.push(scene.insert(ObjectDesc::fixed(Sphere::new(center, 0.2))).unwrap());
    }
    let mut query = Query::new();
    let eyes = [Vec3::new(3.0, 3.0, 7.5), Vec3::new(3.1, 3.2, 0.4), Vec3::new(15.0, 12.0, 13.0)];
    let look = |eye| {
        let pvs = query.run(&scene, &View::from_planes(eye, &[]).unwrap());
        (0..ids.len()).filter(|&i| pvs.contains(ids[i])).collect()
    };
    eyes.into_iter().map(look).collect()
}

#[test]
fn what_is_read_is_what_was_written() {
    let all = meshes();
    assert!(all.iter().any(|m| m.surface.sides.iter().any(|s| s.slack > 0.0)));
    assert!(all.iter().any(|m| m.surface.sides.iter().any(|s| s.opposite())));
    assert!(all.iter().any(|m| m.surface.group_outlines.len() > 1 && m.closed));
    assert!(all.iter().any(|m| m.surface.leaf_sides().any(|side| side.2.is_open()) && m.surface.front));
    assert!(all.iter().any(|m| !m.surface.chains.is_empty()));
    // One after the other, and nothing of the next is taken.
    let mut stream: Vec<u8> = all.iter().flat_map(bytes).collect();
    stream.extend(b"more");
    let mut rest = stream.as_slice();
    for mesh in &all {
        let loaded = TriMesh::read(&mut rest).unwrap();
        assert_eq!(loaded.positions, mesh.positions);
        assert_eq!(loaded.triangles, mesh.triangles);
        assert_eq!((loaded.bounds, loaded.closed), (mesh.bounds, mesh.closed));
        assert_eq!(loaded.surface, mesh.surface);
        assert_eq!(loaded.parts, mesh.parts);
        assert_eq!(bytes(&loaded), bytes(mesh));
    }
    assert_eq!(rest, b"more");
    assert!(matches!(read(&[]), Err(FileError::Truncated { held: 0, .. })));
}

#[test]
fn a_loaded_mesh_hides_what_the_prepared_one_hides() {
    let mut hidden = 0;
    for mesh in meshes() {
        let before = seen(mesh.clone());
        assert_eq!(seen(read(&bytes(&mesh)).unwrap()), before);
        hidden += before.iter().map(|seen| 218 - seen.len()).sum::<usize>();
    }
    assert!(hidden > 100, "{hidden}");
}

#[test]
fn bounds_only_stay_bounds_only() {
    let whole = ball(Vec3::splat(8.0), 0..16, &MeshOptions::default());
    let mesh = TriMesh::bounds_only(whole.positions.to_vec(), whole.triangles.to_vec()).unwrap();
    let loaded = read(&bytes(&mesh)).unwrap();
    assert!(!loaded.occludes() && loaded.is_closed() && !loaded.solid);
    assert_eq!((loaded.sides(), loaded.parts.len()), (0, mesh.parts.len()));
    assert_eq!(bytes(&loaded), bytes(&mesh));
    assert!(bytes(&mesh).len() < bytes(&whole).len());
    // What hides nothing has no front, and nothing to hide with.
    let flags = places(&bytes(&mesh))[2];
    let mut front = bytes(&mesh);
    front[flags + 10] = 1;
    mend(&mut front);
    let refused = read(&front).unwrap_err().to_string();
    assert!(refused.contains("hides from its front, though the mesh occludes nothing"), "{refused}");
}

#[test]
fn refuses_every_damaged_byte() {
    let whole = bytes(&corner());
    for at in 0..whole.len() {
        for flip in [1, 0x10, 0x80, 0xff] {
            let mut damaged = whole.clone();
            damaged[at] ^= flip;
            let refused = read(&damaged).unwrap_err();
            let named = match at {
                0..8 => matches!(refused, FileError::Magic { .. }),
                8..12 => {
                    matches!(refused, FileError::Version { found, known: VERSION } if found != VERSION)
                }
                12..20 => {
                    matches!(refused, FileError::Truncated { .. } | FileError::Checksum { .. })
                }
                _ => matches!(refused, FileError::Checksum { .. }),
            };
            assert!(named, "byte {at}: {refused}");
        }
    }
}

#[test]
fn refuses_every_shortened_file() {
    let whole = bytes(&corner());
    for length in 0..whole.len() {
        match read(&whole[..length]).unwrap_err() {
            FileError::Truncated { held, needed } => {
                assert_eq!(held, length as u64);
                let known = if length < HEADER { HEADER } else { whole.len() };
                assert_eq!(needed, known as u64);
            }
            other => panic!("{length} bytes: {other}"),
        }
        // The same with a checksum that is right.
        if length > HEADER + CHECKSUM {
            let mut short = whole[..length].to_vec();
            mend(&mut short);
            let refused = read(&short).unwrap_err();
            assert!(matches!(refused, FileError::Section { .. }), "{length} bytes: {refused}");
        }
    }
    assert!(matches!(read(b"glTF"), Err(FileError::Magic { found: [b'g', b'l', b'T', b'F', 0, 0, 0, 0] })));
}

#[test]
fn refuses_what_follows_the_last_section() {
    let mut long = bytes(&corner());
    long.splice(long.len() - CHECKSUM..long.len() - CHECKSUM, [0; 3]);
    mend(&mut long);
    assert!(matches!(read(&long), Err(FileError::Trailing(3))));
}

#[test]
fn other_versions_are_refused() {
    for found in [0, 1, 2, 3, 5, u32::MAX] {
        let mut other = bytes(&corner());
        other[8..12].copy_from_slice(&found.to_le_bytes());
        mend(&mut other);
        let refused = read(&other).unwrap_err();
        assert!(matches!(refused, FileError::Version { found: f, known: VERSION } if f == found));
    }
}

/// A stream that never holds more than asked for, and says how much that was.
struct Endless(u64);

impl Read for Endless {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0 += buffer.len() as u64;
        // Far above what doubling takes, far below what is claimed.
        if self.0 > 1 << 20 { Err(io::Error::other("asked for too much")) } else { Ok(0) }
    }
}

#[test]
fn claims_take_no_memory() {
    let whole = bytes(&corner());
    // More than any machine has: taking it fails at once.
    for claim in [1u64 << 36, 1 << 44, 1 << 60, u64::MAX / 12 + 2, u64::MAX] {
        let mut header = whole[..HEADER].to_vec();
        header[12..20].copy_from_slice(&claim.to_le_bytes());
        let mut stream = header.as_slice().chain(Endless(0));
        let refused = TriMesh::read(&mut stream).unwrap_err();
        assert!(matches!(refused, FileError::Truncated { held: 20, .. }), "{refused}");
        for at in places(&whole) {
            let mut claiming = whole.clone();
            claiming[at..at + 8].copy_from_slice(&claim.to_le_bytes());
            mend(&mut claiming);
            let refused = read(&claiming).unwrap_err();
            assert!(matches!(refused, FileError::Section { .. }), "{claim} at {at}: {refused}");
        }
    }
}

/// A change of bytes: where, what is written there, the section that is refused, and a part of the
/// reason.
type Change<'a> = (usize, &'a [u8], &'a str, &'a str);

fn refuses_each(whole: &[u8], changes: &[Change]) {
    for &(at, new, named, reason) in changes {
        let mut made = whole.to_vec();
        made[at..at + new.len()].copy_from_slice(new);
        assert_ne!(made, whole, "{named}: {reason}");
        mend(&mut made);
        match read(&made).unwrap_err() {
            FileError::Entry { section, why, .. } if section == named => {
                assert!(why.contains(reason), "{named} {why}, where {reason} was expected");
            }
            other => panic!("{named} {reason}: {other}"),
        }
    }
}

#[test]
fn refuses_nonsense_with_a_right_checksum() {
    let whole = bytes(&corner());
    let [positions, triangles, flags, sides, patches, open, _] = places(&whole);
    // A bundle of two patches.
    let [whole_patch, one, two_patch] = [8, 84, 160].map(|at| patches + at);
    let (nan, inf) = (f32::NAN.to_le_bytes(), f32::INFINITY.to_le_bytes());
    let (nan64, two) = (f64::NAN.to_le_bytes(), 2f64.to_le_bytes());
    let none = u32::MAX.to_le_bytes();
    // The first open side, and one with a patch beyond.
    let alone = u32::from_le_bytes(*whole[open + 8..].first_chunk().unwrap()) as usize;
    let mesh = corner();
    let beyond = mesh.surface.sides.iter().position(|s| s.twin() != PatchIndex::NONE).unwrap();
    let twin = |side: usize| sides + 8 + 17 * side + 12;
    let other = 2 - u32::from(mesh.surface.patches[1].last as usize <= alone);
    let own = (1 + u32::from(mesh.surface.patches[1].last as usize <= beyond)).to_le_bytes();
    // A corner of the other patch than that of the first side.
    let far = if mesh.surface.patches[1].normal.y.abs() > 0.5 { 4u32 } else { 2 };
    let changes: &[Change] = &[
        (positions + 8, &nan, POSITIONS, "not finite"),
        (positions + 20, &inf, POSITIONS, "not finite"),
        (triangles + 8, &6u32.to_le_bytes(), TRIANGLES, "not there"),
        (triangles + 8, &none, TRIANGLES, "not there"),
        (flags + 8, &[1], FLAGS, "which it is not"),
        (flags + 8, &[2], FLAGS, "neither 0 nor 1"),
        (flags + 9, &[3], FLAGS, "neither 0 nor 1"),
        (flags + 9, &[0], SIDES, "occludes nothing"),
        (flags + 10, &[2], FLAGS, "neither 0 nor 1"),
        (sides + 8, &6u32.to_le_bytes(), SIDES, "not there"),
        (sides + 12, &none, SIDES, "not there"),
        (sides + 12, &far.to_le_bytes(), PATCHES, "leaves its box"),
        (sides + 16, &nan, SIDES, "slack"),
        (sides + 16, &(-1f32).to_le_bytes(), SIDES, "slack"),
        (twin(beyond), &(1u32 << 30).to_le_bytes(), SIDES, "not there"),
        (twin(beyond), &3u32.to_le_bytes(), SIDES, "not there"),
        (twin(beyond), &0u32.to_le_bytes(), SIDES, "not there"),
        (twin(beyond), &own, PATCHES, "itself beyond"),
        (twin(beyond), &none, SIDES, "opposite to no patch"),
        (twin(alone), &other.to_le_bytes(), OPEN, "patch beyond"),
        (twin(alone) + 4, &[7], SIDES, "neither 0 nor 1"),
        (whole_patch, &1u32.to_le_bytes(), PATCHES, "though it is a group"),
        (whole_patch + 4, &none, PATCHES, "leaves its group"),
        (whole_patch + 4, &1u32.to_le_bytes(), PATCHES, "outside of the first"),
        (whole_patch + 4, &3u32.to_le_bytes(), PATCHES, "contain all others"),
        (one, &none, PATCHES, "more than there are"),
        (two_patch, &3u32.to_le_bytes(), PATCHES, "sides without a patch"),
        (one + 4, &1u32.to_le_bytes(), PATCHES, "though it is a group"),
        (one + 4, &2u32.to_le_bytes(), PATCHES, "leaves its group"),
        (one + 8, &nan, PATCHES, "sine"),
        (one + 8, &2f32.to_le_bytes(), PATCHES, "sine"),
        (one + 12, &nan64, PATCHES, "length 1"),
        (one + 12, &two, PATCHES, "length 1"),
        (one + 36, &nan64, PATCHES, "slab"),
        (one + 36, &(-1e9f64).to_le_bytes(), PATCHES, "slab"),
        (one + 36, &1e9f64.to_le_bytes(), PATCHES, "slab"),
        (one + 44, &1e9f64.to_le_bytes(), PATCHES, "slab"),
        (one + 52, &nan, PATCHES, "leaves the mesh"),
        (one + 52, &0f32.to_le_bytes(), PATCHES, "leaves the mesh"),
        (one + 64, &7f32.to_le_bytes(), PATCHES, "leaves the mesh"),
        (open + 8, &none, OPEN, "not there"),
        (open + 8, &(beyond as u32).to_le_bytes(), OPEN, "patch beyond"),
        (open + 20, &(alone as u32).to_le_bytes(), OPEN, "comes before"),
    ];
    refuses_each(&whole, changes);
}

#[test]
fn refuses_parts_that_are_not_solid() {
    let whole = bytes(&corner());
    let [.., parts] = places(&whole);
    let (nan64, two) = (f64::NAN.to_le_bytes(), 2f64.to_le_bytes());
    let (counts, first) = (parts + 8, parts + 14);
    let vertices = usize::from(whole[counts]);
    let faces = first + 24 * vertices;
    let edges = faces + 32 * usize::from(whole[counts + 2]);
    let changes: &[Change] = &[
        (counts, &3u16.to_le_bytes(), PARTS, "too few"),
        (counts + 2, &3u16.to_le_bytes(), PARTS, "too few"),
        (counts + 4, &0u16.to_le_bytes(), PARTS, "too few"),
        (counts + 4, &300u16.to_le_bytes(), PARTS, "too many"),
        (first, &nan64, PARTS, "far from"),
        (first, &1e30f64.to_le_bytes(), PARTS, "far from"),
        (faces, &two, PARTS, "length 1"),
        (faces + 24, &nan64, PARTS, "touch"),
        (faces + 24, &9f64.to_le_bytes(), PARTS, "touch"),
        (edges, &(vertices as u16).to_le_bytes(), PARTS, "without two"),
        (edges + 4, &100u16.to_le_bytes(), PARTS, "without two"),
        (edges, &whole[edges + 2..edges + 4], PARTS, "without two"),
    ];
    refuses_each(&whole, changes);
}

#[test]
fn refuses_sections_without_entries_and_twice_the_flags() {
    let whole = bytes(&corner());
    let [_, triangles, flags, .., parts] = places(&whole);
    let cut = |from: usize, size: usize, count: u64| {
        let mut made = whole.clone();
        made.drain(from + 8..from + 8 + size);
        made[from..from + 8].copy_from_slice(&count.to_le_bytes());
        mend(&mut made);
        read(&made).unwrap_err().to_string()
    };
    assert!(cut(triangles, 48, 0).contains("triangles of the mesh is missing"));
    assert!(cut(flags, 3, 0).contains("flags of the mesh is missing"));
    assert!(cut(parts, whole.len() - CHECKSUM - parts - 8, 0).contains("around the mesh"));
    let mut twice = whole.clone();
    twice[flags..flags + 8].copy_from_slice(&2u64.to_le_bytes());
    mend(&mut twice);
    assert!(read(&twice).unwrap_err().to_string().contains("one too many"));
}

#[test]
fn refuses_groups_nested_without_end() {
    let whole = bytes(&corner());
    let patches = places(&whole)[4];
    for (deep, refused) in [(10, false), (2000, true)] {
        let mut made = whole.clone();
        let first = made[patches + 8..patches + 84].to_vec();
        let bundles = (1..=deep).rev().flat_map(|more: u32| {
            let mut bundle = first.clone();
            bundle[4..8].copy_from_slice(&(2 + more).to_le_bytes());
            bundle
        });
        made.splice(patches + 8..patches + 8, bundles);
        made[patches..patches + 8].copy_from_slice(&u64::from(3 + deep).to_le_bytes());
        // The two patches have other numbers now.
        let sides = places(&made)[3];
        for side in 0..u64::from_le_bytes(*made[sides..].first_chunk().unwrap()) as usize {
            let twin = sides + 8 + 17 * side + 12;
            let number = u32::from_le_bytes(*made[twin..].first_chunk().unwrap());
            if number != PatchIndex::NONE.get() {
                made[twin..twin + 4].copy_from_slice(&(number + deep).to_le_bytes());
            }
        }
        mend(&mut made);
        match read(&made) {
            Ok(mesh) => assert!(!refused && mesh.patches() == 2),
            Err(error) => assert!(refused && error.to_string().contains("too many groups"), "{error}"),
        }
    }
}

#[test]
fn what_passes_all_checks_does_no_harm() {
    let whole = bytes(&corner());
    let mut taken = 0;
    for at in HEADER..whole.len() - CHECKSUM {
        for flip in [1, 0x80] {
            let mut made = whole.clone();
            made[at] ^= flip;
            mend(&mut made);
            if let Ok(mesh) = read(&made) {
                assert_eq!(bytes(&mesh), made);
                seen(mesh);
                taken += 1;
            }
        }
    }
    assert!(taken > 50, "{taken}");
}

#[test]
fn checksums_are_those_of_fnv_1a() {
    assert_eq!(checksum(b""), 0xcbf2_9ce4_8422_2325);
    assert_eq!(checksum(b"a"), 0xaf63_dc4c_8601_ec8c);
    assert_eq!(checksum(b"foobar"), 0x8594_4171_f739_67e8);
}

#[test]
fn writing_says_what_the_stream_says() {
    let mut small = [0; 100];
    assert_eq!(corner().write(&mut small.as_mut_slice()).unwrap_err().kind(), io::ErrorKind::WriteZero);
}
