//! Errors against what was varied, and the residual vectors.

use crate::draw::{ACCENT, Anchor, Canvas, GRID, GRID_HEAVY, INK, P, Pen, Rect, SECOND, Type, WHITE};
use crate::labels::{self, Label, Obstacles};
use crate::overlay::{AXES, CONSTANT_CURVATURE, Plane, along};
use crate::panel::{BAND, NAME, Panel, SMALL, range};
use crate::text::{self, decimals_of, fit, fixed, millimetres};
use crate::ticks::{decimals, nice_step, ticks};
use hydrostat::verify::{Experiment, Input, Verification};

const LABELS: usize = 14;

/// Error of every measured point over the first varied input (over the row's number without one).
pub(crate) fn error_svg(experiment: &Experiment, verification: &Verification) -> String {
    let input = experiment.inputs.first();
    let inputs: Vec<&[f64]> = verification.rows.iter().map(|row| row.inputs.as_slice()).collect();
    let (xs, x_name) = over(input, &inputs);

    // errors in mm, one series per measured point
    let points = verification.rows.iter().map(|r| r.points.len()).max().unwrap_or(0);
    let model: Vec<Vec<P>> =
        (0..points).map(|j| series(verification, &xs, j, |_, p| 1e3 * p.error)).collect();
    let constant: Vec<Vec<P>> = (0..points)
        .map(|j| {
            series(verification, &xs, j, |row, _| {
                1e3 * constant_curvature_error(experiment, verification, row, j)
            })
        })
        .collect();
    let reading = 1e3 * experiment.points.iter().map(|p| p.reading_error).fold(0.0, f64::max);

    let (left, top, width, height) = (44.0, 40.0, 366.0, 262.0);
    let frame = Rect::new(left, top, left + width, top + height);
    let finite = |v: &f64| v.is_finite();
    let high =
        model.iter().chain(&constant).flatten().map(|p| p[1]).filter(finite).fold(2.0 * reading, f64::max);
    let step_y = nice_step(if high > 0.0 { high / 6.0 } else { 0.2 });
    let high = (high / step_y).ceil().max(1.0) * step_y;
    let [low_x, high_x] = range(&xs);
    let step_x = nice_step(((high_x - low_x) / 9.0).max(if input.is_none() { 1.0 } else { 0.0 }));
    let panel = Panel { frame, x: [low_x, high_x], y: [0.0, high] };
    let at = |p: P| panel.at(p);

    let mut page = Canvas::new();
    if reading > 0.0 {
        panel.band(&mut page, [0.0, reading], BAND);
    }
    panel.grid(&mut page, [step_x, step_y]);
    page.text([frame.x0, frame.y0 - 26.0], Anchor::Start, NAME, "error in mm");
    page.text(
        [(frame.x0 + frame.x1) / 2.0, frame.y1 + 34.0],
        Anchor::Middle,
        NAME,
        &fit(&x_name, width, |s| NAME.width(s)),
    );

    for points in &constant {
        let points: Vec<P> = points.iter().map(|p| at(*p)).collect();
        joined(&mut page, &points, CONSTANT_CURVATURE);
        for p in points.iter().filter(|p| p[1].is_finite()) {
            diamond(&mut page, *p);
        }
    }
    for points in &model {
        let points: Vec<P> = points.iter().map(|p| at(*p)).collect();
        joined(&mut page, &points, Pen::new(ACCENT, 1.6));
        for p in points {
            page.circle(p, 3.4, ACCENT, None);
        }
    }
    // which point, where there are several: beside the ends of the lines, kept apart
    let several = points > 1;
    let mut ends: Vec<(f64, String)> = Vec::new();
    for (j, (model, constant)) in model.iter().zip(&constant).enumerate().filter(|_| several) {
        let name = experiment.points.get(j).map_or(String::new(), |point| millimetres(point.at));
        let lines = [model.last(), constant.last()].into_iter().flatten().map(|p| at(*p)[1]);
        ends.extend(lines.filter(|y| y.is_finite()).map(|y| (y + 4.0, name.clone())));
    }
    ends.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut free_below = f64::INFINITY;
    for (y, name) in ends {
        free_below = y.min(free_below - 15.0);
        page.text([frame.x1 + 5.0, free_below], Anchor::Start, SMALL, &name);
    }
    key(&mut page, [frame.x0, frame.y0 - 9.0], reading);
    page.finish(frame.x1 + if several { 64.0 } else { 16.0 }, frame.y1 + 42.0, "Error against load")
}

