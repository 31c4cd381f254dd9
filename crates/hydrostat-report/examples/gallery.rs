//! Draws what this crate can draw from synthetic shapes: `cargo run -p hydrostat-report --example gallery --features png -- OUT`.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod synthetic;

use hydrostat_report::{shape_svg, svg_to_png};
use std::path::PathBuf;

fn main() {
    let out = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "target/gallery".into()));
    std::fs::create_dir_all(&out).unwrap();
    for (name, robot, equilibrium) in synthetic::gallery() {
        let svg = shape_svg(&robot, &equilibrium);
        std::fs::write(out.join(format!("{name}.png")), svg_to_png(&svg, 2.0).unwrap()).unwrap();
        std::fs::write(out.join(format!("{name}.svg")), svg).unwrap();
    }
    println!("{}", out.display());
}
