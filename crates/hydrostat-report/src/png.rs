//! Pixels from the SVG that this crate writes, with an embedded font and no system fonts.
//!
//! It knows the elements [`crate::draw`] writes and refuses all others: a drawing is complete or an error.

use std::fmt;
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, StrokeDash, Transform,
};
use ttf_parser::{Face, OutlineBuilder};

const REGULAR: &[u8] = include_bytes!("../assets/Roboto-Regular-subset.ttf");
const MEDIUM: &[u8] = include_bytes!("../assets/Roboto-Medium-subset.ttf");
/// Larger pictures than this are refused, px along one side.
const LARGEST_SIDE: f64 = 20_000.0;

/// Why a drawing could not be turned into pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct PngError(String);

impl fmt::Display for PngError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no picture: {}", self.0)
    }
}

impl std::error::Error for PngError {}

type Result<T> = std::result::Result<T, PngError>;

/// A PNG of a drawing of this crate, `scale` pixels for each of its own (2 gives about 190 dots per inch).
pub fn svg_to_png(svg: &str, scale: f32) -> Result<Vec<u8>> {
    let document =
        roxmltree::Document::parse(svg).map_err(|e| PngError(format!("the drawing is not XML: {e}")))?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        return Err(PngError(format!("the root is <{}>, not <svg>", root.tag_name().name())));
    }
    let side = |name| -> Result<u32> {
        let px = f64::from(number(&root, name)?) * f64::from(scale);
        if (1.0..=LARGEST_SIDE).contains(&px) {
            Ok(px.round() as u32)
        } else {
            Err(PngError(format!("a {name} of {px} pixels; choose a scale that gives 1 to {LARGEST_SIDE}")))
        }
    };
    let mut pixmap = Pixmap::new(side("width")?, side("height")?)
        .ok_or_else(|| PngError("the picture does not fit into memory".to_owned()))?;
    let fonts = [font(REGULAR)?, font(MEDIUM)?];
    children(&root, &mut pixmap, &fonts, Transform::from_scale(scale, scale))?;
    pixmap.encode_png().map_err(|e| PngError(e.to_string()))
}

type Node<'a> = roxmltree::Node<'a, 'a>;

fn font(data: &'static [u8]) -> Result<Face<'static>> {
    Face::parse(data, 0).map_err(|e| PngError(format!("embedded font: {e}")))
}

fn children(parent: &Node, pixmap: &mut Pixmap, fonts: &[Face; 2], transform: Transform) -> Result<()> {
    for node in parent.children().filter(roxmltree::Node::is_element) {
        match node.tag_name().name() {
            "title" => {}
            "g" => {
                let [x, y] = translation(&node)?;
                children(&node, pixmap, fonts, transform.pre_translate(x, y))?;
            }
            "rect" => {
                let (x, y) = (number(&node, "x")?, number(&node, "y")?);
                let (w, h) = (number(&node, "width")?, number(&node, "height")?);
                if let Some(r) = Rect::from_xywh(x, y, w, h) {
                    paint(&node, pixmap, &PathBuilder::from_rect(r), transform)?;
                }
            }
            "circle" => {
                let (x, y, r) = (number(&node, "cx")?, number(&node, "cy")?, number(&node, "r")?);
                if let Some(path) = PathBuilder::from_circle(x, y, r) {
                    paint(&node, pixmap, &path, transform)?;
                }
            }
            "path" => {
                if let Some(path) = path(node.attribute("d").unwrap_or_default())? {
                    paint(&node, pixmap, &path, transform)?;
                }
            }
            "text" => text(&node, pixmap, fonts, transform)?,
            other => {
                return Err(PngError(format!("element <{other}> is not one that Hydrostat draws")));
            }
        }
    }
    Ok(())
}

fn paint(node: &Node, pixmap: &mut Pixmap, path: &Path, transform: Transform) -> Result<()> {
    if let Some(fill) = colour(node, "fill")? {
        pixmap.fill_path(path, &fill, FillRule::Winding, transform, None);
    }
    if let Some(ink) = colour(node, "stroke")? {
        let dash = match node.attribute("stroke-dasharray") {
            Some(list) => StrokeDash::new(list.split_whitespace().map(parse).collect::<Result<_>>()?, 0.0),
            None => None,
        };
        let stroke = Stroke {
            width: number(node, "stroke-width")?,
            line_cap: LineCap::Round,
            line_join: LineJoin::Round,
            dash,
            ..Stroke::default()
        };
        pixmap.stroke_path(path, &ink, &stroke, transform, None);
    }
    Ok(())
}

/// `#rrggbb`; None for `none` or where it is not given.
fn colour(node: &Node, name: &str) -> Result<Option<Paint<'static>>> {
    let Some(value) = node.attribute(name).filter(|v| *v != "none") else {
        return Ok(None);
    };
    let rgb = value.strip_prefix('#').filter(|h| h.len() == 6).and_then(|h| u32::from_str_radix(h, 16).ok());
    let rgb = rgb.ok_or_else(|| PngError(format!("colour {value:?}")))?;
    let [_, r, g, b] = rgb.to_be_bytes();
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(Color::from_rgba8(r, g, b, 255));
    Ok(Some(paint))
}

