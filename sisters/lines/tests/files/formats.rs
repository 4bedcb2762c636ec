//! Writers of files, by the descriptions of their formats alone. Vertex number n of a file has
//! the value n / 2 with the name "fa", line number n the value 10 n with the name "bundle".

/// The vertices of each line.
pub type Lines = [Vec<[f32; 3]>];

fn le(values: impl IntoIterator<Item = f32>) -> Vec<u8> {
    values.into_iter().flat_map(f32::to_le_bytes).collect()
}

fn vertices(lines: &Lines) -> Vec<[f32; 3]> {
    lines.concat()
}

fn of_vertices(lines: &Lines) -> Vec<f32> {
    (0..vertices(lines).len()).map(|n| n as f32 / 2.0).collect()
}

fn of_lines(lines: &Lines) -> Vec<f32> {
    (0..lines.len()).map(|n| n as f32 * 10.0).collect()
}

/// MRtrix tracks.
pub fn tck(lines: &Lines, double: bool, big: bool) -> Vec<u8> {
    let kind = format!("Float{}{}", if double { 64 } else { 32 }, if big { "BE" } else { "LE" });
    let mut bytes = format!("mrtrix tracks\ncount: 9\ndatatype: {kind}\nfile: . 67\nEND\n").into_bytes();
    bytes.resize(67, 0);
    let mut put = |value: f32| {
        let wide =
            if double { f64::from(value).to_le_bytes().to_vec() } else { value.to_le_bytes().to_vec() };
        if big { bytes.extend(wide.iter().rev()) } else { bytes.extend(wide) }
    };
    for line in lines {
        line.iter().flatten().for_each(|c| put(*c));
        [f32::NAN; 3].into_iter().for_each(&mut put);
    }
    [f32::INFINITY; 3].into_iter().for_each(&mut put);
    bytes
}

/// TrackVis tracks of an image of 50 x 60 x 70 voxels of 2 x 2 x 3 mm, with a matrix and an order
/// of voxels if they are given.
pub fn trk(lines: &Lines, big: bool, matrix: Option<([[f32; 4]; 4], &[u8; 3])>) -> Vec<u8> {
    let mut head = vec![0; 1000];
    let mut put = |at: usize, number: &[u8]| {
        let number: Vec<u8> = if big { number.iter().rev().copied().collect() } else { number.to_vec() };
        head[at..at + number.len()].copy_from_slice(&number);
    };
    for (i, size) in [50_i16, 60, 70].into_iter().enumerate() {
        put(6 + 2 * i, &size.to_le_bytes());
    }
    for (i, size) in [2.0_f32, 2.0, 3.0].into_iter().enumerate() {
        put(12 + 4 * i, &size.to_le_bytes());
    }
    put(36, &1_i16.to_le_bytes());
    put(238, &1_i16.to_le_bytes());
    put(988, &(lines.len() as i32).to_le_bytes());
    put(992, &2_i32.to_le_bytes());
    put(996, &1000_i32.to_le_bytes());
    for (i, value) in matrix.iter().flat_map(|m| m.0).flatten().enumerate() {
        put(440 + 4 * i, &value.to_le_bytes());
    }
    head[..5].copy_from_slice(b"TRACK");
    head[38..40].copy_from_slice(b"fa");
    head[240..246].copy_from_slice(b"bundle");
    if let Some((_, order)) = matrix {
        head[948..951].copy_from_slice(order);
    }
    let (values, mut number) = (of_vertices(lines), 0);
    let mut word = |bytes: [u8; 4]| {
        head.extend(if big { bytes.iter().rev().copied().collect() } else { bytes.to_vec() })
    };
    for (line, own) in lines.iter().zip(of_lines(lines)) {
        word((line.len() as i32).to_le_bytes());
        for point in line {
            point.iter().for_each(|c| word(c.to_le_bytes()));
            word(f32::to_le_bytes(values[number]));
            number += 1;
        }
        word(own.to_le_bytes());
    }
    head
}

/// Cem Yuksel's hair, with thickness, and colours whose red is the number of the vertex.
pub fn hair(lines: &Lines) -> Vec<u8> {
    let mut bytes = b"HAIR".to_vec();
    let points = vertices(lines);
    for number in [lines.len() as u32, points.len() as u32, 1 | 2 | 4 | 16, 0] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.resize(128, 0);
    lines.iter().for_each(|l| bytes.extend((l.len() as u16 - 1).to_le_bytes()));
    bytes.extend(le(points.iter().flatten().copied()));
    bytes.extend(le(of_vertices(lines)));
    bytes.extend(le((0..points.len()).flat_map(|n| [n as f32 / 255.0, 1.0, 0.0])));
    bytes
}

