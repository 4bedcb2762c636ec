//! Components that come and go at random in each frame, beside exact visibility of what Bevy draws.

mod common;

use bevy_math::DVec3;
use casca_scenes::random::Dice;
use common::*;

const SUN: u32 = 1_000_001;
const LAMP: u32 = 1_000_002;
/// Entities without a mesh, which others have as their parents.
const PARENTS: [u32; 3] = [2_000_000, 2_000_001, 2_000_002];
const BOXES: u32 = 60;
/// The first of them are large.
const WALLS: u32 = 12;
/// Room for what rays do not tell: targets are smaller by this, what hides is larger.
const DOUBT: f64 = 1e-3;
const NEAR: f64 = 0.1;
/// Farther away than anything is.
const FAR: f64 = 200.0;

/// A number below another.
fn below(dice: &mut Dice, n: u32) -> u32 {
    (dice.range(0.0, n as f32) as u32).min(n - 1)
}

/// A number up to `most` on both sides of 0: half of all on a small lattice.
fn number(dice: &mut Dice, most: f32) -> f32 {
    match dice.chance(0.5) {
        true => ((below(dice, 9) as f32 - 4.0) * most / 4.0).round(),
        false => dice.range(-most, most),
    }
}

fn point(dice: &mut Dice, most: f32) -> Vec3 {
    Vec3::new(number(dice, most), number(dice, most), number(dice, most))
}

fn place(dice: &mut Dice, nr: u32) -> Transform {
    let (wide, thin) = (14.0, 1.0);
    let sizes = [[wide, 10.0, thin], [thin, 10.0, wide], [wide, thin, wide]];
    let size = match nr < WALLS {
        true => sizes[nr as usize % 3].into(),
        false => Vec3::splat([0.5, 1.0, 2.0][below(dice, 3) as usize]),
    };
    Transform::from_translation(point(dice, 16.0)).with_scale(size)
}

/// What the boxes may be made of.
#[derive(Resource, Clone)]
struct Stock {
    meshes: Vec<Handle<Mesh>>,
    paints: Vec<Handle<Paint>>,
    /// Of the fourth paint, and the frame in which it came, if it is there.
    picture: (Handle<Image>, Option<u32>),
}

/// What a frame changes right before Bevy looks at what is visible, and how often.
#[derive(Resource)]
struct Late(Dice, u32);

fn picture(usage: RenderAssetUsages) -> Image {
    Image { asset_usage: usage, ..Default::default() }
}

fn world_of_boxes(seed: u64) -> App {
    let mut app = painted();
    app.world_mut().register_disabling_component::<Asleep>();
    app.add_systems(
        PostUpdate,
        late.after(VisibilitySystems::CalculateBounds)
            .after(VisibilitySystems::VisibilityPropagate)
            .before(VisibilitySystems::CheckVisibility),
    );
    let world = app.world_mut();
    world.resource_mut::<CascaSettings>().still_after = 1;
    let mut aside = Mesh::from(Cuboid::new(1.0, 1.0, 1.0));
    aside.asset_usage = RenderAssetUsages::MAIN_WORLD;
    let aside = world.resource_mut::<Assets<Mesh>>().add(aside);
    let mut images = world.resource_mut::<Assets<Image>>();
    let never = images.reserve_handle();
    let unseen = images.add(picture(RenderAssetUsages::MAIN_WORLD));
    let there = images.reserve_handle();
    let glass = Paint { alpha_mode: "blend", ..Paint::default() };
    let in_front = Paint { depth_bias: 1.0, ..Paint::default() };
    let pictured = [there.clone(), never, unseen];
    let pictured = pictured.map(|it| Paint { base_color_texture: Some(it), ..Paint::default() });
    let mut paints = world.resource_mut::<Assets<Paint>>();
    let all = [Paint::default(), glass, in_front].into_iter().chain(pictured);
    let paints = all.map(|paint| paints.add(paint)).collect();
    let stock = Stock {
        meshes: vec![world.resource::<Cube>().0.clone(), aside, Handle::default()],
        paints,
        picture: (there, None),
    };
    let mut dice = Dice::new(seed, 0);
    for nr in 0..BOXES {
        let place = place(&mut dice, nr);
        let entity = spawn_box(world, nr, place.translation, place.scale);
        world.entity_mut(entity).insert(MeshMaterial3d(stock.paints[0].clone()));
    }
    for nr in PARENTS {
        world.spawn((Nr(nr), Transform::default(), Visibility::default()));
    }
    spawn_camera(world, CAMERA, Transform::from_xyz(0.0, 0.0, 20.0));
    let down = Transform::default().looking_to(Vec3::new(0.2, -1.0, -0.6), Vec3::Y);
    world.spawn((Nr(SUN), DirectionalLight { shadow_maps_enabled: true, ..Default::default() }, down));
    let lamp = PointLight { shadow_maps_enabled: true, range: 60.0, ..Default::default() };
    world.spawn((Nr(LAMP), lamp, Transform::from_xyz(0.0, 3.0, 0.0)));
    world.insert_resource(stock);
    world.insert_resource(Late(Dice::new(seed, 1), 0));
    settle(&mut app);
    app
}

