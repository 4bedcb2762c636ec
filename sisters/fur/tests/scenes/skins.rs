//! Meshes with skins.

use casca_fur::skin::Pose;

use casca_fur::scenes::import::{Coated, Rig, read_coated};
use casca_scenes::import::{Trouble, read};
use casca_scenes::world::{FRAME_SECONDS, Motion, Shape};
use glam::Vec3;

use crate::parts::{F32, Parts, bytes_of, glb};

/// What stands where in [`arm`].
struct Arm {
    parts: Parts,
    joints: usize,
    weights: usize,
    inverse: usize,
}

/// An arm along x with four vertices at x = 0, 1, 2 and 3: the elbow at 1 turns by a right angle
/// around z in a second.
fn arm(component: u32, joints: &[u8], weights: (u32, &[u8])) -> Arm {
    let mut parts = Parts::default();
    parts.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 3.0, 1.0, 0.0]);
    let joints = parts.dense(component, "VEC4", joints, "");
    let normalized = if weights.0 == F32 { "" } else { r#","normalized":true"# };
    let weights = parts.dense(weights.0, "VEC4", weights.1, normalized);
    let indices = parts.dense(5121, "SCALAR", &[0, 1, 2, 1, 2, 3], "");
    assert_eq!(indices, 3);
    let matrix = |x: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, 0.0, 0.0, 1.0];
    let bytes = bytes_of(&[matrix(0.0), matrix(-1.0)].concat());
    let view = parts.view(&bytes);
    let inverse = parts.accessor(F32, "MAT4", 2, &format!(r#""bufferView":{view}"#));
    parts.floats("SCALAR", &[0.0, 1.0]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    parts.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half]);
    Arm { parts, joints, weights, inverse }
}

impl Arm {
    fn read(&self, joints: &str) -> Result<Coated, Trouble> {
        read_coated(&self.file(joints, ["", "", ""]), None)
    }

    /// The file; more follows the elbow, the nodes and the meshes.
    fn file(&self, joints: &str, [of_elbow, nodes, meshes]: [&str; 3]) -> Vec<u8> {
        let rest = format!(
            r#""scene":0,"scenes":[{{"nodes":[0,1]}}],
            "nodes":[{{"mesh":0,"skin":0,"translation":[9,9,9]}},{{"name":"up","translation":[0,5,0],"children":[2]}},
                {{"name":"shoulder","children":[3]}},{{"name":"elbow","translation":[1,0,0]{of_elbow}}}{nodes}],
            "skins":[{{"joints":{joints},"inverseBindMatrices":{}}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"JOINTS_0":{},"WEIGHTS_0":{}}},"indices":3}}]}}{meshes}],
            "animations":[{{"name":"bend","channels":[{{"sampler":0,"target":{{"node":3,"path":"rotation"}}}}],
                "samplers":[{{"input":{},"output":{}}}]}}]"#,
            self.inverse,
            self.joints,
            self.weights,
            self.inverse + 1,
            self.inverse + 2
        );
        glb(&self.parts.json(&rest, ""), &self.parts.bin)
    }
}

const BYTES: [u8; 16] = [0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0];
const HALVES: [u8; 16] = [255, 0, 0, 0, 255, 255, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0];

#[test]
fn skins_are_read_and_their_clips_pose_them() {
    let words = |bytes: &[u8]| bytes.iter().flat_map(|&b| [b, 0]).collect::<Vec<u8>>();
    let shorts = |bytes: &[u8]| bytes.iter().flat_map(|&b| [b, b]).collect::<Vec<u8>>();
    let floats = bytes_of(&HALVES.map(f32::from));
    for (component, joints, weights) in [
        (5121, BYTES.to_vec(), (5121, HALVES.to_vec())),
        (5123, words(&BYTES), (5123, shorts(&HALVES))),
        (5121, BYTES.to_vec(), (F32, floats)),
    ] {
        let arm = arm(component, &joints, (weights.0, &weights.1));
        let Coated { mesh, rig: Some(rig), .. } = arm.read("[2,3]").unwrap() else { panic!("no skin") };
        assert_eq!((rig.skeleton.joints().len(), mesh.triangles.len()), (3, 2));
        let [(name, clip)] = &rig.clips[..] else { panic!("{:?}", rig.clips) };
        assert_eq!((name.as_str(), clip.seconds()), ("bend", 1.0));
        let mut pose = Pose::rest(&rig.skeleton);
        let at = |pose: &Pose, v: usize| rig.weights.blend(v, pose).transform_point3(mesh.positions[v]);
        // At rest it stands where its joints are, wherever its own node is.
        assert!(at(&pose, 2).distance(Vec3::new(2.0, 5.0, 0.0)) < 1e-5);
        pose.set(&rig.skeleton, clip, 0.999_999);
        for (v, want) in
            [[0.0, 5.0, 0.0], [1.0, 5.0, 0.0], [1.0, 6.0, 0.0], [0.0, 7.0, 0.0]].into_iter().enumerate()
        {
            assert!(at(&pose, v).distance(Vec3::from(want)) < 1e-4, "{v}: {}", at(&pose, v));
        }
        assert!(rig.weights.shares()[1][1] == 0.5 && rig.weights.shares()[0][0] == 1.0);
    }
}

