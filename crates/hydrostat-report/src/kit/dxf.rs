//! A drawing for the cutter as DXF R2000 (AC1015): lines, circles and polylines in millimetres on three layers.
//!
//! Written here because the `dxf` crate's files need seven repairs by their readers. Structure after Autodesk's DXF reference
//! (2012), chapters 1 to 8; handles count up, so that the same drawing has the same bytes.

use super::decimal;
use hydrostat::fabricate::Cut;
use hydrostat::planar::{Contour, Point};
use std::fmt::{Display, Write};

/// Handles that other objects refer to.
const MODEL_SPACE: u32 = 0x1f;
const PAPER_SPACE: u32 = 0x1b;
const ROOT: u32 = 0xc;
const GROUPS: u32 = 0xd;
const LAYOUTS: u32 = 0x1a;
const MODEL_LAYOUT: u32 = 0x22;
const PAPER_LAYOUT: u32 = 0x1e;
/// The first one for entities, and the next that is free for a reader.
const ENTITIES: u32 = 0x100;
/// Names and colours: red, blue, black (white on a dark screen).
const LAYERS: [(&str, u32, u8); 4] =
    [("0", 0x10, 7), ("CUT", 0x40, 1), ("SCORE", 0x41, 5), ("ENGRAVE", 0x42, 7)];

/// Lines of group code and value.
struct Writer {
    text: String,
    next: u32,
}

impl Writer {
    fn put(&mut self, code: u16, value: impl Display) {
        let _ = write!(self.text, "{code}\n{value}\n");
    }

    fn all(&mut self, pairs: &[(u16, &str)]) {
        for (code, value) in pairs {
            self.put(*code, value);
        }
    }

    fn handle(&mut self, code: u16, handle: u32) {
        self.put(code, format!("{handle:X}"));
    }

    /// Start of an object: its type, handle, owner and first class.
    fn object(&mut self, kind: &str, handle: u32, owner: u32, class: &str) {
        self.put(0, kind);
        self.handle(if kind == "DIMSTYLE" { 105 } else { 5 }, handle);
        self.handle(330, owner);
        self.put(100, class);
    }

    fn section(&mut self, name: &str) {
        self.all(&[(0, "SECTION"), (2, name)]);
    }

    fn end_section(&mut self) {
        self.put(0, "ENDSEC");
    }

    fn point(&mut self, code: u16, point: Point) {
        self.put(code, decimal(point.x, 7));
        self.put(code + 10, decimal(point.y, 7));
    }

    fn entity(&mut self, kind: &str, layer: &str, class: &str) {
        let handle = self.next;
        self.next += 1;
        self.object(kind, handle, MODEL_SPACE, "AcDbEntity");
        self.put(8, layer);
        self.put(100, class);
    }
}

/// The whole file.
pub(super) fn dxf(cut: &Cut) -> String {
    let mut entities = Writer { text: String::new(), next: ENTITIES };
    for line in &cut.engravings {
        polyline(&mut entities, "ENGRAVE", line);
    }
    for pocket in &cut.pockets {
        contour(&mut entities, "ENGRAVE", pocket);
    }
    for line in &cut.scores {
        polyline(&mut entities, "SCORE", line);
    }
    for slit in &cut.slits {
        polyline(&mut entities, "CUT", slit);
    }
    for shape in &cut.cuts {
        contour(&mut entities, "CUT", shape);
    }
    let mut w = Writer { text: String::new(), next: entities.next };
    w.put(999, &cut.note);
    header(&mut w, cut.size);
    w.section("CLASSES");
    w.end_section();
    tables(&mut w, cut.size);
    blocks(&mut w);
    w.section("ENTITIES");
    w.text.push_str(&entities.text);
    w.end_section();
    objects(&mut w);
    w.put(0, "EOF");
    w.text
}

fn header(w: &mut Writer, size: [f64; 2]) {
    w.section("HEADER");
    w.all(&[(9, "$ACADVER"), (1, "AC1015"), (9, "$DWGCODEPAGE"), (3, "ANSI_1252"), (9, "$INSBASE")]);
    w.all(&[
        (10, "0"),
        (20, "0"),
        (30, "0"),
        (9, "$EXTMIN"),
        (10, "0"),
        (20, "0"),
        (30, "0"),
        (9, "$EXTMAX"),
    ]);
    w.point(10, Point::new(size[0], size[1]));
    w.all(&[(30, "0"), (9, "$HANDSEED")]);
    let next = w.next;
    w.handle(5, next);
    w.all(&[(9, "$INSUNITS"), (70, "4"), (9, "$MEASUREMENT"), (70, "1"), (9, "$LUNITS"), (70, "2")]);
    w.end_section();
}

