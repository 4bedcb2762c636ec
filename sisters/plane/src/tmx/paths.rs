//! Paths that files name.

/// The folder of a file.
pub(super) fn folder(path: &str) -> &str {
    path.rsplit_once('/').map_or("", |(folder, _)| folder)
}

/// A path that counts from a folder, without steps back as far as there are folders for them.
pub(super) fn joined(folder: &str, path: &str) -> String {
    if folder.is_empty() || path.starts_with('/') {
        return path.to_owned();
    }
    let mut steps: Vec<&str> = folder.split('/').collect();
    for step in path.split('/') {
        match step {
            "." => {}
            ".." if steps.last().is_some_and(|last| !last.is_empty() && *last != "..") => _ = steps.pop(),
            _ => steps.push(step),
        }
    }
    steps.join("/")
}

#[cfg(test)]
mod tests {
    use super::joined;

    #[test]
    fn paths_count_from_the_folder() {
        for (folder, path, all) in [
            ("", "t.tsx", "t.tsx"),
            ("", "../t.tsx", "../t.tsx"),
            ("parts", "t.tsx", "parts/t.tsx"),
            ("parts", "../t.tsx", "t.tsx"),
            ("parts/trees", "../../sets/./t.tsx", "sets/t.tsx"),
            ("..", "../t.tsx", "../../t.tsx"),
            ("/maps", "../t.tsx", "/t.tsx"),
            ("/maps", "../../t.tsx", "/../t.tsx"),
            ("parts", "/t.tsx", "/t.tsx"),
        ] {
            assert_eq!(joined(folder, path), all, "{folder} {path}");
        }
    }
}
