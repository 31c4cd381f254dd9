//! Drives the real program as a user does.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]
#![allow(clippy::print_stdout, reason = "a skipped test says so")]

mod batch;
mod budget;
mod calibrate;
mod fabricate;
mod new;
mod outputs;
mod readme;
mod refusals;
mod solve;
mod validate;
mod verify;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A rod of which every test changes one thing.
const ROD: &str = r#"
name = "rod"
gravity = "[0, -9.81, 0] m/s^2"

[base]
tangent = [1, 0, 0]
normal = [0, 1, 0]

[material.niti]
youngs_modulus = "54 GPa"
poisson_ratio = 0.33
density = "6.45 g/cm^3"
strain_limit = "1 %"

[[section]]
name = "rod"
length = "390 mm"
material = "niti"
profile = { diameter = "1.56 mm" }

[[load]]
at = "tip"
mass = "20 g"
"#;

/// A folder of its own, gone at the end of the test.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Folder {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn with(test: &str, name: &str, text: impl AsRef<[u8]>) -> Folder {
        let folder = Folder::new(test);
        fs::write(folder.0.join(name), text).unwrap();
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).unwrap();
        let mut names: Vec<_> =
            entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Names and what is in them.
    fn contents(&self) -> Vec<(String, Vec<u8>)> {
        self.files().into_iter().map(|name| (name.clone(), fs::read(self.path(&name)).unwrap())).collect()
    }

    fn run(&self, arguments: &str) -> Run {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hydrostat"));
        let output = command.args(arguments.split_whitespace()).current_dir(&self.0).output().unwrap();
        Run {
            code: output.status.code().expect("the program ends by itself"),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// How the program ended and what it printed.
#[derive(Debug)]
struct Run {
    code: i32,
    stdout: String,
    stderr: String,
}

impl Run {
    /// Exit code 0, nothing on stderr.
    #[track_caller]
    fn succeeds(self) -> String {
        assert_eq!((self.code, self.stderr.as_str()), (0, ""), "{self:?}");
        self.stdout
    }

    /// Exit code 2, `error:` with all these words on stderr, nothing on stdout.
    #[track_caller]
    fn refuses(self, words: &[&str]) {
        assert_eq!((self.code, self.stdout.as_str()), (2, ""), "{self:?}");
        assert!(self.stderr.starts_with("error: "), "{}", self.stderr);
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        for word in words {
            assert!(self.stderr.contains(word), "expected {word:?} in:\n{}", self.stderr);
        }
    }
}

#[track_caller]
fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

/// The keys of an object, in their order.
#[track_caller]
fn keys(value: &serde_json::Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}
