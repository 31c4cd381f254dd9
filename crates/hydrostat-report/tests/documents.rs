//! Drawings and pages are well-formed, escape what users write, and survive degenerate input.
#![allow(clippy::unwrap_used)]

#[path = "../examples/synthetic/mod.rs"]
mod synthetic;

mod drawn;

use drawn::{check, drawings, texts_are_apart};
use hydrostat::solution::Check;
use hydrostat::verify::{Experiment, Verification};
use hydrostat::{Equilibrium, Robot};
use hydrostat_report::{Provenance, budget_svg, shape_svg, verification_page};
use nalgebra::Vector3;
use synthetic::v;

fn page(experiment: &Experiment, verification: &Verification) -> String {
    verification_page(experiment, verification, &Provenance::default())
}

fn one() -> (Robot, Equilibrium) {
    let (_, robot, shape) = synthetic::gallery().swap_remove(1);
    (robot, shape)
}

#[test]
fn gallery_is_well_formed() {
    for (_, robot, equilibrium) in synthetic::gallery() {
        check(&shape_svg(&robot, &equilibrium));
    }
    for (_, (experiment, verification)) in synthetic::benches() {
        check(&page(&experiment, &verification));
    }
}

#[test]
fn names_are_escaped() {
    let (mut robot, equilibrium) = one();
    robot.name = "<b> & \"quoted\" \u{1}".into();
    robot.sections[0].name = "</svg><script>".into();
    robot.loads[0].name = Some("a < b & c".into());
    let svg = shape_svg(&robot, &equilibrium);
    check(&svg);
    assert!(!svg.contains("<script>") && !svg.contains("<b>") && svg.contains("&lt;b&gt;"));

    let (mut experiment, mut verification) = synthetic::gray();
    experiment.name = "<script>alert(1)</script> & more".into();
    experiment.inputs[0].unit.0 = "<g>".into();
    experiment.inputs[0].column = "</table>".into();
    verification.verdict.push("error < 1 mm & more".into());
    let html = page(&experiment, &verification);
    check(&html);
    assert!(!html.contains("<script") && !html.contains("<g>0"));
}

#[test]
fn page_needs_nothing_else() {
    let (experiment, verification) = synthetic::gray();
    let html = page(&experiment, &verification);
    for outside in ["<script", "<link", "<img", "url(", "@import", "src="] {
        assert!(!html.contains(outside), "{outside}");
    }
}

#[test]
fn degenerate_robots_are_drawn() {
    let (robot, shape) = one();
    let draw = |change: &dyn Fn(&mut Robot, &mut Equilibrium)| {
        let (mut robot, mut shape) = (robot.clone(), shape.clone());
        change(&mut robot, &mut shape);
        check(&shape_svg(&robot, &shape));
    };
    draw(&|_, e| e.stations.clear());
    draw(&|_, e| e.stations.truncate(1));
    draw(&|r, _| r.sections.clear());
    draw(&|r, _| r.sections[0].length = 0.0);
    draw(&|r, e| {
        r.sections.clear();
        e.stations.clear();
        r.gravity = Vector3::zeros();
    });
    draw(&|_, e| e.stations.iter_mut().for_each(|s| s.position = Vector3::zeros()));
    draw(&|_, e| e.stations[50].position.x = f64::NAN);
    draw(&|_, e| e.stations.iter_mut().for_each(|s| s.position = v(f64::NAN, f64::INFINITY, 0.0)));
    draw(&|_, e| e.tip.position = v(f64::NAN, 0.0, 0.0));
    draw(&|r, _| r.gravity = v(f64::NAN, 0.0, 0.0));
    draw(&|r, _| {
        r.loads.push(hydrostat::model::Load { name: None, kind: synthetic::hung(f64::NAN, f64::NAN) })
    });
    draw(&|r, _| r.loads.iter_mut().for_each(|l| l.kind = synthetic::hung(9.0, 0.0)));
    draw(&|r, _| r.name = "x".repeat(500));
    draw(&|r, _| r.name.clear());
    draw(&|_, e| {
        e.report.stable = Some(false);
        e.checks[0].ok = false;
    });
}

#[test]
fn failed_checks_are_said() {
    let (robot, mut equilibrium) = one();
    equilibrium.checks[0].ok = false;
    equilibrium.checks[0].value = 0.0123;
    equilibrium.report.stable = Some(false);
    let svg = shape_svg(&robot, &equilibrium);
    assert!(svg.contains("Check failed: strain is 1.23 % at 0 mm from the base, its limit 1 %."));
    assert!(svg.contains("Unstable"));

    equilibrium.checks[0] =
        Check { name: "tension", value: 600.0, limit: 500.0, ok: false, at: None, tendons: vec!["a".into()] };
    let svg = shape_svg(&robot, &equilibrium);
    assert!(svg.contains("Check failed: tension is 600 N in tendon a, its limit 500 N."));
    equilibrium.checks[0] = Check {
        name: "slack",
        value: 2.0,
        tendons: vec!["b".into(), "c".into()],
        ..equilibrium.checks[0].clone()
    };
    assert!(shape_svg(&robot, &equilibrium).contains("Check failed: b, c slack although pulled in."));
}

