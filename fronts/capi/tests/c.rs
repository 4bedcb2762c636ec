//! Programs in C and C++ against the library: built by the machine's compilers, plain and under the
//! address and undefined behaviour sanitizers, and run; with `CASCA_HEAVY=1` under valgrind, too.

use std::path::{Path, PathBuf};
use std::process::Command;

/// How a program is built and run.
#[derive(Clone, Copy, PartialEq)]
enum How {
    Plain,
    Sanitized,
    Valgrind,
}

fn here() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folder where the test programs and the static library are built.
fn built() -> PathBuf {
    std::env::current_exe().unwrap().parent().unwrap().to_owned()
}

/// Builds and runs a program, and gives its output; nothing if there is no compiler for it, or no valgrind.
fn run(source: &Path, how: How) -> Option<String> {
    let is_c = source.extension().is_some_and(|e| e == "c");
    let (compiler, standard) = if is_c { ("cc", "-std=c11") } else { ("c++", "-std=c++17") };
    if Command::new(compiler).arg("--version").output().is_err() {
        println!("skipped: no {compiler}");
        return None;
    }
    let to = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let suffix = if how == How::Sanitized { "sanitized" } else { "plain" };
    let program =
        to.join(format!("{}-{suffix}-{}", source.file_stem().unwrap().display(), std::process::id()));
    let mut build = Command::new(compiler);
    build
        .args([standard, "-Wall", "-Wextra", "-Wpedantic", "-Werror"])
        .args(["-g", "-O1", "-I"])
        .arg(here().join("include"));
    build.arg("-I").arg(here().join("tests/c"));
    if let Some(folder) = std::env::var_os("CASCA_GODOT_INCLUDE") {
        build.arg("-isystem").arg(folder);
    }
    if how == How::Sanitized {
        build.args(["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]);
    }
    build.arg(source).arg(built().join("libcasca_c.a"));
    build.args(["-lpthread", "-ldl", "-lm", "-o"]).arg(&program);
    let output = build.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut command = match how {
        How::Valgrind => {
            let mut valgrind = Command::new("valgrind");
            valgrind.args(["--quiet", "--error-exitcode=9", "--leak-check=full"]);
            // The threads of rayon's own pool live until the program ends.
            valgrind.args(["--errors-for-leak-kinds=definite", "--show-leak-kinds=definite"]).arg(&program);
            valgrind
        }
        _ => Command::new(&program),
    };
    let ran = command.output();
    let _ = std::fs::remove_file(&program);
    let output = match ran {
        Err(why) if how == How::Valgrind => {
            println!("skipped: no valgrind: {why}");
            return None;
        }
        other => other.unwrap(),
    };
    let [out, errors] =
        [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
    assert!(output.status.success(), "{}: {}\n{out}{errors}", source.display(), output.status);
    println!("{out}");
    Some(out)
}

fn test_source(name: &str) -> PathBuf {
    here().join("tests/c").join(name)
}

/// Runs a test program under the sanitizers, and with `CASCA_HEAVY=1` also plainly and under
/// valgrind, which takes long to read the library's debug information.
fn everywhere(name: &str) {
    run(&test_source(name), How::Sanitized);
    if std::env::var("CASCA_HEAVY").is_ok_and(|heavy| heavy == "1") {
        run(&test_source(name), How::Plain);
        run(&test_source(name), How::Valgrind);
    }
}

#[test]
fn all_functions_do_what_their_comments_say() {
    everywhere("all.c");
    let header = std::fs::read_to_string(here().join("include/casca.h")).unwrap();
    let program =
        ["all.c", "check.h"].map(|name| std::fs::read_to_string(test_source(name)).unwrap()).concat();
    let declared = header.lines().filter_map(|line| {
        let name = line.split('(').next()?.rsplit([' ', '*']).next()?;
        (line.contains('(') && !line.starts_with([' ', '/', '#', 't']) && name.starts_with("casca_"))
            .then_some(name)
    });
    let declared: Vec<&str> = declared.collect();
    assert!(declared.len() > 60, "{declared:?}");
    let missing: Vec<_> = declared.iter().filter(|name| !program.contains(&format!("{name}("))).collect();
    assert!(missing.is_empty(), "functions that all.c does not call: {missing:?}");
}

#[test]
fn bad_input_is_refused() {
    everywhere("bad_input.c");
}

#[test]
fn the_wrapper_works() {
    everywhere("wrapper.cpp");
}

#[test]
fn threads_share_scenes() {
    everywhere("threads.cpp");
}

/// The program in the chapter at the head of the header, without its indentation.
#[test]
fn the_program_of_the_manual_runs() {
    let header = std::fs::read_to_string(here().join("include/casca.h")).unwrap();
    let (_, from) = header.split_once("A FIRST QUERY\n").unwrap();
    let (program, _) = from.split_once("CONVENTIONS").unwrap();
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("manual.c");
    std::fs::write(&path, program).unwrap();
    if let Some(out) = run(&path, How::Sanitized) {
        assert_eq!(out, "1 object in sight, and it is the wall: 1\n");
    }
}

#[test]
fn the_examples_run() {
    let example = |name: &str| run(&here().join("examples").join(name), How::Sanitized);
    if let Some(out) = example("first_query.c") {
        let lines: Vec<&str> = out.lines().collect();
        assert_eq!(lines.len(), 4, "{out}");
        assert!(lines[0].ends_with("in sight: wall") && lines[3].contains("bird"), "{out}");
    }
    if let Some(out) = example("jobs.cpp") {
        assert_eq!(out.lines().filter(|line| line.starts_with("frame ")).count(), 10, "{out}");
    }
}

/// The files that say the version say the same one.
#[test]
fn versions_agree() {
    let version = env!("CARGO_PKG_VERSION");
    let files = ["cmake/cascaConfigVersion.cmake", "cmake/casca.pc.in"];
    let read = |file: &str| std::fs::read_to_string(here().join(file)).unwrap();
    assert!(files.iter().all(|file| read(file).contains(version)));
    let numbers: Vec<u32> = version.split('.').map(|part| part.parse().unwrap()).collect();
    let packed = 10_000 * numbers[0] + 100 * numbers[1] + numbers[2];
    assert!(read("include/casca.h").contains(&format!("#define CASCA_VERSION {packed}\n")));
}

/// Calls the extension for Godot as the engine does. Godot's header is no part of this repository:
/// `CASCA_GODOT_INCLUDE` names its folder.
#[test]
fn the_extension_for_godot_answers() {
    if std::env::var_os("CASCA_GODOT_INCLUDE").is_none() {
        println!("skipped: CASCA_GODOT_INCLUDE names no folder");
        return;
    }
    run(&test_source("godot_host.cpp"), How::Sanitized);
}
