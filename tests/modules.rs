//! The plan of the house, checked: imports inside `src` form no cycle, neither between files nor
//! between rooms (the folders and single files below `src`), no file and no member is too long, and
//! the drawing in ARCHITECTURE.md shows the imports as they are.
//!
//! `CASCA_GRAPH=write cargo test --test modules` draws it anew. Other crates are checked, too.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use syn::visit::{self, Visit};
use syn::{Attribute, ItemMod, ItemUse, UseTree, Visibility};

/// The sources whose imports and files are checked; the first one is drawn.
const ROOTS: [&str; 21] = [
    "src",
    "crates/scenes/src",
    "crates/truth/src",
    "crates/lab/src",
    "sisters/maps/src",
    "sisters/plane/src",
    "sisters/points/src",
    "sisters/lines/src",
    "sisters/fur/src",
    "sisters/light/src",
    "sisters/lightmap/src",
    "fronts/stage/src",
    "fronts/viewer/src",
    "fronts/bevy_casca/src",
    "fronts/bevy_casca_fur/src",
    "fronts/bevy_casca_light/src",
    "fronts/bake/src",
    "fronts/server/src",
    "fronts/walls/src",
    "fronts/capi/src",
    "fronts/web/src",
];

/// A longer file says at its head why: a line that starts with `//! Long because`.
const LONGEST: usize = 450;

/// The most lines of Rust in each member, with tests and comments. These numbers only go down.
const MOST: [(&str, usize); 33] = [
    ("src", 38050),
    ("tests", 10250),
    ("crates/cache", 400),
    ("crates/draco", 250),
    ("crates/lab", 6250),
    ("crates/meshopt", 450),
    ("crates/scenes", 8250),
    ("crates/slots", 650),
    ("crates/tools", 1200),
    ("crates/truth", 8700),
    ("sisters/fur", 8500),
    ("sisters/images", 250),
    ("sisters/light", 9250),
    ("sisters/lightmap", 1750),
    ("sisters/lines", 8750),
    ("sisters/lit", 550),
    ("sisters/maps", 2800),
    ("sisters/plane", 8100),
    ("sisters/points", 8750),
    ("fronts/bake", 2250),
    ("fronts/baked", 1150),
    ("fronts/bevy_casca", 6850),
    ("fronts/bevy_casca_fur", 1700),
    ("fronts/bevy_casca_light", 1450),
    ("fronts/capi", 4100),
    ("fronts/casca", 1600),
    ("fronts/page", 250),
    ("fronts/python", 1850),
    ("fronts/server", 4650),
    ("fronts/stage", 2150),
    ("fronts/viewer", 7400),
    ("fronts/walls", 1250),
    ("fronts/web", 700),
];

/// A limit may be this far above what is there.
const SLACK: usize = 300;

/// The drawing stands between these lines of ARCHITECTURE.md.
const FENCE: [&str; 2] = ["```mermaid\n", "```\n"];

/// A path of module names below the crate's root; the root itself is empty.
type Module = Vec<String>;

/// What one file imports.
#[derive(Default)]
struct File {
    /// Paths in private imports and in code: absolute, from the crate's root.
    paths: Vec<Vec<String>>,
    /// Names that it passes on (`pub use`), and the paths that they stand for.
    exports: BTreeMap<String, Vec<String>>,
}

/// Walks over the items of one file.
struct Reader<'a> {
    module: &'a Module,
    modules: &'a BTreeSet<Module>,
    file: File,
}

impl Reader<'_> {
    /// A path as seen from the crate's root; `None` if it leads to another crate.
    fn absolute(&self, path: &[String]) -> Option<Vec<String>> {
        let mut from = self.module.clone();
        let mut rest = path;
        match rest.first()?.as_str() {
            "crate" => (from, rest) = (Module::new(), &rest[1..]),
            "self" => rest = &rest[1..],
            "super" => {
                while rest.first().is_some_and(|s| s == "super") {
                    from.pop();
                    rest = &rest[1..];
                }
            }
            first => {
                let child = [from.clone(), vec![first.to_owned()]].concat();
                if !self.modules.contains(&child) {
                    return None;
                }
            }
        }
        from.extend_from_slice(rest);
        Some(from)
    }

    fn import(&mut self, tree: &UseTree, mut path: Vec<String>, exported: bool) {
        let (name, last) = match tree {
            UseTree::Path(p) => {
                path.push(p.ident.to_string());
                return self.import(&p.tree, path, exported);
            }
            UseTree::Group(g) => {
                return g.items.iter().for_each(|t| self.import(t, path.clone(), exported));
            }
            UseTree::Glob(_) => ("*".to_owned(), None),
            UseTree::Name(n) => (n.ident.to_string(), Some(n.ident.to_string())),
            UseTree::Rename(r) => (r.rename.to_string(), Some(r.ident.to_string())),
        };
        path.extend(last.filter(|l| l != "self"));
        let Some(path) = self.absolute(&path) else { return };
        if exported {
            self.file.exports.insert(name, path);
        } else {
            self.file.paths.push(path);
        }
    }
}

