//! The drawings of the steps.

use super::figure::{Anchor, Figure, Pen};
use super::{MM, decimal};
use hydrostat::Robot;
use hydrostat::fabricate::{Guide, Kit, Part, Placed, Workshop};
use hydrostat::planar::{Contour, Point, direction};
use nalgebra::Vector3;

/// Of the page, px.
const WIDTH: f64 = 720.0;
const MILLI: f64 = 1.0 / MM;

fn mm(length: f64) -> String {
    format!("{} mm", decimal(length, 2))
}

/// A part with everything on it, before the kerf.
pub(super) fn part(part: &Part, largest: f64) -> String {
    let size = part.bounds().size() * MM;
    let mut figure = Figure::new((largest / size.x).min(360.0 / size.y).min(8.0));
    draw_part(&mut figure, part, Point::zeros());
    figure.finish(&part.title)
}

fn draw_part(figure: &mut Figure, part: &Part, shift: Point) {
    let moved = |contour: &Contour| contour.moved(0, shift);
    let holes: Vec<Contour> = part.holes.iter().map(moved).collect();
    figure.shape(&moved(&part.outline), &holes, Pen::Part);
    for (pocket, _) in &part.pockets {
        figure.shape(&moved(pocket), &[], Pen::Edge);
    }
    let put = |line: &[Point]| line.iter().map(|p| p + shift).collect::<Vec<_>>();
    for line in &part.scores {
        figure.line(&put(line), Pen::Score);
    }
    for line in &part.engravings {
        figure.line(&put(line), Pen::Thin);
    }
    for slit in &part.slits {
        figure.line(&put(slit), Pen::Tendon);
    }
}

/// A guide, large, with the distances to check.
pub(super) fn guide(robot: &Robot, guide: &Guide, workshop: &Workshop) -> String {
    let mut figure = Figure::new(200.0 / (2.0 * guide.radius * MM));
    draw_part(&mut figure, &guide.part, Point::zeros());
    for hole in &guide.holes {
        let tendon = &robot.tendons[hole.tendon].name;
        let out = hole.center.try_normalize(1e-9).unwrap_or(Point::x());
        let end = if hole.ends { " (tied here)" } else { "" };
        let anchor = if out.x > 0.3 {
            Anchor::Start
        } else if out.x < -0.3 {
            Anchor::End
        } else {
            Anchor::Middle
        };
        // past the rim, clear of the mark at angle 0
        let place = (guide.radius * 1.1) * Point::new(out.x, out.y)
            + Point::new(
                0.0,
                if out.y.abs() < 0.1 { 0.18 * guide.radius } else { 0.08 * guide.radius * out.y.signum() },
            );
        figure.line(&[hole.center, place], Pen::Thin);
        figure.text(place + 0.04 * guide.radius * out, &format!("{tendon}{end}"), anchor);
    }
    let low = Point::new(0.0, -1.2 * guide.radius); // clear of the names
    figure.dimension(
        low - guide.radius * Point::x(),
        low + guide.radius * Point::x(),
        -0.22 * guide.radius,
        &mm(2.0 * guide.radius),
    );
    let rod = guide.part.holes[0].bounds().size().x;
    let text = format!("rod {}, tendons {}", mm(rod), mm(workshop.tendon_hole()));
    figure.text(Point::new(0.0, -1.85 * guide.radius), &text, Anchor::Middle);
    figure.finish(&guide.part.title)
}

