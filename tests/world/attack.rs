//! Random operations on worlds, frame by frame, against rays through a model.

use casca_scenes::world::Mesh;

use crate::common::*;
use crate::model::{Solid, seen};

const CELL: f32 = 1.0 / 16.0;
/// The edge length of a page.
const SIDE: f64 = 32.0;

/// What the player of a game knows.
struct Player {
    random: Random,
    world: World,
    /// By user data.
    solids: Vec<Solid>,
    kinds: Vec<Kind>,
    homes: Vec<Option<PageId>>,
    /// Objects that may go at any time, since their pages were dropped.
    leaving: BTreeSet<usize>,
    /// The movers of the world, and the objects of pages that move.
    movers: Vec<usize>,
    pages: Vec<PageId>,
    eye: DVec3,
    now: f64,
    cube: Arc<TriMesh>,
    seen: usize,
    hidden: usize,
    shifts: usize,
    lost: Vec<String>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Fixed,
    Reported,
    OnExpiry,
}

const SPEED: f32 = 20.0;
const STEP: f64 = 0.1;

fn cube() -> Arc<TriMesh> {
    let cube = Mesh::cuboid(Vec3::splat(-0.5), Vec3::splat(0.5));
    mesh(cube.positions, cube.triangles)
}

impl Player {
    fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        let far = [0.0, 1e4, 1e6, 3e7][random.below(4)];
        let eye = random.point(-far, far);
        let reach = [1, 1, 1, 2, 3][random.below(5)];
        let budget = [10, 100, 1000, usize::MAX][random.below(4)];
        let options = WorldOptions::new(CELL).reach(reach).budget(budget);
        Self {
            random,
            world: World::new(options).unwrap(),
            solids: Vec::new(),
            kinds: Vec::new(),
            homes: Vec::new(),
            leaving: BTreeSet::new(),
            movers: Vec::new(),
            pages: Vec::new(),
            eye,
            now: 0.0,
            cube: cube(),
            seen: 0,
            hidden: 0,
            shifts: 0,
            lost: Vec::new(),
        }
    }

    /// A description of a new object at a place, with the model's.
    fn object(&mut self, place: DVec3, spread: f64, kind: Kind, home: Option<PageId>) -> ObjectDesc {
        let random = &mut self.random;
        let wall = random.chance(0.4);
        let large = if random.chance(0.1) { 2.0 * SIDE } else { 0.4 * SIDE };
        let mut half = random.point(0.1, if wall { large } else { 1.0 }).as_vec3();
        if wall {
            half[random.below(3)] = 0.4;
        }
        let center = random.point(0.0, spread).as_vec3();
        let own = Aabb::new(center - half, center + half);
        let hides = random.chance(if wall { 0.9 } else { 0.2 });
        let form = random.below(4);
        let scale = 2.0 * half;
        let at = Affine3A::from_scale_rotation_translation(scale, glam::Quat::IDENTITY, center);
        let unit = Aabb::new(Vec3::splat(-0.5), Vec3::splat(0.5));
        let make = |bounds: casca::Bounds| match kind {
            Kind::Fixed => ObjectDesc::fixed(bounds),
            Kind::Reported => ObjectDesc::dynamic(bounds).max_speed(SPEED),
            Kind::OnExpiry => ObjectDesc::dynamic(bounds).max_speed(SPEED).reported_on_expiry(),
        };
        let desc = match form {
            0 if hides => make(unit.into()).occluder(unit).placed(at),
            0 => make(unit.into()).placed(at),
            1 => {
                let instance = Instance::new(self.cube.clone(), at).unwrap();
                let desc = make(instance.clone().into());
                if hides { desc.occluder(instance) } else { desc }
            }
            _ if hides => make(own.into()).occluder(own),
            _ => make(own.into()),
        };
        // Exactly the box that the transform or the corners give.
        let (min, max) = if form < 2 {
            let (c, h) = (center.as_dvec3(), scale.as_dvec3() * 0.5);
            (c - h, c + h)
        } else {
            (own.min.as_dvec3(), own.max.as_dvec3())
        };
        self.solids.push(Solid { place, min, max, hides, mesh: form == 1 });
        self.kinds.push(kind);
        self.homes.push(home);
        if kind != Kind::Fixed {
            self.movers.push(self.solids.len() - 1);
        }
        desc.user_data(self.solids.len() as u64 - 1)
    }

    fn kind(&mut self) -> Kind {
        [Kind::Fixed, Kind::Fixed, Kind::Fixed, Kind::Reported, Kind::OnExpiry][self.random.below(5)]
    }

    /// A page near the eye, or some way off.
    fn page(&mut self) -> PageId {
        let off = if self.random.chance(0.2) { 4.0 } else { 0.8 };
        let at = self.eye + self.random.point(-off, off) * SIDE;
        self.world.page_at(at).unwrap()
    }

    fn change_pages(&mut self) {
        for _ in 0..if self.pages.is_empty() { 8 } else { 2 } {
            let page = self.page();
            if self.pages.len() < 4 || self.random.chance(0.6) {
                let corner = self.world.corner(page);
                let objects: Vec<ObjectDesc> = (0..2 + self.random.below(9))
                    .map(|_| {
                        let kind = self.kind();
                        self.object(corner, SIDE, kind, Some(page))
                    })
                    .collect();
                self.world.load(page, PageObjects::new(objects).unwrap()).unwrap();
                self.pages.push(page);
            } else if !self.pages.is_empty() {
                let page = self.pages[self.random.below(self.pages.len())];
                self.pages.retain(|other| *other != page);
                self.world.drop_page(page).unwrap();
                self.leaving.extend((0..self.homes.len()).filter(|&i| self.homes[i] == Some(page)));
            }
        }
        if self.random.chance(0.3) {
            let at = self.eye + self.random.point(-1.5, 1.5) * SIDE;
            let kind = self.kind();
            let desc = self.object(at, 1.0, kind, None);
            self.world.insert(desc, at).unwrap();
        }
    }

    fn move_eye(&mut self) {
        let far = match self.random.below(20) {
            0 => 100.0 * SIDE,
            1..6 => SIDE,
            _ => 0.1 * SIDE,
        };
        self.eye += self.random.point(-far, far);
    }

    /// Moves what moves. Of what is reported on expiry, those are reported that are due or were in
    /// sight; each moves within its speed.
    fn move_objects(&mut self, ids: &[(usize, ObjectId)], due: &[ObjectId], shown: &[ObjectId]) {
        for &(i, id) in ids {
            if self.kinds[i] == Kind::Fixed {
                continue;
            }
            let step = self.random.point(-1.0, 1.0) * 0.57 * STEP * f64::from(SPEED);
            self.solids[i].place += step;
            let told = self.kinds[i] == Kind::Reported || due.contains(&id) || shown.contains(&id);
            if told {
                self.world.set_place(id, self.solids[i].place).unwrap();
            }
        }
        if let Some(&(i, id)) = ids.get(self.random.below(ids.len().max(1)))
            && self.random.chance(0.2)
        {
            self.world.remove(id).unwrap();
            self.movers.retain(|other| *other != i);
        }
    }

    fn ids(&self) -> Vec<(usize, ObjectId)> {
        self.world.scene().iter().map(|(id, object)| (object.user_data() as usize, id)).collect()
    }

    fn judge(&mut self, what: &str, pvs: &Pvs, ids: &[(usize, ObjectId)], seen: &[bool]) {
        for (&(i, id), &seen) in ids.iter().zip(seen) {
            if seen && !pvs.contains(id) {
                let solid = self.solids[i];
                self.lost.push(format!("{what}: {i} {:?} {solid:?} from {}", self.kinds[i], self.eye));
            }
            self.seen += usize::from(seen);
            self.hidden += usize::from(!pvs.contains(id));
        }
    }

    fn play(mut self, frames: usize) -> Self {
        let point = |options| query_by(Method::Point(options));
        let mut queries = [
            ("point", point(PointOptions::new())),
            ("coherent", point(PointOptions::new().coherent(true))),
            ("frustum", query_by(Method::Frustum)),
            ("cell", query_by(Method::Cell(CellOptions::new()))),
        ];
        let mut kept = KeptQuery::with_options(KeptOptions::new().reach(0.5)).unwrap();
        let mut shown: Vec<ObjectId> = Vec::new();
        for frame in 0..frames {
            self.change_pages();
            self.move_eye();
            self.now += STEP;
            let before = self.ids();
            let report = self.world.begin_frame(self.now, self.eye).unwrap();
            self.shifts += usize::from(report.shifted);
            let ids = self.ids();
            for (i, id) in before {
                let stays = self.leaving.contains(&i) || ids.contains(&(i, id));
                assert!(stays, "frame {frame}: object {i} is gone");
            }
            self.move_objects(&ids, &report.due, &shown);
            let ids = self.ids();
            let solids: Vec<Solid> = ids.iter().map(|&(i, _)| self.solids[i]).collect();
            let seen = seen(&solids, self.eye, &mut self.random);
            let view = self.world.scene().view(self.eye, &around(Vec3::ZERO)).unwrap();
            // The walk through single cells takes longer than all others together.
            let asked = if frame % 5 == 0 { 4 } else { 3 };
            for (name, query) in &mut queries[..asked] {
                let pvs = query.run(self.world.scene(), &view).clone();
                self.judge(&format!("frame {frame}, {name}"), &pvs, &ids, &seen);
            }
            let pvs = kept.run(self.world.scene(), &view).clone();
            self.judge(&format!("frame {frame}, kept"), &pvs, &ids, &seen);
            let ended: Vec<&Pvs> = if frame % 2 == 0 { vec![queries[0].1.pvs()] } else { vec![kept.pvs()] };
            shown = ended.iter().flat_map(|pvs| pvs.iter()).collect();
            self.world.end_frame(ended).unwrap();
        }
        self
    }
}

#[test]
fn nothing_that_is_seen_is_lost_while_pages_come_and_go_and_the_origin_moves() {
    let (mut seen, mut hidden, mut shifts) = (0, 0, 0);
    for seed in 0..u64::from(cases(8).cases) {
        let player = Player::new(seed).play(40);
        assert!(player.lost.is_empty(), "seed {seed}: {:#?}", &player.lost[..player.lost.len().min(5)]);
        (seen, hidden, shifts) = (seen + player.seen, hidden + player.hidden, shifts + player.shifts);
    }
    // It plays with what it is about; on the lattice, more comes out of the faces of walls.
    println!("{seen} seen, {hidden} hidden, {shifts} shifts");
    assert!(seen > 10_000 && hidden > 1200 && shifts > 10, "{seen} seen, {hidden} hidden, {shifts} shifts");
}
