//! Rays of the shaders against `strand_at` of casca-fur, point by point along them.

use crate::strands::{Fur, Skin, hash};
use casca_stage::gpu::Gpu;
use casca_stage::wgpu::BufferUsages;
use glam::{Mat3, Vec3, Vec4};

use crate::gpu::compute::{Given, computed};
use crate::gpu::look::Look;

const SHADERS: &str = concat!(include_str!("strands.wgsl"), include_str!("rays.wgsl"));
const RAYS: &str = "
@group(0) @binding(0) var<uniform> look: Look;
@group(0) @binding(1) var<storage, read> rays: array<array<vec4f, 4>>;
@group(0) @binding(2) var<storage, read_write> found: array<vec4u>;

@compute @workgroup_size(64)
fn follow(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&rays) {
        return;
    }
    let base = rays[id.x][0];
    let ray = rays[id.x][1];
    let side = rays[id.x][2];
    let terms = rays[id.x][3];
    // The skin of a ball of radius 1, by its tangent plane.
    let slope = mat3x3f(look.spacing, 0.0, 0.0, 0.0, look.spacing, 0.0, 0.0, 0.0, look.spacing);
    var path: Path;
    path.skin = Skin(base.xyz, base.xyz, base.xyz, slope);
    path.start = extrusion(look, base.xyz, base.w) / look.spacing;
    path.ray = ray.xyz;
    path.far = ray.w;
    path.side = side.xyz;
    path.curve = length(side.xyz) * look.spacing;
    path.slowing = side.w;
    path.height = base.w;
    path.rise = terms.x;
    path.bulge = terms.y;
    path.long = terms.z;
    let met = strand_along(look, path);
    found[id.x] = vec4u(u32(met.found), met.id, bitcast<u32>(met.way), bitcast<u32>(met.along));
}
";

/// A ray over a ball of radius 1.
struct Ray {
    base: Vec3,
    height: f32,
    way: Vec3,
    /// In cells.
    far: f32,
    long: f32,
}

impl Ray {
    fn random(i: u32, fur: &Fur) -> Self {
        let number = |k: u32| crate::strands::unit(hash([i, k, 7, 0])[0]);
        let point = |k: u32| Vec3::new(number(k), number(k + 1), number(k + 2)) - 0.5;
        let base = point(0).normalize_or(Vec3::Y);
        let long = 0.3 + 0.7 * number(3);
        // Half of them go along the skin.
        let flat = base.cross(point(4)).normalize_or(base.any_orthonormal_vector());
        let steep = if i.is_multiple_of(2) { 0.2 } else { 3.0 };
        let way = (flat + base * (steep * (number(7) - 0.7))).normalize();
        let height = long * number(8);
        let mut ray = Self { base, height, way, far: 4.0 * number(9), long };
        // Down to the skin at most.
        while ray.place(fur, ray.far).1 < 0.0 {
            ray.far *= 0.9;
        }
        ray
    }

    /// The base and the height of a point of the ray, so many cells along it.
    fn place(&self, fur: &Fur, cells: f32) -> (Vec3, f32) {
        let start = fur.extruded(self.base, self.base, self.height);
        let at = start + self.way * (cells * fur.spacing);
        let (mut base, mut height) = (at.normalize(), 0.0);
        for _ in 0..20 {
            let side = fur.extruded(Vec3::ZERO, base, height) - base * (fur.height * height);
            let below = at - side;
            (base, height) = (below.normalize(), (below.length() - 1.0) / fur.height);
        }
        (base, height)
    }

    fn words(&self, fur: &Fur) -> [Vec4; 4] {
        let (n, h, cell) = (self.base, self.height, fur.spacing);
        let up = self.way.dot(n);
        let rise = up / fur.height;
        let level = self.way - n * up;
        let bend = (fur.bend - n * fur.bend.dot(n)) * (2.0 * h * up);
        let wider = 1.0 + fur.height * h * (1.0 - h * fur.bend.dot(n));
        let bulge = level.length_squared() / ((1.0 + fur.height * h) * fur.height);
        [
            n.extend(h),
            self.way.extend(self.far),
            ((level - bend) / wider).extend(up / wider * cell),
            Vec4::new(rise * cell, bulge * cell * cell, self.long, 0.0),
        ]
    }

    /// The first strand that contains a point of the ray, and how many cells away that is.
    fn first(&self, fur: &Fur) -> Option<(u32, f32)> {
        let steps = (self.far / STEP).ceil() as u32;
        (0..=steps).map(|i| (i as f32 * STEP).min(self.far)).find_map(|cells| {
            let (base, height) = self.place(fur, cells);
            let skin = Skin { position: base, normal: base, plane: base, slope: Mat3::IDENTITY };
            fur.strand_at(&skin, height.max(0.0), self.long).map(|strand| (strand.id, cells))
        })
    }
}

/// Between the points that are looked up, in cells.
const STEP: f32 = 0.01;

#[test]
fn rays_meet_the_strand_in_which_their_points_first_lie() {
    let Some(gpu) = Gpu::for_tests() else { return };
    for (bend, density) in [(Vec3::ZERO, 0.15), (Vec3::new(0.4, -0.7, 0.1), 0.5)] {
        let fur = Fur { bend, seed: 4, ..Fur::for_radius(1.0, 0.06, density).unwrap() };
        let rays: Vec<Ray> = (0..1500).map(|i| Ray::random(i, &fur)).collect();
        let flat: Vec<f32> = rays.iter().flat_map(|ray| ray.words(&fur)).flat_map(|v| v.to_array()).collect();
        let record = Look::new(fur).record();
        let given = |binding, usage, bytes| Given { place: (0, binding), usage, bytes };
        let given = [
            given(0, BufferUsages::UNIFORM, bytemuck::bytes_of(&record)),
            given(1, BufferUsages::STORAGE, bytemuck::cast_slice(&flat)),
        ];
        let bytes = computed(&gpu, [SHADERS, RAYS].concat(), &given, ((0, 2), 16 * rays.len()), rays.len());
        let answers: Vec<[u32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
        let (mut met, mut differ, mut far) = (0, 0, 0);
        for (ray, [found, id, way, _]) in rays.iter().zip(answers) {
            let want = ray.first(&fur);
            let way = f32::from_bits(way);
            met += u32::from(want.is_some());
            far += u32::from(want.is_some_and(|(_, way)| way > 0.5));
            let same = match want {
                None => found == 0,
                Some((strand, cells)) => found == 1 && strand == id && (way - cells).abs() < 0.1,
            };
            differ += u32::from(!same);
        }
        println!(
            "density {density}: {met} of {} rays meet strands, {far} after half a cell, {differ} differ",
            rays.len()
        );
        // Where strands touch or end the first point may lie in another one.
        assert!(met > 400 && far > 100 && 25 * differ < rays.len() as u32, "{met} {far} {differ}");
    }
}