fn table(w: &mut Writer, name: &str, handle: u32, count: usize) {
    w.all(&[(0, "TABLE"), (2, name)]);
    w.handle(5, handle);
    w.all(&[(330, "0"), (100, "AcDbSymbolTable")]);
    w.put(70, count);
    if name == "DIMSTYLE" {
        w.put(100, "AcDbDimStyleTable");
    }
}

fn tables(w: &mut Writer, size: [f64; 2]) {
    w.section("TABLES");
    let end = |w: &mut Writer| w.put(0, "ENDTAB");
    table(w, "VPORT", 8, 1);
    w.object("VPORT", 0x29, 8, "AcDbSymbolTableRecord");
    w.all(&[
        (100, "AcDbViewportTableRecord"),
        (2, "*Active"),
        (70, "0"),
        (10, "0"),
        (20, "0"),
        (11, "1"),
        (21, "1"),
    ]);
    w.point(12, 0.5 * Point::new(size[0], size[1]));
    w.all(&[
        (13, "0"),
        (23, "0"),
        (14, "10"),
        (24, "10"),
        (15, "10"),
        (25, "10"),
        (16, "0"),
        (26, "0"),
        (36, "1"),
    ]);
    w.all(&[(17, "0"), (27, "0"), (37, "0")]);
    w.put(40, decimal(1.1 * size[1], 3));
    w.put(41, format!("{:.4}", size[0] / size[1]));
    w.all(&[
        (42, "50"),
        (43, "0"),
        (44, "0"),
        (50, "0"),
        (51, "0"),
        (71, "0"),
        (72, "1000"),
        (73, "1"),
        (74, "3"),
    ]);
    w.all(&[(75, "0"), (76, "0"), (77, "0"), (78, "0")]);
    end(w);
    table(w, "LTYPE", 5, 3);
    for (name, handle) in [("ByBlock", 0x14), ("ByLayer", 0x15), ("Continuous", 0x16)] {
        w.object("LTYPE", handle, 5, "AcDbSymbolTableRecord");
        w.put(100, "AcDbLinetypeTableRecord");
        w.put(2, name);
        w.all(&[(70, "0"), (3, ""), (72, "65"), (73, "0"), (40, "0")]);
    }
    end(w);
    table(w, "LAYER", 2, LAYERS.len());
    for (name, handle, colour) in LAYERS {
        w.object("LAYER", handle, 2, "AcDbSymbolTableRecord");
        w.put(100, "AcDbLayerTableRecord");
        w.put(2, name);
        w.put(70, 0);
        w.put(62, colour);
        w.all(&[(6, "Continuous"), (370, "-3"), (390, "F")]);
    }
    end(w);
    table(w, "STYLE", 3, 1);
    w.object("STYLE", 0x11, 3, "AcDbSymbolTableRecord");
    w.all(&[(100, "AcDbTextStyleTableRecord"), (2, "Standard"), (70, "0"), (40, "0"), (41, "1"), (50, "0")]);
    w.all(&[(71, "0"), (42, "2.5"), (3, "txt"), (4, "")]);
    end(w);
    for (name, handle) in [("VIEW", 6), ("UCS", 7)] {
        table(w, name, handle, 0);
        end(w);
    }
    table(w, "APPID", 9, 1);
    w.object("APPID", 0x12, 9, "AcDbSymbolTableRecord");
    w.all(&[(100, "AcDbRegAppTableRecord"), (2, "ACAD"), (70, "0")]);
    end(w);
    table(w, "DIMSTYLE", 0xa, 1);
    w.object("DIMSTYLE", 0x27, 0xa, "AcDbSymbolTableRecord");
    w.all(&[(100, "AcDbDimStyleTableRecord"), (2, "Standard"), (70, "0")]);
    end(w);
    table(w, "BLOCK_RECORD", 1, 2);
    for (name, handle, layout) in
        [("*Model_Space", MODEL_SPACE, MODEL_LAYOUT), ("*Paper_Space", PAPER_SPACE, PAPER_LAYOUT)]
    {
        w.object("BLOCK_RECORD", handle, 1, "AcDbSymbolTableRecord");
        w.put(100, "AcDbBlockTableRecord");
        w.put(2, name);
        w.handle(340, layout);
    }
    end(w);
    w.end_section();
}

