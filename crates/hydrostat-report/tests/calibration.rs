//! The page of a calibration shows what the calibration found, of few rows and of many.
#![allow(clippy::unwrap_used)]

mod drawn;

use drawn::{check, drawings, texts_are_apart};
use hydrostat::calibrate::{Calibration, Problem, calibrate, in_common};
use hydrostat::description::{CalibrationFlags, builtin};
use hydrostat::statics::Settings;
use hydrostat_report::{Provenance, calibration_page};
use nalgebra::DMatrix;

type Done = (Problem, Calibration);

/// The built-in bench with these quantities free.
fn gray(free: &[&str]) -> Done {
    let free = free.iter().map(|name| (*name).to_owned()).collect();
    let problem = builtin::calibration(&CalibrationFlags { free, ..Default::default() }).unwrap().value;
    let calibration = calibrate(&problem, &Settings::default()).unwrap();
    (problem, calibration)
}

fn page(done: &[Done]) -> String {
    calibration_page(done, &Provenance::default()).unwrap()
}

/// A thousand rows of the same readings.
fn large() -> Done {
    let (mut problem, mut calibration) = gray(&["youngs_modulus"]);
    let (measured, found) = (problem.experiment.rows.clone(), calibration.rows.clone());
    problem.experiment.rows = measured.into_iter().cycle().take(1000).collect();
    calibration.rows = found.into_iter().cycle().take(1000).collect();
    calibration.rows[500].after[0].error = 0.0123;
    (problem, calibration)
}

/// So many parameters, the last two strongly correlated.
fn with_parameters(count: usize) -> Done {
    let (mut problem, mut calibration) = gray(&["youngs_modulus"]);
    problem.parameters = vec![problem.parameters[0].clone(); count];
    calibration.parameters = vec![calibration.parameters[0].clone(); count];
    for (i, parameter) in problem.parameters.iter_mut().enumerate() {
        parameter.name = format!("parameter_{i}");
    }
    calibration.correlation =
        DMatrix::from_fn(count, count, |i, j| if i == j { 1.0 } else { 0.001 * (i + j) as f64 });
    calibration.correlation[(count - 2, count - 1)] = -0.97;
    calibration.correlation[(count - 1, count - 2)] = -0.97;
    (problem, calibration)
}

