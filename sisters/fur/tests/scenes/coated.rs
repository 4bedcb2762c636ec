//! Colours, lengths and images of meshes that grow fur.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use casca_fur::mesh::Coat;

use casca_fur::scenes::import::{Coated, read_coated};
use casca_scenes::import::Trouble;
use glam::Vec3;

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
fn images_are_read_once_and_bad_ones_are_named() {
    let texture = |uri: &str| {
        let mut leaf = Leaf::new().material(
            r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":
                {"KHR_texture_transform":{"offset":[0.5,0.25],"scale":[2,4],"rotation":1.5707964}}}}"#,
        );
        let bytes = bytes_of(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
        let view = leaf.parts.view(&bytes);
        let accessor = leaf.parts.accessor(F32, "VEC2", 3, &format!(r#""bufferView":{view}"#));
        leaf.attributes += &format!(r#","TEXCOORD_0":{accessor}"#);
        leaf.more += &format!(r#","textures":[{{"source":0}}],"images":[{{"uri":"{uri}"}}]"#);
        leaf
    };
    // A red texel.
    let png = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC";
    let read = texture(&format!("data:image/png;base64,{png}")).read().unwrap();
    assert_eq!(read.images.len(), 1);
    assert_eq!(read.images[0].texels(), [255, 0, 0, 255]);
    // As the reference viewer of Khronos turns them.
    let want = [[0.5, 0.25], [0.5, -1.75], [4.5, 0.25]];
    for (coord, want) in read.tex_coords.iter().zip(want) {
        assert!((coord.uv - glam::Vec2::from_array(want)).abs().max_element() < 1e-5, "{coord:?}");
        assert_eq!(coord.image, Some(0));
    }
    // A picture of one colour as JPEG, which a uniform block keeps but for rounding.
    let mut jpeg = Vec::new();
    let made = image::RgbImage::from_pixel(16, 8, image::Rgb([200, 30, 60]));
    made.write_with_encoder(image::codecs::jpeg::JpegEncoder::new_with_quality(&mut jpeg, 95)).unwrap();
    let uri = |bytes: &[u8]| format!("data:image/jpeg;base64,{}", STANDARD.encode(bytes));
    let read = texture(&uri(&jpeg)).read().unwrap();
    assert_eq!(read.images[0].size(), glam::UVec2::new(16, 8));
    let near = |texel: &[u8]| texel.iter().zip([200u8, 30, 60, 255]).all(|(a, b)| a.abs_diff(b) <= 2);
    assert!(read.images[0].texels().chunks(4).all(near));
    for part in [2, 20, jpeg.len() / 2] {
        // Decoders may fill up a picture that was cut in its middle.
        let cut = texture(&uri(&jpeg[..part])).read();
        assert!(part == jpeg.len() / 2 || cut.unwrap_err().to_string().starts_with("image 0"), "{part}");
    }
    for uri in ["data:image/png;base64,iVBORw0KGgo=", "data:,", "nowhere.png", "/etc/passwd", "a?b"] {
        let said = texture(uri).read().unwrap_err().to_string();
        assert!(said.starts_with("image 0"), "{said}");
    }
}