/// `M x y`, `L x y` and `Z`.
fn path(d: &str) -> Result<Option<Path>> {
    let mut builder = PathBuilder::new();
    let mut rest = d.trim();
    while let Some(command) = rest.chars().next() {
        let after = &rest[command.len_utf8()..];
        let end = after.find(|c: char| c.is_ascii_alphabetic() && c != 'e').unwrap_or(after.len());
        let mut numbers = after[..end].split_whitespace().map(parse);
        let mut next = || numbers.next().unwrap_or_else(|| Err(PngError(format!("path {d:?} ends early"))));
        match command {
            'M' => builder.move_to(next()?, next()?),
            'L' => builder.line_to(next()?, next()?),
            'Z' => builder.close(),
            other => return Err(PngError(format!("path command {other:?}"))),
        }
        rest = after[end..].trim_start();
    }
    Ok(builder.finish())
}

fn text(node: &Node, pixmap: &mut Pixmap, fonts: &[Face; 2], transform: Transform) -> Result<()> {
    let string: String =
        node.descendants().filter(roxmltree::Node::is_text).filter_map(|n| n.text()).collect();
    let face = &fonts[usize::from(node.has_attribute("font-weight"))];
    let size = number(node, "font-size")? / f32::from(face.units_per_em());

    // glyphs along the baseline; a sign the font lacks becomes its empty box
    let mut outline = Glyphs { builder: PathBuilder::new(), x: 0.0 };
    for c in string.chars() {
        let glyph = face.glyph_index(c).unwrap_or_default();
        let _ = face.outline_glyph(glyph, &mut outline);
        outline.x += f32::from(face.glyph_hor_advance(glyph).unwrap_or_default());
    }
    let width = size * outline.x;
    let shift = match node.attribute("text-anchor") {
        Some("middle") => width / 2.0,
        Some("end") => width,
        _ => 0.0,
    };
    let (x, y) = (number(node, "x")? - shift, number(node, "y")?);
    if let Some(path) = outline.builder.finish() {
        paint(node, pixmap, &path, transform.pre_translate(x, y).pre_scale(size, -size))?;
    }
    Ok(())
}

/// Outlines of successive glyphs, font units.
struct Glyphs {
    builder: PathBuilder,
    x: f32,
}

impl OutlineBuilder for Glyphs {
    fn move_to(&mut self, x: f32, y: f32) {
        self.builder.move_to(self.x + x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.builder.line_to(self.x + x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.builder.quad_to(self.x + x1, y1, self.x + x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.builder.cubic_to(self.x + x1, y1, self.x + x2, y2, self.x + x, y);
    }

    fn close(&mut self) {
        self.builder.close();
    }
}

fn translation(node: &Node) -> Result<[f32; 2]> {
    let value = node.attribute("transform").unwrap_or("translate(0 0)");
    let inner = value.strip_prefix("translate(").and_then(|v| v.strip_suffix(')'));
    match inner.map(|v| v.split_whitespace().map(parse).collect::<Result<Vec<f32>>>()) {
        Some(Ok(list)) if list.len() == 2 => Ok([list[0], list[1]]),
        _ => Err(PngError(format!("transform {value:?}"))),
    }
}

fn number(node: &Node, name: &str) -> Result<f32> {
    let value = node.attribute(name);
    parse(value.ok_or_else(|| PngError(format!("<{}> without {name}", node.tag_name().name())))?)
}

fn parse(s: &str) -> Result<f32> {
    s.parse::<f32>().ok().filter(|x| x.is_finite()).ok_or_else(|| PngError(format!("{s:?} is not a number")))
}
