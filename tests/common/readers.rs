//! Programs that others wrote, which read what is exported. Where one is missing the test says what
//! it skips: `.ci/readers` installs the small ones.

use std::{path::Path, process::Command};

/// Runs `tests/readers/SCRIPT` with a Python that has `module`; gives what it told, or says
/// what is skipped and gives nothing. `NEPHOS_PYTHON` names another Python to try first.
pub fn python(module: &str, script: &str, words: &[&str]) -> Option<String> {
    let own = std::env::var("NEPHOS_PYTHON").ok();
    let pythons = own.as_deref().into_iter().chain(["/usr/bin/python3", "python3"]);
    let has = |python: &&str| {
        let asked = Command::new(python).args(["-c", &format!("import {module}")]).output();
        asked.is_ok_and(|output| output.status.success())
    };
    let Some(python) = pythons.into_iter().find(has) else {
        eprintln!("skipped: no Python here has `{module}`, so that {script} could not read what was written");
        return None;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/readers").join(script);
    Some(run(Command::new(python).arg(script).args(words)))
}

/// Runs a program with these words; gives what it told, or says that it is skipped.
pub fn program(name: &str, words: &[&str]) -> Option<String> {
    if Command::new(name).arg("--version").output().is_err() && Command::new(name).output().is_err() {
        eprintln!("skipped: there is no `{name}` here to read what was written");
        return None;
    }
    Some(run(Command::new(name).args(words)))
}

fn run(command: &mut Command) -> String {
    let output = command.output().expect("the reader starts");
    let (told, complaint) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{command:?}:\n{told}\n{complaint}");
    told.into_owned()
}

/// Runs Node with these words where it finds `module`, in the folders of `NODE_PATH` or in
/// `target/readers`; gives what it told, or says that it is skipped.
pub fn node(module: &str, words: &[&str]) -> Option<String> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/readers/node_modules");
    let path = std::env::var("NODE_PATH").unwrap_or_else(|_| own.to_string_lossy().into_owned());
    let mut asked = Command::new("node");
    asked.env("NODE_PATH", &path).args(["-e", &format!("require('{module}')")]);
    if !asked.output().is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: there is no Node with `{module}` here to read what was written");
        return None;
    }
    Some(run(Command::new("node").env("NODE_PATH", &path).args(words)))
}
