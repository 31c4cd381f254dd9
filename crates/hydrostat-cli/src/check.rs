//! `hydrostat check`: can this robot be built, and will it work?

use crate::{End, Outcome, files, warn};
use hydrostat::fabricate::{self, DesignCheck, Verdict, Workshop};
use hydrostat::{Error, Robot, description};
use std::fmt::Write;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Robot file, with a table [fabrication] for what differs from the defaults
    robot: PathBuf,
}

pub(crate) fn run(args: &Args) -> Result<Outcome, Error> {
    let (robot, workshop) = read(&args.robot)?;
    let checks = fabricate::check(&robot, &workshop)?;
    let passed = checks.iter().all(|check| check.verdict != Verdict::Impossible);
    let stdout = format!("{}\n{}", in_words(&checks), defaults(&workshop));
    Ok(Outcome { stdout, end: End::passed(passed) })
}

pub(crate) fn read(path: &Path) -> Result<(Robot, Workshop), Error> {
    let parsed = description::parse_workshop(&files::read_text(path)?, &path.to_string_lossy())?;
    warn(&parsed.warnings);
    Ok(parsed.value)
}

/// One line per check, and what to try below those that are not good.
pub(crate) fn in_words(checks: &[DesignCheck]) -> String {
    let mut text = String::new();
    for check in checks {
        let mark = match check.verdict {
            Verdict::Good => "good",
            Verdict::Doubtful => "LOOK",
            Verdict::Impossible => "FAILS",
        };
        let _ = writeln!(text, "{mark:<5}  {:<17} {}", check.name, check.says);
        if let Some(hint) = check.hint {
            let _ = writeln!(text, "{:25}hint: {hint}", "");
        }
    }
    text
}

/// The settings that the file leaves to their defaults.
pub(crate) fn defaults(workshop: &Workshop) -> String {
    let mut text = String::from("taken by default, to be set under [fabrication]:\n");
    for setting in workshop.settings().into_iter().filter(|setting| setting.default) {
        let _ = writeln!(text, "  {:<16} {}", setting.key, setting.value);
    }
    text
}
