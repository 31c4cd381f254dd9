//! Project tasks: `cargo xtask test` does all set-up and runs every check.

fn main() {}