#[test]
fn absurd_skins_are_refused_by_name() {
    let good = || arm(5121, &BYTES, (5121, &HALVES));
    let why = |arm: &Arm, joints: &str| arm.read(joints).map(|_| ()).unwrap_err().to_string();
    // The second joint of a vertex does not exist in the skin, and has weight.
    let said = why(&good(), "[2]");
    assert!(said.contains("follows joint 1 of 1"), "{said}");
    let zero = arm(5121, &BYTES, (5121, &[0; 16]));
    assert!(why(&zero, "[2,3]").contains("not all may be zero"));
    let nan = arm(5121, &BYTES, (F32, &bytes_of(&[f32::NAN; 16])));
    assert!(why(&nan, "[2,3]").contains("shares"));
    let mut typed = good();
    typed.joints = typed.weights;
    assert!(why(&typed, "[2,3]").contains("(joints) is of a type"), "{}", why(&typed, "[2,3]"));
    let mut short = good();
    short.weights = 0;
    assert!(why(&short, "[2,3]").contains("(weights)"));
    let mut few = good();
    few.parts.accessors[few.inverse] =
        few.parts.accessors[few.inverse].replace(r#""count":2"#, r#""count":1"#);
    assert!(why(&few, "[2,3]").contains("shorter than the joints"));
    // Cut anywhere, a file is refused and nothing ends.
    let arm = good();
    let whole = glb(&arm.parts.json(r#""scene":0,"scenes":[{"nodes":[]}]"#, ""), &arm.parts.bin);
    for length in (0..whole.len()).step_by(7) {
        let _ = read_coated(&whole[..length], None);
    }
}

#[test]
fn rigid_parts_follow_the_joint_that_they_hang_from() {
    let arm = arm(5121, &BYTES, (5121, &HALVES));
    // A hand half a unit beyond the elbow.
    let more = [
        r#","children":[4]"#,
        r#",{"mesh":1,"translation":[0.5,0,0]}"#,
        r#",{"primitives":[{"attributes":{"POSITION":0},"indices":3}]}"#,
    ];
    let read = read_coated(&arm.file("[2,3]", more), None).unwrap();
    // Four vertices of the arm, four of the hand.
    assert_eq!((read.mesh.positions.len(), read.mesh.triangles.len()), (8, 4));
    let rig = read.rig.unwrap();
    let at = |vertex: usize, seconds: f64| {
        let mut pose = Pose::rest(&rig.skeleton);
        pose.set(&rig.skeleton, &rig.clips[0].1, seconds);
        rig.weights.blend(vertex, &pose).transform_point3(read.mesh.positions[vertex])
    };
    for (vertex, p) in [(4, Vec3::ZERO), (5, Vec3::X), (7, Vec3::new(3.0, 1.0, 0.0))] {
        let hand = p + Vec3::X * 0.5;
        let elbow = Vec3::new(1.0, 5.0, 0.0);
        assert!(at(vertex, 0.0).distance(elbow + hand) < 1e-5, "{}", at(vertex, 0.0));
        let turned = Vec3::new(-hand.y, hand.x, 0.0);
        assert!(at(vertex, 0.999_999_9).distance(elbow + turned) < 1e-5, "{}", at(vertex, 0.999_999_9));
    }
}

#[test]
fn the_box_of_a_skinned_mesh_holds_it_in_every_frame() {
    // Each vertex follows one or both joints.
    let shares = HALVES.map(|w| if w == 255 { 0.5 } else { 0.0 });
    let ones: Vec<f32> = shares.chunks(4).flat_map(|s| s.iter().map(|w| w / s.iter().sum::<f32>())).collect();
    let arm = arm(5121, &BYTES, (F32, &bytes_of(&ones)));
    let file = arm.file("[2,3]", ["", "", ""]);
    let mut world = read("arm", &file, None).unwrap();
    let [told] = &world.source.warnings[..] else { panic!("{:?}", world.source.warnings) };
    assert!(told.starts_with("node 0") && told.contains("skin"), "{told}");
    let [object] = &world.objects[..] else { panic!("one object") };
    assert!(!object.occludes && object.tested && object.motion != Motion::Static);
    let Shape::Box { min, max } = object.shape else { panic!("{object:?}") };
    let Coated { mesh, rig: Some(rig), .. } = read_coated(&file, None).unwrap() else { panic!("no skin") };
    let Rig { skeleton, weights, clips } = &rig;
    let (_, clip) = &clips[0];
    let mut reached = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for frame in 0..world.frames {
        assert!(world.set_frame(frame).is_empty());
        let mut pose = Pose::rest(skeleton);
        pose.set(skeleton, clip, frame as f64 * FRAME_SECONDS);
        for (v, &p) in mesh.positions.iter().enumerate() {
            let at = weights.blend(v, &pose).transform_point3(p);
            assert!(min.cmple(at).all() && at.cmple(max).all(), "frame {frame}: {at}");
            reached = (reached.0.min(at), reached.1.max(at));
        }
    }
    // It is no larger than what follows each joint goes.
    assert!((max - min).cmple((reached.1 - reached.0) + 1.5).all(), "{min} to {max}");
}