#[test]
fn degenerate_benches_are_printed() {
    let print = |change: &dyn Fn(&mut Experiment, &mut Verification)| {
        for (_, (mut experiment, mut verification)) in synthetic::benches() {
            change(&mut experiment, &mut verification);
            check(&page(&experiment, &verification));
        }
    };
    print(&|_, b| b.rows.clear());
    print(&|a, _| a.inputs.clear());
    print(&|a, _| a.points.clear());
    print(&|a, _| a.points[0].axes = vec![1]);
    print(&|a, _| a.points[0].axes = vec![7]);
    print(&|a, _| a.robot.gravity = Vector3::zeros());
    print(&|a, _| a.robot.sections.clear());
    print(&|_, b| b.rows.iter_mut().for_each(|r| r.shape.clear()));
    print(&|_, b| b.rows.iter_mut().for_each(|r| r.constant_curvature_shape.clear()));
    print(&|_, b| b.rows.iter_mut().for_each(|r| r.points.clear()));
    print(&|_, b| b.rows.iter_mut().for_each(|r| r.inputs.clear()));
    print(&|_, b| b.rows[0].points[0].error = f64::NAN);
    print(&|_, b| b.rows[0].points[0].observed.x = f64::INFINITY);
    print(&|_, b| b.rows[0].shape[3].y = f64::NAN);
    print(&|a, _| a.points[0].reading_error = 0.0);
    print(&|_, b| {
        let rows = b.rows.clone();
        (0..30).for_each(|_| b.rows.extend(rows.iter().cloned()));
    });
}

#[test]
fn texts_do_not_overlap_or_leave_the_page() {
    for (name, mut robot, equilibrium) in synthetic::gallery() {
        texts_are_apart(name, &shape_svg(&robot, &equilibrium));
        robot.loads.iter_mut().for_each(|load| load.name = Some("a load with a long name".into()));
        robot.name = "A robot whose name fills more than one line of this drawing, and ".repeat(3);
        texts_are_apart(name, &shape_svg(&robot, &equilibrium));
    }
    for (name, (experiment, verification)) in synthetic::benches() {
        let draw = |change: &dyn Fn(&mut Experiment, &mut Verification)| {
            let (mut experiment, mut verification) = (experiment.clone(), verification.clone());
            change(&mut experiment, &mut verification);
            for svg in drawings(&page(&experiment, &verification)) {
                texts_are_apart(name, &svg);
            }
        };
        draw(&|_, _| ());
        draw(&|_, b| b.rows.extend(b.rows.clone()));
        draw(&|a, _| a.inputs.iter_mut().for_each(|i| i.unit = ("ng".into(), 1e-12)));
        draw(&|a, _| a.inputs.iter_mut().for_each(|i| i.column = "a very long name of a column ".repeat(4)));
    }
}

#[cfg(feature = "png")]
mod png {
    use super::*;
    use hydrostat_report::svg_to_png;

    fn side(bytes: &[u8], at: usize) -> u32 {
        u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
    }

    #[test]
    fn png_has_the_right_size_and_something_on_it() {
        for scale in [1.0_f32, 2.0] {
            let (robot, equilibrium) = one();
            let svg = shape_svg(&robot, &equilibrium);
            let png = svg_to_png(&svg, scale).unwrap();
            let document = roxmltree::Document::parse(&svg).unwrap();
            let expected = |a: &str| {
                let px: f32 = document.root_element().attribute(a).unwrap().parse().unwrap();
                (px * scale).round() as u32
            };
            assert_eq!(&png[1..4], b"PNG");
            assert_eq!((side(&png, 16), side(&png, 20)), (expected("width"), expected("height")));
            assert!(png.len() > 10_000);
        }
    }

    #[test]
    fn drawings_of_a_page_become_pictures() {
        let (experiment, verification) = synthetic::spatial();
        let html = page(&experiment, &verification);
        let drawings = drawings(&html);
        assert_eq!(drawings.len(), 5);
        for drawing in drawings {
            svg_to_png(&drawing, 1.0).unwrap();
        }
    }

    #[test]
    fn what_is_not_ours_is_refused() {
        let say = |svg: &str, scale| svg_to_png(svg, scale).unwrap_err().to_string();
        assert!(say("<svg", 1.0).contains("not XML"));
        assert!(say("<html/>", 1.0).contains("the root is <html>"));
        let svg = |inner: &str| format!(r#"<svg width="10" height="10">{inner}</svg>"#);
        assert!(say(&svg("<ellipse/>"), 1.0).contains("element <ellipse>"));
        assert!(say(&svg(r##"<path d="M0 0 C1 1" fill="none"/>"##), 1.0).contains("path"));
        assert!(say(&svg(""), 1e9).contains("choose a scale"));
        assert!(say(&svg(""), f32::NAN).contains("choose a scale"));
    }
}

/// Bars of the thesis's bench, with names that need escaping and with one that is no number.
#[test]
fn budgets_are_drawn() {
    let (mut experiment, tolerances) = hydrostat::description::builtin::budget(&[]).unwrap().value;
    let settings = hydrostat::statics::Settings::default();
    let mut budget = hydrostat::budget::budget(&experiment, &tolerances, 20, 1, &settings).unwrap();
    let svg = budget_svg(&experiment, &budget);
    check(&svg);
    assert!(svg.contains("grid_tilt.z, 0.50 deg") && svg.contains("smaller ones are not shown"));
    experiment.name = "<b> & more".into();
    budget.contributions[0].displacement.monte_carlo[0][0] = f64::NAN;
    budget.contributions[1].displacement.rms_first_order = f64::NAN;
    check(&budget_svg(&experiment, &budget));
    budget.contributions.clear();
    check(&budget_svg(&experiment, &budget));
}
