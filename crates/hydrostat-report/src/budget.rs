//! A budget of tolerances as bars, the largest on top.

use crate::draw::{ACCENT, Anchor, Canvas, GRID, GRID_HEAVY, INK, MUTED, P, Pen, Rect, SECOND, Type, WHITE};
use crate::text::{fit, fixed};
use crate::ticks::{decimals, nice_step, ticks};
use hydrostat::budget::{Budget, Contribution, Displacement};
use hydrostat::verify::Experiment;

const SMALL: Type = Type::new(11.0, MUTED);
const NAME: Type = Type::new(12.0, INK);
const TITLE: Type = Type::bold(14.0, INK);
const BAR: &str = "#9fc3e6";
const TOTAL: &str = "#aab4c0";
/// Between two lines, and of a bar.
const STEP: f64 = 25.0;
const THICK: f64 = 14.0;
const WIDTH: f64 = 430.0;
const NAMES: f64 = 260.0;
/// More bars are not read; what is shown is at least this part of the total.
const MOST: usize = 16;
const LEAST: f64 = 0.01;

/// One bar per tolerance: root mean square over all rows to first order, with the samples' as a mark, and the range over the rows.
pub fn budget_svg(experiment: &Experiment, budget: &Budget) -> String {
    let total = &budget.total;
    let shown: Vec<&Contribution> = budget
        .contributions
        .iter()
        .filter(|part| part.displacement.rms_monte_carlo > LEAST * total.rms_monte_carlo)
        .take(MOST)
        .collect();
    let mut bars: Vec<(String, &Displacement, &str)> =
        shown.iter().map(|part| (label(part), &part.displacement, BAR)).collect();
    bars.push(("all together".to_owned(), total, TOTAL));

    let largest = bars.iter().map(|(_, part, _)| range(part)[1]).fold(budget.verified.rms, f64::max);
    let step = nice_step(1e3 * largest / 7.0);
    let high = (1e3 * largest / step).ceil().max(1.0) * step;
    let (left, top) = (NAMES + 20.0, 70.0);
    let frame = Rect::new(left, top, left + WIDTH, top + STEP * bars.len() as f64 + 6.0);
    let x = |length: f64| left + WIDTH * 1e3 * length / high;

    let mut page = Canvas::new();
    page.text(
        [14.0, 22.0],
        Anchor::Start,
        TITLE,
        &fit(&experiment.name, left + WIDTH - 14.0, |s| TITLE.width(s)),
    );
    let mut grid = Vec::new();
    for tick in ticks(0.0, high, step) {
        let at = x(1e-3 * tick);
        grid.push(([at, frame.y0], [at, frame.y1]));
        page.text([at, frame.y1 + 16.0], Anchor::Middle, SMALL, &fixed(tick, decimals(step)));
    }
    page.hairlines(&grid, Pen::new(GRID, 1.0));
    let name = "standard deviation of the points that are read, in mm";
    page.text([left + WIDTH / 2.0, frame.y1 + 34.0], Anchor::Middle, NAME, name);
    let left_out = budget.contributions.len() - shown.len();
    if left_out > 0 {
        let text = format!("{left_out} smaller ones are not shown");
        page.text([left - 8.0, frame.y1 + 16.0], Anchor::End, SMALL, &text);
    }
    for (i, (name, part, colour)) in bars.iter().enumerate() {
        let y = top + 3.0 + STEP * (i as f64 + 0.5);
        page.text([left - 8.0, y + 4.0], Anchor::End, NAME, &fit(name, NAMES, |s| NAME.width(s)));
        page.rect(Rect::new(left, y - THICK / 2.0, x(part.rms_first_order), y + THICK / 2.0), colour, None);
        let [low, high] = range(part).map(x);
        page.line([low, y], [high, y], Pen::new(INK, 1.2));
        for end in [low, high] {
            page.line([end, y - 3.5], [end, y + 3.5], Pen::new(INK, 1.2));
        }
        diamond(&mut page, [x(part.rms_monte_carlo), y]);
    }
    let found = x(budget.verified.rms);
    page.line([found, frame.y0], [found, frame.y1], FOUND);
    page.rect(frame, "none", Some(Pen::new(GRID_HEAVY, 1.0)));
    key(&mut page, [14.0, 48.0]);
    page.finish(frame.x1 + 18.0, frame.y1 + 44.0, "Budget of tolerances")
}

const FOUND: Pen = Pen::dashed(SECOND, 1.4, "5 3.5");

fn label(part: &Contribution) -> String {
    match &part.tolerance {
        Some(tolerance) => format!("{}, {}", tolerance.name, tolerance.show(tolerance.deviation)),
        None => "reading error".to_owned(),
    }
}

/// Smallest and largest over rows and points, by Monte Carlo.
fn range(part: &Displacement) -> [f64; 2] {
    let all = || part.monte_carlo.iter().flatten().copied().filter(|x| x.is_finite());
    [all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)]
}

fn diamond(page: &mut Canvas, c: P) {
    let ring = |r: f64| [[c[0], c[1] - r], [c[0] + r, c[1]], [c[0], c[1] + r], [c[0] - r, c[1]]];
    page.polygon(&ring(5.0), ACCENT);
    page.polygon(&ring(2.6), WHITE);
}

/// What bar, mark and lines are, in one row.
fn key(page: &mut Canvas, at: P) {
    let (mut x, y) = (at[0], at[1]);
    let middle = y - 4.0;
    let mut name = |page: &mut Canvas, text: &str, draw: &dyn Fn(&mut Canvas, f64)| {
        draw(page, x);
        page.text([x + 27.0, y], Anchor::Start, SMALL, text);
        x += 27.0 + SMALL.width(text) + 14.0;
    };
    name(page, "first order, rms over all rows", &|page, x| {
        page.rect(Rect::centred([x + 11.0, middle], 22.0, 9.0), BAR, None);
    });
    name(page, "Monte Carlo", &|page, x| diamond(page, [x + 11.0, middle]));
    name(page, "from row to row", &|page, x| {
        page.line([x, middle], [x + 22.0, middle], Pen::new(INK, 1.2));
        for end in [x, x + 22.0] {
            page.line([end, middle - 3.5], [end, middle + 3.5], Pen::new(INK, 1.2));
        }
    });
    name(page, "rms error that verify finds", &|page, x| page.line([x, middle], [x + 22.0, middle], FOUND));
}
