//! The bent backbone to scale, from the side and from the front.

use crate::describe;
use crate::draw::{
    ACCENT, ACCENT_LIGHT, Anchor, Canvas, GRID, GRID_HEAVY, INK, MUTED, P, Pen, Rect, SECOND, Type, WHITE,
};
use crate::labels::{self, Label, Obstacles};
use crate::loads::{self, Shape};
use crate::tendons;
use crate::text::{fixed, millimetres, prefixed, wrap};
use crate::ticks::{decimals, nice_step, ticks};
use crate::view::{Axis, View, direction_in_words, direction_name, side_and_front};
use hydrostat::model::{Command, Section};
use hydrostat::solution::TendonState;
use hydrostat::{Equilibrium, Robot};
use nalgebra::Vector3;

const MARGIN: f64 = 28.0;
const ROOM: [f64; 2] = [700.0, 470.0];
const GAP: f64 = 34.0;
const SMALLEST_PANEL: [f64; 2] = [190.0, 170.0];
const SMALLEST_PAGE: f64 = 640.0;
const HEADING: f64 = 34.0;
const BODY: Type = Type::new(13.0, INK);
const SMALL: Type = Type::new(12.0, MUTED);

/// Draws an equilibrium to scale: side view (the plane in which the robot bends most) and front view, the same vertical
/// axis for both, loads as arrows, world coordinates in mm. A self-contained SVG document.
pub fn shape_svg(robot: &Robot, equilibrium: &Equilibrium) -> String {
    // what is seen, in px from the base
    let views = side_and_front(robot, equilibrium);
    let scale = scale(robot, equilibrium, &views);
    let shape = Shape { equilibrium, base: robot.base.position, scale };
    let scenes = [scene(robot, &shape, &views[0], true), scene(robot, &shape, &views[1], false)];

    // panels of one height
    let mut frames = [0, 1].map(|i| {
        let least = SMALLEST_PANEL[0]
            .max(heading_width(&views[i]))
            .max(BODY.width(&axis_name(&views[i].right)) + 72.0);
        scenes[i].bounds.grown(16.0).at_least(least, SMALLEST_PANEL[1])
    });
    let (top, bottom) = (frames[0].y0.min(frames[1].y0), frames[0].y1.max(frames[1].y1));
    for frame in &mut frames {
        (frame.y0, frame.y1) = (top, bottom);
    }

    // ticks
    let step_mm = nice_step(46.0 / scale * 1e3);
    let widest = frames
        .iter()
        .zip(&views)
        .flat_map(|(frame, view)| axis_ticks(&view.up, &shape, -frame.y1, -frame.y0, step_mm))
        .map(|(_, text)| SMALL.width(&text))
        .fold(20.0, f64::max);
    let left = MARGIN + widest + 10.0;

    // the page, from the top down; narrow views share what is left
    let taken = |frames: &[Rect; 2]| left + frames[0].width() + GAP + frames[1].width() + MARGIN;
    let spare = (SMALLEST_PAGE - taken(&frames)).max(0.0);
    for frame in &mut frames {
        (frame.x0, frame.x1) = (frame.x0 - 0.25 * spare, frame.x1 + 0.25 * spare);
    }
    let width = taken(&frames);
    let mut page = Canvas::new();
    let mut y = header(&mut page, robot, equilibrium, &views, width);
    y += HEADING + 6.0;
    let mut x = left;
    for ((frame, scene), (view, first)) in frames.iter().zip(&scenes).zip(views.iter().zip([true, false])) {
        let origin = [x - frame.x0, y - frame.y0];
        panel(&mut page, view, &shape, frame, origin, step_mm, first);
        page.place(scene, origin);
        heading(&mut page, robot, view, Rect::new(x, y - HEADING, x + frame.width(), y));
        x += frame.width() + GAP;
    }
    y += bottom - top + 50.0;
    let y = tendon_legend(&mut page, robot, equilibrium, y, width);
    let end = legend(&mut page, robot, y, width);
    page.finish(width, end + MARGIN * 0.6, &format!("Shape of {}", robot.name))
}