fn numbers(text: &str) -> Vec<f64> {
    text.split(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-')))
        .filter_map(|n| n.parse().ok())
        .collect()
}

#[test]
fn two_calibrations_are_one_page() {
    let done = [gray(&["youngs_modulus"]), gray(&["youngs_modulus", "length"])];
    let html = page(&done);
    check(&html);
    let shown = html.replace("<wbr/>", "");
    for words in ["54.61 GPa", "54.12 to 55.10 GPa", "390.27 to 392.44 mm", "section.rod.length", "−2.42"] {
        assert!(shown.contains(words), "{words}");
    }
    assert!(html.contains(&in_common(&[&done[0].1, &done[1].1]).unwrap()));
    assert!(!page(&done[..1]).contains("Together"));
    assert_eq!(drawings(&html).len(), 1 + 2 + 2 + 2 + 1, "intervals, residuals, one grid");
    for outside in ["<script", "<link", "<img", "url(", "@import", "src="] {
        assert!(!html.contains(outside), "{outside}");
    }
    assert!(calibration_page(&[], &Provenance::default()).is_none());
}

/// 95 % intervals of a fit without bounds are symmetric about the value; the stated value lies below.
#[test]
fn an_interval_is_drawn_about_its_value() {
    let drawing = drawings(&page(&[gray(&["youngs_modulus"])])).swap_remove(0);
    let document = roxmltree::Document::parse(&drawing).unwrap();
    let of = |tag: &str| document.descendants().rfind(|n| n.has_tag_name(tag)).unwrap();
    let number = |tag: &str, name: &str| of(tag).attribute(name).unwrap().parse::<f64>().unwrap();
    let (bar, width, dot) = (number("rect", "x"), number("rect", "width"), number("circle", "cx"));
    assert!((bar + width / 2.0 - dot).abs() < 0.02, "{drawing}");
    let stated = numbers(of("path").attribute("d").unwrap())[0];
    // 54.61 GPa with 54.12 to 55.10, stated 54.00
    let part = (dot - stated) / (width / 2.0);
    assert!((part - (54.61 - 54.0) / 0.49).abs() < 0.05, "{part}");
}

/// Heights of the dots are one linear map of the residuals, before and after.
#[test]
fn residuals_are_drawn_to_one_scale() {
    let (problem, calibration) = gray(&["youngs_modulus"]);
    let off = |e: &hydrostat::verify::PointError| 1e3 * (e.predicted.y - e.observed.y);
    let residuals = calibration.rows.iter().map(|row| off(&row.before[0]));
    let residuals: Vec<f64> =
        residuals.chain(calibration.rows.iter().map(|row| off(&row.after[0]))).collect();
    let drawings = drawings(&page(&[(problem, calibration)]));
    let y = drawings.iter().find(|svg| svg.contains("y: predicted")).unwrap();
    let document = roxmltree::Document::parse(y).unwrap();
    let paths = document.descendants().filter_map(|n| n.attribute("d"));
    let heights: Vec<f64> = paths
        .filter(|d| d.ends_with("h.01"))
        .flat_map(|d| numbers(d).into_iter().skip(1).step_by(3))
        .collect();
    assert_eq!(heights.len(), 22);
    let scale = (heights[10] - heights[0]) / (residuals[10] - residuals[0]);
    assert!(scale < -5.0, "px per mm, upward: {scale}");
    for (height, residual) in heights.iter().zip(&residuals) {
        // a coordinate is rounded to 0.1 px
        assert!((height - heights[0] - scale * (residual - residuals[0])).abs() < 0.2, "{residual}");
    }
}

#[test]
fn a_thousand_rows_stay_small() {
    let small = page(&[gray(&["youngs_modulus"])]);
    let html = page(&[large()]);
    check(&html);
    assert!(html.contains("The 10 of 1000 rows with the largest errors") && html.contains("12.30"));
    assert!(!small.contains("with the largest errors"));
    assert!(html.len() < small.len() + 80_000, "{} bytes", html.len());
    let texts = |html: &str| drawings(html).iter().map(|svg| svg.matches("<text").count()).sum::<usize>();
    assert!(texts(&html) <= texts(&small) + 8, "{}", texts(&html));
}

#[test]
fn many_parameters_are_listed_by_their_strongest_pairs() {
    let grid = page(&[with_parameters(12)]);
    let pairs = page(&[with_parameters(13)]);
    check(&grid);
    check(&pairs);
    assert!(grid.contains("Correlations") && !grid.contains("Strongest"));
    assert!(pairs.contains("Strongest") && !pairs.contains("Correlations<"));
    let first = &pairs[pairs.find("Strongest").unwrap()..];
    let row = &first[first.find("<td").unwrap()..first.find("</tr>\n    <tr>").unwrap()];
    for words in ["parameter_11", "parameter_12", "−0.97"] {
        assert!(row.contains(words), "{row}");
    }
    for (name, done) in
        [("twelve", with_parameters(12)), ("large", large()), ("gray", gray(&["youngs_modulus", "length"]))]
    {
        drawings(&page(&[done])).iter().for_each(|svg| texts_are_apart(name, svg));
    }
}

#[test]
fn names_are_escaped() {
    let (mut problem, mut calibration) = gray(&["youngs_modulus", "length"]);
    problem.experiment.name = "<script>alert(1)</script> & more".into();
    problem.experiment.inputs[0].column = "</table>".into();
    for parameter in &mut problem.parameters {
        parameter.name = "</svg><script>".into();
    }
    calibration.parameters[0].parameter.name = "<script>".into();
    calibration.warnings.push("error < 1 mm & more".into());
    let html = page(&[(problem, calibration)]);
    check(&html);
    assert!(!html.contains("<script"));
}

#[test]
fn degenerate_calibrations_are_printed() {
    let done = gray(&["youngs_modulus", "length"]);
    let print = |change: &dyn Fn(&mut Problem, &mut Calibration)| {
        let (mut problem, mut calibration) = done.clone();
        change(&mut problem, &mut calibration);
        check(&page(&[(problem, calibration)]));
    };
    print(&|_, c| c.rows.clear());
    print(&|_, c| c.rows.truncate(1));
    print(&|p, _| p.experiment.inputs.clear());
    print(&|p, _| p.experiment.points.clear());
    print(&|p, _| p.experiment.points[0].axes = vec![2]);
    print(&|p, _| p.experiment.points[0].axes = vec![7]);
    print(&|_, c| c.rows.iter_mut().for_each(|row| row.inputs.clear()));
    print(&|_, c| c.rows[0].after[0].error = f64::NAN);
    print(&|_, c| c.rows[0].after[0].observed.x = f64::INFINITY);
    print(&|p, _| p.experiment.points[0].reading_error = 0.0);
    print(&|_, c| c.correlation.fill(f64::NAN));
    print(&|_, c| {
        c.parameters[0].standard_error = None;
        c.parameters[0].interval_95 = None;
        c.parameters[0].before = c.parameters[0].value;
    });
    print(&|_, c| (c.left_out, c.chance) = (None, None));
    print(&|p, c| {
        p.folds = 3;
        (c.folds, c.holdout) = (Some(c.after), Some([c.before, c.after]));
        c.verdict.clear();
    });
}
