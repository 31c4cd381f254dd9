//! Kits of two robots, read by programs that did not write them: ezdxf, trimesh, and LibreCAD where it can be had.

use crate::{capture, command, hydrostat, root, run};
use std::fs;

const ROBOTS: [&str; 2] = ["scr", "scr_two_section"];
/// From PyPI, pinned.
const READERS: [&str; 4] = ["ezdxf==1.4.5", "trimesh==5.2.0", "numpy==2.4.6", "pymupdf==1.28.2"];
const SCRIPT: &str = include_str!("readers.py");

/// Makes the kits into a folder of `target` and has them read.
pub(crate) fn check() -> Result<(), String> {
    let python = python()?;
    let librecad = librecad();
    let folder = root().join("target/kits");
    let program = hydrostat()?.to_string_lossy().into_owned();
    fs::create_dir_all(&folder).map_err(|error| format!("cannot make {}: {error}", folder.display()))?;
    for robot in ROBOTS {
        let kit = folder.join(robot).to_string_lossy().into_owned();
        let file = format!("robots/{robot}.toml");
        capture(&[&program, "fabricate", &file, "--out", &kit, "--force"])?;
        let mut words = vec![python.as_str(), "-c", SCRIPT, &kit];
        words.extend(librecad.then_some("librecad"));
        let output = command(&words).env("QT_QPA_PLATFORM", "offscreen").output();
        let output = output.map_err(|error| format!("cannot run {python}: {error}"))?;
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into_owned());
        }
        print!("{}", String::from_utf8_lossy(&output.stdout));
    }
    Ok(())
}

/// A Python of its own with the readers; made once.
fn python() -> Result<String, String> {
    let folder = root().join("target/readers");
    let python = folder.join("bin/python").to_string_lossy().into_owned();
    let wanted = READERS.join(" ");
    let made = folder.join("made");
    if fs::read_to_string(&made).is_ok_and(|have| have == wanted) {
        return Ok(python);
    }
    let hint = "hint: this step needs Python 3 with venv, and a network once (on Debian `apt-get install python3-venv`)";
    println!("installing {wanted} into {}", folder.display());
    let install: Vec<&str> = [&python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        .into_iter()
        .chain(READERS)
        .collect();
    run(&["python3", "-m", "venv", &folder.to_string_lossy()])
        .and_then(|()| run(&install))
        .map_err(|error| format!("{error}\n{hint}"))?;
    fs::write(&made, wanted).map_err(|error| format!("cannot write {}: {error}", made.display()))?;
    Ok(python)
}

/// Whether LibreCAD is there, or can be installed.
fn librecad() -> bool {
    let there = || capture(&["sh", "-c", "command -v librecad"]).is_ok();
    let install = ["apt-get", "install", "--yes", "--quiet", "--no-install-recommends", "librecad"];
    if there() || (capture(&install).is_ok() && there()) {
        return true;
    }
    println!("SKIPPED: LibreCAD's print is not measured, since it is not installed");
    println!("hint: on Debian `apt-get update && apt-get install librecad`");
    false
}