/// How far a tendon is pulled in, and how much longer it is than its way where it is slack.
fn way(state: &TendonState, command: &Command) -> String {
    let mm = |length: f64| fixed(1e3 * length, 2);
    let moved = |length: f64| {
        format!("{} {} mm", if length < 0.0 { "let out" } else { "pulled in" }, mm(length.abs()))
    };
    match command {
        Command::Displacement { displacement, .. }
            if state.slack && mm(*displacement) != mm(state.displacement) =>
        {
            let by = mm(state.displacement - displacement);
            format!("{}, slack by {by} mm", moved(*displacement))
        }
        _ => moved(state.displacement),
    }
}

/// Tension and displacement of every tendon, in its colour; returns where the next line stands.
fn tendon_legend(page: &mut Canvas, robot: &Robot, equilibrium: &Equilibrium, mut y: f64, width: f64) -> f64 {
    if robot.tendons.is_empty() {
        return y;
    }
    y += 14.0; // below the titles of the axes
    let mut x = MARGIN;
    for (number, (tendon, state)) in robot.tendons.iter().zip(&equilibrium.tendons).enumerate() {
        let (tension, way) = (fixed(state.tension, 2), way(state, &robot.actuation[number]));
        let text = format!("{}  {tension} N, {way}", tendon.name);
        let room = 26.0 + SMALL.width(&text) + 22.0;
        if x > MARGIN && x + room > width {
            (x, y) = (MARGIN, y + 18.0);
        }
        page.line([x, y - 4.0], [x + 20.0, y - 4.0], Pen::new(tendons::colour(number), 2.2));
        page.text([x + 26.0, y], Anchor::Start, SMALL, &text);
        x += room;
    }
    y + 24.0
}

/// px per m so that both views fit.
fn scale(robot: &Robot, equilibrium: &Equilibrium, views: &[View; 2]) -> f64 {
    let mut extents = [Rect::EMPTY; 2];
    for (extent, view) in extents.iter_mut().zip(views) {
        for p in equilibrium.stations.iter().map(|s| s.position).chain(rest_line(robot)) {
            extent.include(view.project(&p));
        }
    }
    let width = extents[0].width() + extents[1].width();
    let height = extents[0].height().max(extents[1].height());
    let scale = (ROOM[0] / width).min(ROOM[1] / height);
    if scale.is_finite() && scale > 0.0 { scale } else { 1000.0 }
}

/// The direction in which the base is clamped: as long as the backbone, or a third where that is curved at rest.
fn rest_line(robot: &Robot) -> [Vector3<f64>; 2] {
    let curved = robot.sections.iter().any(|s| s.rest_curvature.norm() > 0.0);
    let length = robot.length() * if curved { 0.33 } else { 1.0 };
    let base = robot.base.position;
    [base, base + robot.base.rotation.matrix().column(2) * length]
}

/// Everything inside a panel, in px from the base.
fn scene(robot: &Robot, shape: &Shape, view: &View, named_tip: bool) -> Canvas {
    let mut canvas = Canvas::new();
    let rest = rest_line(robot).map(|p| shape.on_page(view, &p));
    canvas.polyline(&rest, Pen::dashed(MUTED, 1.1, "5 4"));
    clamp(&mut canvas, robot, view);
    tendons::draw(&mut canvas, robot, shape, view);
    backbone(&mut canvas, robot, shape, view);

    // the tip, below the loads that act there
    let tip = shape.equilibrium.tip.position;
    let on_page = shape.on_page(view, &tip);
    canvas.circle(on_page, 4.5, WHITE, Some(Pen::new(INK, 1.8)));
    let mut wanted = Vec::new();
    if named_tip {
        // beside the backbone rather than ahead, where a load's arrow may be
        let outward = shape.tangent(view, robot.length()).unwrap_or([1.0, 0.0]);
        let beside = [if outward[0] >= 0.0 { 1.0 } else { -1.0 }, -0.35];
        wanted.push(Label {
            at: on_page,
            prefer: beside,
            text: coordinates(&tip),
            style: Type::bold(12.5, INK),
        });
    }
    loads::draw(&mut canvas, &mut wanted, robot, shape, view);

    let mut obstacles = Obstacles {
        boxes: vec![Rect::centred(on_page, 11.0, 11.0)],
        lines: canvas.segments.clone(),
        within: None,
    };
    labels::place(&mut canvas, &mut obstacles, &wanted);
    canvas
}

