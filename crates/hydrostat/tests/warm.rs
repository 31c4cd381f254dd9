//! A solve that starts from another robot's solution must end where a solve from cold does.

use hydrostat::description::{builtin, parse_robot};
use hydrostat::model::{Command, CrossSection, Frame, Load, LoadKind, Motion, Routing};
use hydrostat::solution::Method;
use hydrostat::statics::{Input, Settings, Workspace, derivatives, solve, solve_near};
use hydrostat::validate::robustness;
use hydrostat::{Equilibrium, Robot};
use nalgebra::{Rotation3, Vector3};

/// Of the length: two solves, each to this tolerance.
const TOLERANCE: f64 = 1e-10;
const CLOSE: f64 = 2.0 * TOLERANCE;

fn settings(method: Method) -> Settings {
    Settings { tolerance: TOLERANCE, eigenvalue: false, method, ..Settings::default() }
}

fn load(kind: LoadKind) -> Load {
    Load { name: None, kind }
}

/// The thesis's rod with a small mass at a place.
fn thesis_rod(at: f64, mass: f64) -> Robot {
    let mut robot = builtin::robot().expect("the built-in robot is read").value;
    robot.loads.push(load(LoadKind::Mass { at: at * robot.length(), mass }));
    robot
}

fn in_two_sections(mut robot: Robot) -> Robot {
    robot.sections[0].length *= 0.5;
    let mut distal = robot.sections[0].clone();
    distal.rest_curvature = Vector3::new(1.0, 0.5, 0.0);
    distal.profile.tip = CrossSection::Round { diameter: 1.2e-3 };
    robot.sections.push(distal);
    robot
}

fn turned(mut robot: Robot, angle: f64) -> Robot {
    robot.base.position += Vector3::new(0.3, -0.1, 2.0);
    robot.base.rotation = Rotation3::new(angle * Vector3::new(0.3, 0.4, 1.2)) * robot.base.rotation;
    robot
}

fn with_follower(mut robot: Robot, force: f64) -> Robot {
    let at = robot.length();
    let force = Vector3::new(force, 0.5 * force, 0.0);
    robot.loads.push(load(LoadKind::Point { at, force, moment: Vector3::zeros(), frame: Frame::Body }));
    robot
}

fn spread(mut robot: Robot, from: f64, to: f64) -> Robot {
    let (from, to) = (from * robot.length(), to * robot.length());
    let force_per_length = Vector3::new(0.0, 0.0, 0.2);
    robot.loads.push(load(LoadKind::Distributed {
        from,
        to,
        force_per_length,
        moment_per_length: Vector3::zeros(),
        frame: Frame::World,
    }));
    robot
}

/// Largest distance of the stations as a part of the length, and the same of the tips.
fn distance(a: &Equilibrium, b: &Equilibrium, length: f64) -> f64 {
    let stations = a
        .stations
        .iter()
        .zip(&b.stations)
        .map(|(a, b)| (a.position - b.position).norm())
        .fold(0.0, hydrostat::numeric::larger);
    stations.max((a.tip.position - b.tip.position).norm()) / length
}

fn assert_same(robot: &Robot, method: Method, workspace: &mut Workspace, what: &str) {
    let what = format!("{method:?}, {what}");
    let settings = settings(method);
    let near = solve_near(robot, &settings, workspace).unwrap_or_else(|error| panic!("{what}: {error}"));
    let cold = solve(robot, &settings).unwrap_or_else(|error| panic!("{what}: {error}"));
    let found = distance(&near, &cold, robot.length());
    assert!(found <= CLOSE, "{what}: {found:.1e}");
    assert_eq!(near.report.stable, cold.report.stable, "{what}");
    // what else the workspace answers belongs to the same solution
    let middle = workspace.station(robot, 0.5 * robot.length()).expect("a solution was found");
    let off = (middle.position - cold.stations[50].position).norm() / robot.length();
    assert!(off <= CLOSE, "{what}: station in the middle {off:.1e}");
}

