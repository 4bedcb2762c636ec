//! A drive through a world of any size: pages are loaded ahead and dropped behind, and the origin of
//! coordinates follows the eye.
//!
//! `cargo run --release --example large_world`

use std::collections::BTreeSet;

use casca::glam::{DVec3, Mat4, Vec3, Vec4};
use casca::{Aabb, Error, ObjectDesc, PageId, PageObjects, Query, View, World, WorldOptions};

/// The objects of a page, relative to its corner. An engine reads them from a file, on another
/// thread, and prepares their meshes there.
fn page() -> Result<PageObjects, Error> {
    let boxed = |x: f32, z: f32, size: Vec3| {
        let min = Vec3::new(x, 0.0, z);
        Aabb::new(min, min + size)
    };
    let mut objects = Vec::new();
    for i in 0..8 {
        for j in 0..8 {
            let (x, z) = (64.0 * i as f32, 64.0 * j as f32);
            let house = boxed(x + 8.0, z + 8.0, Vec3::new(48.0, 20.0, 48.0));
            objects.push(ObjectDesc::fixed(house).occluder(house));
            objects.push(ObjectDesc::fixed(boxed(x + 2.0, z + 30.0, Vec3::new(0.2, 4.0, 0.2))));
        }
    }
    PageObjects::new(objects)
}

fn main() -> Result<(), Error> {
    // Cells of a metre, pages of 512 m, and an origin that follows the eye when that is 4 pages away.
    let options = WorldOptions::new(1.0).reach(4);
    let mut world = World::new(options)?;
    let mut query = Query::new();
    let mut handed: BTreeSet<PageId> = BTreeSet::new();
    // Two thousand kilometres from the origin; a step in single precision is 0.12 m there.
    let start = DVec3::new(2.0e6, 2.0, -1.0e6);
    let car = Aabb::new(Vec3::new(-1.0, -1.5, -2.0), Vec3::new(1.0, 0.0, 2.0));
    let car = world.insert(ObjectDesc::dynamic(car).occluder(car).max_speed(60.0), start)?;
    // Eye-relative, as a renderer of large worlds draws: 60 degrees high and 16:9, looking along x.
    let projection = Mat4::from_cols(Vec4::X * 0.974, Vec4::Y * 1.732, -Vec4::W, Vec4::Z * 0.1);
    let turn = Mat4::from_rotation_y(std::f32::consts::FRAC_PI_2);
    for frame in 0..3000 {
        let eye = start + DVec3::X * f64::from(frame);
        let here = world.page_at(eye)?;
        let near: BTreeSet<PageId> =
            (-2..=2).flat_map(|x| (-2..=2).map(move |z| PageId::new(here.x + x, 0, here.z + z))).collect();
        for gone in handed.difference(&near) {
            world.drop_page(*gone)?;
        }
        for new in near.difference(&handed) {
            world.load(*new, page()?)?;
        }
        handed = near;

        let changes = world.begin_frame(f64::from(frame) / 60.0, eye)?;
        if changes.shifted {
            println!("frame {frame}: the origin is at {} now", world.origin());
        }
        world.set_place(car, eye + DVec3::X * 20.0)?;
        let view = world.scene().view(eye, &View::perspective(Vec3::ZERO, projection * turn)?)?;
        let pvs = query.run(world.scene(), &view);
        assert!(pvs.contains(car));
        if frame % 500 == 0 {
            println!("frame {frame}: {} of {} objects may be seen", pvs.len(), world.scene().len());
        }
        world.end_frame([query.pvs()])?;
    }
    Ok(())
}
