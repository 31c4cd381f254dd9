//! How a page came about.

use hydrostat::solution::Method;
use hydrostat::statics::Settings;
use hydrostat_report::Provenance;
use std::path::PathBuf;

/// Of this run; no files stand for the built-in bench.
pub(crate) fn provenance(settings: &Settings, files: &[PathBuf]) -> Provenance {
    let arguments: Vec<String> =
        std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned()).collect();
    let method = match settings.method {
        Method::Energy => "energy method",
        Method::Shooting => "multiple shooting",
    };
    Provenance {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        method: format!("special Cosserat rod, {method}"),
        tolerance: settings.tolerance,
        files: if files.is_empty() {
            vec!["the built-in bench of Gray 2009".to_owned()]
        } else {
            files.iter().map(|file| file.to_string_lossy().into_owned()).collect()
        },
        command: Some(format!("hydrostat {}", arguments.join(" "))),
        date: None, // the same input gives the same page
    }
}
