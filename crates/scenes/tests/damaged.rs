//! Damaged glTF files give errors, and cost memory and time in proportion to their bytes.

use casca_scenes::import::read;
use peak_alloc::PeakAlloc;
use serde_json::{Value, json};

#[path = "../../../tests/damage/mod.rs"]
mod damage;
mod files;

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

/// Whether a file holds a scene.
fn read_all(bytes: &[u8]) -> bool {
    read("damaged", bytes, None).is_ok()
}

/// Takes away, doubles or replaces one value of a document, anywhere in it.
fn alter(value: &mut Value, next: &mut dyn FnMut() -> u64) {
    let mut below = |n: usize| (next() % n.max(1) as u64) as usize;
    let go_on = below(6) > 0;
    match value {
        Value::Object(members) if !members.is_empty() => {
            let name = members.keys().nth(below(members.len())).cloned().unwrap_or_default();
            match (go_on, members.get_mut(&name)) {
                (true, Some(member)) => alter(member, next),
                _ => _ = members.remove(&name),
            }
        }
        Value::Array(items) if !items.is_empty() => {
            let at = below(items.len());
            match (go_on, below(2)) {
                (true, _) => alter(&mut items[at], next),
                (false, 0) => _ = items.remove(at),
                (false, _) => items.insert(at, items[at].clone()),
            }
        }
        _ => {
            let others = [json!(null), json!(-1), json!(4_294_967_296_u64), json!(0.5), json!(1e300)];
            let more = [json!("x"), json!([]), json!({}), json!([[0]]), json!(true), json!(below(9))];
            *value = others.iter().chain(&more).nth(below(11)).cloned().unwrap_or_default();
        }
    }
}

// One test: another one beside it would count too.
#[test]
fn damaged_scenes_are_read_or_refused() {
    let whole = files::all();
    for file in &whole {
        let mut mended = file.clone();
        files::mend(&mut mended);
        assert_eq!(&mended, file);
        assert_eq!(read("whole", file, None).map(|world| world.objects.len()).ok(), Some(4));
    }
    let mut taken = 0;
    damage::survive(&HEAP, "scenes", &whole, 4000, &files::mend, &mut |bytes| {
        taken += usize::from(read_all(bytes));
    });
    // The second file is all text.
    let whole: Value = serde_json::from_slice(&whole[1]).unwrap();
    for case in 0..20_000 {
        let mut next = damage::numbers(case);
        let mut document = whole.clone();
        for _ in 0..=next() % 3 {
            alter(&mut document, &mut next);
        }
        let bytes = document.to_string().into_bytes();
        damage::check(&HEAP, "altered", &bytes, &mut |bytes| taken += usize::from(read_all(bytes)));
    }
    println!("{taken} were read");
    assert!(taken > 100, "{taken}");
}