fn is_for_tests(attributes: &[Attribute]) -> bool {
    let test = |a: &Attribute| {
        let list = a.meta.require_list().map(|l| l.tokens.to_string());
        a.path().is_ident("cfg") && list.is_ok_and(|l| l == "test" || l == "doctest")
    };
    attributes.iter().any(test)
}

impl<'ast> Visit<'ast> for Reader<'_> {
    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        if !is_for_tests(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        if !is_for_tests(&item.attrs) {
            self.import(&item.tree, Vec::new(), !matches!(item.vis, Visibility::Inherited));
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Vec<String> = path.segments.iter().map(|s| s.ident.to_string()).collect();
        if names.len() > 1 {
            self.file.paths.extend(self.absolute(&names));
        }
        visit::visit_path(self, path);
    }
}

/// All source files below a folder, with the names of their modules.
fn sources(folder: &Path, module: &Module, out: &mut BTreeMap<Module, PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let child = [module.clone(), vec![stem.clone()]].concat();
        // `tests` belongs to the tests, as a `mod tests` inside a file does. Each program in `bin` is a crate of its own.
        if stem == "tests" || stem == "bin" {
            continue;
        }
        if path.is_dir() {
            sources(&path, &child, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            match stem.as_str() {
                "lib" | "mod" => out.insert(module.clone(), path),
                // The root of a program without a library.
                "main" if !folder.join("lib.rs").exists() => out.insert(module.clone(), path),
                _ => out.insert(child, path),
            };
        }
    }
}

/// The module that defines the end of a path, through the names that modules pass on.
fn defining(path: &[String], files: &BTreeMap<Module, File>) -> Module {
    let mut path = path.to_vec();
    // A chain of names that are passed on is no longer than the tree is deep.
    for _ in 0..16 {
        let length = (0..=path.len()).rev().find(|&n| files.contains_key(&path[..n])).unwrap();
        let passed_on = path.get(length).and_then(|name| files[&path[..length]].exports.get(name));
        match passed_on {
            Some(target) => path = [target.as_slice(), &path[length + 1..]].concat(),
            None => return path[..length].to_vec(),
        }
    }
    panic!("{} is passed on in a circle", path.join("::"))
}

type Graph = BTreeMap<String, BTreeSet<String>>;

/// The imports between files, or between rooms.
fn graph(files: &BTreeMap<Module, File>, name: impl Fn(&Module) -> String) -> Graph {
    let mut graph = Graph::new();
    for (module, file) in files {
        let from = name(module);
        let targets = graph.entry(from.clone()).or_default();
        let imported = file.paths.iter().map(|path| name(&defining(path, files)));
        targets.extend(imported.filter(|to| *to != from));
    }
    graph
}

/// A cycle, as the names along it.
fn cycle(graph: &Graph) -> Option<Vec<String>> {
    fn visit<'a>(
        at: &'a str,
        graph: &'a Graph,
        way: &mut Vec<&'a str>,
        done: &mut BTreeSet<&'a str>,
    ) -> bool {
        if way.contains(&at) {
            way.drain(..way.iter().position(|w| *w == at).unwrap());
            return true;
        }
        if !done.insert(at) {
            return false;
        }
        way.push(at);
        if graph.get(at).is_some_and(|next| next.iter().any(|n| visit(n, graph, way, done))) {
            return true;
        }
        way.pop();
        false
    }
    let mut done = BTreeSet::new();
    graph.keys().find_map(|start| {
        let mut way = Vec::new();
        visit(start, graph, &mut way, &mut done).then(|| way.into_iter().map(str::to_owned).collect())
    })
}

/// The imports that no longer way implies: those are enough for a drawing.
fn reduced(graph: &Graph) -> Graph {
    fn reaches(from: &str, to: &str, graph: &Graph) -> bool {
        from == to || graph[from].iter().any(|next| reaches(next, to, graph))
    }
    let direct = |from: &String, to: &String| {
        !graph[from].iter().any(|other| other != to && reaches(other, to, graph))
    };
    graph
        .iter()
        .map(|(from, to)| (from.clone(), to.iter().filter(|t| direct(from, t)).cloned().collect()))
        .collect()
}

fn drawing(rooms: &Graph) -> String {
    let mut text = String::from("flowchart TD\n");
    for (from, targets) in reduced(rooms) {
        for to in targets {
            text += &format!("    {from} --> {to}\n");
        }
    }
    text
}

