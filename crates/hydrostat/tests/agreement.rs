//! Two methods, one answer.

use hydrostat::description::{self, builtin};
use hydrostat::model::{CrossSection, Frame, Load, LoadKind, Material, Pose, Profile, Section};
use hydrostat::solution::{Report, Station};
use hydrostat::statics::{Settings, solve};
use hydrostat::validate::robustness;
use hydrostat::{Equilibrium, Robot};
use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};

/// Of the length: between solutions by different shooting intervals.
const SAME: f64 = 1e-10;
/// What each of them is asked for: the estimate behind it is right within a factor of three.
const TOLERANCE: f64 = 1e-11;
/// The same of single shooting, in which rounding grows along the rod.
const SINGLE_TOLERANCE: f64 = 3e-11;
/// Of the length: between the solver and the Runge-Kutta method below, whose own error at this step is 1e-11 and grows with the
/// wrench error of the solution, at most 1e-9, along the rods chosen here.
const INDEPENDENT: f64 = 1e-8;
/// Of a right answer between two stations, in units of the length and of the base wrench: the bound of the random sweep.
const BALANCED: f64 = 1e-6;
/// Steps of that method over the length.
const STEPS: f64 = 4000.0;
/// The same where the shape changes within a hundredth of the length.
const STEEP_STEPS: f64 = 100_000.0;

fn settings(shooting_intervals: Option<usize>) -> Settings {
    let tolerance = if shooting_intervals == Some(1) { SINGLE_TOLERANCE } else { TOLERANCE };
    Settings { tolerance, shooting_intervals, eigenvalue: false, ..shooting() }
}

/// The rod of the thesis with each mass of its table.
fn thesis_rods() -> Vec<Robot> {
    let bench = builtin::experiment().expect("the built-in experiment is read").value;
    bench.acting().iter().map(|acting| bench.robot_in(&bench.robot, acting)).collect()
}

/// Largest distance over the stations, as a part of the length.
fn distance(a: &Equilibrium, b: &Equilibrium, length: f64) -> f64 {
    let pairs = a.stations.iter().zip(&b.stations);
    pairs.map(|(a, b)| (a.position - b.position).norm()).fold(0.0, hydrostat::numeric::larger) / length
}

/// Single shooting and a few intervals against one interval a step.
fn assert_intervals_agree(robot: &Robot) -> Result<(), String> {
    let reference = solve(robot, &settings(None)).map_err(|error| format!("{}: {error}", robot.name))?;
    for intervals in [1, 2, 3, 7] {
        let found = solve(robot, &settings(Some(intervals)))
            .map_err(|error| format!("{}, {intervals} intervals: {error}", robot.name))?;
        let distance = distance(&reference, &found, robot.length());
        if distance.is_nan() || distance > SAME {
            return Err(format!("{}, {intervals} intervals: {distance:.1e} L", robot.name));
        }
    }
    Ok(())
}

