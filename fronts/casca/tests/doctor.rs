//! `casca doctor`: what it says of levels of which is known what hides.

use std::path::Path;
use std::process::Command;

/// The exit code, the output and the errors.
fn doctor(folder: &Path, words: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_casca"));
    let output = command.current_dir(folder).arg("doctor").args(words).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// A file without a camera: a floor, and a wall of a material with many small things behind it.
fn level(material: &str, extensions: &str) -> String {
    let mut nodes = vec![
        // A triangle that lies on its back.
        r#"{"mesh":0,"rotation":[-0.70710678,0,0,0.70710678],"scale":[40,40,1],"translation":[-10,0,20]}"#
            .to_owned(),
        r#"{"mesh":1,"scale":[30,12,1],"translation":[-12,0,0]}"#.to_owned(),
    ];
    for i in 0..100 {
        let (x, z) = (i % 10 - 9, -2 - i / 10);
        nodes.push(format!(r#"{{"mesh":0,"scale":[0.5,0.5,1],"translation":[{x},0.2,{z}]}}"#));
    }
    let scene: Vec<String> = (0..nodes.len()).map(|i| i.to_string()).collect();
    format!(
        r#"{{"asset":{{"version":"2.0"}},{extensions}"scene":0,"scenes":[{{"nodes":[{}]}}],"nodes":[{}],
        "materials":[{{"name":"curtain",{material}"doubleSided":true}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}},
            {{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],
        "buffers":[{{"byteLength":36,
            "uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}]}}"#,
        scene.join(","),
        nodes.join(",")
    )
}

#[test]
fn what_hides_nothing_is_named_with_its_reason_and_nothing_visible_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (material, clear) in
        [("", false), (r#""alphaMode":"MASK","#, true), (r#""alphaMode":"BLEND","#, true)]
    {
        std::fs::write(folder.join("level.gltf"), level(material, "")).unwrap();
        let (code, said, errors) = doctor(folder, &["level.gltf", "--check"]);
        assert_eq!(code, Some(0), "{said}{errors}");
        assert!(said.starts_with("level: 102 objects (0 move), 102 triangles, 42.0"), "{said}");
        assert!(said.contains("places on its floors, 1.70 m high"), "{said}");
        let row = said.lines().find(|line| line.contains("(curtain)")).unwrap_or_default();
        // The wall has 180 of 992.5 square metres.
        assert_eq!(row.contains("18.1%  alphaMode"), clear, "{said}");
        assert_eq!(said.contains("hides nothing"), clear, "{said}");
        assert_eq!(said.contains(" 18.1%  from both sides"), !clear, "{said}");
        assert!(said.contains("0 visible objects are lost"), "{said}");
        // What can be seen through a curtain is drawn.
        let share =
            said.split("leaves out ").nth(1).and_then(|rest| rest.split('%').next()?.parse::<u32>().ok());
        assert_eq!(share.unwrap_or(0) < 50, clear, "{said}");
        let picture = std::fs::read(folder.join("target/doctor/level.png")).unwrap();
        assert!(picture.starts_with(b"\x89PNG") && picture.len() > 5000, "{}", picture.len());
    }
}

#[test]
fn files_that_cannot_be_read_are_refused_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let extensions = r#""extensionsUsed":["VENDOR_walls"],"extensionsRequired":["VENDOR_walls"],"#;
    let packed = r#"{"extensions":{"KHR_draco_mesh_compression":{"bufferView":99}},"attributes""#;
    let damaged = level("", r#""extensionsRequired":["KHR_draco_mesh_compression"],"#).replacen(
        r#"{"attributes""#,
        packed,
        1,
    );
    for (file, name, advice) in [
        (level("", extensions), "VENDOR_walls", "export the level without them"),
        (damaged, "packed by Draco", "export it anew, or without compression"),
    ] {
        std::fs::write(folder.join("level.gltf"), file).unwrap();
        let (code, said, errors) = doctor(folder, &["level.gltf"]);
        assert_eq!((code, said.as_str()), (Some(3), ""));
        assert!(errors.contains(name) && errors.contains(advice), "{errors}");
    }
    assert_eq!(doctor(folder, &["none.glb"]).0, Some(3));
    assert_eq!(doctor(folder, &["house"]).0, Some(2));
    assert!(std::fs::read_dir(folder).unwrap().count() == 1, "no picture");
}
