//! Exact visibility in rational arithmetic, which shares no code with the library.
//!
//! The directions to all ends of walls and to all points where two walls cross divide the circle
//! into sectors. Inside of such a sector one wall is the nearest throughout: that on a ray in its
//! middle. So the visible region is a union of triangles, one a sector.

use std::cmp::Ordering;

use glam::Vec2;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

pub type Number = BigRational;

/// A point or a vector.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    pub x: Number,
    pub y: Number,
}

pub fn number(v: f64) -> Number {
    Number::from_float(v).expect("numbers of tests are finite")
}

impl Point {
    pub fn new(x: f64, y: f64) -> Self {
        Self { x: number(x), y: number(y) }
    }

    pub fn of(p: Vec2) -> Self {
        Self::new(p.x.into(), p.y.into())
    }

    fn minus(&self, other: &Self) -> Self {
        Self { x: &self.x - &other.x, y: &self.y - &other.y }
    }

    fn plus(&self, other: &Self) -> Self {
        Self { x: &self.x + &other.x, y: &self.y + &other.y }
    }

    fn times(&self, k: &Number) -> Self {
        Self { x: &self.x * k, y: &self.y * k }
    }

    fn dot(&self, other: &Self) -> Number {
        &self.x * &other.x + &self.y * &other.y
    }

    fn is_zero(&self) -> bool {
        self.x.is_zero() && self.y.is_zero()
    }
}

fn cross(a: &Point, b: &Point) -> Number {
    &a.x * &b.y - &a.y * &b.x
}

fn area(a: &Point, b: &Point, c: &Point) -> Number {
    cross(&b.minus(a), &c.minus(a))
}

/// A shape that blocks or is looked for.
#[derive(Debug, Clone)]
pub enum Form {
    /// A chain of walls without thickness.
    Chain(Vec<Point>),
    /// A solid whose corners run counterclockwise.
    Solid(Vec<Point>),
    /// A disc; it is only looked for.
    Disc(Point, Number),
}

impl Form {
    fn sides(&self) -> Vec<[Point; 2]> {
        match self {
            Self::Chain(points) => points.windows(2).map(|p| [p[0].clone(), p[1].clone()]).collect(),
            Self::Solid(points) => {
                let next = points.iter().cycle().skip(1);
                points.iter().zip(next).map(|(a, b)| [a.clone(), b.clone()]).collect()
            }
            Self::Disc(..) => Vec::new(),
        }
    }
}

/// Where one sees: all round, or between two directions (less than a whole turn apart), and how
/// far.
#[derive(Debug, Clone, Default)]
pub struct Look {
    pub between: Option<[Point; 2]>,
    pub range: Option<Number>,
}

/// A sector of directions and the wall that ends it.
struct Sector {
    from: Point,
    to: Point,
    wall: Option<[Point; 2]>,
}

/// The visible region of an eye.
pub struct Region {
    eye: Point,
    sectors: Vec<Sector>,
    range: Option<Number>,
}

/// The order of directions by angle from +x, counterclockwise.
fn by_angle(a: &Point, b: &Point) -> Ordering {
    let lower = |p: &Point| p.y.is_negative() || p.y.is_zero() && p.x.is_negative();
    lower(a).cmp(&lower(b)).then_with(|| Number::zero().cmp(&cross(a, b)))
}

