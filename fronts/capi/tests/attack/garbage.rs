//! Garbage: random bytes in all structs, numbers and handles of the C face. Pointers are null or
//! lead to memory. No call may panic or crash, and scenes that were made before must still answer.

use std::ptr::null_mut;

use casca_c::*;

use super::{Dice, variable};

impl Dice {
    /// Mostly a number that may be meant, else any float.
    fn float(&mut self) -> f32 {
        match self.below(16) {
            0 => f32::from_bits(self.bits() as u32),
            1 => [f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MAX, f32::MIN_POSITIVE, -0.0][self.below(6)],
            2 => 0.0,
            _ => (self.below(4001) as f32 - 2000.0) * 0.01,
        }
    }

    fn floats<const N: usize>(&mut self) -> [f32; N] {
        std::array::from_fn(|_| self.float())
    }

    /// One of those that were given out, sometimes any other number.
    fn one_of(&mut self, known: &[u64]) -> u64 {
        match (known.len(), self.below(12)) {
            (_, 0) => self.bits(),
            (_, 1) | (0, _) => self.below(3) as u64,
            (n, 2) => known[self.below(n)] ^ 1 << self.below(64),
            (n, _) => known[self.below(n)],
        }
    }

    fn size(&mut self, size: usize) -> usize {
        match self.below(20) {
            0 => self.bits() as usize,
            1 => self.below(2 * size),
            _ => size,
        }
    }

    fn flags(&mut self, known: u32) -> u32 {
        if self.below(16) == 0 { self.bits() as u32 } else { self.bits() as u32 & known }
    }
}

/// What was given out so far, freed or not.
#[derive(Default)]
struct Known {
    scenes: Vec<u64>,
    queries: Vec<u64>,
    meshes: Vec<u64>,
    solids: Vec<u64>,
    jobs: Vec<u64>,
    ids: Vec<u64>,
}

/// Two corners, mostly of a box.
fn corners(dice: &mut Dice) -> [[f32; 3]; 2] {
    let (min, other): ([f32; 3], [f32; 3]) = (dice.floats(), dice.floats());
    if dice.below(6) == 0 {
        return [min, other];
    }
    [min, std::array::from_fn(|i| min[i] + other[i].abs())]
}

fn shape(dice: &mut Dice, known: &Known) -> casca_shape {
    let [min, max] = corners(dice);
    casca_shape {
        kind: dice.below(7) as u32,
        radius: if dice.below(4) == 0 { dice.float() } else { dice.float().abs() },
        center: dice.floats(),
        min,
        max,
        half: dice.floats(),
        rotation: dice.floats(),
        solid: casca_solid { handle: dice.one_of(&known.solids) },
        mesh: casca_mesh { handle: dice.one_of(&known.meshes) },
    }
}

fn object(dice: &mut Dice, known: &Known) -> casca_object {
    let mut object = init!(casca_object);
    object.size = dice.size(object.size);
    object.flags = dice.flags(31);
    object.max_speed = dice.float();
    object.layers = if dice.below(2) == 0 { 0 } else { dice.bits() };
    object.bounds = shape(dice, known);
    object.occluder = if dice.below(2) == 0 { object.bounds } else { shape(dice, known) };
    object.transform = dice.floats();
    if dice.below(4) > 0 {
        (object.transform[3], object.transform[7], object.transform[11], object.transform[15]) =
            (0.0, 0.0, 0.0, 1.0);
    }
    object
}

fn view(dice: &mut Dice, planes: &[f32; 40]) -> casca_view {
    let mut view = init!(casca_view);
    view.size = dice.size(view.size);
    (view.kind, view.flags) = (dice.below(7) as u32, dice.flags(3));
    view.matrix = dice.floats();
    (view.eye, view.forward, view.cell_max) = (dice.floats(), dice.floats(), dice.floats());
    if dice.below(3) > 0 {
        (view.reach, view.turn) = (0.0, 0.0);
    } else {
        (view.reach, view.turn) = (dice.float(), dice.float());
    }
    view.planes = if dice.below(5) == 0 { std::ptr::null() } else { planes.as_ptr() };
    view.plane_count = if dice.below(10) == 0 { dice.bits() as usize | 64 } else { dice.below(11) };
    view.layers = dice.below(4) as u64;
    view
}