/// VTK's legacy files: of version 5.1 or before, with words or bytes. A vertex cell stands before
/// the lines, with a value of its own.
pub fn vtk(lines: &Lines, ascii: bool, new: bool) -> Vec<u8> {
    let kind = if ascii { "ASCII" } else { "BINARY" };
    let version = if new { "5.1" } else { "3.0" };
    let mut file =
        format!("# vtk DataFile Version {version}\ntitle\n{kind}\nDATASET POLYDATA\n").into_bytes();
    let floats = |file: &mut Vec<u8>, all: &[f32]| match ascii {
        true => file.extend(all.iter().flat_map(|v| format!("{v} ").into_bytes()).chain(*b"\n")),
        false => file.extend(all.iter().flat_map(|v| v.to_be_bytes()).chain(*b"\n")),
    };
    let whole = |file: &mut Vec<u8>, all: &[i32], wide: bool| match (ascii, wide) {
        (true, _) => file.extend(all.iter().flat_map(|v| format!("{v} ").into_bytes()).chain(*b"\n")),
        (_, true) => file.extend(all.iter().flat_map(|v| i64::from(*v).to_be_bytes()).chain(*b"\n")),
        (_, false) => file.extend(all.iter().flat_map(|v| v.to_be_bytes()).chain(*b"\n")),
    };
    let points = vertices(lines);
    file.extend(format!("POINTS {} float\n", points.len()).into_bytes());
    floats(&mut file, points.as_flattened());
    // Old files have the counts among the numbers of points.
    let mut cells = |name: &str, ranges: &[std::ops::Range<i32>]| {
        let list: Vec<i32> = ranges.iter().cloned().flatten().collect();
        if new {
            file.extend(
                format!("{name} {} {}\nOFFSETS vtktypeint64\n", ranges.len() + 1, list.len()).into_bytes(),
            );
            let ends = ranges.iter().scan(0, |end, r| {
                Some({
                    *end += r.len() as i32;
                    *end
                })
            });
            whole(&mut file, &std::iter::once(0).chain(ends).collect::<Vec<_>>(), true);
            file.extend(b"CONNECTIVITY vtktypeint64\n");
            whole(&mut file, &list, true);
        } else {
            file.extend(format!("{name} {} {}\n", ranges.len(), list.len() + ranges.len()).into_bytes());
            let all = ranges.iter().flat_map(|r| std::iter::once(r.len() as i32).chain(r.clone()));
            whole(&mut file, &all.collect::<Vec<_>>(), false);
        }
    };
    let mut next = 0;
    let ranges: Vec<_> = lines
        .iter()
        .map(|l| {
            let from = next;
            next += l.len() as i32;
            from..next
        })
        .collect();
    cells("VERTICES", std::slice::from_ref(&(0..1)));
    cells("LINES", &ranges);
    file.extend(
        format!("POINT_DATA {}\nSCALARS fa float 1\nLOOKUP_TABLE default\n", points.len()).into_bytes(),
    );
    floats(&mut file, &of_vertices(lines));
    file.extend(b"METADATA\nINFORMATION 0\n\n");
    file.extend(format!("CELL_DATA {}\nFIELD FieldData 1\nbundle 1 {0} int\n", lines.len() + 1).into_bytes());
    let values = std::iter::once(7.0).chain(of_lines(lines)).map(|v| v as i32);
    whole(&mut file, &values.collect::<Vec<_>>(), false);
    file
}

/// How a VTP file has its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Numbers {
    Ascii,
    Inline,
    AppendedText,
    AppendedRaw,
}

