//! What a fit leaves, coordinate by coordinate, before and after.

use crate::chart::{joined, over};
use crate::draw::{ACCENT, Anchor, Canvas, GRID_HEAVY, P, Pen, Rect, SECOND};
use crate::overlay::AXES;
use crate::panel::{BAND, NAME, Panel, SMALL, range};
use crate::text::fit;
use crate::ticks::nice_step;
use hydrostat::calibrate::{CalibratedRow, Calibration};
use hydrostat::verify::{Experiment, PointError};

/// Rows of up to this number have marks that are joined; more have dots alone.
const FEW: usize = 60;
/// Of a field; its scale is its own where the other's reach is so many times as large.
const SIZE: [f64; 2] = [310.0, 132.0];
const GAP: f64 = 66.0;
const OWN_SCALE: f64 = 3.0;

/// One drawing per axis that was read: predicted less observed, before and calibrated side by side.
pub(crate) fn residual_svgs(experiment: &Experiment, calibration: &Calibration) -> Vec<String> {
    let read = |axis: &usize| experiment.points.iter().any(|point| point.axes.contains(axis));
    (0..3).filter(read).map(|axis| residual_svg(experiment, calibration, axis)).collect()
}

fn residual_svg(experiment: &Experiment, calibration: &Calibration, axis: usize) -> String {
    let rows = &calibration.rows;
    // a single input tells rows apart; with several, their order does
    let input = if let [input] = experiment.inputs.as_slice() { Some(input) } else { None };
    let inputs: Vec<&[f64]> = rows.iter().map(|row| row.inputs.as_slice()).collect();
    let (xs, x_name) = over(input, &inputs);
    let [before, after] = [|row: &CalibratedRow| row.before.clone(), |row: &CalibratedRow| row.after.clone()]
        .map(|side| series(experiment, rows, &xs, axis, side));
    let reading = reading_error(experiment, axis);
    let reaches = [&before, &after].map(|series| reach(series).max(1.5 * reading));
    let largest = reaches[0].max(reaches[1]);
    let scales = if largest > OWN_SCALE * reaches[0].min(reaches[1]) { reaches } else { [largest; 2] };

    let mut page = Canvas::new();
    let heading = format!("{}: predicted − observed in mm", AXES[axis]);
    page.text([44.0, 14.0], Anchor::Start, NAME, &heading);
    let mut left = 44.0;
    for (name, series, reach, colour) in
        [("before", &before, scales[0], SECOND), ("calibrated", &after, scales[1], ACCENT)]
    {
        let step = nice_step(if reach > 0.0 { reach / 4.0 } else { 0.2 });
        let reach = (reach / step).ceil().max(1.0) * step;
        let frame = Rect::new(left, 36.0, left + SIZE[0], 36.0 + SIZE[1]);
        let panel = Panel { frame, x: range(&xs), y: [-reach, reach] };
        page.text([left, 31.0], Anchor::Start, SMALL, name);
        field(&mut page, &panel, series, reading, [input.is_none(), rows.len() <= FEW], step, colour);
        let below = [left + SIZE[0] / 2.0, frame.y1 + 32.0];
        page.text(below, Anchor::Middle, SMALL, &fit(&x_name, SIZE[0], |s| SMALL.width(s)));
        left += SIZE[0] + GAP;
    }
    page.finish(left - GAP + 16.0, 36.0 + SIZE[1] + 40.0, "Residuals before and after")
}

/// Band of the reading error, grid, zero, and one mark for each coordinate; series are those of one measured point.
fn field(
    page: &mut Canvas,
    panel: &Panel,
    series: &[Vec<P>],
    reading: f64,
    [by_number, few]: [bool; 2],
    step: f64,
    colour: &'static str,
) {
    panel.band(page, [-reading, reading], BAND);
    let step_x = nice_step(((panel.x[1] - panel.x[0]) / 8.0).max(if by_number { 1.0 } else { 0.0 }));
    panel.grid(page, [step_x, step]);
    let zero = panel.at([panel.x[0], 0.0])[1];
    page.hairlines(&[([panel.frame.x0, zero], [panel.frame.x1, zero])], Pen::new(GRID_HEAVY, 1.2));
    for points in series {
        let points: Vec<P> = points.iter().map(|p| panel.at(*p)).collect();
        if few {
            joined(page, &points, Pen::new(colour, 1.2));
        }
        page.dots(&points, Pen::new(colour, if few { 5.4 } else { 1.8 }));
    }
}

/// One series per measured point whose `axis` was read, mm.
fn series(
    experiment: &Experiment,
    rows: &[CalibratedRow],
    xs: &[f64],
    axis: usize,
    side: impl Fn(&CalibratedRow) -> Vec<PointError>,
) -> Vec<Vec<P>> {
    let sides: Vec<Vec<PointError>> = rows.iter().map(side).collect();
    let points = experiment.points.iter().enumerate().filter(|(_, point)| point.axes.contains(&axis));
    let residual = |error: &PointError| 1e3 * (error.predicted[axis] - error.observed[axis]);
    let of_point = |j: usize| {
        let rows = sides.iter().zip(xs);
        rows.filter_map(move |(row, x)| row.get(j).map(|error| [*x, residual(error)]))
    };
    points.map(|(j, _)| of_point(j).filter(|p| p[1].is_finite()).collect()).collect()
}

/// Largest of the points whose `axis` was read, mm.
fn reading_error(experiment: &Experiment, axis: usize) -> f64 {
    let points = experiment.points.iter().filter(|point| point.axes.contains(&axis));
    1e3 * points.map(|point| point.reading_error).fold(0.0, f64::max)
}

fn reach(series: &[Vec<P>]) -> f64 {
    series.iter().flatten().map(|p| p[1].abs()).fold(0.0, f64::max)
}