/// Where rows stand along the horizontal axis: by an input, in its own unit, or by their number; and the name of that axis.
pub(crate) fn over(input: Option<&Input>, inputs: &[&[f64]]) -> (Vec<f64>, String) {
    let Some(input) = input else {
        return ((1..=inputs.len()).map(|i| i as f64).collect(), "row".to_owned());
    };
    let (unit, size) = &input.unit;
    let xs = inputs.iter().map(|row| row.first().copied().unwrap_or(0.0) / size).collect();
    (xs, if unit.is_empty() { input.column.clone() } else { format!("{} in {unit}", input.column) })
}

/// Line, mark and name of each series, in one row.
fn key(page: &mut Canvas, at: P, reading: f64) {
    let (mut x, y) = (at[0], at[1]);
    let middle = y - 4.0;
    page.line([x, middle], [x + 22.0, middle], Pen::new(ACCENT, 1.6));
    page.circle([x + 11.0, middle], 3.4, ACCENT, None);
    page.text([x + 27.0, y], Anchor::Start, SMALL, "model");
    x += 27.0 + SMALL.width("model") + 14.0;
    page.line([x, middle], [x + 22.0, middle], CONSTANT_CURVATURE);
    diamond(page, [x + 11.0, middle]);
    page.text([x + 27.0, y], Anchor::Start, SMALL, "constant curvature");
    x += 27.0 + SMALL.width("constant curvature") + 14.0;
    if reading > 0.0 {
        page.rect(Rect::centred([x + 11.0, middle], 22.0, 9.0), BAND, None);
        let text = format!("reading error {} mm", crate::text::short(reading, 2));
        page.text([x + 27.0, y], Anchor::Start, SMALL, &text);
    }
}

fn diamond(page: &mut Canvas, c: P) {
    let ring = |r: f64| [[c[0], c[1] - r], [c[0] + r, c[1]], [c[0], c[1] + r], [c[0] - r, c[1]]];
    page.polygon(&ring(4.6), SECOND);
    page.polygon(&ring(2.6), WHITE);
}

/// A line through the points where it can be read as a function: no value of the input twice.
pub(crate) fn joined(page: &mut Canvas, points: &[P], pen: Pen) {
    let mut sorted: Vec<P> =
        points.iter().copied().filter(|p| p[0].is_finite() && p[1].is_finite()).collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
    if sorted.windows(2).all(|w| w[1][0] - w[0][0] > 1e-6) {
        page.polyline(&sorted, pen);
    }
}

fn series(
    verification: &Verification,
    xs: &[f64],
    j: usize,
    value: impl Fn(usize, &hydrostat::verify::PointError) -> f64,
) -> Vec<P> {
    let rows = verification.rows.iter().enumerate().zip(xs);
    rows.filter_map(|((i, row), x)| row.points.get(j).map(|p| [*x, value(i, p)])).collect()
}

/// Distance of the constant-curvature shape from an observed point, over the axes that were read.
fn constant_curvature_error(
    experiment: &Experiment,
    verification: &Verification,
    row: usize,
    j: usize,
) -> f64 {
    let Some((row, point)) = verification.rows.get(row).and_then(|r| Some((r, r.points.get(j)?))) else {
        return f64::NAN;
    };
    let Some(p) = along(&row.constant_curvature_shape, point.at / experiment.robot.length()) else {
        return f64::NAN;
    };
    let axes = experiment.points.get(j).map_or(&[0, 1, 2][..], |p| &p.axes);
    axes.iter().filter(|&&a| a < 3).map(|&a| (p[a] - point.observed[a]).powi(2)).sum::<f64>().sqrt()
}