fn coordinates(p: &Vector3<f64>) -> String {
    let d = if p.amax() < 0.05 { 2 } else { 1 };
    format!("({}, {}, {}) mm", fixed(1e3 * p.x, d), fixed(1e3 * p.y, d), fixed(1e3 * p.z, d))
}

/// The wall that holds the base.
fn clamp(canvas: &mut Canvas, robot: &Robot, view: &View) {
    let t = view.project(&robot.base.rotation.matrix().column(2).into_owned());
    let n = t[0].hypot(t[1]);
    let (wall, hatch) = (Pen::new(INK, 2.0), Pen::new(INK, 0.9));
    if n < 0.3 {
        // seen along the backbone: the wall is behind it
        let half = 17.0;
        canvas.rect(Rect::centred([0.0; 2], 2.0 * half, 2.0 * half), "#eef1f4", Some(Pen::new(MUTED, 1.0)));
        let lines: Vec<(P, P)> = (1..12)
            .map(|i| f64::from(i) * 2.0 * half / 6.0 - 2.0 * half)
            .map(|sum| ((sum - half).max(-half), (sum + half).min(half), sum))
            .map(|(a, b, sum)| ([a, sum - a], [b, sum - b]))
            .collect();
        canvas.hairlines(&lines, Pen::new(GRID_HEAVY, 1.0));
        return;
    }
    let (back, along) = ([-t[0] / n, t[1] / n], [-t[1] / n, -t[0] / n]);
    let at = |a: f64, b: f64| [a * along[0] + b * back[0], a * along[1] + b * back[1]];
    for i in -3..=3 {
        let a = 5.0 * f64::from(i);
        canvas.line(at(a, 1.0), at(a - 5.0, 8.0), hatch);
    }
    canvas.line(at(-19.0, 1.0), at(19.0, 1.0), wall);
}

/// Sections in two shades with marks between them, guides as ticks.
fn backbone(canvas: &mut Canvas, robot: &Robot, shape: &Shape, view: &View) {
    let mut start = 0.0;
    for (i, section) in robot.sections.iter().enumerate() {
        let end = start + section.length;
        let mut points: Vec<P> =
            [start].into_iter().filter_map(|s| shape.at(s)).map(|(p, _)| shape.on_page(view, &p)).collect();
        let inside = shape.equilibrium.stations.iter().filter(|k| k.s > start && k.s < end);
        points.extend(inside.map(|k| shape.on_page(view, &k.position)));
        points.extend(shape.at(end).map(|(p, _)| shape.on_page(view, &p)));
        let marked = section.guides.iter().filter(|_| robot.tendons.is_empty());
        for s in marked.flat_map(|g| &g.positions) {
            across(canvas, shape, view, start + s, 6.0, Pen::new(MUTED, 1.2));
        }
        canvas.polyline(&points, Pen::new(section_colour(i), 3.4));
        if i > 0 {
            across(canvas, shape, view, start, 5.0, Pen::new(INK, 2.0));
        }
        start = end;
    }
}

fn section_colour(i: usize) -> &'static str {
    if i.is_multiple_of(2) { ACCENT } else { ACCENT_LIGHT }
}

/// A tick across the backbone.
fn across(canvas: &mut Canvas, shape: &Shape, view: &View, s: f64, half: f64, pen: Pen) {
    let (Some((p, _)), Some(t)) = (shape.at(s), shape.tangent(view, s)) else {
        return;
    };
    let c = shape.on_page(view, &p);
    canvas.line([c[0] - half * t[1], c[1] + half * t[0]], [c[0] + half * t[1], c[1] - half * t[0]], pen);
}

/// Places (px from the base, along the page's direction) and texts of the ticks between two such places.
fn axis_ticks(axis: &Axis, shape: &Shape, low: f64, high: f64, step_mm: f64) -> Vec<(f64, String)> {
    let base = shape.base.dot(&axis.direction);
    let world = |px: f64| axis.sign * (px / shape.scale + base) * 1e3;
    let (a, b) = (world(low), world(high));
    ticks(a.min(b), a.max(b), step_mm)
        .into_iter()
        .map(|mm| ((axis.sign * mm * 1e-3 - base) * shape.scale, fixed(mm, decimals(step_mm))))
        .collect()
}