/// Calls one function with garbage; gives its status.
fn throw(dice: &mut Dice, known: &mut Known) -> casca_status {
    let scene = casca_scene { handle: dice.one_of(&known.scenes) };
    let query = casca_query { handle: dice.one_of(&known.queries) };
    let id = dice.one_of(&known.ids);
    let (numbers, planes): ([f32; 48], [f32; 40]) = (dice.floats(), dice.floats());
    let (mut made, mut count, mut bytes, mut answer) = (0u64, 0usize, [0u8; 64], false);
    let ids: [u64; 3] = std::array::from_fn(|_| dice.one_of(&known.ids));
    let seen = view(dice, &planes);
    // SAFETY: pointers are null or lead to as much memory as the calls may touch.
    unsafe {
        match dice.below(24) {
            0 => {
                let mut grid = init!(casca_grid);
                grid.size = dice.size(grid.size);
                [grid.min, grid.max] = corners(dice);
                (grid.cell, grid.objects) = (dice.float().abs().max(0.5), dice.below(100) as u32);
                let status = casca_scene_create(&grid, (&raw mut made).cast());
                known.scenes.extend((status == casca_status::CASCA_OK).then_some(made));
                status
            }
            1 => {
                let mut options = init!(casca_query_options);
                options.size = dice.size(options.size);
                (options.method, options.preset, options.flags) =
                    (dice.below(4) as u32, dice.below(4) as u32, dice.flags(3));
                if dice.below(2) == 0 {
                    (options.pixel_degrees, options.reach, options.turn) =
                        (dice.float(), dice.float(), dice.float());
                }
                let status = casca_query_create(&options, (&raw mut made).cast());
                known.queries.extend((status == casca_status::CASCA_OK).then_some(made));
                status
            }
            2..6 => {
                let object = object(dice, known);
                let status = casca_scene_add(scene, &object, &mut made);
                known.ids.extend((status == casca_status::CASCA_OK).then_some(made));
                status
            }
            6 => casca_scene_update(scene, id, &shape(dice, known), std::ptr::null()),
            7 => casca_scene_set_bounds(scene, id, &shape(dice, known)),
            8 => casca_scene_set_occluder(scene, id, &shape(dice, known)),
            9 => casca_scene_move_spheres(scene, ids.as_ptr(), numbers.as_ptr(), dice.below(4)),
            10 => casca_scene_move_boxes(scene, ids.as_ptr(), numbers.as_ptr(), dice.below(4)),
            11 => casca_scene_set_transforms(
                scene,
                ids.as_ptr(),
                numbers.as_ptr(),
                dice.below(4),
                dice.flags(1),
            ),
            12 => casca_scene_translate(scene, id, numbers.as_ptr()),
            13 if dice.below(8) == 0 => {
                let origin = [0, 1, 2].map(|i| f64::from(numbers[i]));
                casca_scene_set_origin(scene, origin.as_ptr())
            }
            13 => casca_scene_begin_frame(scene, f64::from(dice.float()), &mut count),
            14 => casca_scene_end_frame(scene, &query, 1, null_mut()),
            15..18 => casca_query_run(query, scene, &seen, &mut count),
            18 => {
                casca_query_may_see_boxes(query, scene, numbers.as_ptr(), dice.below(9), bytes.as_mut_ptr())
            }
            19 => casca_query_is_valid(query, scene, &seen, &mut answer),
            20 => {
                let mut lamp = init!(casca_light);
                (lamp.kind, lamp.range) = (dice.below(4) as u32, dice.float());
                (lamp.direction, lamp.position) = (dice.floats(), dice.floats());
                lamp.view = if dice.below(4) == 0 { std::ptr::null() } else { &seen };
                let light = casca_query { handle: dice.one_of(&known.queries) };
                casca_query_shadow_casters(light, scene, query, &lamp, &mut count)
            }
            21 => {
                let indices: [u32; 12] = std::array::from_fn(|_| dice.below(17) as u32);
                let mut desc = init!(casca_mesh_desc);
                (desc.positions, desc.position_count) = (numbers.as_ptr(), dice.below(17));
                (desc.indices, desc.index_count) = (indices.as_ptr(), dice.below(13));
                (desc.flags, desc.tolerance) = (dice.flags(7), dice.float());
                let status = casca_mesh_create(&desc, (&raw mut made).cast());
                known.meshes.extend((status == casca_status::CASCA_OK).then_some(made));
                let solid = casca_solid_create(numbers.as_ptr(), dice.below(17), (&raw mut made).cast());
                known.solids.extend((solid == casca_status::CASCA_OK).then_some(made));
                if solid == casca_status::CASCA_ERROR_PANIC { solid } else { status }
            }
            22 => {
                let job = casca_job { handle: dice.one_of(&known.jobs) };
                let ran = casca_job_run(job);
                let installed = casca_query_install(query, scene, job, null_mut());
                let status = casca_query_prepare(query, scene, &seen, (&raw mut made).cast());
                known.jobs.extend((status == casca_status::CASCA_OK).then_some(made));
                [ran, installed, status].into_iter().max_by_key(|status| *status as u32).unwrap_or(status)
            }
            _ => match dice.below(6) {
                0 => casca_scene_free(scene),
                1 => casca_query_free(query),
                2 => casca_mesh_free(casca_mesh { handle: dice.one_of(&known.meshes) }),
                3 => casca_solid_free(casca_solid { handle: dice.one_of(&known.solids) }),
                4 => casca_scene_set_layers(scene, id, dice.bits()),
                _ => casca_scene_remove(scene, id),
            },
        }
    }
}

