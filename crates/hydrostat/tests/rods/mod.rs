//! Rods along x under gravity along -y, and benches of files that stand in the test.

use hydrostat::Error;

/// A rod of `wire`; name, length and diameter of every section.
pub(crate) fn rod(youngs_modulus: &str, sections: &[[&str; 3]]) -> String {
    let sections = sections.iter().map(|[name, length, diameter]| {
        format!("[[section]]\nname = \"{name}\"\nlength = \"{length}\"\nmaterial = \"wire\"\nprofile = {{ diameter = \"{diameter}\" }}\n")
    });
    format!(
        "name = \"rod\"\ngravity = \"[0, -9.81, 0] m/s^2\"\n[base]\ntangent = [1, 0, 0]\nnormal = [0, 1, 0]\n[material.wire]\n\
         youngs_modulus = \"{youngs_modulus}\"\npoisson_ratio = 0.3\ndensity = \"6.5 g/cm^3\"\n{}",
        sections.collect::<String>()
    )
}

/// Fetches the robot or the table, `data.csv`.
pub(crate) fn files(robot: String, data: &str) -> impl FnMut(&str) -> Result<String, Error> {
    let data = data.to_owned();
    move |path| Ok(if path == "data.csv" { data.clone() } else { robot.clone() })
}