#[test]
fn shooting_intervals_do_not_matter_for_the_thesiss_rod() {
    let faults: Vec<String> =
        thesis_rods().iter().filter_map(|robot| assert_intervals_agree(robot).err()).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn shooting_intervals_do_not_matter_for_random_rods() {
    let faults: Vec<String> =
        (0..200).filter_map(|index| assert_intervals_agree(&robustness::robot(5, index)).err()).collect();
    assert!(faults.is_empty(), "{} of 200:\n{}", faults.len(), faults.join("\n"));
}

/// Position, rotation, force and moment in the world frame.
#[derive(Clone, Copy)]
struct State {
    p: Vector3<f64>,
    q: Quaternion<f64>,
    n: Vector3<f64>,
    m: Vector3<f64>,
}

impl State {
    fn plus(&self, h: f64, rate: &State) -> State {
        State {
            p: self.p + h * rate.p,
            q: self.q + rate.q * h,
            n: self.n + h * rate.n,
            m: self.m + h * rate.m,
        }
    }
}

/// R x for the rotation of a quaternion of any length near 1.
fn rotate(q: &Quaternion<f64>, x: &Vector3<f64>) -> Vector3<f64> {
    UnitQuaternion::from_quaternion(*q) * x
}

/// The rod's equations (G 3, 4, 6, 11-21) at `s`, within one section and between two loads.
fn rates(robot: &Robot, s: f64, section: (usize, f64), state: &State) -> State {
    let (section, start) = (&robot.sections[section.0], section.1);
    let fraction = (s - start) / section.length;
    let (shear, bend) = section.stiffness(fraction);
    let to_body = |x: &Vector3<f64>| rotate(&state.q.conjugate(), x);
    let v = to_body(&state.n).component_div(&shear) + Vector3::z();
    let u = to_body(&state.m).component_div(&bend) + section.rest_curvature;
    let mut f = section.material.density * section.cross_section(fraction).area() * robot.gravity;
    let mut l = Vector3::zeros();
    for load in &robot.loads {
        if let LoadKind::Distributed { from, to, force_per_length, moment_per_length, frame } = load.kind
            && (from < s && s < to)
        {
            let turn = |x| if frame == Frame::Body { rotate(&state.q, &x) } else { x };
            f += turn(force_per_length);
            l += turn(moment_per_length);
        }
    }
    let p = rotate(&state.q, &v);
    State { p, q: state.q * Quaternion::from_imag(u) * 0.5, n: -f, m: state.n.cross(&p) - l }
}

/// Classical Runge-Kutta between two places with no load and no change of section in between.
fn advance(robot: &Robot, (from, to): (f64, f64), steps: f64, mut state: State) -> State {
    let (mut index, mut start) = (0, 0.0);
    while index + 1 < robot.sections.len() && 0.5 * (from + to) > start + robot.sections[index].length {
        start += robot.sections[index].length;
        index += 1;
    }
    let count = (steps * (to - from) / robot.length()).ceil();
    let h = (to - from) / count;
    // the ends are taken just inside, where the loads of this piece act
    let inside = |s: f64| s.clamp(from + 1e-9 * h, to - 1e-9 * h);
    let rate = |s: f64, state: &State| rates(robot, inside(s), (index, start), state);
    for i in 0..count as usize {
        let s = from + i as f64 * h;
        let k1 = rate(s, &state);
        let k2 = rate(s + 0.5 * h, &state.plus(0.5 * h, &k1));
        let k3 = rate(s + 0.5 * h, &state.plus(0.5 * h, &k2));
        let k4 = rate(s + h, &state.plus(h, &k3));
        state = state.plus(h / 6.0, &k1).plus(h / 3.0, &k2).plus(h / 3.0, &k3).plus(h / 6.0, &k4);
        state.q /= state.q.norm();
    }
    state
}

/// Takes the point loads at a place off the wrench beyond it.
fn pass(robot: &Robot, place: f64, state: &mut State) {
    let here = |at: f64| (at - place).abs() < 1e-12 * robot.length();
    for load in &robot.loads {
        match load.kind {
            LoadKind::Point { at, force, moment, frame } if here(at) => {
                let turn = |x| if frame == Frame::Body { rotate(&state.q, &x) } else { x };
                let (force, moment) = (turn(force), turn(moment));
                state.n -= force;
                state.m -= moment;
            }
            LoadKind::Mass { at, mass } if here(at) => state.n -= mass * robot.gravity,
            _ => {}
        }
    }
}

/// Largest distance of the stations from the integrated base wrench, and what is left of the wrench beyond the tip, both in
/// units of the length and of the base wrench.
fn integrated(robot: &Robot, found: &Equilibrium) -> (f64, f64) {
    let base = &found.stations[0];
    let rotation = UnitQuaternion::from_rotation_matrix(&robot.base.rotation);
    let mut state =
        State { p: robot.base.position, q: *rotation.quaternion(), n: base.force, m: base.moment };
    let mut places: Vec<f64> = found.stations.iter().map(|station| station.s).collect();
    let mut end = 0.0;
    for section in &robot.sections {
        end += section.length;
        places.push(end);
    }
    for load in &robot.loads {
        match load.kind {
            LoadKind::Point { at, .. } | LoadKind::Mass { at, .. } => places.push(at),
            LoadKind::Distributed { from, to, .. } => places.extend([from, to]),
        }
    }
    places.sort_by(f64::total_cmp);
    places.dedup_by(|a, b| *a - *b < 1e-12 * robot.length());
    let (mut largest, mut from) = (0.0_f64, 0.0);
    for &to in &places {
        if to > from {
            state = advance(robot, (from, to), STEPS, state);
        }
        let same = |station: &&Station| (station.s - to).abs() < 1e-12 * robot.length();
        if let Some(station) = found.stations.iter().find(same) {
            let turned = (UnitQuaternion::from_quaternion(state.q).to_rotation_matrix().into_inner()
                - station.rotation)
                .amax();
            largest = largest.max((state.p - station.position).norm() / robot.length()).max(turned);
        }
        pass(robot, to, &mut state);
        from = to;
    }
    let left = state.n.norm() * robot.length() + state.m.norm();
    (largest, left / (base.force.norm() * robot.length() + base.moment.norm()))
}

fn assert_integrates(robot: &Robot) {
    let found = solve(robot, &settings(None)).unwrap_or_else(|error| panic!("{}: {error}", robot.name));
    let (distance, left) = integrated(robot, &found);
    assert!(distance < INDEPENDENT, "{}: {distance:.1e} L", robot.name);
    assert!(left < INDEPENDENT, "{}: {left:.1e} of the wrench is left beyond the tip", robot.name);
}

#[test]
fn runge_kutta_on_quaternions_gives_the_thesiss_rod() {
    thesis_rods().iter().for_each(assert_integrates);
}

#[test]
fn runge_kutta_on_quaternions_gives_random_rods() {
    (0..20).map(|index| robustness::robot(6, index)).for_each(|robot| assert_integrates(&robot));
}

/// A round rod along x of a density, gravity downwards.
fn round_rod(name: &str, length: f64, diameter: f64, youngs_modulus: f64, density: f64) -> Robot {
    let round = CrossSection::Round { diameter };
    Robot {
        tendons: Vec::new(),
        actuation: Vec::new(),
        name: name.into(),
        gravity: Vector3::new(0.0, -9.81, 0.0),
        base: Pose {
            position: Vector3::zeros(),
            rotation: Rotation3::from_basis_unchecked(&[Vector3::y(), Vector3::z(), Vector3::x()]),
        },
        sections: vec![Section {
            name: name.into(),
            length,
            material: Material {
                name: name.into(),
                youngs_modulus,
                shear_modulus: youngs_modulus / 2.6,
                density,
                strain_limit: None,
            },
            profile: Profile { base: round, tip: round, shear_coefficient: 0.9 },
            rest_curvature: Vector3::zeros(),
            guides: None,
        }],
        loads: Vec::new(),
    }
}

fn with_tip_force(mut robot: Robot, force: Vector3<f64>) -> Robot {
    let kind = LoadKind::Point { at: robot.length(), force, moment: Vector3::zeros(), frame: Frame::World };
    robot.loads.push(Load { name: None, kind });
    robot
}

/// An answer without NaN whose wrench balances, or a reason. (Single shooting cannot do these.)
#[test]
fn stiff_and_thin_rods_converge_or_say_why() {
    let nitinol = |length| round_rod("Nitinol 1.56 mm", length, 1.56e-3, 54e9, 6800.0);
    let wire = || round_rod("steel wire 0.1 mm, 1 m", 1.0, 0.1e-3, 200e9, 7850.0);
    let silicone = |length| round_rod("silicone 10 mm", length, 10e-3, 1e6, 1100.0);
    // F L^2/EI = 1000
    let stiff = nitinol(0.39);
    let ei = stiff.sections[0].stiffness(0.0).1.x;
    let thousand = 1000.0 * ei / 0.39_f64.powi(2);
    let rods = [
        nitinol(0.39),
        nitinol(3.0),
        wire(),
        with_tip_force(wire(), Vector3::new(0.0, 0.0, 0.01)),
        with_tip_force(stiff.clone(), Vector3::new(0.0, -thousand, 0.0)),
        with_tip_force(stiff.clone(), Vector3::new(thousand, 0.0, 0.0)),
        with_tip_force(stiff, Vector3::new(-0.5 * thousand, 0.0, 0.8 * thousand)),
        silicone(0.3),
        silicone(1.0),
        silicone(3.0),
    ];
    for (i, robot) in rods.iter().enumerate() {
        match solve(robot, &shooting()) {
            Ok(found) => {
                let defect = between_stations(robot, &found);
                assert!(defect < BALANCED, "rod {i}, {}: defect {defect:.1e}", robot.name);
            }
            Err(error) => assert!(error.to_string().contains("hint:"), "rod {i}, {}: {error}", robot.name),
        }
    }
}

/// Largest jump of position, force and moment where each station is integrated to the next; NaN for a shape that has one.
fn between_stations(robot: &Robot, found: &Equilibrium) -> f64 {
    let base = &found.stations[0];
    let (length, wrench) = (robot.length(), base.force.norm() * robot.length() + base.moment.norm());
    let jumps = found.stations.windows(2).map(|pair| {
        let rotation =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(pair[0].rotation));
        let start =
            State { p: pair[0].position, q: *rotation.quaternion(), n: pair[0].force, m: pair[0].moment };
        let end = advance(robot, (pair[0].s, pair[1].s), STEEP_STEPS, start);
        let off = (end.n - pair[1].force).norm() * length + (end.m - pair[1].moment).norm();
        (end.p - pair[1].position).norm() / length + off / wrench
    });
    jumps.fold(0.0, |largest, jump| if largest >= jump { largest } else { jump })
}

