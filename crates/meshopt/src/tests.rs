//! What the encoder of the extension packs is unpacked, and damaged bytes are survived.

use meshopt::{encode_index_buffer, encode_index_sequence, encode_vertex_buffer_level};

use super::*;

/// Random numbers from 0 to 1 (a linear congruential generator; Knuth).
fn dice() -> impl FnMut() -> f32 {
    let mut state = 1u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1u64 << 24) as f32
    }
}

/// Reads packed bytes, and then damaged ones: those that end too soon or go on must be refused.
fn survives(packed: &[u8], read: impl Fn(&[u8]) -> bool) {
    let step = 1 + packed.len() / 40;
    assert!(read(packed) && !read(&[packed, &[0]].concat()));
    assert!(!(0..packed.len()).step_by(step).any(|length| read(&packed[..length])));
    for at in (0..packed.len()).step_by(step) {
        for change in [1, 0x80, 0xff] {
            let mut damaged = packed.to_vec();
            damaged[at] ^= change;
            _ = read(&damaged);
        }
    }
}

#[test]
fn what_the_encoder_packs_is_unpacked() {
    let mut dice = dice();
    for count in [1, 15, 16, 17, 255, 256, 257, 1000] {
        // Bytes that stay, that differ little, and any.
        let mut vertex = |i: usize| {
            let any: [u8; 4] = std::array::from_fn(|_| (dice() * 256.0) as u8);
            let [a, b] = (1000 + i as u16 * 3).to_le_bytes();
            let [c, d, e, f] = (i as f32).to_le_bytes();
            [any[0], any[1], 7, 7, a, b, 0, any[2] & 3, c, d, e, f, any[3] & 1, 0, 255, i as u8]
        };
        let vertices: Vec<[u8; 16]> = (0..count).map(&mut vertex).collect();
        for (version, level) in [(0, 0), (1, 0), (1, 1), (1, 2), (1, 3)] {
            let packed = encode_vertex_buffer_level(&vertices, level, Some(version)).unwrap();
            let found = unpacked("ATTRIBUTES", "NONE", &packed, count, 16);
            assert!(found.as_deref() == Some(vertices.as_flattened()), "{count} {version} {level}");
            survives(&packed, |bytes| attributes(bytes, count, 16).is_some());
        }
        let wide: Vec<[u8; 256]> = vertices.iter().map(|v| std::array::from_fn(|i| v[i % 16])).collect();
        let packed = encode_vertex_buffer_level(&wide, 3, Some(1)).unwrap();
        assert_eq!(attributes(&packed, count, 256).as_deref(), Some(wide.as_flattened()));

        let any: Vec<u32> = (0..3 * count).map(|_| (dice() * 1e6) as u32).collect();
        let near: Vec<u32> = (0..3 * count as u32).map(|i| i / 2 + i % 3).collect();
        let rows = (0..2 * count as u32).flat_map(|i| {
            let a = i / 2 + i / 60;
            if i % 2 == 0 { [a, a + 1, a + 31] } else { [a + 31, a + 1, a + 32] }
        });
        for corners in [any, near, rows.collect()] {
            let packed = encode_index_sequence(&corners, 1 << 20).unwrap();
            assert_eq!(indices(&packed, corners.len()).as_ref(), Some(&corners));
            survives(&packed, |bytes| indices(bytes, corners.len()).is_some());
            let packed = encode_index_buffer(&corners, 1 << 20).unwrap();
            // The encoder turns triangles, but keeps their order.
            let found = triangles(&packed, corners.len()).unwrap();
            let turned = |t: &[u32]| (0..3).map(|k| [t[k], t[(k + 1) % 3], t[(k + 2) % 3]]).min();
            assert!(found.chunks(3).map(turned).eq(corners.chunks(3).map(turned)), "{count}");
            survives(&packed, |bytes| triangles(bytes, corners.len()).is_some());
        }
    }
    let packed = encode_index_sequence(&[3, 70_000, 5], 70_001).unwrap();
    let narrow = unpacked("INDICES", "NONE", &packed, 3, 2);
    assert_eq!(narrow.as_deref(), Some(&[3u16, 4464, 5].map(u16::to_le_bytes).concat()[..]));
    for (mode, count, stride) in [("INDICES", 3, 3), ("TRIANGLES", 3, 2), ("POINTS", 3, 2), ("INDICES", 4, 2)]
    {
        assert!(unpacked(mode, "NONE", &packed, count, stride).is_none(), "{mode} {count} {stride}");
    }
    for stride in [0, 3, 6, 260] {
        assert!(attributes(&[0xa1; 1000], 4, stride).is_none(), "{stride}");
    }
    assert!(attributes(&[], 0, 4).is_none() && triangles(&[], 0).is_none() && indices(&[], 0).is_none());
}