/// Frame, grid and numbers of one view.
fn panel(page: &mut Canvas, view: &View, shape: &Shape, frame: &Rect, origin: P, step_mm: f64, first: bool) {
    let (x0, x1) = (frame.x0 + origin[0], frame.x1 + origin[0]);
    let (y0, y1) = (frame.y0 + origin[1], frame.y1 + origin[1]);
    let mut grid = Vec::new();
    let mut free_from = x0 - 14.0;
    for (px, text) in axis_ticks(&view.right, shape, frame.x0, frame.x1, step_mm) {
        let x = px + origin[0];
        grid.push(([x, y0], [x, y1]));
        let half = SMALL.width(&text) / 2.0;
        if x - half > free_from && x + half < x1 + 14.0 {
            page.text([x, y1 + 16.0], Anchor::Middle, SMALL, &text);
            free_from = x + half + 6.0;
        }
    }
    for (px, text) in axis_ticks(&view.up, shape, -frame.y1, -frame.y0, step_mm) {
        let y = origin[1] - px;
        grid.push(([x0, y], [x1, y]));
        if first && y > y0 + 4.0 && y < y1 - 2.0 {
            page.text([x0 - 8.0, y + 4.2], Anchor::End, SMALL, &text);
        }
    }
    page.hairlines(&grid, Pen::new(GRID, 1.0));
    page.rect(Rect::new(x0, y0, x1, y1), "none", Some(Pen::new(GRID_HEAVY, 1.0)));

    // names of the axes, with arrows towards growing numbers
    let name = axis_name(&view.right);
    let centre = (x0 + x1) / 2.0;
    let half = BODY.width(&name) / 2.0;
    page.text([centre, y1 + 35.0], Anchor::Middle, BODY, &name);
    let (tail, head) = (centre + view.right.sign * (half + 6.0), centre + view.right.sign * (half + 30.0));
    page.arrow([tail, y1 + 31.0], [head, y1 + 31.0], Pen::new(MUTED, 1.1), 6.0);
}

fn axis_name(axis: &Axis) -> String {
    let comma = if axis.name.contains(' ') { "," } else { "" };
    format!("{}{comma} in mm", axis.name)
}

fn heading_width(view: &View) -> f64 {
    Type::bold(14.0, INK).width(view.title) + 24.0 + BODY.width(&axis_name(&view.up)) + 34.0
}

/// Above a panel: the view's name, the vertical axis, gravity.
fn heading(page: &mut Canvas, robot: &Robot, view: &View, area: Rect) {
    let base = area.y1 - 11.0;
    page.text([area.x0, base], Anchor::Start, Type::bold(14.0, INK), view.title);
    let after = area.x0 + Type::bold(14.0, INK).width(view.title) + 12.0;
    let up = axis_name(&view.up);
    page.text([after + 12.0, base], Anchor::Start, BODY, &up);
    let (low, high) = (base + 2.0, base - 13.0);
    let (from, to) = if view.up.sign > 0.0 { (low, high) } else { (high, low) };
    page.arrow([after + 4.0, from], [after + 4.0, to], Pen::new(MUTED, 1.1), 6.0);
    if robot.gravity.norm() > 0.0 {
        page.arrow([area.x1 - 6.0, base - 14.0], [area.x1 - 6.0, base + 6.0], Pen::new(INK, 1.6), 8.0);
        page.text([area.x1 - 15.0, base], Anchor::End, Type::bold(13.0, INK), "g");
    }
}