/// The device from the side: combs, plates across, guides on the rod.
pub(super) fn device_side(robot: &Robot, kit: &Kit, workshop: &Workshop) -> String {
    let device = &kit.device;
    let length = robot.length();
    let mut figure = Figure::new(((WIDTH - 60.0) / ((length + 0.04) * MM)).min(4.0));
    let t = workshop.sheet_thickness;
    let upright = |s: f64, low: f64, high: f64| {
        Contour::rectangle(Point::new(s, 0.5 * (low + high)), Point::new(t, high - low))
    };
    for comb in &device.combs {
        for s in &comb.across {
            let top = kit.device.parts.last().map_or(0.0, |cradle| cradle.bounds().high.y);
            figure.shape(&upright(*s, 0.0, top), &[], Pen::Edge);
        }
    }
    for guide in &kit.guides {
        let [low, high] = [device.axis_height - guide.radius, device.axis_height + guide.radius];
        figure.shape(&upright(guide.s, low, high), &[], Pen::Edge);
    }
    for (comb, part) in device.combs.iter().zip(&device.parts) {
        figure.shape(&part.outline.moved(0, Point::new(comb.starts, 0.0)), &[], Pen::Part);
    }
    let axis = |s: f64| Point::new(s, device.axis_height);
    figure.line(&[axis(-0.02 - kit.base.rod_in_base), axis(length)], Pen::Rod);
    let wire = device.axis_height + robot.tendons[device.aligned].path.radius;
    figure.line(&[Point::new(-0.02, wire), Point::new(length + 0.02, wire)], Pen::Tendon);
    figure.dimension(
        Point::zeros(),
        Point::new(length, 0.0),
        -8.0 * MILLI,
        &format!("{} from the base's face (0) to the tip", mm(length)),
    );
    figure.finish("the assembly device from the side")
}

/// The device from the end: a guide on both combs.
pub(super) fn device_end(robot: &Robot, kit: &Kit, workshop: &Workshop) -> String {
    let device = &kit.device;
    let Some(cradle) = device.parts.last() else { return String::new() };
    let guide = &kit.guides[0];
    let mut figure = Figure::new(260.0 / (cradle.bounds().size().y * MM));
    draw_part(&mut figure, cradle, Point::zeros());
    figure.circle(Point::new(0.0, device.axis_height), guide.radius, Pen::Hidden);
    for side in [-1.0, 1.0] {
        let center = Point::new(side * device.beside, 0.5 * device.comb_height);
        figure.shape(
            &Contour::rectangle(center, Point::new(workshop.sheet_thickness, device.comb_height)),
            &[],
            Pen::Hidden,
        );
    }
    let wire = Point::new(0.0, device.axis_height + robot.tendons[device.aligned].path.radius);
    let right = cradle.bounds().high.x + 4.0 * MILLI;
    figure.line(&[wire, Point::new(right, wire.y)], Pen::Thin);
    figure.text(
        Point::new(right, wire.y),
        &format!("taut wire, holes of {}", robot.tendons[device.aligned].name),
        Anchor::Start,
    );
    let rod = Point::new(0.0, device.axis_height);
    figure.line(&[rod, Point::new(right, rod.y)], Pen::Thin);
    figure.text(Point::new(right, rod.y), &format!("rod, {} above the table", mm(rod.y)), Anchor::Start);
    figure.finish("the assembly device from its end")
}

/// The motor plate from above with what stands on it.
pub(super) fn base_above(robot: &Robot, kit: &Kit, workshop: &Workshop) -> String {
    let base = &kit.base;
    let mut figure = Figure::new(360.0 / (base.side * MM));
    if let Some(plate) = kit.parts.iter().find(|part| part.name == "motor-plate") {
        draw_part(&mut figure, plate, Point::zeros());
    }
    for place in &base.places {
        let (out, across) = (direction(place.angle), direction(place.angle + std::f64::consts::FRAC_PI_2));
        let half = 0.5 * workshop.motor.frame.side;
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let square = corners.map(|(i, j)| place.shaft + half * (i * out + j * across));
        figure.rings(&[square.to_vec()], Pen::Hidden);
        let Some(tendon) = place.tendon else { continue };
        figure.circle(place.shaft, 0.5 * workshop.spool_diameter, Pen::Edge);
        let meets = place.shaft - workshop.spool_radius() * across;
        figure.line(&[place.tendon_at, meets], Pen::Tendon);
        figure.circle(place.tendon_at, 0.6 * MILLI, Pen::Rod);
        let text = format!("{}: {}", place.axis, robot.tendons[tendon].name);
        figure.text(place.shaft, &text, Anchor::Middle);
    }
    figure.finish("the motor plate from above: motors dashed, spools grey, tendons orange")
}

