//! What of a file is left out or taken otherwise than its author may expect.

use std::cell::RefCell;

/// Warnings while a file is read. The same about many places is one line.
#[derive(Debug, Default)]
pub struct Warnings(RefCell<Vec<Warning>>);

#[derive(Debug)]
struct Warning {
    first: String,
    what: String,
    others: usize,
}

impl Warnings {
    /// Says what is so at a place of the file, such as `node 3 ("hero")`.
    pub fn add(&self, place: String, what: &str) {
        let mut all = self.0.borrow_mut();
        match all.iter_mut().find(|w| w.what == what) {
            Some(known) => known.others += 1,
            None => all.push(Warning { first: place, what: what.to_owned(), others: 0 }),
        }
    }

    /// A line for each thing said, such as `node 3 ("hero") and 2 more: ...`, in the order of the
    /// file.
    pub fn lines(&self) -> Vec<String> {
        let line = |w: &Warning| match w.others {
            0 => format!("{}: {}", w.first, w.what),
            n => format!("{} and {n} more: {}", w.first, w.what),
        };
        self.0.borrow().iter().map(line).collect()
    }
}

/// How a node is named in warnings.
pub(super) fn node_name(node: &gltf::Node) -> String {
    format!("node {} ({:?})", node.index(), node.name().unwrap_or(""))
}