impl Region {
    pub fn new(eye: &Point, blocking: &[Form], look: &Look) -> Self {
        let surrounds = |form: &Form| {
            matches!(form, Form::Solid(_)) && form.sides().iter().all(|[a, b]| area(a, b, eye).is_positive())
        };
        let blocking: Vec<&Form> = blocking.iter().filter(|form| !surrounds(form)).collect();
        let walls: Vec<[Point; 2]> = blocking.iter().flat_map(|form| form.sides()).collect();
        let units = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)].map(|(x, y)| Point::new(x, y));
        let mut directions: Vec<Point> = units.to_vec();
        directions.extend(look.between.iter().flatten().cloned());
        directions.extend(walls.iter().flatten().map(|p| p.minus(eye)));
        for (i, a) in walls.iter().enumerate() {
            directions.extend(walls[..i].iter().filter_map(|b| crossing(a, b)).map(|p| p.minus(eye)));
        }
        directions.retain(|d| !d.is_zero());
        directions.sort_by(by_angle);
        directions.dedup_by(|a, b| by_angle(a, b).is_eq());
        let next = directions.iter().cycle().skip(1);
        let sectors = directions.iter().zip(next).filter_map(|(from, to)| {
            let middle = from.plus(to);
            let seen = look.between.as_ref().is_none_or(|ends| is_between(&middle, ends));
            let enters = blocking.iter().any(|form| enters(form, eye, &middle));
            let wall = nearest(eye, &middle, &walls);
            (seen && !enters).then(|| Sector { from: from.clone(), to: to.clone(), wall })
        });
        Self { eye: eye.clone(), sectors: sectors.collect(), range: look.range.clone() }
    }

    /// Whether the region, made larger by `more` where it ends at the range, and a disc's radius,
    /// meets a form.
    pub fn meets(&self, form: &Form, more: &Number) -> bool {
        match form {
            Form::Solid(_) if form.sides().iter().all(|[a, b]| !area(a, b, &self.eye).is_negative()) => {
                !self.sectors.is_empty()
            }
            Form::Disc(center, radius) => {
                assert!(self.range.is_none(), "the oracle has no discs at the end of a range");
                let radius = radius * (Number::one() + more);
                self.sectors.iter().any(|sector| self.is_near(sector, center, &radius))
            }
            _ => form.sides().iter().any(|side| self.sectors.iter().any(|s| self.meets_side(s, side, more))),
        }
    }

    /// The half-planes whose common part is a sector, each by a point and the direction that it
    /// lies left of.
    fn half_planes(&self, sector: &Sector) -> Vec<(Point, Point)> {
        let back = Point { x: -&sector.to.x, y: -&sector.to.y };
        let mut all = vec![(self.eye.clone(), sector.from.clone()), (self.eye.clone(), back)];
        if let Some([a, b]) = &sector.wall {
            let (a, b) = if area(a, b, &self.eye).is_positive() { (a, b) } else { (b, a) };
            all.push((a.clone(), b.minus(a)));
        }
        all
    }

    fn meets_side(&self, sector: &Sector, [p, q]: &[Point; 2], more: &Number) -> bool {
        let (mut first, mut last) = (Number::zero(), Number::one());
        for (at, along) in self.half_planes(sector) {
            let (start, end) = (cross(&along, &p.minus(&at)), cross(&along, &q.minus(&at)));
            match (start.is_negative(), end.is_negative()) {
                (true, true) => return false,
                (true, false) => first = first.max(&start / (&start - &end)),
                (false, true) => last = last.min(&start / (&start - &end)),
                (false, false) => {}
            }
        }
        if first > last {
            return false;
        }
        let Some(range) = &self.range else { return true };
        let range = range * (Number::one() + more);
        let u = q.minus(p);
        let ends = [first, last].map(|at| p.plus(&u.times(&at)));
        squared_distance(&self.eye, &ends[0], &ends[1]) <= &range * &range
    }

    fn is_near(&self, sector: &Sector, center: &Point, radius: &Number) -> bool {
        let planes = self.half_planes(sector);
        if planes.iter().all(|(at, along)| !cross(along, &center.minus(at)).is_negative()) {
            return true;
        }
        let squared = radius * radius;
        // Far beyond the disc.
        let reach = center.minus(&self.eye);
        let reach = (reach.x.abs() + reach.y.abs() + radius) * number(2.0);
        let ends = [&sector.from, &sector.to].map(|d| match &sector.wall {
            Some([a, b]) => meet(&self.eye, d, a, b),
            None => self.eye.plus(&d.times(&(&reach / (d.x.abs().max(d.y.abs()))))),
        });
        let mut sides = vec![[&self.eye, &ends[0]], [&self.eye, &ends[1]]];
        if sector.wall.is_some() {
            sides.push([&ends[0], &ends[1]]);
        }
        sides.iter().any(|[a, b]| squared_distance(center, a, b) <= squared)
    }
}

/// Whether a direction lies between two, counterclockwise from the first to the second.
fn is_between(d: &Point, [from, to]: &[Point; 2]) -> bool {
    let (after, before) = (cross(from, d).is_positive(), cross(d, to).is_positive());
    if cross(from, to).is_negative() { after || before } else { after && before }
}

/// Whether a ray from the eye, which is not inside the form, runs into it at once.
fn enters(form: &Form, eye: &Point, along: &Point) -> bool {
    let Form::Solid(_) = form else { return false };
    form.sides().iter().all(|[a, b]| {
        let side = area(a, b, eye);
        side.is_positive() || side.is_zero() && cross(&b.minus(a), along).is_positive()
    })
}

/// The point where two walls cross, if they cross in one point that is an end of neither.
fn crossing([a, b]: &[Point; 2], [p, q]: &[Point; 2]) -> Option<Point> {
    let apart =
        |x: Number, y: Number| x.is_positive() && y.is_negative() || x.is_negative() && y.is_positive();
    let cross = apart(area(a, b, p), area(a, b, q)) && apart(area(p, q, a), area(p, q, b));
    cross.then(|| meet(a, &b.minus(a), p, q))
}

/// The point where the line from `at` along `d` meets the line through `a` and `b`.
fn meet(at: &Point, d: &Point, a: &Point, b: &Point) -> Point {
    let u = b.minus(a);
    at.plus(&d.times(&(cross(&a.minus(at), &u) / cross(d, &u))))
}

/// The wall that a ray meets first. No end of a wall lies on the ray.
fn nearest(eye: &Point, along: &Point, walls: &[[Point; 2]]) -> Option<[Point; 2]> {
    let mut best: Option<(Number, &[Point; 2])> = None;
    for wall in walls {
        let (a, b) = (wall[0].minus(eye), wall[1].minus(eye));
        let (left, right) = (cross(along, &a), cross(along, &b));
        if left.is_zero() || right.is_zero() || left.is_positive() == right.is_positive() {
            continue;
        }
        let u = b.minus(&a);
        let distance = cross(&a, &u) / cross(along, &u);
        if distance.is_positive() && best.as_ref().is_none_or(|(least, _)| distance < *least) {
            best = Some((distance, wall));
        }
    }
    best.map(|(_, wall)| wall.clone())
}

fn squared_distance(p: &Point, a: &Point, b: &Point) -> Number {
    let (u, v) = (b.minus(a), p.minus(a));
    let length = u.dot(&u);
    let at = if length.is_zero() {
        Number::zero()
    } else {
        (v.dot(&u) / length).clamp(Number::zero(), Number::one())
    };
    let off = v.minus(&u.times(&at));
    off.dot(&off)
}
