//! The energy method against shooting and closed forms.
use hydrostat::model::{Command, Motion, Path, Routing, Tendon};
use hydrostat::solution::Method;
use hydrostat::statics::{self, Settings};
use hydrostat::{Robot, description};

fn robot(text: &str) -> Robot {
    description::parse_robot(text, "test.toml").unwrap().value
}
fn tendon(robot: &mut Robot, radius: f64, angle: f64, turns: f64, routing: Routing, tension: f64) {
    robot.tendons.push(Tendon {
        name: format!("t{}", robot.tendons.len()),
        ends: robot.sections.len() - 1,
        path: Path { radius, tip_radius: radius, angle, turns },
        routing,
        stiffness: None,
        friction: 0.0,
        breaking_load: None,
        mass_per_length: 0.0,
    });
    robot.actuation.push(Command::Tension { tension, motion: Motion::Pulled });
}
const NITI: &str = r#"
name = "t"
gravity = "[0, 0, 0] m/s^2"
[material.m]
youngs_modulus = "54 GPa"
poisson_ratio = 0.33
density = "6450 kg/m^3"
[[section]]
length = "400 mm"
material = "m"
profile = { diameter = "1.56 mm" }
"#;
#[test]
fn rods_agree_with_shooting() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/reference_cases");
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| {
            p.extension().unwrap() == "toml" && p.file_name().unwrap().to_str().unwrap().starts_with('r')
        })
        .collect();
    files.sort();
    files.push(concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/gray2009_rod.toml").into());
    for file in files {
        let r = robot(&std::fs::read_to_string(&file).unwrap());
        let a = statics::solve(&r, &Settings { method: Method::Shooting, ..Settings::default() }).unwrap();
        let start = std::time::Instant::now();
        match statics::solve(
            &r,
            &Settings { method: Method::Energy, eigenvalue: true, ..Settings::default() },
        ) {
            Ok(b) => {
                eprintln!(
                    "{} tip {:.1e} it {} res {:.1e} est {:.1e} eig {:?} {:?} {:?} {:?}",
                    file.file_name().unwrap().to_str().unwrap(),
                    (a.tip.position - b.tip.position).norm(),
                    b.report.iterations,
                    b.report.residual,
                    b.report.error_estimate,
                    b.report.smallest_eigenvalue,
                    a.report.smallest_eigenvalue,
                    b.report.stable,
                    start.elapsed()
                );
                let worst = a
                    .stations
                    .iter()
                    .zip(&b.stations)
                    .map(|(a, b)| (a.position - b.position).norm())
                    .fold(0.0, f64::max);
                let wm = a
                    .stations
                    .iter()
                    .zip(&b.stations)
                    .map(|(a, b)| (a.moment - b.moment).norm() / a.moment.norm().max(1e-3))
                    .fold(0.0, f64::max);
                eprintln!("  stations {worst:.1e} moment {wm:.1e}");
            }
            Err(e) => eprintln!("{} {e}", file.display()),
        }
    }
}
#[test]
fn straight_tendon() {
    for routing in [Routing::Channel, Routing::Guides] {
        let mut r = robot(NITI);
        tendon(&mut r, 8e-3, 0.0, 0.0, routing, 5.0);
        if routing == Routing::Guides {
            r.sections[0].guides = Some(hydrostat::model::Guides {
                positions: (1..=40).map(|i| f64::from(i) * 0.01).collect(),
                mass: 0.0,
                mass_center: [0.0; 2],
                radius: None,
            });
        }
        match statics::solve(&r, &Settings { method: Method::Energy, ..Settings::default() }) {
            Ok(b) => eprintln!("{:?} {:?} {:?} {:?}", b.tip.position, b.stations[50].u, b.report, b.tendons),
            Err(e) => eprintln!("{e}"),
        }
    }
}
#[test]
fn displacement() {
    for routing in [Routing::Channel, Routing::Guides] {
        let mut r = robot(NITI);
        r.gravity.y = -9.81;
        for i in 0..3 {
            tendon(
                &mut r,
                8e-3,
                0.3 + f64::from(i) * 2.0943951,
                if i == 1 { 0.3 } else { 0.0 },
                routing,
                [3.0, 0.0, 0.5][i as usize],
            );
        }
        if routing == Routing::Guides {
            r.sections[0].guides = Some(hydrostat::model::Guides {
                positions: (1..=40).map(|i| f64::from(i) * 0.01).collect(),
                mass: 0.0,
                mass_center: [0.0; 2],
                radius: None,
            });
        }
        let start = std::time::Instant::now();
        let a = statics::solve(
            &r,
            &Settings { method: Method::Energy, eigenvalue: false, ..Settings::default() },
        );
        eprintln!("{:?}", start.elapsed());
        let Ok(a) = a else {
            eprintln!("{}", a.unwrap_err());
            continue;
        };
        eprintln!("{:?} {:?}", a.report, a.tendons);
        for i in 0..3 {
            if i != 1 || routing == Routing::Guides {
                r.actuation[i] =
                    Command::Displacement { displacement: a.tendons[i].displacement, motion: Motion::Pulled };
            }
        }
        let start = std::time::Instant::now();
        match statics::solve(&r, &Settings { method: Method::Energy, ..Settings::default() }) {
            Ok(b) => eprintln!(
                "{:?} {:?} {:?} {:.1e}\n",
                start.elapsed(),
                b.report,
                b.tendons,
                (a.tip.position - b.tip.position).norm()
            ),
            Err(e) => eprintln!("{e}"),
        }
    }
}
#[test]
fn from_any_start() {
    let mut r = robot(NITI);
    r.gravity.y = -9.81;
    for i in 0..3 {
        tendon(
            &mut r,
            8e-3,
            0.3 + f64::from(i) * 2.0943951,
            if i == 1 { 0.3 } else { 0.0 },
            Routing::Channel,
            [3.0, 0.0, 0.5][i as usize],
        );
    }
    let settings = Settings { method: Method::Energy, ..Settings::default() };
    let a = statics::solve(&r, &settings).unwrap();
    for mode in 0..2 {
        if mode == 1 {
            for i in 0..3 {
                r.actuation[i] =
                    Command::Displacement { displacement: a.tendons[i].displacement, motion: Motion::Pulled };
            }
        }
        for seed in 0..8 {
            let mut other = robot(NITI);
            other.sections[0].rest_curvature = 8.0
                * nalgebra::Vector3::new(
                    (seed as f64).sin(),
                    (3.1 * seed as f64).cos(),
                    (1.7 * seed as f64).sin(),
                );
            let start = statics::solve(&other, &settings).unwrap();
            match statics::solve_from(&r, &settings, &start.stations) {
                Ok(b) => eprintln!(
                    "{:.1e} it {} stable {:?} eig {:?}",
                    (a.tip.position - b.tip.position).norm(),
                    b.report.iterations,
                    b.report.stable,
                    b.report.smallest_eigenvalue
                ),
                Err(e) => eprintln!("{e}"),
            }
        }
    }
}
