//! glTF files in the making, for the tests of the reader; sisters' tests have them, too.
#![allow(dead_code)]

pub fn glb(json: &str, bin: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let words = [2, 28 + json.len() + bin.len(), json.len()].map(|word| (word as u32).to_le_bytes());
    let length = (bin.len() as u32).to_le_bytes();
    [b"glTF", &words.concat()[..], b"JSON", &json, &length, b"BIN\0", bin].concat()
}

/// A file in the making: what its accessors read.
#[derive(Default, Clone)]
pub struct Parts {
    pub accessors: Vec<String>,
    pub views: Vec<String>,
    pub bin: Vec<u8>,
}

pub const F32: u32 = 5126;

impl Parts {
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.views.push(format!(
            r#"{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#,
            self.bin.len(),
            bytes.len()
        ));
        self.bin.extend(bytes);
        while !self.bin.len().is_multiple_of(4) {
            self.bin.push(0);
        }
        self.views.len() - 1
    }

    /// An accessor; `more` follows its type and count.
    pub fn accessor(&mut self, component: u32, kind: &str, count: usize, more: &str) -> usize {
        self.accessors.push(format!(
            r#"{{"componentType":{component},"type":"{kind}","count":{count},"min":[0,0,0],"max":[0,0,0],{more}}}"#
        ));
        self.accessors.len() - 1
    }

    pub fn dense(&mut self, component: u32, kind: &str, bytes: &[u8], more: &str) -> usize {
        let width = match component {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            _ => 4,
        };
        let size = width
            * match kind {
                "SCALAR" => 1,
                "VEC3" => 3,
                _ => 4,
            };
        let view = self.view(bytes);
        self.accessor(component, kind, bytes.len() / size, &format!(r#""bufferView":{view}{more}"#))
    }

    pub fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        self.dense(F32, kind, &bytes_of(values), "")
    }

    pub fn json(&self, rest: &str, uri: &str) -> String {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{}{uri}}}],{rest}}}"#,
            self.accessors.join(","),
            self.views.join(","),
            self.bin.len()
        )
    }

    pub fn glb(&self, rest: &str) -> Vec<u8> {
        glb(&self.json(rest, ""), &self.bin)
    }
}

pub fn bytes_of(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|f| f.to_le_bytes()).collect()
}
