use hydrostat::{Robot, model::*, statics::*};
use nalgebra::*;
use std::f64::consts::PI;
pub fn gray(mass: f64, weight: f64) -> Robot {
    let d: f64 = 1.56e-3;
    let area = PI / 4.0 * d * d;
    Robot {
        name: "gray".into(),
        gravity: Vector3::new(0.0, -9.81, 0.0),
        base: Pose { position: Vector3::zeros(), rotation: Rotation3::from_matrix_unchecked(Matrix3::new(0.,0.,1., 1.,0.,0., 0.,1.,0.)) },
        sections: vec![Section { name: "rod".into(), length: 0.39,
            material: Material { name: "n".into(), youngs_modulus: 54e9, shear_modulus: 54e9 / 2.66, density: weight / 9.81 / area, strain_limit: Some(0.01) },
            profile: Profile { base: CrossSection::Round { diameter: d }, tip: CrossSection::Round { diameter: d }, shear_coefficient: 1.0 },
            rest_curvature: Vector3::zeros(), guides: None }],
        loads: vec![Load { name: None, kind: LoadKind::Mass { at: 0.39, mass } }],
    }
}
fn main() {
    for m in [0.0, 0.0138, 0.02, 0.0417] {
        let r = gray(m, 0.1176);
        for tolerance in [1e-3, 1e-6, 1e-9, 1e-12] {
            let s = Settings { tolerance, ..Settings::default() };
            match solve(&r, &s) {
                Ok(e) => println!("{m} {tolerance:e} {:.12?} {:?}", e.tip.position.as_slice(), e.report),
                Err(e) => println!("{m} {tolerance:e} {e}"),
            }
        }
        let s = Settings { tolerance: 1e-9, shooting_intervals: Some(1), ..Settings::default() };
        match solve(&r, &s) { Ok(e) => println!("K=1 {:.12?} {:?}", e.tip.position.as_slice(), e.report), Err(e) => println!("{e}") }
    }
    for tolerance in [1e-6, 1e-9] {
        let s = Settings { tolerance, stations: 0, ..Settings::default() };
        let mut w = Workspace::default();
        let n = 20000;
        let r = gray(0.02, 0.1176);
        for (name, warm) in [("cold", false), ("warm", true)] {
            let rs = [gray(0.02, 0.1176), gray(0.0202, 0.1176)];
            let t = std::time::Instant::now();
            let mut x = 0.0;
            for i in 0..n {
                let e = if warm { solve_near(&rs[i % 2], &s, &mut w) } else { solve_in(&r, &s, &mut w) }.unwrap();
                x += e.tip.position.x;
                if i == n - 1 { println!("{name} {tolerance:e}: {:?} {:?}", t.elapsed() / n as u32, e.report); }
            }
            std::hint::black_box(x);
        }
    }
}