/// One tendon's way from the front plate to its spool, in the plane in which it runs.
pub(super) fn tendon_way(kit: &Kit, workshop: &Workshop) -> String {
    let base = &kit.base;
    let Some(place) = base.places.iter().find(|place| place.tendon.is_some()) else { return String::new() };
    let out = direction(place.angle);
    let [hole, pulley, shaft] = [place.tendon_at, place.pulley, place.shaft].map(|p| p.dot(&out));
    let t = workshop.sheet_thickness;
    let mut figure = Figure::new(3.6);
    let reach = shaft + 0.5 * workshop.motor.frame.side + 4.0 * MILLI;
    let bar = |x0: f64, x1: f64, z0: f64, z1: f64| {
        Contour::rectangle(0.5 * Point::new(x0 + x1, z0 + z1), Point::new(x1 - x0, z1 - z0))
    };
    let clamp =
        kit.parts.iter().find(|part| part.name == "rod-clamp").map_or(0.0, |part| part.bounds().high.x);
    figure.shape(&bar(-clamp, reach, base.gap, base.gap + t), &[], Pen::Edge);
    for i in 1..=base.clamp_plates {
        let top = base.gap - t * (i - 1) as f64;
        figure.shape(&bar(-clamp, clamp, top - t, top), &[], Pen::Edge);
    }
    figure.shape(&bar(-clamp, reach, -t, 0.0), &[], Pen::Edge);
    let half = 0.5 * workshop.motor.frame.side;
    figure.shape(&bar(shaft - half, shaft + half, -t - workshop.motor.length, -t), &[], Pen::Part);
    figure.text(
        Point::new(shaft, -t - 0.5 * workshop.motor.length),
        workshop.motor.frame.name,
        Anchor::Middle,
    );
    let shaft_half = 0.5 * workshop.motor.frame.shaft;
    figure.shape(
        &bar(shaft - shaft_half, shaft + shaft_half, -t, workshop.motor.frame.shaft_length - t),
        &[],
        Pen::Part,
    );
    let core = 0.5 * workshop.spool_diameter;
    for (i, half) in [(-1.0, core + 3.0 * MILLI), (0.0, core), (1.0, core + 3.0 * MILLI)] {
        let middle = base.spool_height + i * t;
        figure.shape(&bar(shaft - half, shaft + half, middle - 0.5 * t, middle + 0.5 * t), &[], Pen::Edge);
    }
    figure.circle(Point::new(pulley, base.pulley_height), 0.5 * workshop.pulley_diameter, Pen::Part);
    figure.circle(Point::new(pulley, base.pulley_height), 0.5 * workshop.screw_diameter, Pen::Part);
    let mut way = vec![Point::new(hole, base.gap + t + 12.0 * MILLI)];
    way.extend((0..=12).map(|i| {
        let turn = std::f64::consts::PI * (1.0 + f64::from(i) / 24.0);
        Point::new(pulley, base.pulley_height) + base.pulley_radius * direction(turn)
    }));
    way.push(Point::new(shaft, base.spool_height));
    figure.line(&way, Pen::Tendon);
    figure.line(
        &[
            Point::new(0.0, base.gap - t * base.clamp_plates as f64),
            Point::new(0.0, base.gap + t + 12.0 * MILLI),
        ],
        Pen::Rod,
    );
    figure.dimension(Point::new(reach, 0.0), Point::new(reach, base.gap), -4.0 * MILLI, &mm(base.gap));
    figure.text(
        Point::new(hole + 3.0 * MILLI, base.gap + t + 8.0 * MILLI),
        "rod and tendon, to the robot",
        Anchor::Start,
    );
    figure.finish("the way of a tendon: front plate, pulley, spool")
}

