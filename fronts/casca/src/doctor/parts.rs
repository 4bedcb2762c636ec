//! What of a level hides, what does not, and why. The reader decides that; here its decisions are
//! told in the words of the file.

use std::collections::{BTreeMap, BTreeSet};

use casca_scenes::import::parts::OPAQUE;
use casca_scenes::world::{Motion, Object, Shape, Sides, World, turn_of};
use serde_json::Value;

/// What has one reason in common.
#[derive(Debug, Clone, Default)]
pub struct Part {
    /// Objects with such surfaces; one may be in several parts.
    pub objects: usize,
    /// Triangles of all these objects.
    pub triangles: usize,
    /// Their area in square metres.
    pub area: f64,
    /// Materials of those that hide nothing.
    materials: BTreeSet<String>,
}

impl Part {
    /// Names of materials, as far as they fit.
    pub fn names(&self) -> String {
        const FIT: usize = 3;
        let names = self.materials.iter().take(FIT).map(String::as_str).collect::<Vec<_>>().join(", ");
        match self.materials.len() {
            0 => String::new(),
            n if n > FIT => format!(" ({names} and {} more)", n - FIT),
            _ => format!(" ({names})"),
        }
    }
}

/// The surfaces of a level.
#[derive(Debug, Default)]
pub struct Parts {
    /// All of them.
    pub all: Part,
    /// Those that hide, by the sides from which they do.
    pub hide: Vec<(&'static str, Part)>,
    /// Those that hide nothing by the reason, the largest first.
    pub clear: Vec<(String, Part)>,
    /// Objects that move.
    pub moving: usize,
}

impl Parts {
    /// Of a world as it is now.
    pub fn of(world: &World) -> Self {
        let file = File(document(world));
        let (mut all, mut hide) = (Part::default(), BTreeMap::<&str, Part>::new());
        let mut clear = BTreeMap::<String, Part>::new();
        for (i, object) in world.objects.iter().enumerate() {
            let part = world.source.parts.get(i);
            let (node, primitives) = part.map_or((None, &[][..]), |p| (Some(p.node), &*p.primitives));
            // By primitive, and by the sides: what is in it of this object.
            let mut own = BTreeMap::<_, (Sides, usize, f64)>::new();
            for (t, sides, area) in surfaces(object) {
                let sum = own.entry((primitives.get(t).copied(), sides as u8)).or_insert((sides, 0, 0.0));
                *sum = (sides, sum.1 + usize::from(t != SOLID), sum.2 + area);
            }
            all.objects += 1;
            let mut met = BTreeSet::new();
            for ((primitive, _), (sides, triangles, area)) in own {
                all.triangles += triangles;
                all.area += area;
                let primitive = file.primitive(node, primitive);
                let (key, part) = match sides {
                    Sides::Both => ("from both sides".to_owned(), hide.entry("from both sides").or_default()),
                    Sides::Front => {
                        let key = "from the front, which alone is drawn";
                        (key.to_owned(), hide.entry(key).or_default())
                    }
                    Sides::Neither => {
                        let why = file.why(object, node, primitive);
                        (why.clone(), clear.entry(why).or_default())
                    }
                };
                part.objects += usize::from(met.insert(key));
                part.triangles += triangles;
                part.area += area;
                if sides == Sides::Neither {
                    part.materials.extend(file.material(primitive));
                }
            }
        }
        let (mut hide, mut clear): (Vec<_>, Vec<_>) =
            (hide.into_iter().collect(), clear.into_iter().collect());
        hide.sort_by(|a, b| b.1.area.total_cmp(&a.1.area));
        clear.sort_by(|a, b| b.1.area.total_cmp(&a.1.area).then_with(|| a.0.cmp(&b.0)));
        let moving = world.objects.iter().filter(|o| o.motion != Motion::Static).count();
        Self { all, hide, clear, moving }
    }