/// Undoes a filter of vectors of four; the decoder may round halves in the other direction.
fn undone(filter: &str, packed: &[[i16; 4]], expected: &[[i16; 4]]) {
    let mut bytes: Vec<u8> = packed.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
    unfilter(filter, 8, &mut bytes).unwrap();
    for (found, &expected) in bytes.chunks_exact(2).zip(expected.as_flattened()) {
        let off = i16::from_le_bytes([found[0], found[1]]).wrapping_sub(expected);
        assert!((-1..=1).contains(&off), "{filter}: {found:?} is not {expected}");
    }
}

#[test]
fn filters_are_undone_as_the_decoder_undoes_them() {
    let mut dice = dice();
    let mut any = |_| std::array::from_fn(|_| 2.0 * dice() - 1.0);
    let all: Vec<[f32; 4]> = (0..500).map(&mut any).collect();
    let scaled = |v: &[f32; 4], n: usize| {
        let length = v[..n].iter().map(|c| c * c).sum::<f32>().sqrt();
        std::array::from_fn(|i| if i < n { v[i] / length } else { v[i] })
    };
    let directions: Vec<[f32; 4]> = all.iter().map(|v| scaled(v, 3)).collect();
    let packed = meshopt::encode_filter_oct::<i16>(&directions, 12);
    let mut expected = packed.clone();
    meshopt::decode_filter_oct(&mut expected);
    undone("OCTAHEDRAL", &packed, &expected);
    let turns: Vec<[f32; 4]> = all.iter().map(|v| scaled(v, 4)).collect();
    let packed = meshopt::encode_filter_quat(&turns, 12);
    let mut expected = packed.clone();
    meshopt::decode_filter_quat(&mut expected);
    undone("QUATERNION", &packed, &expected);
    let colors: Vec<[f32; 4]> = all.iter().map(|v| v.map(f32::abs)).collect();
    let packed = meshopt::encode_filter_color::<u16>(&colors, 12);
    let mut expected = packed.clone();
    meshopt::decode_filter_color(&mut expected);
    let signed = |all: &[[u16; 4]]| all.iter().map(|v| v.map(|c| c as i16)).collect::<Vec<_>>();
    undone("COLOR", &signed(&packed), &signed(&expected));
    // Three times 2 to the power of 2, and so on.
    let mut bytes = [0x0200_0003u32, 0xff00_0005, 0xfeff_ffff].map(u32::to_le_bytes).concat();
    unfilter("EXPONENTIAL", 12, &mut bytes).unwrap();
    assert_eq!(bytes, [12.0f32, 2.5, -0.25].map(f32::to_le_bytes).concat());
    // One byte a component: half of the way from x to y.
    let mut bytes = [64, 64, 127, 9];
    unfilter("OCTAHEDRAL", 4, &mut bytes).unwrap();
    assert_eq!(bytes, [90, 90, 255, 9]);
    for (filter, stride) in [("OCTAHEDRAL", 12), ("QUATERNION", 4), ("COLOR", 16), ("MEDIAN", 8)] {
        assert!(unfilter(filter, stride, &mut [0; 48]).is_none(), "{filter} {stride}");
    }
}
