//! Programs in C and C++ against the library: built by the machine's compilers, plain and under the
//! address and undefined behaviour sanitizers, and run; where valgrind is there, under it, too.

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

/// The flags that programs of a language are built with.
fn language(source: &Path) -> (&'static str, &'static [&'static str]) {
    const WARNINGS: [&str; 5] = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];
    match source.extension().is_some_and(|e| e == "c") {
        true => ("cc", const { &["-std=c11", WARNINGS[0], WARNINGS[1], WARNINGS[2], WARNINGS[4]] }),
        false => ("c++", const { &["-std=c++17", WARNINGS[0], WARNINGS[1], WARNINGS[2], WARNINGS[4]] }),
    }
}

/// Builds and runs a program; false if there is no compiler for it, or no valgrind.
fn run(source: &Path, how: How, arguments: &[&str]) -> bool {
    let (compiler, flags) = language(source);
    if Command::new(compiler).arg("--version").output().is_err() {
        println!("skipped: no {compiler}");
        return false;
    }
    let to = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let suffix = if how == How::Sanitized { "sanitized" } else { "plain" };
    let program =
        to.join(format!("{}-{suffix}-{}", source.file_stem().unwrap().display(), std::process::id()));
    let mut build = Command::new(compiler);
    build.args(flags).args(["-g", "-O1", "-I"]).arg(here().join("include"));
    build.arg("-I").arg(here().join("tests/c"));
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
            valgrind.args(["--quiet", "--error-exitcode=9", "--leak-check=full"]).arg(&program);
            valgrind
        }
        _ => Command::new(&program),
    };
    let ran = command.args(arguments).output();
    let _ = std::fs::remove_file(&program);
    let output = match ran {
        Err(why) if how == How::Valgrind => {
            println!("skipped: no valgrind: {why}");
            return false;
        }
        other => other.unwrap(),
    };
    let [out, errors] =
        [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
    assert!(output.status.success(), "{}: {}\n{out}{errors}", source.display(), output.status);
    println!("{out}");
    true
}

fn test_source(name: &str) -> PathBuf {
    here().join("tests/c").join(name)
}

/// Runs a test program plainly and under the sanitizers, and, if asked for, under valgrind.
fn everywhere(name: &str) {
    for how in [How::Plain, How::Sanitized] {
        run(&test_source(name), how, &[]);
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