fn read(root: &str) -> (BTreeMap<Module, PathBuf>, BTreeMap<Module, File>) {
    let mut paths = BTreeMap::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join(root), &Module::new(), &mut paths);
    let modules: BTreeSet<Module> = paths.keys().cloned().collect();
    let read = |(module, path): (&Module, &PathBuf)| {
        let syntax = syn::parse_file(&fs::read_to_string(path).unwrap()).unwrap();
        let mut reader = Reader { module, modules: &modules, file: File::default() };
        reader.visit_file(&syntax);
        (module.clone(), reader.file)
    };
    let files = paths.iter().map(read).collect();
    (paths, files)
}

/// The room of a module: the first name below the root.
fn room(module: &Module) -> String {
    module.first().cloned().unwrap_or_else(|| "lib".to_owned())
}

#[test]
fn imports_form_no_cycle() {
    let mut cycles = Vec::new();
    for root in ROOTS {
        let (_, files) = read(root);
        assert!(!files.is_empty(), "no file was found in {root}");
        let file = |module: &Module| if module.is_empty() { "lib".to_owned() } else { module.join("::") };
        let [by_file, by_room] = [graph(&files, file), graph(&files, room)];
        assert!(
            by_file.values().map(BTreeSet::len).sum::<usize>() > 5,
            "hardly an import was found in {root}"
        );
        for graph in [by_file, by_room] {
            cycles.extend(cycle(&graph).map(|way| format!("{root}: {}", way.join(" -> "))));
        }
    }
    assert!(cycles.is_empty(), "cycles of imports: {cycles:#?}");
}

#[test]
fn a_cycle_is_found() {
    let edges = [("a", "b"), ("b", "c"), ("c", "d"), ("d", "b"), ("a", "d")];
    let mut graph = Graph::new();
    for (from, to) in edges {
        graph.entry(from.to_owned()).or_default().insert(to.to_owned());
    }
    let mut found = cycle(&graph).unwrap();
    found.sort();
    assert_eq!(found, ["b", "c", "d"]);
    graph.get_mut("d").unwrap().clear();
    assert_eq!(cycle(&graph), None);
    // The way over b and c says that a imports d as well.
    assert_eq!(drawing(&graph), "flowchart TD\n    a --> b\n    b --> c\n    c --> d\n");
}

#[test]
fn files_are_short() {
    let mut long = Vec::new();
    for path in ROOTS.into_iter().flat_map(|root| read(root).0.into_values()) {
        let text = fs::read_to_string(&path).unwrap();
        let lines = text.lines().count();
        let reason = text.lines().take(40).any(|l| l.starts_with("//! Long because"));
        if lines > LONGEST && !reason {
            long.push(format!("{} has {lines} lines", path.display()));
        }
    }
    assert!(long.is_empty(), "files without a reason for their length: {long:#?}");
}

#[test]
fn the_drawing_shows_the_imports() {
    let (_, files) = read(ROOTS[0]);
    let mut rooms = graph(&files, room);
    rooms.remove("lib");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("ARCHITECTURE.md");
    let text = fs::read_to_string(&path).unwrap();
    let (before, rest) = text.split_once(FENCE[0]).expect("ARCHITECTURE.md has a drawing");
    let (drawn, after) = rest.split_once(FENCE[1]).unwrap();
    let actual = drawing(&rooms);
    if std::env::var("CASCA_GRAPH").is_ok_and(|v| v == "write") {
        fs::write(&path, [before, FENCE[0], &actual, FENCE[1], after].concat()).unwrap();
    } else {
        assert_eq!(drawn, actual, "CASCA_GRAPH=write cargo test --test modules draws it anew");
    }
}

/// The lines of Rust in a folder, without folders of builds.
fn lines(folder: &Path) -> usize {
    let mut sum = 0;
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() && !path.ends_with("target") {
            sum += lines(&path);
        } else if path.extension().is_some_and(|e| e == "rs") {
            sum += fs::read_to_string(&path).unwrap().lines().count();
        }
    }
    sum
}

/// Each member is at most as long as it was: whoever needs more room takes something out. A limit
/// that is far above what is there is to be lowered.
#[test]
fn members_do_not_grow() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut wrong = Vec::new();
    for (member, most) in MOST {
        let lines = lines(&here.join(member));
        if lines > most || lines + SLACK < most {
            wrong.push(format!("{member} has {lines} lines, and {most} is its limit"));
        }
    }
    let listed: BTreeSet<&str> = MOST.iter().map(|(member, _)| *member).collect();
    for folder in ["crates", "sisters", "fronts"] {
        for entry in fs::read_dir(here.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(here).unwrap().to_str().unwrap().to_owned();
            if path.join("Cargo.toml").exists() && !listed.contains(name.as_str()) {
                wrong.push(format!("{name} has no limit"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