/// The box, apart: front plate lifted, walls moved out.
pub(super) fn base_apart(kit: &Kit, workshop: &Workshop) -> String {
    let base = &kit.base;
    // from the upper front left, as drawings of furniture are
    let (right, up) = (Vector3::new(0.82, 0.57, 0.0), Vector3::new(-0.28, 0.41, 0.87));
    let towards = right.cross(&up);
    let shown = |placed: &&Placed| !placed.part.starts_with("spool");
    let mut placed: Vec<(f64, Placed)> = base
        .placed
        .iter()
        .filter(shown)
        .map(|placed| apart(base.side, placed))
        .map(|placed| (placed.origin.dot(&towards), placed))
        .collect();
    placed.sort_by(|a, b| a.0.total_cmp(&b.0));
    let project = |p: Vector3<f64>| Point::new(right.dot(&p), up.dot(&p));
    let spread = placed.iter().map(|(_, placed)| project(placed.origin)).collect::<Vec<_>>();
    let wide = spread.iter().map(|p| p.x).fold(f64::NEG_INFINITY, f64::max)
        - spread.iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
    let mut figure = Figure::new(500.0 / ((wide + 1.4 * base.side) * MM));
    for (_, placed) in &placed {
        let Some(part) = base.parts.iter().find(|part| part.name == placed.part) else { continue };
        let normal = placed.x.cross(&placed.y);
        // the face that is seen
        let depth = if normal.dot(&towards) > 0.0 { 1.0 } else { 0.0 };
        let thickness = workshop.sheet_thickness;
        let ring = |contour: &Contour, depth: f64| {
            contour
                .chords(2e-3)
                .into_iter()
                .map(|p| project(placed.at(p, depth * thickness)))
                .collect::<Vec<_>>()
        };
        figure.rings(&[ring(&part.outline, 1.0 - depth)], Pen::Edge);
        let rings: Vec<Vec<Point>> =
            std::iter::once(&part.outline).chain(&part.holes).map(|contour| ring(contour, depth)).collect();
        figure.rings(&rings, Pen::Part);
    }
    figure.finish("the base, taken apart")
}

/// Moved out from the middle.
fn apart(side: f64, placed: &Placed) -> Placed {
    let lift = match placed.part.as_str() {
        "front-plate" => 0.75 * side * Vector3::z(),
        "rod-clamp" => 0.45 * side * Vector3::z(),
        "motor-plate" | "pulley-bracket" => Vector3::zeros(),
        _ => 0.45 * side * Vector3::new(placed.origin.x, placed.origin.y, 0.0).normalize(),
    };
    Placed { origin: placed.origin + lift, ..placed.clone() }
}

/// The first test: the straight robot, and its shape with one tendon pulled, in the plane in which the tip moves.
pub(super) fn first_test(robot: &Robot, kit: &Kit) -> String {
    let test = &kit.first_test;
    let axes = robot.base.rotation.matrix();
    let (along, origin) = (Vector3::from(axes.column(2)), robot.base.position);
    let moved = test.tip - test.at_rest;
    let side =
        (moved - along * along.dot(&moved)).try_normalize(1e-9).unwrap_or(Vector3::from(axes.column(0)));
    let put = |p: &Vector3<f64>| Point::new(side.dot(&(p - origin)), along.dot(&(p - origin)));
    let mut figure = Figure::new(360.0 / (robot.length() * MM));
    figure.line(&[Point::zeros(), put(&test.at_rest)], Pen::Hidden);
    let shape: Vec<Point> = test.shape.iter().map(put).collect();
    figure.line(&shape, Pen::Rod);
    let half = 0.5 * kit.base.side;
    figure.line(&[Point::new(-0.5 * half, 0.0), Point::new(0.5 * half, 0.0)], Pen::Rod);
    let tip = put(&test.tip);
    figure.circle(tip, 0.008 * robot.length(), Pen::Tendon);
    let [x, y, z] = [test.tip.x, test.tip.y, test.tip.z].map(|x| decimal(x, 1));
    figure.text(
        tip + Point::new(0.03 * robot.length(), 0.0),
        &format!("tip at ({x}, {y}, {z}) mm"),
        Anchor::Start,
    );
    figure.dimension(Point::new(0.0, tip.y), tip, -0.06 * robot.length(), &mm(tip.x));
    figure.finish("the first test")
}

/// The grid with its heavy lines only, a rod in a clamp at 30 degrees on it.
pub(super) fn grid(kit: &Kit, workshop: &Workshop) -> String {
    let [width, height] = workshop.bench_size;
    let Some(grid) = kit.parts.iter().find(|part| part.name == "grid") else { return String::new() };
    let mut figure = Figure::new(330.0 / (height * MM));
    figure.shape(&grid.outline, &grid.holes, Pen::Part);
    for line in &grid.engravings {
        figure.line(
            line,
            if line.len() == 2 && (line[1] - line[0]).norm() > 0.5 * width { Pen::Other } else { Pen::Thin },
        );
    }
    figure.dimension(Point::zeros(), Point::new(width, 0.0), -10.0 * MILLI, &mm(width));
    figure.dimension(Point::zeros(), Point::new(0.0, height), 10.0 * MILLI, &mm(height));
    figure.finish("the verification grid")
}