/// The full load at once, from the bend of the tendons, leads where small steps of all loads together lead.
#[test]
fn the_load_at_once_leads_where_small_steps_lead() {
    let at_once = Settings { eigenvalue: false, ..Settings::default() };
    let in_steps = Settings { largest_load_step: 0.2, ..at_once.clone() };
    let mut compared = 0;
    for index in 0..200 {
        let robot = robustness::tendon_robot(3, index);
        if let (Ok(a), Ok(b)) = (solve(&robot, &at_once), solve(&robot, &in_steps)) {
            let apart = (a.tip.position - b.tip.position).norm() / robot.length();
            assert!(apart < INDEPENDENT, "robot {index}: {apart:.1e} L");
            assert_eq!(a.report.stable, b.report.stable, "robot {index}");
            compared += 1;
        }
    }
    assert!(compared > 195, "{compared}");
}

/// Between the eigenvalues of the two methods: one of them calls 0.999 and above 1.
const SAME_EIGENVALUE: f64 = 1e-3;

/// A shipped robot, with commands as on the command line.
fn shipped(name: &str, tension: &str, displacement: &str) -> Robot {
    let file = format!("{}/../../robots/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{file}: {error}"));
    let mut robot = description::parse_robot(&text, &file).expect("a shipped robot is read").value;
    let flag = |commands: &str| if commands.is_empty() { Vec::new() } else { vec![commands.to_owned()] };
    let commands = [flag(tension), flag(displacement)];
    description::parse_commands(&mut robot, &mut Vec::new(), &commands[0], &commands[1], &[])
        .expect("the robot has these tendons");
    robot
}

