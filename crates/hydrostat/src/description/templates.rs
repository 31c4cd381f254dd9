//! First files for `hydrostat new`: commented, complete, ready to be edited.

/// A file to write: its name and its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    pub name: String,
    pub text: String,
}

/// The robot file of a clamped rod with a hung mass.
pub fn rod(name: &str) -> File {
    file(name, ".toml", include_str!("templates/rod.toml"))
}

/// The robot file of a rod with three tendons.
pub fn tendon(name: &str) -> File {
    file(name, ".toml", include_str!("templates/tendon.toml"))
}

/// A bench with mount angles of 0, 30 and 60 degrees: experiment, data and the rod that they are about.
pub fn bench(name: &str) -> [File; 3] {
    let rod = include_str!("templates/rod.toml");
    let unloaded = rod.split("\n[[load]]").next().unwrap_or(rod); // the bench hangs the masses
    [
        file(name, ".toml", include_str!("templates/bench.toml")),
        file(name, ".csv", include_str!("templates/bench.csv")),
        file(name, "_rod.toml", unloaded),
    ]
}

/// Characters that TOML or a file name could trip over become `_`.
fn file(name: &str, ending: &str, template: &str) -> File {
    let safe = |c: char| {
        if c.is_control() || "\"\\/:*?<>|".contains(c) { '_' } else { c }
    };
    let name: String = name.chars().map(safe).collect();
    File { text: template.replace("NAME", &name), name: name + ending }
}