#[test]
fn garbage_neither_panics_nor_crashes() {
    let seed = variable("CASCA_SEED", 1) << 32;
    let mut statuses = [0u32; 16];
    for round in 0..100 * variable("CASCA_CASES", 1) {
        let (mut dice, mut known) = (Dice(seed + round), Known::default());
        // Something to begin with.
        let (mut grid, mut scene, mut query) =
            (init!(casca_grid), casca_scene { handle: 0 }, casca_query { handle: 0 });
        (grid.min, grid.max, grid.cell) = ([-20.0; 3], [20.0; 3], 1.0);
        ok!(casca_scene_create(&grid, &mut scene));
        ok!(casca_query_create(std::ptr::null(), &mut query));
        known.scenes.extend([scene.handle; 4]);
        known.queries.extend([query.handle; 4]);
        for call in 0..400 {
            let status = throw(&mut dice, &mut known);
            // SAFETY: the message is a string that ends.
            let why =
                || unsafe { std::ffi::CStr::from_ptr(casca_last_error()) }.to_string_lossy().into_owned();
            assert!(status != casca_status::CASCA_ERROR_PANIC, "round {round}, call {call}: {}", why());
            statuses[status as usize] += 1;
        }
        // They end as they lived: freed, or refused.
        known.scenes.iter().for_each(|&handle| _ = casca_scene_free(casca_scene { handle }));
        known.queries.iter().for_each(|&handle| _ = casca_query_free(casca_query { handle }));
        known.meshes.iter().for_each(|&handle| _ = casca_mesh_free(casca_mesh { handle }));
        known.solids.iter().for_each(|&handle| _ = casca_solid_free(casca_solid { handle }));
        known.jobs.iter().for_each(|&handle| _ = casca_job_free(casca_job { handle }));
    }
    println!("calls by status: {statuses:?}");
    let met = statuses.iter().filter(|count| **count > 0).count();
    assert!(statuses[0] > 1000 && met >= 8, "{statuses:?}");
}
