//! Meshes that several nodes and instances share.

use super::*;

#[test]
fn nodes_share_meshes() {
    let world = triangle().read(&ONE.replace(r#"{"mesh":0}"#, r#"{"mesh":0},{"mesh":0}"#)).unwrap();
    let meshes: Vec<_> = world.objects.iter().map(|o| shared(&o.shape)).collect();
    assert!(meshes.len() == 2 && Arc::ptr_eq(&meshes[0], &meshes[1]));
}

fn shared(shape: &Shape) -> Arc<Mesh> {
    let Shape::Mesh { mesh, .. } = shape else { panic!("no mesh") };
    mesh.clone()
}

#[test]
fn instances_become_objects() {
    let (parts, rest) = instanced(PLACED);
    let world = parts.read(&rest).unwrap();
    let names: Vec<&str> = world.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["tree#0", "tree#1", "tree#2"]);
    assert!(world.objects.iter().all(|o| !o.tested && o.motion == Motion::Static));
    // The last is mirrored, and single sided: programs differ in which side they draw.
    assert_eq!([0, 1, 2].map(|i| world.objects[i].occludes), [true, true, false]);
    let meshes: Vec<_> = world.objects.iter().map(|o| shared(&o.shape)).collect();
    assert!(Arc::ptr_eq(&meshes[0], &meshes[2]));
    for (object, corners) in [
        (0, [[10.0, 0.0, 0.0], [9.0, 0.0, 0.0], [10.0, 1.0, 0.0]]),
        (1, [[10.0, 2.0, 0.0], [10.0, 4.0, 0.0], [12.0, 2.0, 0.0]]),
        (2, [[7.0, 0.0, 0.0], [8.0, 0.0, 0.0], [7.0, -1.0, 0.0]]),
    ] {
        for (found, corner) in triangles(&world, object)[0].iter().zip(corners) {
            assert!(found.distance(Vec3::from_array(corner)) < 1e-3, "{object}: {found} is not {corner:?}");
        }
    }
    // What is not about places still counts instances.
    let (parts, rest) = instanced(r#"{"attributes":{"_AGE":4}}"#);
    assert_eq!(parts.read(&rest).unwrap().objects.len(), 2);
}

#[test]
fn broken_instances_are_refused() {
    for (attributes, why) in [
        ("7", "without attributes"),
        ("{}", "without attributes"),
        (r#"{"attributes":{}}"#, "without attributes"),
        (r#"{"attributes":{"TRANSLATION":"1"}}"#, "TRANSLATION is no accessor"),
        (r#"{"attributes":{"SCALE":-1}}"#, "SCALE is no accessor"),
        (r#"{"attributes":{"SCALE":5}}"#, "SCALE is no accessor"),
        (r#"{"attributes":{"TRANSLATION":1,"_AGE":4}}"#, "different lengths"),
    ] {
        let (parts, rest) = instanced(attributes);
        says(parts.read(&rest), &["node 0 (\"tree\")", why]);
    }
    for attribute in [r#"{"attributes":{"ROTATION":1}}"#, r#"{"attributes":{"TRANSLATION":2}}"#] {
        let (parts, rest) = instanced(attribute);
        says(parts.read(&rest), &["(instances)", "type"]);
    }
    let (mut parts, rest) = instanced(r#"{"attributes":{"ROTATION":5}}"#);
    parts.floats("VEC4", &[0.0; 4]);
    says(parts.read(&rest), &["accessor 5 (instances)", "rotation"]);
}