/// Observed minus predicted in one plane of the bench, to scale, with a disc of the reading error.
pub(crate) fn residual_svg(
    experiment: &Experiment,
    verification: &Verification,
    plane: Plane,
    names: &[String],
) -> String {
    let mut residuals = Vec::new(); // row, point, mm right and up
    for (i, row) in verification.rows.iter().enumerate() {
        for (j, p) in row.points.iter().enumerate() {
            let read = |axis| experiment.points.get(j).is_none_or(|point| point.axes.contains(&axis));
            let d = (p.observed - p.predicted) * 1e3;
            if read(plane.right) && read(plane.up) && d.iter().all(|x| x.is_finite()) {
                residuals.push((i, j, [d[plane.right], plane.up_sign * d[plane.up]]));
            }
        }
    }
    let reading = 1e3 * experiment.points.iter().map(|p| p.reading_error).fold(0.0, f64::max);
    let most = residuals.iter().map(|(_, _, d)| d[0].abs().max(d[1].abs())).fold(1.3 * reading, f64::max);
    let step = nice_step(if most > 0.0 { most / 4.5 } else { 0.2 });
    let reach = (most / step + 0.35).ceil().max(1.0) * step;

    let (left, top, side) = (44.0, 40.0, 262.0);
    let frame = Rect::new(left, top, left + side, top + side);
    let scale = side / (2.0 * reach);
    let centre = [left + side / 2.0, top + side / 2.0];
    let at = |d: P| [centre[0] + scale * d[0], centre[1] - scale * d[1]];
    let mut page = Canvas::new();
    let mut grid = Vec::new();
    for t in ticks(-reach, reach, step) {
        let [x, y] = at([t, t]);
        grid.extend([([x, frame.y0], [x, frame.y1]), ([frame.x0, y], [frame.x1, y])]);
        page.text([x, frame.y1 + 16.0], Anchor::Middle, SMALL, &fixed(t, decimals(step)));
        let up = t * plane.up_sign;
        page.text([frame.x0 - 7.0, y + 4.0], Anchor::End, SMALL, &fixed(up, decimals(step)));
    }
    page.hairlines(&grid, Pen::new(GRID, 1.0));
    if reading > 0.0 {
        page.circle(centre, reading * scale, BAND, None);
    }
    let axes =
        [([frame.x0, centre[1]], [frame.x1, centre[1]]), ([centre[0], frame.y0], [centre[0], frame.y1])];
    page.hairlines(&axes, Pen::new(GRID_HEAVY, 1.0));
    page.rect(frame, "none", Some(Pen::new(GRID_HEAVY, 1.0)));
    page.text([frame.x0, frame.y0 - 26.0], Anchor::Start, NAME, "observed − predicted");
    let upright = format!("{} in mm", AXES[plane.up]);
    page.text([frame.x0, frame.y0 - 9.0], Anchor::Start, SMALL, &upright);
    let level = format!("{} in mm", AXES[plane.right]);
    page.text([centre[0], frame.y1 + 34.0], Anchor::Middle, NAME, &level);

    // arrows from the prediction, which is the middle
    let mut obstacles = Obstacles { within: Some(frame.grown(-3.0)), ..Obstacles::default() };
    let mut wanted = Vec::new();
    let every = residuals.len().div_ceil(LABELS).max(1);
    for (k, (i, _, d)) in residuals.iter().enumerate() {
        let p = at(*d);
        page.line(centre, p, Pen::new("#9fc3e6", 0.9));
        page.circle(p, 3.2, ACCENT, None);
        obstacles.boxes.push(Rect::centred(p, 8.0, 8.0));
        obstacles.lines.push((centre, p));
        if k % every == 0 || experiment.inputs.len() != 1 && residuals.len() <= 60 {
            let prefer = [p[0] - centre[0], p[1] - centre[1] + 1e-6];
            let text = names.get(*i).cloned().unwrap_or_default();
            wanted.push(Label { at: p, prefer, text, style: Type::new(10.5, INK) });
        }
    }
    labels::place(&mut page, &mut obstacles, &wanted);
    let width = page.bounds.x1.max(frame.x1 + 14.0) + 2.0;
    page.finish(width, frame.y1 + 42.0, "Residual vectors")
}

/// What labels the rows: the varied input where there is one, else the row's number.
pub(crate) fn row_names(experiment: &Experiment, verification: &Verification) -> Vec<String> {
    let rows = &verification.rows;
    let [input] = experiment.inputs.as_slice() else {
        return (1..=rows.len()).map(|i| i.to_string()).collect();
    };
    let (unit, size) = &input.unit;
    let values = rows.iter().map(|r| r.inputs.first().copied().unwrap_or(f64::NAN) / size);
    let digits = decimals_of(values.clone());
    values
        .map(|x| fit(format!("{} {unit}", fixed(x, digits)).trim_end(), 110.0, |s| text::width(s, 11.0)))
        .collect()
}