    /// The share of all surfaces that hides.
    pub fn share(&self) -> f64 {
        self.hide.iter().fold(0.0, |sum, (_, part)| sum + part.area) / self.all.area.max(f64::MIN_POSITIVE)
    }
}

/// Stands for the number of a triangle where a solid has none.
const SOLID: usize = usize::MAX;

/// The surfaces of an object: the number of a triangle, from where it hides, its area.
fn surfaces(object: &Object) -> Vec<(usize, Sides, f64)> {
    let solid = |area: f32| {
        vec![(SOLID, if object.occludes { Sides::Both } else { Sides::Neither }, f64::from(area))]
    };
    match &object.shape {
        Shape::Sphere { radius, .. } => solid(4.0 * std::f32::consts::PI * radius * radius),
        Shape::Box { min, max } => {
            let d = *max - *min;
            solid(2.0 * (d.x * d.y + d.y * d.z + d.z * d.x))
        }
        Shape::Mesh { mesh, transform } => {
            let place =
                |v: u32| mesh.positions.get(v as usize).map(|p| transform.transform_point3(*p).as_dvec3());
            let surface = |(t, [a, b, c]): (usize, &[u32; 3])| {
                let (a, b, c) = (place(*a)?, place(*b)?, place(*c)?);
                let sides = if object.occludes { mesh.sides_of(t) } else { Sides::Neither };
                Some((t, sides, (b - a).cross(c - a).length() / 2.0))
            };
            mesh.triangles.iter().enumerate().filter_map(surface).collect()
        }
    }
}

/// The JSON of the file that a world comes from; null if it comes from none.
pub fn document(world: &World) -> Value {
    let json = &*world.source.document;
    serde_json::from_slice(json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json)).unwrap_or_default()
}

/// The JSON of a file.
struct File(Value);

impl File {
    fn primitive(&self, node: Option<usize>, primitive: Option<u32>) -> &Value {
        let mesh = node.and_then(|node| self.0["nodes"][node]["mesh"].as_u64());
        match (mesh, primitive) {
            (Some(mesh), Some(primitive)) => {
                &self.0["meshes"][mesh as usize]["primitives"][primitive as usize]
            }
            _ => &Value::Null,
        }
    }

    fn material(&self, primitive: &Value) -> Option<String> {
        let index = primitive["material"].as_u64()?;
        let name = self.0["materials"][index as usize]["name"].as_str();
        Some(name.map_or_else(|| format!("material {index}"), str::to_owned))
    }

    /// Why surfaces hide nothing, of which the reader says so, and what to do.
    fn why(&self, object: &Object, node: Option<usize>, primitive: &Value) -> String {
        let (node, material) = match (node, primitive["material"].as_u64()) {
            (Some(node), Some(i)) => (&self.0["nodes"][node], &self.0["materials"][i as usize]),
            (Some(node), None) => (&self.0["nodes"][node], &Value::Null),
            (None, _) => return "the scene says that it hides nothing".to_owned(),
        };
        let mirrors =
            |o: &Object| matches!(&o.shape, Shape::Mesh { transform, .. } if turn_of(transform) <= 0.0);
        let extension = || {
            let names = material["extensions"].as_object()?.keys();
            names.map(String::as_str).find(|name| !OPAQUE.contains(name))
        };
        let alpha = material["alphaMode"].as_str().filter(|mode| *mode != "OPAQUE");
        if primitive.is_null() && node["extensions"]["MSFT_lod"].is_null() {
            return "a skin or morph targets: it counts as the box of all its poses".to_owned();
        }
        if primitive["mode"].as_u64().is_some_and(|mode| mode < 4) {
            return "points or lines have no area".to_owned();
        }
        match (alpha, extension()) {
            (Some("MASK"), _) => "alphaMode MASK: give what has no holes an OPAQUE material".to_owned(),
            (Some(mode), _) => format!("alphaMode {mode}: set OPAQUE where nothing shines through"),
            _ if node["extras"]["role"] == "occludee" => "extras.role is \"occludee\"".to_owned(),
            _ if !node["extensions"]["MSFT_lod"].is_null() => {
                "MSFT_lod: it may be drawn in another form".to_owned()
            }
            _ if !primitive["extensions"]["KHR_materials_variants"].is_null() => {
                "KHR_materials_variants: not all of its materials are opaque".to_owned()
            }
            (None, Some(name)) => format!("{name}: light may pass"),
            _ if object.occludes => "an animation changes the material".to_owned(),
            _ if mirrors(object) => {
                "an instance that mirrors or flattens: make its material double sided".to_owned()
            }
            _ => "an animation shows and hides it".to_owned(),
        }
    }
}
