//! Draws what this crate can draw from synthetic shapes: `cargo run -p hydrostat-report --example gallery --features png -- OUT`.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod synthetic;

use hydrostat_report::{Provenance, shape_svg, svg_to_png, verification_page};
use std::path::PathBuf;

fn main() {
    let out = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "target/gallery".into()));
    std::fs::create_dir_all(&out).unwrap();
    for (name, robot, equilibrium) in synthetic::gallery() {
        let svg = shape_svg(&robot, &equilibrium);
        std::fs::write(out.join(format!("{name}.png")), svg_to_png(&svg, 2.0).unwrap()).unwrap();
        std::fs::write(out.join(format!("{name}.svg")), svg).unwrap();
    }
    let provenance = Provenance {
        version: "0.1.0".into(),
        method: "special Cosserat rod, multiple shooting on SO(3)".into(),
        tolerance: 1e-9,
        files: vec!["robots/gray.toml".into(), "data/gray2009_table2.csv".into()],
        command: Some("hydrostat verify experiments/gray2009.toml --report page.html".into()),
        date: None,
    };
    for (name, (experiment, verification)) in synthetic::benches() {
        let page = verification_page(&experiment, &verification, &provenance);
        std::fs::write(out.join(format!("{name}.html")), page).unwrap();
    }
    println!("{}", out.display());
}
