//! The light of texels and probes beside closed forms and a path tracer, and charts that do not overlap.

use std::collections::HashMap;
use std::sync::Arc;

use casca_lightmap::{
    BakeError, Following, Light, Placed, Probes, Settings, beside, light, on_page, texels, unwrap,
};
use casca_radiosity::Light as Lamp;
use casca_radiosity::lit::{Kind, LitObject, LitScene, Material};
use casca_scenes::world::Mesh;
use glam::{Affine3A, DVec2, Quat, Vec3};

/// A box with its fronts outside, or inside.
fn cuboid(min: Vec3, max: Vec3, inside: bool, material: u32) -> LitObject {
    let mut mesh = Mesh::cuboid(min, max);
    if inside {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    let materials = vec![material; mesh.triangles.len()].into();
    LitObject { mesh: Arc::new(mesh), materials, uv: Arc::default(), transform: Affine3A::IDENTITY }
}

fn scene(objects: Vec<LitObject>, materials: Vec<Material>, lights: Vec<Lamp>) -> LitScene {
    let empty = Kind::Cornell.build();
    LitScene { objects, materials, lights, sky: Vec3::ZERO, ..empty }
}

fn placed(scene: &LitScene) -> Vec<Placed> {
    let of = |o: &LitObject| Placed { mesh: (*o.mesh).clone(), places: vec![o.transform] };
    scene.objects.iter().map(of).collect()
}

fn baked(scene: &LitScene, settings: &Settings) -> Light {
    light(scene, &placed(scene), settings, &mut |_, _, _| {}).unwrap()
}

const FAST: Settings = Settings { texels: 6.0, side: 512, spacing: 1.0, cells: 24, rays: 64, live: false };

#[test]
fn a_furnace_is_as_bright_as_the_series_says_in_texels_and_in_all_faces_of_probes() {
    for albedo in [0.0_f32, 0.5] {
        let material = Material { emission: Vec3::ONE, ..Material::matt(Vec3::splat(albedo)) };
        let walls = cuboid(Vec3::ZERO, Vec3::new(3.0, 2.0, 2.5), true, 0);
        let found = baked(&scene(vec![walls], vec![material], vec![]), &FAST);
        // All walls send pi / (1 - a); matt white scatters that over pi.
        let truth = 1.0 / (1.0 - albedo);
        let off = |color: &Vec3| (*color / truth - 1.0).abs().max_element();
        let texels = found.texels.iter().filter(|t| **t != Vec3::ZERO);
        let worst = texels.map(off).fold(0.0, f32::max);
        let probes = found.probes.cubes.iter().flatten().map(off).fold(0.0, f32::max);
        println!("{albedo}: {worst} {probes} {} texels", found.lit);
        assert!(worst < 1e-3 && probes < 1e-3, "{albedo}: {worst}, {probes}");
        // Six walls of 31.5 square metres, and not a texel of them dark.
        assert!(found.lit > 31 * 36 && found.probes.cubes.len() == 3 * 2 * 3, "{}", found.lit);
    }
}

#[test]
fn texels_of_the_cornell_box_are_lit_as_a_path_tracer_lights_their_points() {
    for (kind, bound) in [(Kind::Cornell, 0.04), (Kind::CornellPoint, 0.04)] {
        let scene = kind.build();
        let settings = Settings { texels: 4.0, cells: 64, rays: 128, ..FAST };
        let found = baked(&scene, &settings);
        let b = beside(&scene, &placed(&scene), &found, 170, 1024);
        println!("{} {b:?} of {} texels", kind.name(), found.lit);
        assert!(b.error < bound && b.difference.abs() < 0.015 && b.texels > 100, "{b:?}");
        // Threads do not matter.
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert_eq!(one.install(|| baked(&scene, &settings)).texels, found.texels);
    }
}

#[test]
fn a_sealed_room_beside_a_lit_one_is_black_in_texels_and_probes() {
    for (thickness, turn) in [(0.0, 0.0), (0.02, 0.0), (0.02, 0.7), (0.3, 0.7)] {
        // Both stand on one floor, which goes on below the wall.
        let room = |x: f32| {
            let mut room = cuboid(Vec3::new(x, 0.0, 0.0), Vec3::new(x + 2.0, 2.0, 2.0), true, 0);
            Arc::make_mut(&mut room.mesh).triangles.retain(|t| t.iter().any(|v| room_height(*v) > 0.0));
            room.materials = vec![0; room.mesh.triangles.len()].into();
            room
        };
        let dark = 2.0 + thickness;
        let floor = cuboid(Vec3::new(0.0, -0.5, 0.0), Vec3::new(dark + 2.0, 0.0, 2.0), false, 0);
        let mut objects = vec![room(0.0), room(dark), floor];
        let place = Affine3A::from_quat(Quat::from_axis_angle(Vec3::new(1.0, 2.0, 0.5).normalize(), turn));
        objects.iter_mut().for_each(|o| o.transform = place);
        let lamp = Lamp::point(place.transform_point3(Vec3::splat(1.0)), Vec3::splat(10.0));
        let scene = scene(objects, vec![Material::matt(Vec3::splat(0.8))], vec![lamp]);
        let found = baked(&scene, &FAST);
        let (mut seen, mut bright) = (0, 0.0_f32);
        for t in &texels(&found.atlas, &placed(&scene)).lit {
            let at = place.inverse().transform_point3(t.point);
            let color = found.texels[t.number as usize];
            if at.x > dark && at.y > -1e-3 {
                assert_eq!(color, Vec3::ZERO, "{at} of {thickness}, {turn}");
                seen += 1;
            }
            bright += color.x;
        }
        assert!(seen > 500 && bright > 500.0, "{seen} {bright}");
        // No ring around the charts of that room is lit either.
        let atlas = &found.atlas;
        let corners =
            [[0.0; 2], [1.0; 2]].map(|uv| on_page(atlas, &atlas.meshes[1].instances[0], uv).as_uvec2());
        let [low, high] = corners;
        for (x, y) in (low.x..high.x).flat_map(|x| (low.y..high.y).map(move |y| (x, y))) {
            assert_eq!(found.texels[(y * atlas.width + x) as usize], Vec3::ZERO, "{x} {y}");
        }
        for (i, cube) in found.probes.cubes.iter().enumerate() {
            let at = place.inverse().transform_point3(found.probes.place(i));
            let inside =
                at.cmpgt(Vec3::new(dark, 0.0, 0.0)).all() && at.cmplt(Vec3::new(dark + 2.0, 2.0, 2.0)).all();
            assert!(!inside || *cube == [Vec3::ZERO; 6], "{at}");
        }
    }
}

/// The height of a corner of a box of 2 metres.
fn room_height(vertex: u32) -> f32 {
    Mesh::cuboid(Vec3::ZERO, Vec3::splat(2.0)).positions[vertex as usize].y
}

#[test]
fn floors_are_as_bright_at_the_feet_of_walls_that_stand_in_them_as_beside() {
    // A block that reaches into the floor, under an even sky that lights all that is not below it.
    let floor = cuboid(Vec3::new(-2.0, -1.0, -2.0), Vec3::new(2.0, 0.0, 2.0), false, 0);
    let block = cuboid(Vec3::new(-0.55, -0.5, -0.55), Vec3::new(0.55, 0.02, 0.55), false, 0);
    let mut scene = scene(vec![floor, block], vec![Material::matt(Vec3::ZERO)], vec![]);
    scene.sky = Vec3::ONE;
    let found = baked(&scene, &Settings { texels: 8.0, ..FAST });
    let mut near = 0;
    for t in &texels(&found.atlas, &placed(&scene)).lit {
        let depth = 0.55 - t.point.x.abs().max(t.point.z.abs());
        if t.normal.y > 0.9 && t.point.y < 0.01 && depth > 0.0 && depth < 0.24 {
            near += 1;
            let color = found.texels[t.number as usize];
            assert!(color.x > 0.5, "{} {color}", t.point);
        }
    }
    assert!(near > 20, "{near}");
}

#[test]
fn charts_overlap_nowhere_and_stay_on_their_pages_with_the_density_that_was_asked_for() {
    let torn = Affine3A::from_scale_rotation_translation(
        Vec3::new(-2.0, 1.0, 1.0),
        Quat::from_rotation_y(0.4),
        Vec3::splat(7.0),
    );
    let all = [
        Placed { mesh: Mesh::ball(2), places: vec![Affine3A::IDENTITY, torn] },
        Placed { mesh: Mesh::cuboid(Vec3::ZERO, Vec3::new(3.0, 0.1, 5.0)), places: vec![torn] },
        // Without an area, without triangles, and without a place.
        Placed {
            mesh: Mesh { positions: vec![Vec3::ZERO; 3], triangles: vec![[0, 1, 2]; 2], ..Mesh::default() },
            places: vec![torn],
        },
        Placed { mesh: Mesh::default(), places: vec![torn] },
        Placed { mesh: Mesh::ball(1), places: vec![] },
    ];
    for side in [2048, 128] {
        let atlas = unwrap(&all, 10.0, side).unwrap();
        let longest = atlas.width.max(atlas.height);
        assert!(longest <= side && (atlas.page_count > 1) == (side == 128), "{longest}");
        let mut owner: HashMap<(u32, u32, u32), (usize, usize)> = HashMap::new();
        let mut area = 0.0;
        for (m, layout) in atlas.meshes.iter().enumerate() {
            let within = |uv: [f32; 2]| uv.iter().all(|c| (0.0..=1.0).contains(c));
            assert!(layout.vertices.iter().all(|v| within(v.uv)));
            for (rect, t) in
                layout.instances.iter().flat_map(|r| layout.indices.chunks(3).map(move |t| (r, t)))
            {
                assert!(within(rect.min) && within(rect.max) && rect.page < atlas.page_count);
                let [a, b, c] = [0, 1, 2].map(|i| on_page(&atlas, rect, layout.vertices[t[i] as usize].uv));
                area += 0.5 * (b - a).perp_dot(c - a);
                let (low, high) = (a.min(b).min(c).as_uvec2(), a.max(b).max(c).as_uvec2());
                for (x, y) in (low.x..=high.x).flat_map(|x| (low.y..=high.y).map(move |y| (x, y))) {
                    let p = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                    let sides = [(b - a).perp_dot(p - a), (c - b).perp_dot(p - b), (a - c).perp_dot(p - c)];
                    // Middles on an edge belong to both of its triangles.
                    if sides.iter().all(|s| *s > 1e-3) {
                        let old = owner.insert((rect.page, x, y), (m, t[0] as usize));
                        assert_eq!(old, None, "{x} {y} of {m} {t:?}");
                    }
                }
            }
        }
        // The cuboid alone has twice 3.0 x 5.0 square metres, and the scale is that of its longest axis.
        assert!(owner.len() > 5_000 && area > 100.0 * 4.0 * 31.6, "{} {area}", owner.len());
    }
}

#[test]
fn probes_follow_a_door_as_if_they_were_baked_anew() {
    // Two rooms with a gap in their wall, which a door shuts, and a lamp in the first.
    let solid = |[x0, x1]: [f32; 2], [z0, z1]: [f32; 2]| {
        cuboid(Vec3::new(x0, 0.0, z0), Vec3::new(x1, 2.0, z1), false, 0)
    };
    let rooms = cuboid(Vec3::ZERO, Vec3::new(4.2, 2.0, 2.0), true, 0);
    let mut objects = vec![solid([2.05, 2.15], [0.6, 1.4]), rooms];
    objects.extend([[0.0, 0.7], [1.3, 2.0]].map(|z| solid([2.0, 2.2], z)));
    let lamps = vec![Lamp::point(Vec3::ONE, Vec3::ONE)];
    let mut scene = scene(objects, vec![Material::matt(Vec3::splat(0.8))], lamps);
    let settings = Settings { spacing: 0.5, cells: 32, ..FAST };
    let mut following = Following::new(scene.clone(), &settings).unwrap();
    let light = |p: &Probes, least: f32| -> f32 {
        let far = (0..p.cubes.len()).filter(|i| p.place(*i).x > least);
        far.map(|i| p.cubes[i].iter().map(|c| c.x).sum::<f32>()).sum()
    };
    // It slides into the wall.
    for open in [0.0, 0.55, 0.3, 0.0] {
        scene.objects[0].transform = Affine3A::from_translation(Vec3::Z * open);
        following.moved(&[(0, scene.objects[0].transform)]).unwrap();
        let (anew, found) = (baked(&scene, &settings).probes, &following.probes);
        let off: f32 = anew.cubes.iter().zip(&found.cubes).map(|(a, b)| (a[0] - b[0]).abs().x).sum();
        let (sum, beyond) = (light(&anew, 0.0), light(found, 2.5));
        assert!(off < 0.005 * sum && (beyond > 0.0) == (open > 0.0), "{open}: {off} of {sum}, {beyond}");
    }
    assert!(following.moved(&[(9, Affine3A::IDENTITY)]).unwrap_err().to_string().contains("object"));
}

#[test]
fn settings_out_of_range_and_meshes_that_are_none_are_errors_that_say_what_to_do() {
    let scene = Kind::Cornell.build();
    let said = |settings: Settings| {
        light(&scene, &placed(&scene), &settings, &mut |_, _, _| {}).map(|_| ()).unwrap_err().to_string()
    };
    for (settings, word) in [
        (Settings { texels: f32::NAN, ..FAST }, "texels a metre are NaN: there must be 0.01 to 1000"),
        (Settings { side: 1 << 20, ..FAST }, "64 to 8192"),
        (Settings { texels: 999.0, ..FAST }, "a metre would do"),
        (Settings { texels: 100.0, side: 64, ..FAST }, "larger pages"),
        (Settings { spacing: 0.0, ..FAST }, "metres between probes"),
        (Settings { spacing: 1e-3, ..FAST }, "m would do"),
        (Settings { cells: 0, ..FAST }, "cells"),
        (Settings { rays: 0, ..FAST }, "rays"),
    ] {
        assert!(said(settings).contains(word), "{settings:?}: {}", said(settings));
    }
    let nan = Mesh { positions: vec![Vec3::NAN; 3], triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let far = Mesh { triangles: vec![[0, 1, 99]], ..Mesh::ball(0) };
    for (mesh, place) in [
        (nan, Affine3A::IDENTITY),
        (far, Affine3A::IDENTITY),
        (Mesh::ball(0), Affine3A::from_scale(Vec3::INFINITY)),
        (Mesh::ball(0), Affine3A::from_scale(Vec3::splat(1e30))),
    ] {
        let why = unwrap(&[Placed { mesh, places: vec![place] }], 1.0, 512).unwrap_err();
        assert!(matches!(why, BakeError::Unwrap(_) | BakeError::Texels(..)), "{why}");
    }
}
