//! The `hydrostat` command: flags and glue around the core.

fn main() {}
