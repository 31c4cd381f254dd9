//! Stand-ins for what other parts bring; at the merge their callers are pointed at the real ones and this file goes.

#![allow(unused_variables, reason = "the stand-ins ignore what they are given")]

use hydrostat::validate::Case;
use hydrostat::verify::{Experiment, Verification};
use hydrostat::{Equilibrium, Error, Robot};

/// `hydrostat::description::Parsed`.
pub(crate) struct Parsed<T> {
    pub(crate) value: T,
    pub(crate) warnings: Vec<String>,
}

/// Gives the text of a file that a description names.
pub(crate) type Load<'a> = dyn FnMut(&str) -> Result<String, Error> + 'a;

/// `hydrostat::description::parse_robot`.
pub(crate) fn parse_robot(text: &str, file: &str) -> Result<Parsed<Robot>, Error> {
    Err(missing("description"))
}

/// `hydrostat::description::parse_experiment`.
pub(crate) fn parse_experiment(text: &str, file: &str, load: &mut Load) -> Result<Parsed<Experiment>, Error> {
    Err(missing("description"))
}

/// `hydrostat::description::builtin::experiment`.
pub(crate) fn built_in_experiment() -> Result<Parsed<Experiment>, Error> {
    Err(missing("description"))
}

/// Files of a starter rod: name and text.
pub(crate) fn rod_template(name: &str) -> Vec<(String, String)> {
    vec![(format!("{name}.toml"), format!("name = \"{name}\"\n"))]
}

/// Files of a starter bench: name and text.
pub(crate) fn bench_template(name: &str) -> Vec<(String, String)> {
    vec![
        (format!("{name}.toml"), format!("name = \"{name}\"\n")),
        (format!("{name}.csv"), "mass [g],x [mm],y [mm]\n".to_owned()),
    ]
}

/// `hydrostat::validate::run`; without a Result.
pub(crate) fn validate(sorosim_csv: Option<&str>) -> Result<Vec<Case>, Error> {
    Err(missing("validate"))
}

/// `hydrostat::validate::markdown`.
pub(crate) fn markdown(cases: &[Case]) -> String {
    String::new()
}

/// The cases of `hydrostat::validate::robustness::sweep`.
pub(crate) fn sweep(count: usize, seed: u64) -> Vec<Case> {
    Vec::new()
}

/// `Case::ours`.
pub(crate) fn ours(case: &Case) -> Result<f64, String> {
    Ok(case.ours)
}

/// `Case::difference`.
pub(crate) fn difference(case: &Case) -> f64 {
    case.ours - case.reference
}

/// `hydrostat_report::Provenance`.
#[allow(dead_code, reason = "the stand-in reads nothing")]
pub(crate) struct Provenance {
    pub(crate) version: String,
    pub(crate) method: String,
    pub(crate) tolerance: f64,
    pub(crate) files: Vec<String>,
    pub(crate) command: Option<String>,
    pub(crate) date: Option<String>,
}

/// `hydrostat_report::shape_svg`.
pub(crate) fn shape_svg(robot: &Robot, shape: &Equilibrium) -> String {
    String::new()
}

/// `hydrostat_report::svg_to_png`.
#[cfg(feature = "png")]
pub(crate) fn svg_to_png(svg: &str, scale: f32) -> Result<Vec<u8>, Error> {
    Err(missing("report"))
}

/// `hydrostat_report::verification_page`.
pub(crate) fn verification_page(
    experiment: &Experiment,
    verification: &Verification,
    provenance: &Provenance,
) -> String {
    String::new()
}

fn missing(part: &str) -> Error {
    Error::new(format!("not merged yet: {part}"))
}