/// VTK's XML files; with packed numbers in blocks of 24 bytes, and headers of 64 bits, in one order
/// of bytes or the other.
pub fn vtp(lines: &Lines, numbers: Numbers, packed: bool, wide: bool) -> Vec<u8> {
    let points = vertices(lines);
    let (mut xml, mut appended) = (String::new(), Vec::new());
    let order = if wide { "BigEndian" } else { "LittleEndian" };
    let (header, how) =
        (if wide { "UInt64" } else { "UInt32" }, if packed { "vtkZLibDataCompressor" } else { "" });
    xml += &format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"{order}\" header_type=\"{header}\" compressor=\"{how}\">\n"
    );
    xml += &format!(
        "<PolyData><Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"{}\">\n",
        points.len(),
        lines.len()
    );
    let mut array = |xml: &mut String, name: &str, kind: &str, components: usize, values: &[f64]| {
        let start = format!("<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\"");
        let bytes: Vec<u8> = values
            .iter()
            .flat_map(|v| {
                let mut bytes = match kind {
                    "Float32" => (*v as f32).to_le_bytes().to_vec(),
                    "Int64" => (*v as i64).to_le_bytes().to_vec(),
                    _ => (*v as i32).to_le_bytes().to_vec(),
                };
                if wide {
                    bytes.reverse()
                }
                bytes
            })
            .collect();
        let parts =
            if packed { blocks(&bytes, wide) } else { vec![[head(&[bytes.len()], wide), bytes].concat()] };
        match numbers {
            Numbers::Ascii => {
                let words: Vec<String> = values.iter().map(f64::to_string).collect();
                *xml += &format!("{start} format=\"ascii\">{}</DataArray>\n", words.join(" "));
            }
            Numbers::Inline => {
                let text: String = parts.iter().map(|p| base64(p)).collect();
                *xml += &format!("{start} format=\"binary\">\n{text}\n</DataArray>\n");
            }
            Numbers::AppendedText | Numbers::AppendedRaw => {
                *xml += &format!("{start} format=\"appended\" offset=\"{}\"/>\n", appended.len());
                for part in parts {
                    let text = numbers == Numbers::AppendedText;
                    appended.extend(if text { base64(&part).into_bytes() } else { part });
                }
            }
        }
    };
    let doubles = |all: &[f32]| all.iter().map(|v| f64::from(*v)).collect::<Vec<_>>();
    let ends: Vec<f64> = lines
        .iter()
        .scan(0, |end, l| {
            Some({
                *end += l.len();
                *end as f64
            })
        })
        .collect();
    let list: Vec<f64> = (0..points.len()).map(|i| i as f64).collect();
    xml += "<PointData Scalars=\"fa\">";
    array(&mut xml, "fa", "Float32", 1, &doubles(&of_vertices(lines)));
    xml += "</PointData><CellData>";
    array(&mut xml, "bundle", "Int32", 1, &doubles(&of_lines(lines)));
    xml += "</CellData><Points>";
    array(&mut xml, "Points", "Float32", 3, &doubles(points.as_flattened()));
    xml += "</Points><Lines>";
    array(&mut xml, "connectivity", "Int64", 1, &list);
    array(&mut xml, "offsets", "Int32", 1, &ends);
    xml += "</Lines></Piece></PolyData>\n";
    let kind = if numbers == Numbers::AppendedRaw { "raw" } else { "base64" };
    let mut file = xml.into_bytes();
    if !appended.is_empty() {
        file.extend(format!("<AppendedData encoding=\"{kind}\">\n_").into_bytes());
        file.extend(appended);
        file.extend(b"\n</AppendedData>\n");
    }
    file.extend(b"</VTKFile>\n");
    file
}

fn head(numbers: &[usize], wide: bool) -> Vec<u8> {
    let one = |n: &usize| {
        if wide { (*n as u64).to_be_bytes().to_vec() } else { (*n as u32).to_le_bytes().to_vec() }
    };
    numbers.iter().flat_map(one).collect()
}

/// A header, and blocks of 24 bytes packed by zlib.
fn blocks(bytes: &[u8], wide: bool) -> Vec<Vec<u8>> {
    const BLOCK: usize = 24;
    let packed: Vec<Vec<u8>> = bytes.chunks(BLOCK).map(zlib).collect();
    let mut numbers = vec![packed.len(), BLOCK, bytes.len() % BLOCK];
    numbers.extend(packed.iter().map(Vec::len));
    vec![head(&numbers, wide), packed.concat()]
}

/// The stored blocks of RFC 1951: no packing.
fn deflate(bytes: &[u8]) -> Vec<u8> {
    let long = bytes.len() as u16;
    [&[1], &long.to_le_bytes()[..], &(!long).to_le_bytes(), bytes].concat()
}

