//! What tests ask of every document.

/// Parses, and looks for numbers that are none.
pub(crate) fn check(document: &str) {
    let body = document.trim_start_matches("<!DOCTYPE html>");
    let parsed = roxmltree::Document::parse(body).unwrap_or_else(|e| panic!("{e}\n{document}"));
    for node in parsed.descendants().filter(|n| n.is_element() || n.is_text()) {
        let words = node.attributes().map(|a| a.value()).chain(node.text());
        for word in words.flat_map(|w| w.split(|c: char| !c.is_alphanumeric())) {
            assert!(!matches!(word, "NaN" | "inf" | "Infinity"), "{word} in {node:?}");
        }
    }
}

/// Widths as an average of Roboto.
pub(crate) fn texts_are_apart(name: &str, svg: &str) {
    let document = roxmltree::Document::parse(svg).unwrap();
    let number = |n: &roxmltree::Node, a: &str| n.attribute(a).unwrap().parse::<f64>().unwrap();
    let root = document.root_element();
    let (width, height) = (number(&root, "width"), number(&root, "height"));
    let mut boxes: Vec<([f64; 4], String)> = Vec::new();
    for text in document.descendants().filter(|n| n.has_tag_name("text")) {
        let mut at = [number(&text, "x"), number(&text, "y")];
        for group in text.ancestors().filter(|n| n.has_tag_name("g")) {
            let inner = group.attribute("transform").unwrap();
            let inner = inner.trim_start_matches("translate(").trim_end_matches(')');
            for (x, d) in at.iter_mut().zip(inner.split(' ')) {
                *x += d.parse::<f64>().unwrap();
            }
        }
        let words = text.text().unwrap().to_owned();
        let size = number(&text, "font-size");
        let wide = |c: char| c.is_ascii_digit() || c.is_uppercase();
        let w: f64 = words.chars().map(|c| size * if wide(c) { 0.57 } else { 0.47 }).sum();
        let left = match text.attribute("text-anchor") {
            Some("middle") => at[0] - w / 2.0,
            Some("end") => at[0] - w,
            _ => at[0],
        };
        let b = [left, at[1] - 0.75 * size, left + w, at[1] + 0.2 * size];
        assert!(b[0] > 0.0 && b[1] > 0.0 && b[2] < width && b[3] < height, "{name}: {words:?} is cut");
        for (c, other) in &boxes {
            let apart = b[0] >= c[2] || c[0] >= b[2] || b[1] >= c[3] || c[1] >= b[3];
            assert!(apart, "{name}: {words:?} on {other:?}");
        }
        boxes.push((b, words));
    }
}

/// The SVG documents in a page.
pub(crate) fn drawings(html: &str) -> Vec<String> {
    html.split("<svg ").skip(1).map(|s| format!("<svg {}", &s[..s.find("</svg>").unwrap() + 6])).collect()
}