fn late(world: &mut World) {
    world.resource_scope(|world, mut late: Mut<Late>| {
        for _ in 0..late.1 {
            change(world, &mut late.0, 0);
        }
    });
}

/// Inserts or removes a component.
fn put<C: Component>(entity: &mut EntityWorldMut, component: Option<C>) {
    match component {
        Some(component) => _ = entity.insert(component),
        None => _ = entity.remove::<C>(),
    }
}

/// Takes away a component of a box, gives it one, or moves it.
fn change(world: &mut World, dice: &mut Dice, frame: u32) {
    let stock = world.resource::<Stock>().clone();
    let nr = below(dice, BOXES);
    let parent = find(world, PARENTS[below(dice, 3) as usize]).unwrap();
    let Some(id) = find(world, nr) else { return };
    let mut thing = world.entity_mut(id);
    let (coin, three) = (below(dice, 2) == 0, below(dice, 3) as usize);
    match below(dice, 27) {
        0 => put(&mut thing, [None, Some(Visibility::Hidden), Some(Visibility::Visible)][three]),
        1 => {
            let states = [None, Some(InheritedVisibility::HIDDEN), Some(InheritedVisibility::VISIBLE)];
            put(&mut thing, states[three]);
        }
        2 => put(&mut thing, coin.then(ViewVisibility::default)),
        3 => {
            let mesh = TypeId::of::<Mesh3d>();
            let classes = [vec![], vec![mesh], vec![mesh, TypeId::of::<Nr>()]][three].clone();
            put(&mut thing, (below(dice, 4) > 0).then(|| VisibilityClass(classes.into_iter().collect())));
        }
        4 => put(&mut thing, coin.then_some(Disabled)),
        5 => put(&mut thing, coin.then_some(Asleep)),
        6 => put(&mut thing, coin.then(|| Mesh3d(stock.meshes[three].clone()))),
        7 => put(&mut thing, coin.then(|| MeshMaterial3d(stock.paints[0].clone()))),
        8 | 9 => put(&mut thing, Some(MeshMaterial3d(stock.paints[below(dice, 6) as usize].clone()))),
        10 => {
            let sets: [&[usize]; 3] = [&[0], &[1], &[0, 40]];
            put(&mut thing, (below(dice, 4) > 0).then(|| RenderLayers::from_layers(sets[three])));
        }
        11 => put::<Aabb>(&mut thing, None),
        12 => put(&mut thing, coin.then_some(NoFrustumCulling)),
        13 => put(&mut thing, Some(place(dice, nr))),
        14 => put(&mut thing, coin.then(|| GlobalTransform::from(place(dice, nr)))),
        15 => put(&mut thing, coin.then_some(NotShadowCaster)),
        16 => put(&mut thing, coin.then_some(ChildOf(parent))),
        17 => put(&mut thing, [None, Some(Opaque::Front), Some(Opaque::Front)][three]),
        18 => put(&mut thing, coin.then_some(NotOccluder)),
        19 => put(&mut thing, coin.then(|| Occluder(stock.meshes[0].clone()))),
        20 => put(&mut thing, (three == 0).then_some(NoOcclusionCulling)),
        21 => put(&mut thing, (three == 0).then_some(NoCpuCulling)),
        22 => mend(world, id, nr, dice),
        23 => *world.get_mut(parent).unwrap() = [Visibility::Hidden, Visibility::Inherited][coin as usize],
        24 => world.get_mut::<Transform>(parent).unwrap().translation = point(dice, 2.0),
        _ if frame > 0 => change_assets(world, &stock, dice, frame),
        _ => {}
    }
}

/// A new box in the place of one, with all that it needs.
fn mend(world: &mut World, id: Entity, nr: u32, dice: &mut Dice) {
    let paint = MeshMaterial3d(world.resource::<Stock>().paints[0].clone());
    let place = place(dice, nr);
    if nr.is_multiple_of(3) {
        world.despawn(id);
    } else {
        world.entity_mut(id).remove::<Nr>().insert(Visibility::Hidden);
    }
    let entity = spawn_box(world, nr, place.translation, place.scale);
    world.entity_mut(entity).insert(paint);
}