/// RFC 1950.
fn zlib(bytes: &[u8]) -> Vec<u8> {
    let (a, b) = bytes.iter().fold((1u32, 0u32), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % 65521;
        (a, (b + a) % 65521)
    });
    [&[0x78, 0x01], &deflate(bytes)[..], &(b << 16 | a).to_be_bytes()].concat()
}

/// RFC 4648.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |part: &[u8]| {
        let bits = (0..3).fold(0u32, |bits, i| bits << 8 | u32::from(part.get(i).copied().unwrap_or(0)));
        let letter = |i: usize| LETTERS[(bits >> (18 - 6 * i) & 63) as usize] as char;
        (0..4).map(|i| if i <= part.len() { letter(i) } else { '=' }).collect::<String>()
    };
    bytes.chunks(3).map(group).collect()
}

/// A ZIP of stored files, or of files in stored blocks of deflate (PKWARE's APPNOTE 6.3).
pub fn zip(files: &[(&str, Vec<u8>)], deflated: bool) -> Vec<u8> {
    let (mut all, mut directory) = (Vec::new(), Vec::new());
    for (name, bytes) in files {
        let method = if deflated { 8u16 } else { 0 };
        let packed = if deflated { deflate(bytes) } else { bytes.clone() };
        let crc = !bytes.iter().fold(!0u32, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |c, _| (c >> 1) ^ (0xedb8_8320 * (c & 1)))
        });
        let mut common = [20u16, 0, method, 0, 0x21].map(u16::to_le_bytes).concat();
        common.extend([crc, packed.len() as u32, bytes.len() as u32].map(u32::to_le_bytes).concat());
        common.extend([name.len() as u16, 0].map(u16::to_le_bytes).concat());
        directory.extend(
            [
                b"PK\x01\x02\x14\x00",
                &common[..],
                &[0; 10],
                &(all.len() as u32).to_le_bytes(),
                name.as_bytes(),
            ]
            .concat(),
        );
        all.extend([b"PK\x03\x04", &common[..], name.as_bytes(), &packed].concat());
    }
    let (start, count) = (all.len() as u32, files.len() as u16);
    let long = directory.len() as u32;
    all.extend(directory);
    all.extend(b"PK\x05\x06\0\0\0\0");
    all.extend([count, count].map(u16::to_le_bytes).concat());
    all.extend([long, start].map(u32::to_le_bytes).concat());
    all.extend([0, 0]);
    all
}

/// A TRX of float32 with offsets of 64 bits, or of float64 with offsets of 32 bits and without the
/// last one. Line 0 is in two groups.
pub fn trx(lines: &Lines, double: bool, deflated: bool) -> Vec<u8> {
    let points = vertices(lines);
    let header = format!(
        "{{\"DIMENSIONS\": [5, 6, 7], \"VOXEL_TO_RASMM\": [], \"NB_VERTICES\": {}, \"NB_STREAMLINES\": {}}}",
        points.len(),
        lines.len()
    );
    let ends = lines.iter().scan(0, |end, l| {
        Some({
            *end += l.len();
            *end
        })
    });
    let mut offsets: Vec<usize> = std::iter::once(0).chain(ends).collect();
    let flat = points.as_flattened().iter().copied();
    let (places, marks) = match double {
        true => {
            offsets.pop();
            let marks: Vec<u8> = offsets.iter().flat_map(|o| (*o as u32).to_le_bytes()).collect();
            let places = flat.flat_map(|c| f64::from(c).to_le_bytes()).collect();
            (("positions.3.float64", places), ("offsets.uint32", marks))
        }
        false => {
            let marks: Vec<u8> = offsets.iter().flat_map(|o| (*o as u64).to_le_bytes()).collect();
            (("positions.3.float32", le(flat)), ("offsets.uint64", marks))
        }
    };
    let mut files = vec![("header.json", header.into_bytes()), marks, places];
    files.push(("dpv/fa.float32", le(of_vertices(lines))));
    files.push(("dps/bundle.uint8", of_lines(lines).iter().map(|v| *v as u8).collect()));
    if !lines.is_empty() {
        files.push(("groups/left.uint32", 0u32.to_le_bytes().to_vec()));
        let all: Vec<u8> = (0..lines.len() as u32).flat_map(u32::to_le_bytes).collect();
        files.push(("groups/whole.uint32", all));
    }
    zip(&files, deflated)
}