/// One workspace through all changes, there and back.
#[test]
fn any_change_of_the_robot_gives_what_a_cold_solve_gives() {
    let base = || thesis_rod(1.0, 0.005);
    let robots = [
        ("as it is", base()),
        ("another mass", thesis_rod(1.0, 0.02)),
        ("the mass elsewhere", thesis_rod(0.4, 0.02)),
        ("two sections", in_two_sections(base())),
        ("another place, as many spans", in_two_sections(thesis_rod(0.5, 0.01))),
        ("a distributed load", spread(base(), 0.2, 0.7)),
        ("the same elsewhere", spread(base(), 0.6, 0.9)),
        ("a turned base", turned(base(), 0.5)),
        ("a base turned far", turned(base(), 2.5)),
        ("a follower", with_follower(base(), 0.05)),
        ("a follower on two sections", with_follower(in_two_sections(base()), 0.05)),
        ("no load at all", {
            let mut robot = base();
            robot.loads.clear();
            robot.gravity = Vector3::zeros();
            robot
        }),
    ];
    for method in [Method::Shooting, Method::Energy] {
        there_and_back(method, &robots);
    }
}

fn there_and_back(method: Method, robots: &[(&str, Robot)]) {
    let mut workspace = Workspace::default();
    for (from, first) in robots {
        for (to, second) in robots {
            assert_same(first, method, &mut workspace, &format!("{to} -> {from}"));
            assert_same(second, method, &mut workspace, &format!("{from} -> {to}"));
        }
    }
}

fn commanded(text: &str, commands: [Command; 3]) -> Robot {
    let mut robot = parse_robot(text, "test.toml").expect("is valid").value;
    robot.actuation[..3].copy_from_slice(&commands);
    robot
}

/// Tendons by tension and by displacement, taut and slack, in channels and between guides, rubbing; a follower that comes and goes.
#[test]
fn any_change_of_a_tendon_robot_gives_what_a_cold_solve_gives() {
    let pulled =
        |tensions: [f64; 3]| tensions.map(|tension| Command::Tension { tension, motion: Motion::Pulled });
    let held =
        |mm: [f64; 3]| mm.map(|mm| Command::Displacement { displacement: 1e-3 * mm, motion: Motion::Pulled });
    const SCR: &str = include_str!("../../../robots/scr.toml");
    const TILL: &str = include_str!("../../../robots/till2019.toml");
    let follower = |force: f64| with_follower(commanded(TILL, pulled([3.0, 1.0, 0.0])), force);
    let robots = [
        ("guides", commanded(SCR, pulled([5.0, 2.0, 1.0]))),
        ("guides, a little more", commanded(SCR, pulled([5.02, 2.01, 1.0]))),
        ("guides, held", commanded(SCR, held([5.0, -2.4, -2.4]))),
        ("guides, held, slack", commanded(SCR, held([5.0, -9.0, -9.0]))),
        ("channels", commanded(TILL, pulled([3.0, 1.0, 0.0]))),
        ("channels, a little more", commanded(TILL, pulled([3.01, 1.0, 0.0]))),
        ("channels, held", commanded(TILL, held([2.0, 0.0, -3.0]))),
        (
            "channels, rubbing",
            commanded(&TILL.replace("[[tendon]]", "[[tendon]]\nfriction = 0.1"), pulled([3.0, 1.0, 0.0])),
        ),
        ("a follower of no force", follower(0.0)),
        ("a follower", follower(0.02)),
    ];
    there_and_back(Method::Energy, &robots);
}

