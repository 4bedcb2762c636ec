//! Small valid maps of Tiled, for tests of damaged ones and for the fuzz target `readers`.

// Each test and the fuzz target use a part of it.
#![allow(dead_code)]

/// The tileset in a file of its own that the maps name.
pub const TILESET: &str = include_str!("t.tsx");

/// The tiles of each layer: 4 by 3. Those from 5 on are of the tileset in a file of its own; the
/// last is turned.
pub const TILES: [u32; 12] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 2, 6, 0x8000_0006];

/// A map of two layers, of which one is in a group, with the attributes of their data and the data.
pub fn map(attributes: &str, data: &str) -> String {
    include_str!("map.tmx").replace("encoding=\"csv\">DATA", &format!("{attributes}>{data}"))
}

/// The map of [`objects`] as JSON, with what its data say of themselves and the data.
pub fn json(stored: &str, data: &str) -> String {
    include_str!("map.tmj").replace("\"encoding\":\"csv\"", stored).replace("DATA", data)
}

/// The tiles as text.
pub fn csv() -> String {
    TILES.map(|id| id.to_string()).join(",\n")
}

/// The tiles in base64, compressed or not, by programs that share nothing with the reader.
pub fn base64(compression: &str) -> String {
    match compression {
        "zlib" => "eNpjYGBgYARiJiBmBmIWIGYFYjYgZgdiDqgcGwQ3AAAEoACz",
        "gzip" => "H4sIAAAAAAACA2NgYGBgBGImIGYGYhYgZgViNiBmB2IOqBwbBDcAAO3hvY8wAAAA",
        "zstd" => "KLUv/SQw7QAAAkMGDdClMQAAQMSESEKI3CnlfdfJx3fxcHB9PgAFNqqs",
        _ => "AAAAAAEAAAACAAAAAwAAAAQAAAAFAAAABgAAAAcAAAAIAAAAAgAAAAYAAAAGAACA",
    }
    .into()
}

/// A map with objects of all kinds.
pub fn objects() -> String {
    map("encoding=\"csv\"", &csv())
        .replace("\n</map>", &["\n", include_str!("objects.xml"), "</map>"].concat())
}

/// Maps of each encoding, one with objects, and two of JSON.
pub fn all() -> Vec<Vec<u8>> {
    let packed = |compression: &str| {
        let attributes = format!("encoding=\"base64\" compression=\"{compression}\"");
        map(attributes.replace(" compression=\"\"", "").as_str(), &base64(compression)).into_bytes()
    };
    let plain = map("encoding=\"csv\"", &csv()).into_bytes();
    let list = json("\"opacity\":1", &format!("[{}]", csv())).into_bytes();
    let zstd = "\"encoding\":\"base64\",\"compression\":\"zstd\"";
    let folded = json(zstd, &format!("\"{}\"", base64("zstd"))).into_bytes();
    let packed = ["", "zlib", "gzip", "zstd"].map(packed);
    [plain].into_iter().chain(packed).chain([objects().into_bytes(), list, folded]).collect()
}