/// Materials and pictures change where Bevy can tell the renderer in the same frame.
fn change_assets(world: &mut World, stock: &Stock, dice: &mut Dice, frame: u32) {
    if below(dice, 2) == 0 {
        let mut paints = world.resource_mut::<Assets<Paint>>();
        let mut paint = paints.get_mut(&stock.paints[3]).unwrap();
        paint.alpha_mode = ["blend", "opaque"][below(dice, 2) as usize];
        return;
    }
    // A renderer that has the image goes on drawing with it.
    let (image, None) = stock.picture.clone() else { return };
    let picture = picture(RenderAssetUsages::default());
    world.resource_mut::<Assets<Image>>().insert(&image, picture).unwrap();
    world.resource_mut::<Stock>().picture.1 = Some(frame);
}

/// A box that Bevy draws.
struct Drawn {
    entity: Entity,
    middle: DVec3,
    half: DVec3,
    glass: bool,
    in_front: bool,
    /// An [`Occluder`] hides from both sides, also from an eye in it.
    both: bool,
    for_camera: bool,
    for_light: bool,
}

impl Drawn {
    /// Where a ray is in the box, which is made larger on all sides by so much.
    fn span(&self, from: DVec3, along: DVec3, larger: f64) -> Option<(f64, f64)> {
        let (from, half) = (from - self.middle, self.half + larger);
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            let (a, b) = ((-half[axis] - from[axis]) / along[axis], (half[axis] - from[axis]) / along[axis]);
            (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
        }
        (half.min_element() > 0.0 && enter < leave).then_some((enter, leave))
    }
}

/// All boxes that a renderer draws, by the components of Bevy's own queries.
fn drawn(world: &mut World, frame: u32) -> Vec<Drawn> {
    let stock = world.resource::<Stock>().clone();
    let paints = world.resource::<Assets<Paint>>();
    let paints: Vec<_> = stock.paints.iter().map(|paint| paints.get(paint).unwrap().clone()).collect();
    let all = world.iter_entities().filter(|one| !one.contains::<Disabled>() && !one.contains::<Asleep>());
    let drawn = all.filter(|one| one.contains::<ViewVisibility>()).filter_map(|one| {
        let (mesh, at) = (one.get::<Mesh3d>()?, one.get::<GlobalTransform>()?);
        let (painted, inherited) = (one.get::<MeshMaterial3d<Paint>>()?, one.get::<InheritedVisibility>()?);
        let [no_shadow, no_list] = [one.contains::<NotShadowCaster>(), one.contains::<NoCpuCulling>()];
        let is_occluder = one.contains::<Occluder>();
        let paint = stock.paints.iter().position(|paint| *paint == painted.0).unwrap();
        let ready = match paint {
            3 => stock.picture.1.is_some_and(|since| since < frame),
            paint => paint < 3,
        };
        let by_default = RenderLayers::default();
        let on_layer = one.get::<RenderLayers>().is_none_or(|layers| layers.intersects(&by_default));
        if mesh.0 != stock.meshes[0] || !inherited.get() || !ready || !on_layer {
            return None;
        }
        // None of them is turned.
        let place: Affine3A = at.affine();
        let classes = one.get::<VisibilityClass>();
        let is_mesh = classes.is_some_and(|classes| classes.contains(&TypeId::of::<Mesh3d>()));
        // Who says so is believed.
        let glass = paints[paint].alpha_mode != "opaque" && !one.contains::<Opaque>() && !is_occluder;
        let in_front = paints[paint].depth_bias != 0.0;
        Some(Drawn {
            entity: one.id(),
            middle: place.translation.as_dvec3(),
            half: (place.matrix3 * Vec3::splat(0.5)).as_dvec3(),
            both: is_occluder,
            for_camera: is_mesh && !no_list,
            for_light: !glass && !in_front && !no_shadow && !no_list,
            glass,
            in_front,
        })
    });
    drawn.collect()
}

/// Follows a ray, and asserts that all that it shows is in a list. What is nearer than the first of
/// `ends` is cut off; what lies between the second and the third is asked for. Returns how much is
/// left out.
fn follow(
    boxes: &[&Drawn],
    (from, along): (DVec3, DVec3),
    ends: [f64; 3],
    list: &BTreeSet<Entity>,
    what: &str,
) -> usize {
    // Back faces are culled: one sees through what the eye is in.
    let enters = |one: &Drawn| one.span(from, along, -DOUBT).map(|(enter, _)| enter);
    let is_cut = |one: &Drawn| !one.both && enters(one).is_some_and(|enter| enter < ends[0] - DOUBT);
    let mut stops: Vec<(Entity, f64)> = Vec::new();
    for one in boxes.iter().filter(|one| !one.glass && !one.in_front && !is_cut(one)) {
        let span = one.span(from, along, DOUBT).filter(|(_, leave)| *leave > 0.0);
        stops.extend(span.map(|(enter, _)| (one.entity, enter)));
    }
    let mut hidden = 0;
    for one in boxes {
        let asked = |enter: f64| enter > ends[1] + DOUBT && enter < ends[2];
        let span = one.span(from, along, -DOUBT).filter(|(enter, _)| asked(*enter));
        let Some((enter, _)) = span else { continue };
        let is_free = stops.iter().all(|(other, stop)| *other == one.entity || *stop > enter);
        let listed = list.contains(&one.entity);
        assert!(listed || !(one.in_front || is_free), "{what}: {} is lost, at {enter}", one.entity);
        hidden += usize::from(!listed);
    }
    hidden
}