/// Bows between guides, which two points a panel take for a third, are of one robot: another may taper, or have a tendon in a channel.
#[test]
fn bows_of_one_robot_are_not_taken_for_those_of_another() {
    const SCR: &str = include_str!("../../../robots/scr.toml");
    let pulled =
        |tensions: [f64; 3]| tensions.map(|tension| Command::Tension { tension, motion: Motion::Pulled });
    // not evenly spread, which are solved in the gaps
    let apart = |robot: &mut Robot| {
        guide(
            robot,
            |k| 0.01 * (k + 1) as f64 + if k < 29 { 1e-3 * ((k % 3) as f64 - 1.0) } else { 0.0 },
            30,
        );
    };
    let at = |tensions| {
        let mut robot = commanded(SCR, pulled(tensions));
        apart(&mut robot);
        robot
    };
    let guides = || at([5.0, 2.0, 1.0]);
    let changed = |change: fn(&mut Robot)| {
        let mut robot = guides();
        change(&mut robot);
        robot
    };
    let robots = [
        guides(),
        at([5.05, 2.02, 1.01]),
        at([1.0, 4.0, 0.0]),
        changed(|robot| robot.gravity *= 0.5),
        changed(|robot| robot.sections[0].profile.tip = CrossSection::Round { diameter: 0.8e-3 }),
        changed(|robot| robot.tendons[1].routing = Routing::Channel),
        changed(|robot| robot.tendons[1].friction = 0.1),
        changed(|robot| robot.sections[0].length *= 1.01),
    ];
    let coarse = Settings { tolerance: 1e-6, ..settings(Method::Energy) };
    let exact =
        robots.each_ref().map(|robot| solve(robot, &settings(Method::Energy)).expect("has an answer"));
    let mut workspace = Workspace::default();
    for i in 0..robots.len() {
        for j in (0..robots.len()).flat_map(|j| [i, j]) {
            let near = solve_near(&robots[j], &coarse, &mut workspace).expect("has an answer");
            let off = distance(&near, &exact[j], robots[j].length());
            let estimate = near.report.error_estimate / robots[j].length();
            assert!(off <= 1e-6 && estimate <= 1e-6, "{i} -> {j}: {off:.1e}, estimate {estimate:.1e}");
            assert_eq!(near.report.stable, exact[j].report.stable, "{i} -> {j}");
        }
        // shooting in between leaves nothing to go on from
        solve_near(&robots[i], &settings(Method::Shooting), &mut workspace).ok();
        let again = solve_near(&robots[i], &coarse, &mut workspace).expect("has an answer");
        assert!(distance(&again, &exact[i], robots[i].length()) <= 1e-6, "{i} after shooting");
    }
}

