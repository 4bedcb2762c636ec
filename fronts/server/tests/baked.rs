//! Sets from cell to cell as the first filter.

use casca_baked::{Cells, ReadError, Writer};
use casca_server::casca::glam::Vec3;
use casca_server::casca::{Aabb, Scene};
use casca_server::{
    ClientDesc, ClientId, EntityDesc, EntityId, ServerError, ServerOptions, VisibilityServer,
};

/// Cells of 4 m in a row along x, from 0 to 40 m; `sets` gives the cells that some of them see.
fn file(sets: &[(u32, &[u32])]) -> Vec<u8> {
    let mut writer = Writer::cell_to_cell(row(), &sets.iter().map(|(cell, _)| *cell).collect()).unwrap();
    sets.iter().for_each(|(cell, set)| writer.put(*cell, set).unwrap());
    writer.finish().unwrap()
}

fn row() -> Cells {
    Cells { low: [0.0; 3], size: [4.0; 3], dims: [10, 1, 1], origin: [0.0; 3] }
}

/// An empty level, with a client whose eye is at 6 m and entities at 1 to 39 m; none moves.
fn field(options: ServerOptions) -> (VisibilityServer, ClientId, Vec<EntityId>) {
    let level = Scene::new(1.0).unwrap();
    let mut server = VisibilityServer::new(level, options).unwrap();
    let client = server.add_client(ClientDesc::new(Vec3::new(6.0, 2.0, 2.0), 0.0, 0.0), 0.0).unwrap();
    let person = |x| EntityDesc::new(Aabb::from_center(Vec3::new(x, 2.0, 2.0), Vec3::splat(0.5)), 0.0);
    let places = (0..20).map(|i| 1.0 + 2.0 * i as f32);
    let entities = places.map(|x| server.add_entity(person(x), 0.0).unwrap()).collect();
    (server, client, entities)
}

/// Where those are, in metres, that the client is told of.
fn told(server: &mut VisibilityServer, client: ClientId, now: f64) -> Vec<f32> {
    server.tick(now).unwrap();
    let told = &server.answer(client).unwrap().told;
    told.iter().map(|id| server.entity(*id).unwrap().bounds.center().x).collect()
}

#[test]
fn cells_that_see_each_other_are_told() {
    let (mut server, client, entities) = field(ServerOptions::new());
    let all: Vec<f32> = (0..20).map(|i| 1.0 + 2.0 * i as f32).collect();
    assert_eq!(told(&mut server, client, 0.0), all);
    // Cell 1, from 4 to 8 m, sees 0, 1 and 3. Nothing is known about the cells from 5 on.
    server.set_baked(file(&[(0, &[]), (1, &[0, 1, 3]), (2, &[]), (3, &[]), (4, &[])])).unwrap();
    let expected = |seen: &[u32]| -> Vec<f32> {
        let is_told = |x: &&f32| **x > 20.0 || seen.contains(&((**x / 4.0) as u32));
        all.iter().filter(is_told).copied().collect()
    };
    assert_eq!(told(&mut server, client, 0.1), expected(&[0, 1, 3]));
    // In cell 2 it sees nothing that is known.
    server.move_eye(client, Vec3::new(10.0, 2.0, 2.0), 0.2).unwrap();
    assert_eq!(told(&mut server, client, 0.2), expected(&[]));
    // In two cells an eye sees what one of them sees.
    server.set_baked(file(&[(0, &[]), (1, &[0]), (2, &[4]), (3, &[]), (4, &[])])).unwrap();
    server.move_eye(client, Vec3::new(7.5, 2.0, 2.0), 0.25).unwrap();
    server.set_motion(client, 5.0, 0.2).unwrap();
    assert_eq!(told(&mut server, client, 0.3), expected(&[0, 4]));
    // An entity in two cells is seen if one of them is.
    let both = Aabb::new(Vec3::new(15.0, 1.0, 1.0), Vec3::new(17.0, 3.0, 3.0));
    server.move_entity(entities[6], both, 0.3).unwrap();
    assert!(told(&mut server, client, 0.4).contains(&16.0));
    // An eye outside, and an entity that reaches out, may see all and be seen.
    let out = Aabb::new(Vec3::new(13.0, 1.0, 1.0), Vec3::new(14.0, 5.0, 3.0));
    server.move_entity(entities[6], out, 0.4).unwrap();
    assert!(told(&mut server, client, 0.5).contains(&13.5));
    server.move_eye(client, Vec3::new(30.0, 2.0, 2.0), 0.5).unwrap();
    assert_eq!(told(&mut server, client, 0.5).len(), 20);
}

#[test]
fn an_eye_on_the_border_of_cells_sees_what_eyes_on_both_sides_see() {
    // It may be on the face of a wall that fills one of them.
    for x in [8.0f32, 8.000_001, 7.999_999] {
        let (mut server, client, _) = field(ServerOptions::new());
        server.set_baked(file(&[(0, &[]), (1, &[0]), (2, &[3]), (3, &[]), (4, &[])])).unwrap();
        server.move_eye(client, Vec3::new(x, 2.0, 2.0), 0.1).unwrap();
        let told = told(&mut server, client, 0.1);
        assert_eq!(told[..4], [1.0, 3.0, 13.0, 15.0], "{x}: {told:?}");
    }
}

#[test]
fn a_changed_level_and_eyes_in_walls_end_them() {
    let sets = file(&[(0, &[]), (1, &[]), (2, &[])]);
    let (mut server, client, _) = field(ServerOptions::new());
    server.set_baked(sets.clone()).unwrap();
    assert!(server.has_baked() && told(&mut server, client, 0.0)[0] > 12.0);
    server.level_mut();
    assert!(!server.has_baked() && told(&mut server, client, 0.1)[0] == 1.0);
    // Eyes that are in walls see what none in a cell does.
    let (mut server, client, _) = field(ServerOptions::new().walls(false));
    server.set_baked(sets).unwrap();
    assert!(!server.has_baked() && told(&mut server, client, 0.0)[0] == 1.0);
}

#[test]
fn other_files_are_refused_and_change_nothing() {
    let (mut server, client, _) = field(ServerOptions::new());
    server.set_baked(file(&[(0, &[]), (1, &[]), (2, &[])])).unwrap();
    let of_objects = Writer::new(row(), 10).unwrap().finish().unwrap();
    assert_eq!(server.set_baked(of_objects), Err(ServerError::NotCellToCell));
    assert_eq!(server.set_baked(b"PVS".to_vec()), Err(ReadError::NotBaked.into()));
    assert!(told(&mut server, client, 0.0)[0] > 12.0);
}
