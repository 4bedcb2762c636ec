//! Colours and lengths of meshes that grow fur.

use std::io::Cursor;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use casca_fur::mesh::Coat;
use casca_fur::scenes::import::{Coated, read_coated};
use casca_scenes::import::Trouble;
use casca_tools::image::srgb;
use glam::{Vec2, Vec3};
use image::{ImageFormat, Rgb, RgbImage};

use crate::parts::{F32, Parts, bytes_of, glb};

/// A triangle with an attribute and a material.
struct Leaf {
    parts: Parts,
    attributes: String,
    more: String,
}

impl Leaf {
    fn new() -> Self {
        let mut parts = Parts::default();
        parts.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        Self { parts, attributes: r#""POSITION":0"#.into(), more: String::new() }
    }

    fn with(mut self, name: &str, (component, kind): (u32, &str), bytes: &[u8]) -> Self {
        let normalized = if component == F32 { "" } else { r#","normalized":true"# };
        let accessor = self.parts.dense(component, kind, bytes, normalized);
        self.attributes += &format!(r#","{name}":{accessor}"#);
        self
    }

    fn material(mut self, json: &str) -> Self {
        self.more = format!(r#","materials":[{{"name":"skin",{json}}}]"#);
        self
    }

    fn read(&self) -> Result<Coated, Trouble> {
        let material = if self.more.is_empty() { "" } else { r#","material":0"# };
        let rest = format!(
            r#""scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{{}}}{material}}}]}}]{}"#,
            self.attributes, self.more
        );
        read_coated(&glb(&self.parts.json(&rest, ""), &self.parts.bin), None)
    }

    fn coats(&self) -> Vec<Coat> {
        self.read().unwrap().coats
    }
}

fn words(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

#[test]
fn colours_of_all_kinds_are_linear_and_alpha_is_the_length() {
    let want = [(Vec3::new(1.0, 0.2, 0.0), 0.4), (Vec3::ZERO, 1.0), (Vec3::ONE, 0.0)];
    let rgba = [1.0, 0.2, 0.0, 0.4, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0];
    let bytes = rgba.map(|x: f32| (x * 255.0).round() as u8);
    let shorts = rgba.map(|x| (x * 65535.0).round() as u16);
    for (component, data) in [(F32, bytes_of(&rgba)), (5121, bytes.to_vec()), (5123, words(&shorts))] {
        let coats = Leaf::new().with("COLOR_0", (component, "VEC4"), &data).coats();
        for (coat, (color, length)) in coats.iter().zip(want) {
            assert!((coat.color - color).abs().max_element() < 1e-5, "{component}: {coat:?}");
            assert!((coat.length - length).abs() < 1e-5, "{component}: {coat:?}");
        }
    }
    // Three components: full length. Floats beyond 1 are moved there.
    let rgb = [2.0, 0.5, -1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let coats = Leaf::new().with("COLOR_0", (F32, "VEC3"), &bytes_of(&rgb)).coats();
    assert_eq!(coats[0], Coat { color: Vec3::new(1.0, 0.5, 0.0), length: 1.0 });
}

#[test]
fn lengths_count_before_alpha_and_materials_multiply() {
    let rgba = [0.5f32, 0.5, 0.5, 0.25].repeat(3);
    let leaf = || Leaf::new().with("COLOR_0", (F32, "VEC4"), &bytes_of(&rgba));
    let factor = r#""pbrMetallicRoughness":{"baseColorFactor":[0.5,1,0,0.1]}"#;
    let coats = leaf().material(factor).coats();
    assert_eq!(coats[0], Coat { color: Vec3::new(0.25, 0.5, 0.0), length: 0.25 });
    let coats = leaf().with("_FURLENGTH", (F32, "SCALAR"), &bytes_of(&[0.0, 0.75, 9.0])).coats();
    assert_eq!(coats.iter().map(|c| c.length).collect::<Vec<_>>(), [0.0, 0.75, 1.0]);
    let coats = leaf().with("_FURLENGTH", (5123, "SCALAR"), &words(&[0, 65535, 65535])).coats();
    assert_eq!(coats[1].length, 1.0);
    // Nothing is said: brown. A material says white.
    assert!(Leaf::new().coats()[0].color.x < 0.5);
    assert_eq!(Leaf::new().material(r#""alphaMode":"OPAQUE""#).coats()[0], Coat::default());
}

#[test]
fn what_cannot_be_a_colour_is_refused() {
    let nan = [0.0, f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let said = |leaf: Leaf| leaf.read().unwrap_err().to_string();
    assert!(said(Leaf::new().with("COLOR_0", (F32, "VEC3"), &bytes_of(&nan))).contains("a colour of mesh 0"));
    let infinite = bytes_of(&[0.0, f32::INFINITY, 0.0]);
    assert!(said(Leaf::new().with("_FURLENGTH", (F32, "SCALAR"), &infinite)).contains("a length of mesh 0"));
    let short = bytes_of(&[0.0; 6]);
    assert!(
        said(Leaf::new().with("COLOR_0", (F32, "VEC3"), &short)).contains("not as long as the positions")
    );
    assert!(said(Leaf::new().with("COLOR_0", (5122, "VEC3"), &words(&[0; 9]))).contains("of a type"));
    assert!(said(Leaf::new().with("COLOR_0", (F32, "SCALAR"), &bytes_of(&[0.0; 3]))).contains("of a type"));
}

#[test]
fn the_colours_of_images_multiply_and_bad_images_are_named() {
    let texture = |uri: &str, uvs: &[f32; 6]| {
        let mut leaf = Leaf::new().material(
            r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":
                {"KHR_texture_transform":{"offset":[0.5,0.25],"scale":[2,4],"rotation":1.5707964}}}}"#,
        );
        let view = leaf.parts.view(&bytes_of(uvs));
        let accessor = leaf.parts.accessor(F32, "VEC2", 3, &format!(r#""bufferView":{view}"#));
        leaf.attributes += &format!(r#","TEXCOORD_0":{accessor}"#);
        leaf.more += &format!(r#","textures":[{{"source":0}}],"images":[{{"uri":"{uri}"}}]"#);
        leaf
    };
    let uvs = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    let uri = |kind: &str, bytes: &[u8]| format!("data:image/{kind};base64,{}", STANDARD.encode(bytes));
    let written = |picture: &RgbImage, format: ImageFormat| {
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    };
    // 8 x 8 texels whose red and green are their places, as sRGB stores them.
    let stored = |x: u32| srgb((x as f32 + 0.5) / 8.0);
    let places = RgbImage::from_fn(8, 8, |x, y| Rgb([stored(x), stored(y), 0]));
    let png = written(&places, ImageFormat::Png);
    // As the reference viewer of Khronos turns them: to (0.5, 0.25), (0.5, -1.75) and (4.5, 0.25).
    let read = texture(&uri("png", &png), &uvs).read().unwrap();
    for (coat, want) in read.coats.iter().zip([[0.5, 0.25], [0.5, 0.25], [0.5, 0.25]]) {
        assert!((coat.color.truncate() - Vec2::from_array(want)).abs().max_element() < 0.01, "{coat:?}");
        assert_eq!(coat.length, 1.0);
    }
    let third = texture(&uri("png", &png), &[0.05, 0.0, 0.0, 0.1, 0.05, 0.05]).read().unwrap();
    for (coat, want) in third.coats.iter().zip([[0.5, 0.15], [0.9, 0.25], [0.7, 0.15]]) {
        assert!((coat.color.truncate() - Vec2::from_array(want)).abs().max_element() < 0.02, "{coat:?}");
    }
    assert!(texture(&uri("png", &png), &[f32::NAN; 6]).read().is_err());
    // A picture of one colour as JPEG, which a uniform block keeps but for rounding.
    let jpeg = written(&RgbImage::from_pixel(16, 8, Rgb([200, 30, 60])), ImageFormat::Jpeg);
    let near = |coat: &Coat| {
        let bytes = coat.color.to_array().map(srgb);
        bytes.iter().zip([200u8, 30, 60]).all(|(a, b)| a.abs_diff(b) <= 2)
    };
    assert!(texture(&uri("jpeg", &jpeg), &uvs).coats().iter().all(near));
    for part in [2, 20, jpeg.len() / 2] {
        // Decoders may fill up a picture that was cut in its middle.
        let cut = texture(&uri("jpeg", &jpeg[..part]), &uvs).read();
        assert!(part == jpeg.len() / 2 || cut.unwrap_err().to_string().starts_with("image 0"), "{part}");
    }
    for uri in ["data:image/png;base64,iVBORw0KGgo=", "data:,", "nowhere.png", "/etc/passwd", "a?b"] {
        let said = texture(uri, &uvs).read().unwrap_err().to_string();
        assert!(said.starts_with("image 0"), "{said}");
    }
}