/// To 1e-6 robots with guides are found by way of averaged gaps, under other commands without the gaps: tip, lengths, strain and the stations
/// between are those of the gaps all the same.
#[test]
fn averaged_gaps_tell_what_the_gaps_do() {
    const SCR: &str = include_str!("../../../robots/scr.toml");
    const RAO: &str = include_str!("../../../robots/rao2021.toml");
    let pulled = |tension: f64| Command::Tension { tension, motion: Motion::Pulled };
    let scr = |change: fn(&mut Robot)| {
        let mut robot = commanded(SCR, [5.0, 2.0, 1.0].map(pulled));
        change(&mut robot);
        robot
    };
    let tip = |robot: &Robot, force: [f64; 3], moment: f64| {
        let (at, moment) = (robot.length(), moment * Vector3::z());
        load(LoadKind::Point { at, force: force.into(), moment, frame: Frame::World })
    };
    let mut sideways = scr(|_| ());
    sideways.loads.push(tip(&sideways, [0.1, 0.05, -0.1], 0.0));
    let mut twisted = scr(|_| ());
    twisted.loads.push(tip(&twisted, [0.0, 0.0, 0.05], 0.01));
    let mut cut = sideways.clone();
    cut.loads.push(load(LoadKind::Point {
        at: 0.017,
        force: Vector3::new(0.05, 0.2, -0.1),
        moment: Vector3::zeros(),
        frame: Frame::World,
    }));
    let mut held = sideways.clone();
    for (command, mm) in held.actuation.iter_mut().zip([4.0, -1.0, -2.0]) {
        *command = Command::Displacement { displacement: 1e-3 * mm, motion: Motion::Pulled };
    }
    let robots = [
        ("rao", parse_robot(RAO, "rao2021.toml").expect("is valid").value),
        ("scr", scr(|_| ())),
        ("sideways", sideways),
        ("twisted", twisted),
        ("a load within a gap", cut),
        ("held", held),
        ("fewer guides", scr(|robot| guide(robot, |k| 0.03 * (k + 1) as f64, 10))),
        ("uneven", scr(|robot| guide(robot, |k| 0.015 * (k + 1) as f64 + 2e-3 * ((k % 3) as f64 - 1.0), 19))),
    ];
    let to = |tolerance, stations| Settings { tolerance, stations, ..settings(Method::Energy) };
    for (what, robot) in &robots {
        let (mut workspace, mut robot, length) = (Workspace::default(), robot.clone(), robot.length());
        for (round, more) in [1.0, 1.01, 1.01, 0.97, 1.1, 0.99].into_iter().enumerate() {
            for command in &mut robot.actuation {
                match command {
                    Command::Tension { tension, .. } => *tension *= more,
                    Command::Displacement { displacement, .. } => *displacement *= more,
                }
            }
            let exact = solve(&robot, &to(1e-10, 21)).expect("has an answer");
            let near = solve_near(&robot, &to(1e-6, 0), &mut workspace).expect("has an answer");
            let off = (near.tip.position - exact.tip.position).norm() / length;
            let estimate = near.report.error_estimate / length;
            assert!(off <= 1e-6 && estimate <= 1e-6, "{what} {round}: {off:.1e}, estimate {estimate:.1e}");
            assert_eq!(near.report.stable, exact.report.stable, "{what} {round}");
            for (near, exact) in near.tendons.iter().zip(&exact.tendons) {
                let off = (near.displacement - exact.displacement).abs() / length;
                assert!(off <= 1e-6, "{what} {round}: displacement {off:.1e}");
            }
            for exact in &exact.stations {
                let near = workspace.station(&robot, exact.s).expect("is on the backbone");
                let off = (near.position - exact.position).norm() / length;
                let bent = (near.u - exact.u).norm() * length;
                assert!(off <= 2e-6 && bent <= 1e-3, "{what} {round} at {}: {off:.1e}, {bent:.1e}", exact.s);
            }
            let strain =
                |of: &Equilibrium| of.checks.iter().find(|check| check.name == "strain").map(|c| c.value);
            let (near, exact) = (strain(&near).expect("is checked"), strain(&exact).expect("is checked"));
            assert!((near / exact - 1.0).abs() < 0.01, "{what} {round}: strain {near} {exact}");
        }
        // and with stations, of the gaps themselves
        let exact = solve(&robot, &to(1e-10, 21)).expect("has an answer");
        let whole = solve(&robot, &to(1e-6, 21)).expect("has an answer");
        let off = distance(&whole, &exact, length);
        assert!(off <= 1e-6, "{what}: stations {off:.1e}");
    }
}

/// What is read between two solves, or asked for by one, moves the gaps; what was left out at rest or under small tensions tells nothing of
/// large ones.
#[test]
fn averaged_gaps_are_where_they_were_read_last() {
    const SCR: &str = include_str!("../../../robots/scr.toml");
    let at = |tensions: [f64; 3]| {
        let pulled = |tension| Command::Tension { tension, motion: Motion::Pulled };
        let mut robot = commanded(SCR, tensions.map(pulled));
        let force = Vector3::new(0.1, 0.05, -0.1);
        let kind =
            LoadKind::Point { at: robot.length(), force, moment: Vector3::zeros(), frame: Frame::World };
        robot.loads.push(load(kind));
        robot
    };
    let to = |tolerance, stations| Settings { tolerance, stations, ..settings(Method::Energy) };
    let mut workspace = Workspace::default();
    let mut check = |what: &str, tensions: [f64; 3], stations: usize, reads: bool| {
        let robot = at(tensions);
        let near = solve_near(&robot, &to(1e-6, stations), &mut workspace).expect("has an answer");
        let exact = solve(&robot, &to(1e-10, stations)).expect("has an answer");
        let off = distance(&near, &exact, robot.length());
        assert!(off <= 1e-6, "{what}: {off:.1e}, estimate {:.1e}", near.report.error_estimate);
        if reads {
            let inputs = Input::commands(&robot);
            let near = derivatives(&robot, &mut workspace, &[robot.length()], &inputs).expect("is regular");
            let mut cold = Workspace::default();
            solve_near(&robot, &to(1e-10, 0), &mut cold).expect("has an answer");
            let exact = derivatives(&robot, &mut cold, &[robot.length()], &inputs).expect("is regular");
            for (near, exact) in near.iter().zip(&exact) {
                let (near, exact) = (near.poses[0].position, exact.poses[0].position);
                assert!((near - exact).norm() <= 1e-4 * exact.norm(), "{what}: {near} {exact}");
            }
        }
    };
    check("at rest", [0.0; 3], 0, false);
    check("little", [0.01, 0.0, 0.0], 0, false);
    check("all alike", [4.0; 3], 0, false);
    check("one", [5.0, 2.0, 1.0], 0, false);
    check("one more", [5.05, 2.02, 1.01], 0, true);
    check("after derivatives", [5.1, 2.04, 1.02], 0, false);
    check("with stations", [5.15, 2.06, 1.03], 11, false);
    check("after stations", [5.2, 2.08, 1.04], 0, true);
    check("back", [5.1, 2.04, 1.02], 0, false);
}