/// Name, tip, and whatever the solver wants known; returns where it ends.
fn header(page: &mut Canvas, robot: &Robot, equilibrium: &Equilibrium, views: &[View; 2], width: f64) -> f64 {
    let title = Type::bold(21.0, INK);
    let room = width - 2.0 * MARGIN;
    let name = if robot.name.trim().is_empty() { "Robot without a name" } else { &robot.name };
    let mut y = MARGIN + 14.0;
    for line in wrap(name, room, |s| title.width(s)) {
        page.text([MARGIN, y], Anchor::Start, title, &line);
        y += 27.0;
    }
    let tip = coordinates(&equilibrium.tip.position);
    let [side, front] = views.each_ref().map(|view| direction_in_words(&view.away()));
    let mut lines = vec![
        (MUTED, format!("Backbone {}, to scale. Tip at (x, y, z) = {tip}.", millimetres(robot.length()))),
        (MUTED, format!("The side view looks along {side}, the front view along {front}.")),
    ];
    if equilibrium.report.stable == Some(false) {
        lines.push((SECOND, "Unstable: the robot would not stay in this shape.".to_owned()));
    }
    for check in equilibrium.checks.iter().filter(|c| !c.ok) {
        lines.push((SECOND, describe::failed_check(check)));
    }
    for (colour, text) in lines {
        let style = Type::new(13.5, colour);
        for line in wrap(&text, room, |s| style.width(s)) {
            page.text([MARGIN, y], Anchor::Start, style, &line);
            y += 19.0;
        }
    }
    y - 8.0
}

/// What the lines mean; wraps at the page's width, returns where it ends.
fn legend(page: &mut Canvas, robot: &Robot, top: f64, width: f64) -> f64 {
    enum Mark {
        Line(Pen),
        Guide,
        Tip,
        Gravity,
    }
    let mut entries: Vec<(Mark, String)> = Vec::new();
    for (i, section) in robot.sections.iter().enumerate() {
        entries.push((Mark::Line(Pen::new(section_colour(i), 3.4)), section_text(section)));
    }
    if let Some(count) = robot
        .sections
        .iter()
        .filter_map(|s| s.guides.as_ref())
        .map(|g| g.positions.len())
        .reduce(|a, b| a + b)
    {
        entries.push((Mark::Guide, format!("{count} guides")));
    }
    entries.push((Mark::Line(Pen::dashed(MUTED, 1.1, "5 4")), "direction of the clamped base".to_owned()));
    entries.push((Mark::Tip, "tip".to_owned()));
    let g = robot.gravity.norm();
    if g > 0.0 {
        let text = format!("gravity {} along {}", prefixed(g, "m/s²"), direction_name(&(robot.gravity / g)));
        entries.push((Mark::Gravity, text));
    }

    let (mut x, mut y) = (MARGIN, top + 14.0);
    for (mark, text) in entries {
        let lines = wrap(&text, width - 2.0 * MARGIN - 34.0, |s| SMALL.width(s));
        let needed = 34.0 + lines.iter().map(|l| SMALL.width(l)).fold(0.0, f64::max);
        if x > MARGIN && x + needed > width - MARGIN {
            (x, y) = (MARGIN, y + 21.0);
        }
        let middle = y - 4.0;
        match mark {
            Mark::Line(pen) => page.line([x + 1.0, middle], [x + 25.0, middle], pen),
            Mark::Guide => {
                // as drawn: the rim of a disk behind the backbone, or a tick where no tendon passes
                if robot.tendons.is_empty() {
                    page.line([x + 13.0, middle - 6.0], [x + 13.0, middle + 6.0], Pen::new(MUTED, 1.2));
                } else {
                    let at = |angle: f64| [x + 13.0 + 3.0 * angle.cos(), middle + 8.0 * angle.sin()];
                    let rim: Vec<P> =
                        (0..=36).map(|i| at(f64::from(i) * std::f64::consts::TAU / 36.0)).collect();
                    page.polyline(&rim, tendons::RIM);
                }
                page.line([x + 1.0, middle], [x + 25.0, middle], Pen::new(ACCENT, 3.4));
            }
            Mark::Tip => page.circle([x + 18.0, middle], 4.5, WHITE, Some(Pen::new(INK, 1.8))),
            Mark::Gravity => {
                page.arrow([x + 18.0, middle - 9.0], [x + 18.0, middle + 8.0], Pen::new(INK, 1.6), 8.0)
            }
        }
        for (i, line) in lines.iter().enumerate() {
            y += if i > 0 { 16.0 } else { 0.0 };
            page.text([x + 32.0, y], Anchor::Start, SMALL, line);
        }
        x += needed + 22.0;
    }
    y
}

fn section_text(section: &Section) -> String {
    let profile = describe::profile(&section.profile);
    format!("{}: {}, {profile}, {}", section.name, millimetres(section.length), section.material.name)
}
