//! A picture from above: what of a level is drawn for one view, what is hidden, what is out of view.

use std::path::Path;

use casca_scenes::world::{Camera, Mesh, Object, Shape, World};
use casca_tools::pictures::PictureError;
use casca_tools::pictures::palette::{CAMERA, CULLED, DRAWN, GROUND, LIT, OUTSIDE, QUIET, RGBColor, TEXT};
use casca_tools::pictures::raster::Canvas;
use glam::{Affine3A, Vec3};

/// The longer side of the plan in pixels, and the least width of the picture: its words need that.
const SIDES: (f32, usize) = (1100.0, 900);
/// Pixels around the plan.
const MARGIN: usize = 24;
/// Pixels above it, for the words.
const HEAD: usize = 84;
/// The plan is drawn so many times as large, for smooth edges.
const FINE: usize = 2;
/// A sphere is drawn as an icosahedron that was cut so often.
const CUTS: u32 = 2;
/// How much of its colour a surface has that does not face up.
const STEEP: f32 = 0.72;
/// How much of its colour the border of an object has.
const BORDER: f32 = 0.7;
/// What is longer and wider than this share of the level is a ground: it has so much of its colour.
const LARGE: f32 = 0.5;
/// How much of its colour a ground has.
const PALE: f32 = 0.35;
/// How much of the colour of the frustum is mixed into what lies in it.
const TINT: f32 = 0.16;

/// What becomes of an object in a view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fate {
    /// It is found, and drawn.
    Drawn,
    /// It is in the frustum, hidden and left out.
    Hidden,
    /// It is outside of the frustum.
    Outside,
}

impl Fate {
    const ALL: [(Self, RGBColor, &'static str); 3] = [
        (Self::Drawn, DRAWN, "drawn"),
        (Self::Hidden, CULLED, "in the frustum, hidden and left out"),
        (Self::Outside, OUTSIDE, "outside the frustum"),
    ];
}

/// What lies at a point of the plan.
#[derive(Clone, Copy)]
struct Dot {
    height: f32,
    object: usize,
    /// Of its normal, the part that points up or down.
    level: f32,
}

/// The plan of a level.
struct Plan {
    size: [usize; 2],
    /// Of the level, in metres: its least corner.
    from: Vec3,
    /// Pixels a metre.
    scale: f32,
    /// Nothing above this height is drawn.
    cut: f32,
    dots: Vec<Option<Dot>>,
}

impl Plan {
    fn new(world: &World, cut: f32) -> Self {
        let (from, extent) = (world.grid.min, world.grid.max - world.grid.min);
        let scale = SIDES.0 * FINE as f32 / extent.x.max(extent.z).max(f32::MIN_POSITIVE);
        let size =
            [extent.x, extent.z].map(|side| (side * scale / FINE as f32).ceil().max(1.0) as usize * FINE);
        Self { size, from, scale, cut, dots: vec![None; size[0] * size[1]] }
    }

    /// A place in the plan, and its height.
    fn place(&self, p: Vec3) -> Vec3 {
        let p = p - self.from;
        Vec3::new(p.x * self.scale, p.z * self.scale, p.y + self.from.y)
    }

    fn put(&mut self, x: f32, y: f32, dot: Dot) {
        if !(x >= 0.0 && y >= 0.0 && dot.height <= self.cut) {
            return;
        }
        let (x, y) = (x as usize, y as usize);
        if x < self.size[0] && y < self.size[1] {
            let at = &mut self.dots[y * self.size[0] + x];
            if at.is_none_or(|old| old.height < dot.height) {
                *at = Some(dot);
            }
        }
    }