/// Looks at all views of a frame. Returns how many boxes behind others were left out by rays.
fn look(app: &mut App, dice: &mut Dice, frame: u32, what: &str) -> [usize; 3] {
    let world = app.world_mut();
    let all = drawn(world, frame);
    let for_camera: Vec<&Drawn> = all.iter().filter(|one| one.for_camera).collect();
    let for_light: Vec<&Drawn> = all.iter().filter(|one| one.for_light).collect();
    let [camera, sun, lamp] = [CAMERA, SUN, LAMP].map(|nr| entity(world, nr));
    let place = |entity| world.get::<GlobalTransform>(entity).unwrap().affine();
    let eye = place(camera);
    let lists = world.get::<VisibleEntities>(camera).unwrap();
    let seen = lists.get(TypeId::of::<Mesh3d>()).iter().copied().collect();
    let is_lit = lists.get(TypeId::of::<ClusterVisibilityClass>()).contains(&lamp);
    let from = eye.translation.as_dvec3();
    let shone = world.get::<CubemapVisibleEntities>(lamp).unwrap();
    let shone: BTreeSet<_> = shone.iter().flat_map(|list| &list.entities).copied().collect();
    let bulb = place(lamp).translation.as_dvec3();
    let lit = world.get::<CascadesVisibleEntities>(sun).unwrap();
    let lit: BTreeSet<_> = lit.entities.values().flatten().flat_map(|list| &list.entities).copied().collect();
    let down = -place(sun).matrix3.z_axis.as_dvec3();
    let mut hidden = [0; 3];
    for _ in 0..250 {
        // Within the view, which is 45 degrees high.
        let mut side = |most: f32| dice.range(-most, most);
        let ray = Vec3::new(side(0.7), side(0.4), -1.0);
        let along = eye.transform_vector3(ray).as_dvec3().normalize();
        // As deep as the near plane, along this ray.
        let near = NEAR * f64::from(ray.length());
        hidden[0] += follow(&for_camera, (from, along), [near, near, FAR], &seen, &format!("{what}, camera"));
        let out = DVec3::from_array([side(1.0), side(1.0), side(1.0)].map(f64::from));
        if is_lit && out.length() > 0.1 {
            // The near plane of a face of a cube lies deepest in its corners.
            let ray = (bulb, out.normalize());
            hidden[1] += follow(&for_light, ray, [NEAR, 2.0 * NEAR, FAR], &shone, &format!("{what}, lamp"));
        }
        let point = from + along * f64::from(side(10.0).abs() + 1.0);
        // What lies behind this point need not be in a cascade.
        let ray = (point - down * FAR, down);
        hidden[2] += follow(&for_light, ray, [0.0, 0.0, FAR], &lit, &format!("{what}, sun"));
    }
    hidden
}

#[test]
fn what_bevy_does_not_draw_never_hides() {
    let mut hidden = [0; 3];
    for seed in 0..6 {
        let mut app = world_of_boxes(seed);
        let mut dice = Dice::new(seed, 2);
        for frame in 1..250 {
            let world = app.world_mut();
            // Some frames change much, some nothing.
            let count = [0, 1, 2, 6][below(&mut dice, 4) as usize];
            for _ in 0..count {
                change(world, &mut dice, frame);
            }
            world.resource_mut::<Late>().1 = below(&mut dice, 3);
            if frame % 5 == 0 {
                let at = Transform::from_translation(point(&mut dice, 18.0));
                let camera = entity(world, CAMERA);
                *world.get_mut::<Transform>(camera).unwrap() = at.looking_at(point(&mut dice, 3.0), Vec3::Y);
                let lamp = entity(world, LAMP);
                world.get_mut::<Transform>(lamp).unwrap().translation = point(&mut dice, 8.0);
                // Walls wear out.
                for nr in [below(&mut dice, WALLS), below(&mut dice, WALLS), below(&mut dice, BOXES)] {
                    find(world, nr).into_iter().for_each(|id| mend(world, id, nr, &mut dice));
                }
            }
            app.update();
            let found = look(&mut app, &mut dice, frame, &format!("seed {seed}, frame {frame}"));
            hidden = std::array::from_fn(|i| hidden[i] + found[i]);
        }
    }
    println!("left out by rays of camera, lamp and sun: {hidden:?}");
    assert!(hidden.iter().all(|hidden| *hidden > 300), "it hides little: {hidden:?}");
}
