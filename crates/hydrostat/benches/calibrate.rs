//! Time of a fit of the thesis's bench on all cores: `cargo bench -p hydrostat --bench calibrate`.

use divan::{Bencher, black_box};
use hydrostat::calibrate::calibrate;
use hydrostat::description::{CalibrationFlags, builtin};
use hydrostat::statics::Settings;

fn main() {
    divan::main();
}

/// As the command line solves it: error of a solution over the length, or finer where the reading error asks for it.
const TOLERANCE: f64 = 1e-6;

#[divan::bench(args = ["youngs_modulus", "youngs_modulus,length", "youngs_modulus,length,density,mount_angle"])]
fn gray(bencher: Bencher, free: &str) {
    let flags = CalibrationFlags { free: vec![free.to_owned()], ..CalibrationFlags::default() };
    let problem = builtin::calibration(&flags).expect("is valid").value;
    let settings = Settings { tolerance: TOLERANCE, ..Settings::default() };
    bencher.bench_local(|| calibrate(black_box(&problem), &settings).expect("fits"));
}