fn guide(robot: &mut Robot, at: impl Fn(usize) -> f64, count: usize) {
    let guides = robot.sections[0].guides.as_mut().expect("has guides");
    guides.positions = (0..count).map(at).chain([0.3]).collect();
    guides.positions.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
}

#[test]
fn a_refusal_leaves_a_workspace_that_still_works() {
    let robot = thesis_rod(1.0, 0.02);
    let (mut workspace, method) = (Workspace::default(), Method::Shooting);
    assert_same(&robot, method, &mut workspace, "first");
    let impossible = Settings { tolerance: 1.0, ..settings(method) };
    assert!(solve_near(&robot, &impossible, &mut workspace).is_err());
    assert_same(&robot, method, &mut workspace, "after impossible settings");
    let mut crushed = robot.clone();
    crushed.loads[0].kind = LoadKind::Point {
        at: robot.length(),
        force: Vector3::new(-1e9, 0.0, 0.0),
        moment: Vector3::zeros(),
        frame: Frame::World,
    };
    assert!(solve_near(&crushed, &settings(method), &mut workspace).is_err());
    assert_same(&robot, method, &mut workspace, "after a crushed rod");
}

/// Other tolerances and intervals between solves change the mesh under the kept solution.
#[test]
fn other_settings_in_between_do_not_matter() {
    let (robot, mut workspace) = (thesis_rod(1.0, 0.02), Workspace::default());
    for (tolerance, shooting_intervals) in
        [(1e-4, None), (1e-12, None), (1e-3, Some(1)), (1e-9, Some(3)), (1e-11, Some(1))]
    {
        let between = Settings { tolerance, shooting_intervals, ..settings(Method::Shooting) };
        solve_near(&robot, &between, &mut workspace).unwrap_or_else(|error| panic!("{error}"));
        assert_same(
            &robot,
            Method::Shooting,
            &mut workspace,
            &format!("after {tolerance:e}, {shooting_intervals:?}"),
        );
    }
}

/// Rods of the sweep in one workspace, loads 1 % up: the branch is the same as from cold.
#[test]
fn a_small_change_of_random_rods_stays_on_the_branch() {
    for (index, method) in (0..100).flat_map(|index| [(index, Method::Shooting), (index, Method::Energy)]) {
        let robot = robustness::robot(11, index);
        let mut workspace = Workspace::default();
        if solve_near(&robot, &settings(method), &mut workspace).is_err() {
            continue;
        }
        let mut more = robot.clone();
        more.gravity *= 1.01;
        for load in &mut more.loads {
            if let LoadKind::Point { force, moment, .. } = &mut load.kind {
                (*force, *moment) = (1.01 * *force, 1.01 * *moment);
            }
        }
        assert_same(&more, method, &mut workspace, &robot.name);
    }
}