/// By the energy method and by shooting.
fn reports(robot: &Robot) -> [Report; 2] {
    [Settings::default(), shooting()].map(|settings| {
        solve(robot, &settings).unwrap_or_else(|error| panic!("{}: {error}", robot.name)).report
    })
}

#[test]
fn both_methods_agree_on_the_eigenvalue() {
    let shipped = [
        ("elephant_trunk", ""),
        ("gray2009_rod", ""),
        ("rao2021", ""),
        ("rucker2011_helical", ""),
        ("scr", ""),
        ("scr", "a=20N,b=20N,c=20N"),
        ("scr", "a=100N,b=100N,c=100N"),
        ("scr", "a=200N,b=200N,c=200N"),
        ("scr", "a=20N"),
        ("scr_two_section", ""),
        ("scr_two_section", "a=30N,b=30N,c=30N,d=30N,e=30N,f=30N"),
        ("till2019", ""),
    ]
    .map(|(name, tension)| shipped(name, tension, ""));
    for robot in shipped {
        let [energy, shooting] = reports(&robot);
        let eigenvalues = [&energy, &shooting].map(|report| report.smallest_eigenvalue.expect("asked for"));
        assert!((eigenvalues[0] - eigenvalues[1]).abs() < SAME_EIGENVALUE, "{}: {eigenvalues:?}", robot.name);
        assert_eq!(energy.stable, shooting.stable, "{}", robot.name);
    }
}

/// Shooting judges tendons that keep their tensions, and gives no eigenvalue where they keep their lengths.
#[test]
fn shooting_gives_no_eigenvalue_of_held_tendons() {
    let [energy, shooting] = reports(&shipped("scr", "", "a=5mm,b=0mm,c=0mm"));
    assert!(energy.smallest_eigenvalue.is_some());
    assert_eq!((shooting.smallest_eigenvalue, shooting.stable), (None, Some(true)));
    // those that are slack hold nothing
    let eigenvalues =
        [shipped("scr", "a=2N", "b=-20mm,c=-20mm"), shipped("scr", "a=2N,b=0N,c=0N", "")].map(|robot| {
            let [_, shooting] = reports(&robot);
            shooting.smallest_eigenvalue.expect("nothing is held")
        });
    assert!((eigenvalues[0] - eigenvalues[1]).abs() < SAME_EIGENVALUE, "{eigenvalues:?}");
}

/// This file is about the shooting method.
fn shooting() -> Settings {
    Settings { method: hydrostat::solution::Method::Shooting, ..Settings::default() }
}