fn blocks(w: &mut Writer) {
    w.section("BLOCKS");
    for (name, owner, begin, paper) in
        [("*Model_Space", MODEL_SPACE, 0x20, false), ("*Paper_Space", PAPER_SPACE, 0x1c, true)]
    {
        let on_paper = |w: &mut Writer| {
            if paper {
                w.put(67, 1);
            }
            w.put(8, "0");
        };
        w.object("BLOCK", begin, owner, "AcDbEntity");
        on_paper(w);
        w.put(100, "AcDbBlockBegin");
        w.put(2, name);
        w.all(&[(70, "0"), (10, "0"), (20, "0"), (30, "0")]);
        w.put(3, name);
        w.put(1, "");
        w.object("ENDBLK", begin + 1, owner, "AcDbEntity");
        on_paper(w);
        w.put(100, "AcDbBlockEnd");
    }
    w.end_section();
}

fn objects(w: &mut Writer) {
    w.section("OBJECTS");
    let dictionary = |w: &mut Writer, handle: u32, owner: u32, entries: &[(&str, u32)]| {
        w.object("DICTIONARY", handle, owner, "AcDbDictionary");
        w.put(281, 1);
        for (name, entry) in entries {
            w.put(3, name);
            w.handle(350, *entry);
        }
    };
    let styles = [("ACAD_GROUP", GROUPS), ("ACAD_LAYOUT", LAYOUTS), ("ACAD_PLOTSTYLENAME", 0xe)];
    dictionary(w, ROOT, 0, &styles);
    dictionary(w, GROUPS, ROOT, &[]);
    dictionary(w, LAYOUTS, ROOT, &[("Layout1", PAPER_LAYOUT), ("Model", MODEL_LAYOUT)]);
    // layers name their plot style
    w.object("ACDBDICTIONARYWDFLT", 0xe, ROOT, "AcDbDictionary");
    w.all(&[(281, "1"), (3, "Normal"), (350, "F"), (100, "AcDbDictionaryWithDefault"), (340, "F")]);
    w.put(0, "ACDBPLACEHOLDER");
    w.handle(5, 0xf);
    w.handle(330, 0xe);
    for (name, handle, block, order, flags) in
        [("Layout1", PAPER_LAYOUT, PAPER_SPACE, 1, 0), ("Model", MODEL_LAYOUT, MODEL_SPACE, 0, 1024)]
    {
        w.object("LAYOUT", handle, LAYOUTS, "AcDbPlotSettings");
        w.all(&[(1, ""), (2, "none_device"), (4, ""), (6, ""), (40, "0"), (41, "0"), (42, "0"), (43, "0")]);
        w.all(&[(44, "0"), (45, "0"), (46, "0"), (47, "0"), (48, "0"), (49, "0"), (140, "0"), (141, "0")]);
        w.all(&[(142, "1"), (143, "1")]);
        w.put(70, flags);
        w.all(&[(72, "1"), (73, "0"), (74, "5"), (7, ""), (75, "16"), (147, "1"), (148, "0"), (149, "0")]);
        w.put(100, "AcDbLayout");
        w.put(1, name);
        w.put(70, 1);
        w.put(71, order);
        w.all(&[(10, "0"), (20, "0"), (11, "420"), (21, "297"), (12, "0"), (22, "0"), (32, "0")]);
        w.all(&[(14, "0"), (24, "0"), (34, "0"), (15, "0"), (25, "0"), (35, "0"), (146, "0")]);
        w.all(&[
            (13, "0"),
            (23, "0"),
            (33, "0"),
            (16, "1"),
            (26, "0"),
            (36, "0"),
            (17, "0"),
            (27, "1"),
            (37, "0"),
        ]);
        w.put(76, 0);
        w.handle(330, block);
    }
    w.end_section();
}

/// A line, or an open polyline of several.
fn polyline(w: &mut Writer, layer: &str, points: &[Point]) {
    if let [from, to] = points {
        w.entity("LINE", layer, "AcDbLine");
        for (code, point) in [(10, from), (11, to)] {
            w.point(code, *point);
            w.put(code + 20, 0);
        }
        return;
    }
    w.entity("LWPOLYLINE", layer, "AcDbPolyline");
    w.put(90, points.len());
    w.put(70, 0);
    for point in points {
        w.point(10, *point);
    }
}

fn contour(w: &mut Writer, layer: &str, contour: &Contour) {
    match contour {
        Contour::Circle { center, radius } => {
            w.entity("CIRCLE", layer, "AcDbCircle");
            w.point(10, *center);
            w.put(30, 0);
            w.put(40, decimal(*radius, 7));
        }
        Contour::Polygon(vertices) => {
            w.entity("LWPOLYLINE", layer, "AcDbPolyline");
            w.put(90, vertices.len());
            w.put(70, 1);
            for vertex in vertices {
                w.point(10, vertex.at);
                if vertex.bulge != 0.0 {
                    w.put(42, format!("{:.12}", vertex.bulge));
                }
            }
        }
    }
}