    fn triangle(&mut self, object: usize, corners: [Vec3; 3]) {
        let [a, b, c] = corners.map(|p| self.place(p));
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let level = normal.normalize_or_zero().y.abs();
        let area = (b - a).truncate().perp_dot((c - a).truncate());
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let last = [0, 1].map(|i| high[i].min(self.size[i] as f32));
        let mut y = low.y.max(0.0).floor() + 0.5;
        while y < last[1] {
            let mut x = low.x.max(0.0).floor() + 0.5;
            while x < last[0] {
                let p = glam::Vec2::new(x, y);
                let share =
                    |from: Vec3, to: Vec3| (to - from).truncate().perp_dot(p - from.truncate()) / area;
                let (u, v) = (share(c, a), share(a, b));
                if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
                    let height = a.z + u * (b.z - a.z) + v * (c.z - a.z);
                    self.put(x, y, Dot { height, object, level });
                }
                x += 1.0;
            }
            y += 1.0;
        }
        // Walls have no area from above: their upper edges are drawn, or where they are cut.
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let steps = (to - from).truncate().length().min(2.0 * SIDES.0 * FINE as f32).ceil() as usize;
            for i in 0..=steps {
                let p = from.lerp(to, i as f32 / steps.max(1) as f32);
                let height = if low.z < self.cut { p.z.min(self.cut) } else { p.z };
                self.put(p.x, p.y, Dot { height, object, level });
            }
        }
    }

    fn object(&mut self, number: usize, object: &Object) {
        let (mesh, transform) = match &object.shape {
            Shape::Mesh { mesh, transform } => (mesh.clone(), *transform),
            Shape::Box { min, max } => (Mesh::cuboid(*min, *max).into(), Affine3A::IDENTITY),
            Shape::Sphere { center, radius } => {
                let place = Affine3A::from_scale_rotation_translation(
                    Vec3::splat(*radius),
                    glam::Quat::IDENTITY,
                    *center,
                );
                (Mesh::ball(CUTS).into(), place)
            }
        };
        let place = |v: u32| mesh.positions.get(v as usize).map(|&p| transform.transform_point3(p));
        for [a, b, c] in &mesh.triangles {
            if let (Some(a), Some(b), Some(c)) = (place(*a), place(*b), place(*c)) {
                self.triangle(number, [a, b, c]);
            }
        }
    }

    /// The colour of a pixel of the picture: the mean of its dots.
    fn colour(&self, (x, y): (usize, usize), colours: &[Vec3], lit: bool) -> RGBColor {
        let mut sum = Vec3::ZERO;
        for (i, j) in (0..FINE * FINE).map(|i| (x * FINE + i % FINE, y * FINE + i / FINE)) {
            let at = |i: usize, j: usize| {
                self.dots[j.min(self.size[1] - 1) * self.size[0] + i.min(self.size[0] - 1)]
            };
            let own = at(i, j);
            let colour = |dot: Dot| {
                let same = |other: Option<Dot>| other.is_some_and(|o| o.object == dot.object);
                let border = if same(at(i + 1, j)) && same(at(i, j + 1)) { 1.0 } else { BORDER };
                colours[dot.object] * border * (STEEP + (1.0 - STEEP) * dot.level)
            };
            sum += own.map_or(rgb(GROUND), colour);
        }
        let mean = sum / (FINE * FINE) as f32;
        let [r, g, b] = mean.lerp(rgb(LIT), if lit { TINT } else { 0.0 }).to_array().map(|c| c.round() as u8);
        RGBColor(r, g, b)
    }
}

fn rgb(RGBColor(r, g, b): RGBColor) -> Vec3 {
    Vec3::new(r.into(), g.into(), b.into())
}

/// Draws one view. `eyes` are those of all views; without `ceilings` nothing higher than the eye is
/// drawn.
///
/// # Errors
/// The file cannot be written.
pub fn draw(
    path: &Path,
    world: &World,
    camera: &Camera,
    (fates, eyes, ceilings): (&[Fate], &[Vec3], bool),
) -> Result<(), PictureError> {
    let colour = |(object, fate): (&Object, &Fate)| {
        let own = rgb(Fate::ALL.iter().find(|known| known.0 == *fate).map_or(GROUND, |known| known.1));
        let (min, max) = object.shape.bounds();
        let large = (max - min) / (world.grid.max - world.grid.min);
        if large.x.min(large.z) > LARGE { rgb(GROUND).lerp(own, PALE) } else { own }
    };
    let colours: Vec<Vec3> = world.objects.iter().zip(fates).map(colour).collect();
    let mut plan = Plan::new(world, if ceilings { f32::INFINITY } else { camera.eye.y });
    world.objects.iter().enumerate().for_each(|(i, object)| plan.object(i, object));
    let [width, height] = plan.size.map(|side| side / FINE);
    let left = MARGIN.max(SIDES.1.saturating_sub(width) / 2);
    let mut canvas = Canvas::new(width + 2 * left, HEAD + height + MARGIN, RGBColor(255, 255, 255));
    let matrix = camera.view_projection();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let way = Vec3::new(x as f32, 0.0, y as f32) * FINE as f32 / plan.scale;
        let clip = matrix * (plan.from + way).with_y(camera.eye.y).extend(1.0);
        let lit = clip.w > 0.0 && clip.x.abs() <= clip.w;
        canvas.set(left + x, HEAD + y, plan.colour((x, y), &colours, lit));
    }
    let mut mark = |eye: Vec3, radius: f32, colour: RGBColor| {
        let place = plan.place(eye) / FINE as f32;
        canvas.disc((place.x + left as f32, place.y + HEAD as f32), radius, colour);
    };
    eyes.iter().for_each(|eye| mark(*eye, 2.0, QUIET));
    mark(camera.eye, 8.5, RGBColor(255, 255, 255));
    mark(camera.eye, 6.5, CAMERA);
    let count = |fate: Fate| fates.iter().filter(|f| **f == fate).count();
    let (drawn, hidden) = (count(Fate::Drawn), count(Fate::Hidden));
    let title = format!(
        "{}: of {} objects in the frustum, {hidden} are hidden and left out",
        world.name,
        drawn + hidden
    );
    canvas.text((MARGIN as f32, 24.0), 25.0, TEXT, &title);
    let mut x = MARGIN as f32 + 8.0;
    for (fate, colour, label) in Fate::ALL {
        canvas.disc((x, 60.0), 7.0, colour);
        x = canvas.text((x + 14.0, 60.0), 18.0, TEXT, &format!("{label}: {}", count(fate))) + 34.0;
    }
    canvas.disc((x, 60.0), 6.5, CAMERA);
    let cut = if ceilings { "" } else { ", cut at its height" };
    canvas.text((x + 14.0, 60.0), 18.0, TEXT, &format!("the eye{cut}"));
    canvas.save(path)
}
