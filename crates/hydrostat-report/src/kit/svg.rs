//! A drawing for the cutter as SVG: millimetres, hairlines, one colour and one group per layer.

use super::decimal;
use crate::text::escape;
use hydrostat::fabricate::Cut;
use hydrostat::planar::{Contour, Point};
use std::fmt::Write;

/// About the 1/1000 inch that cutters take as a line to follow, mm.
const HAIRLINE: &str = "0.025";

/// The drawing, with thickness and kerf as its description.
pub(super) fn svg(cut: &Cut) -> String {
    let [w, h] = cut.size.map(|side| decimal(side, 6));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}mm\" height=\"{h}mm\" viewBox=\"0 0 {w} {h}\">\n<desc>{}</desc>\n",
        escape(&cut.note)
    );
    svg.push_str(&layers(cut, HAIRLINE));
    svg.push_str("</svg>\n");
    svg
}

/// The layers as groups in millimetres; engraving first, so that a cutter may take them in order.
pub(super) fn layers(cut: &Cut, width: &str) -> String {
    let up = |point: &Point| Point::new(point.x, cut.size[1] - point.y);
    let engraved: Vec<String> = cut.engravings.iter().map(|line| line_path(line, &up)).collect();
    let pockets = cut.pockets.iter().map(|pocket| contour_path(pocket, &up));
    let scored: Vec<String> = cut.scores.iter().map(|line| line_path(line, &up)).collect();
    let slits = cut.slits.iter().map(|slit| line_path(slit, &up));
    let mut svg = String::new();
    for (layer, colour, paths) in [
        ("ENGRAVE", "#000000", engraved.into_iter().chain(pockets).collect::<Vec<_>>()),
        ("SCORE", "#0000ff", scored),
        ("CUT", "#ff0000", slits.chain(cut.cuts.iter().map(|contour| contour_path(contour, &up))).collect()),
    ] {
        if paths.is_empty() {
            continue;
        }
        let _ =
            writeln!(svg, "<g id=\"{layer}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\">");
        for path in paths {
            let _ = writeln!(svg, "{path}");
        }
        svg.push_str("</g>\n");
    }
    svg
}

fn point(p: Point) -> String {
    format!("{} {}", decimal(p.x, 6), decimal(p.y, 6))
}

fn line_path(line: &[Point], up: &impl Fn(&Point) -> Point) -> String {
    let points: Vec<String> = line.iter().map(|p| point(up(p))).collect();
    format!("<path d=\"M{}\"/>", points.join("L"))
}

/// A path of lines and arcs.
pub(super) fn contour_path(contour: &Contour, up: &impl Fn(&Point) -> Point) -> String {
    match contour {
        Contour::Circle { center, radius } => {
            let c = up(center);
            format!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"/>",
                decimal(c.x, 6),
                decimal(c.y, 6),
                decimal(*radius, 6)
            )
        }
        Contour::Polygon(vertices) => {
            let mut path = format!("<path d=\"M{}", point(up(&vertices[0].at)));
            for (i, from) in vertices.iter().enumerate() {
                let to = vertices[(i + 1) % vertices.len()].at;
                if from.bulge == 0.0 {
                    if i + 1 < vertices.len() {
                        let _ = write!(path, "L{}", point(up(&to)));
                    }
                    continue;
                }
                let bulge = from.bulge;
                let radius = (to - from.at).norm() * (1.0 + bulge * bulge) / (4.0 * bulge.abs());
                let large = i32::from(bulge.abs() > 1.0);
                let sweep = i32::from(bulge < 0.0); // the page's y points down
                let r = decimal(radius, 6);
                let _ = write!(path, "A{r} {r} 0 {large} {sweep} {}", point(up(&to)));
            }
            path.push_str("Z\"/>");
            path
        }
    }
}
