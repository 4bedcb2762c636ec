//! Small valid maps of Tiled, for tests of damaged ones and for the fuzz target `readers`.

// Each test and the fuzz target use a part of it.
#![allow(dead_code)]

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};

/// The tileset in a file of its own that the maps name.
pub const TILESET: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<tileset name=\"t\" tilewidth=\"16\" tileheight=\"16\" \
    tilecount=\"4\" columns=\"2\">\n <image source=\"t.png\" width=\"32\" height=\"32\"/>\n <tile id=\"1\"><properties>\
    <property name=\"opaque\" type=\"bool\" value=\"true\"/></properties></tile>\n</tileset>\n";

/// The tiles of each layer: 4 by 3. Those from 5 on are of the tileset in a file of its own; the
/// last is turned.
pub const TILES: [u32; 12] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 2, 6, 0x8000_0006];

/// A map of two layers, of which one is in a group, with the attributes of their data and the data.
pub fn map(attributes: &str, data: &str) -> String {
    let layer = |name: &str| {
        format!(
            "<layer id=\"1\" name=\"{name}\" width=\"4\" height=\"3\"><data {attributes}>{data}</data></layer>"
        )
    };
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<map version=\"1.10\" orientation=\"orthogonal\" width=\"4\" height=\"3\" \
         tilewidth=\"16\" tileheight=\"16\" infinite=\"0\">\n<tileset firstgid=\"1\" name=\"s\" tilewidth=\"16\" tileheight=\"16\" \
         tilecount=\"4\" columns=\"2\"><image source=\"s.png\" width=\"32\" height=\"32\"/>\n<tile id=\"1\"><properties>\
         <property name=\"opaque\" type=\"bool\" value=\"true\"/></properties></tile><tile id=\"2\"><properties>\
         <property name=\"opaque\" type=\"bool\" value=\"false\"/><property name=\"class\" type=\"class\"><properties>\
         <property name=\"opaque\" type=\"bool\" value=\"true\"/></properties></property></properties></tile></tileset>\n\
         <tileset firstgid=\"5\" source=\"t.tsx\"/>\n<objectgroup id=\"3\" name=\"o\"><object id=\"1\" x=\"1\" y=\"2\">\
         <polygon points=\"0,0 1,1 2,0\"/></object></objectgroup>\n{}\n<group id=\"4\" name=\"g\">{}</group>\n</map>\n",
        layer("ground"),
        layer("farther")
    )
}

/// The tiles as text.
pub fn csv() -> String {
    TILES.map(|id| id.to_string()).join(",\n")
}

/// The tiles in base64, compressed or not.
pub fn base64(compression: &str) -> String {
    let bytes = TILES.map(u32::to_le_bytes).concat();
    let packed = match compression {
        "zlib" => {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(&bytes).and_then(|()| encoder.finish())
        }
        "gzip" => {
            let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(&bytes).and_then(|()| encoder.finish())
        }
        // Made by the reference program.
        "zstd" => return "KLUv/SQw7QAAAkMGDdClMQAAQMSESEKI3CnlfdfJx3fxcHB9PgAFNqqs".into(),
        _ => Ok(bytes),
    };
    STANDARD.encode(packed.expect("a list takes all bytes"))
}

/// Objects of all kinds, in a layer.
const OBJECTS: &str = "<group offsetx=\"8\" visible=\"0\"><objectgroup id=\"5\" name=\"things\" offsety=\"-4\">\
    <object id=\"2\" name=\"box\" type=\"opaque\" x=\"16\" y=\"8.5\" width=\"12\" height=\"20\" rotation=\"30\"/>\
    <object id=\"3\" class=\"door\" x=\"4\" y=\"4\" width=\"12\" height=\"20\" visible=\"0\"><ellipse/></object>\
    <object id=\"4\" x=\"40\" y=\"40\"><point/></object><object id=\"5\" type=\"opaque\" x=\"1\" y=\"2\">\
    <polygon points=\"0,0 30,0 30,10 10,10 10,30 0,30\"/></object><object id=\"6\" type=\"opaque\" x=\"1\" y=\"2\">\
    <polyline points=\"0,0 30,10 10,30\"/></object><object id=\"7\" gid=\"2147483650\" x=\"16\" y=\"32\" width=\"16\" \
    height=\"16\"/><object id=\"8\" x=\"3\" y=\"3\" width=\"9\" height=\"9\"><text>A</text></object>\
    <object id=\"9\" x=\"20\" y=\"20\" width=\"8\" height=\"8\"><properties><property name=\"opaque\" type=\"bool\" \
    value=\"true\"/><property name=\"i\" type=\"int\" value=\"7\"/><property name=\"f\" type=\"float\" value=\"0.5\"/>\
    <property name=\"c\" type=\"color\" value=\"#ff102030\"/><property name=\"o\" type=\"object\" value=\"2\"/>\
    <property name=\"s\" value=\"text\"/><property name=\"k\" type=\"class\" propertytype=\"K\"><properties>\
    <property name=\"m\" type=\"bool\" value=\"false\"/></properties></property></properties></object>\
    </objectgroup></group>";

/// A map with objects of all kinds.
pub fn objects() -> String {
    map("encoding=\"csv\"", &csv()).replace("\n</map>", &format!("\n{OBJECTS}</map>"))
}

/// Maps of each encoding, and one with objects.
pub fn all() -> Vec<Vec<u8>> {
    let packed = |compression: &str| {
        let attributes = format!("encoding=\"base64\" compression=\"{compression}\"");
        map(attributes.replace(" compression=\"\"", "").as_str(), &base64(compression)).into_bytes()
    };
    let plain = map("encoding=\"csv\"", &csv()).into_bytes();
    vec![plain, packed(""), packed("zlib"), packed("gzip"), packed("zstd"), objects().into_bytes()]
}
