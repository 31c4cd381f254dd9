"""Reads a kit with programs that did not write it. Arguments: the kit's folder, and LibreCAD's program where there is one."""

import csv
import math
import subprocess
import sys
from pathlib import Path

import ezdxf
import pymupdf
import trimesh
from ezdxf.math import bulge_to_arc

COLOURS = {"CUT": 1, "SCORE": 5, "ENGRAVE": 7}
AREA = 1e-4  # mm^2: coordinates have seven decimals
VOLUME = 5e-4  # facets lie within 1e-4 of an arc's radius
PAPER = 5e-4  # LibreCAD rounds its page to whole points,
DOT = 0.025  # mm: and lines to dots of 1/1200 inch


def fail(message):
    sys.exit(f"{message}")


def rows(kit, name):
    with open(kit / name, newline="") as file:
        return list(csv.DictReader(file))


def area(entity):
    """Of a circle or a closed polyline with arcs."""
    if entity.dxftype() == "CIRCLE":
        return math.pi * entity.dxf.radius**2
    points = list(entity.get_points("xyb"))
    total = 0.0
    for (x0, y0, bulge), (x1, y1, _) in zip(points, points[1:] + points[:1]):
        total += 0.5 * (x0 * y1 - x1 * y0)
        if bulge:
            _, start, end, radius = bulge_to_arc((x0, y0), (x1, y1), bulge)
            angle = (end - start) % math.tau
            segment = 0.5 * radius**2 * (angle - math.sin(angle))
            total += segment if bulge > 0 else -segment
    return abs(total)


def drawing(path):
    """The cut contours of a drawing that its reader neither refuses nor repairs."""
    document = ezdxf.readfile(path)
    audit = document.audit()
    if audit.errors or audit.fixes:
        fail(f"{path}: {[entry.message for entry in audit.errors + audit.fixes]}")
    if (document.dxfversion, document.units) != ("AC1015", 4):
        fail(f"{path}: {document.dxfversion}, unit {document.units}, expected AC1015 in millimetres")
    for layer, colour in COLOURS.items():
        if document.layers.get(layer).color != colour:
            fail(f"{path}: layer {layer} is not of colour {colour}")
    contours = []
    for entity in document.modelspace():
        kind, layer = entity.dxftype(), entity.dxf.layer
        if kind not in ("LINE", "CIRCLE", "LWPOLYLINE") or layer not in COLOURS:
            fail(f"{path}: a {kind} on layer {layer}")
        if layer == "CUT" and kind != "LINE":
            if kind == "LWPOLYLINE" and not entity.closed:
                fail(f"{path}: an open cut")
            contours.append(entity)
    return contours


def check_drawings(kit):
    parts = {row["part"]: row for row in rows(kit, "cut-list.csv")}
    kerf = next(row["value"] for row in rows(kit, "settings.csv") if row["key"] == "kerf")
    half = float(kerf.split()[0]) / 2
    paths = sorted(kit.rglob("*.dxf"))
    for path in paths:
        contours = drawing(path)
        name = path.stem
        if path.parent.name != "parts" or name in ("grid", "coupon"):
            continue  # the grid's outline is the sheet's edge; the coupon's window is cut on its line
        # round parts with round holes: put the kerf back and compare with the cut list
        if all(contour.dxftype() == "CIRCLE" for contour in contours):
            radii = sorted((c.dxf.radius for c in contours), reverse=True)
            left = math.pi * ((radii[0] - half) ** 2 - sum((r + half) ** 2 for r in radii[1:]))
            if abs(left - float(parts[name]["area [mm^2]"])) > AREA:
                fail(f"{path}: {left} mm^2, the cut list says {parts[name]['area [mm^2]']}")
        # the others: the kerf adds its half along the length of the cuts
        else:
            areas = sorted(map(area, contours), reverse=True)
            left, listed = areas[0] - sum(areas[1:]), float(parts[name]["area [mm^2]"])
            grown = half * float(parts[name]["cut length [mm]"])
            if not 0.9 * grown < left - listed < 1.1 * grown:
                fail(f"{path}: {left} mm^2, expected {listed} and {grown} for the kerf")
    guides = [name for name in parts if name.startswith("guide-")]
    on_sheets = [sheet for name in guides for sheet in parts[name]["sheets"].split()]
    if not guides or len(on_sheets) != len(guides):
        fail("a guide of the cut list is on no sheet, or on two")
    return len(paths)


def check_solids(kit):
    parts = {row["part"]: row for row in rows(kit, "cut-list.csv")}
    paths = sorted((kit / "solids").glob("*.stl"))
    for path in paths:
        mesh = trimesh.load(path)
        listed = float(parts[path.stem]["volume [mm^3]"])
        if not (mesh.is_watertight and mesh.is_winding_consistent):
            fail(f"{path}: not watertight")
        if abs(mesh.volume / listed - 1) > VOLUME:
            fail(f"{path}: {mesh.volume} mm^3, the cut list says {listed}")
    return len(paths)


def check_paper(kit, librecad):
    """Sizes on LibreCAD's own print, against the cut list."""
    parts = {row["part"]: row for row in rows(kit, "cut-list.csv")}
    kerf = float(next(r["value"] for r in rows(kit, "settings.csv") if r["key"] == "kerf").split()[0])
    for name in ("guide-01", "motor-plate", "comb-1", "clamp-plain"):
        path = kit / "parts" / f"{name}.dxf"
        subprocess.run([librecad, "dxf2pdf", str(path)], check=True, capture_output=True, timeout=120)
        rectangles = [drawn["rect"] for drawn in pymupdf.open(path.with_suffix(".pdf"))[0].get_drawings()]
        low = [min(r.x0 for r in rectangles), min(r.y0 for r in rectangles)]
        high = [max(r.x1 for r in rectangles), max(r.y1 for r in rectangles)]
        for side, listed in zip((0, 1), ("width [mm]", "height [mm]")):
            measured = (high[side] - low[side]) * 25.4 / 72
            expected = float(parts[name][listed]) + kerf
            if abs(measured - expected) > PAPER * expected + DOT:
                fail(f"{path}: LibreCAD prints {measured:.3f} mm, expected {expected:.3f}")


def main():
    kit = Path(sys.argv[1])
    drawings, solids = check_drawings(kit), check_solids(kit)
    print(f"{kit.name}: {drawings} drawings without error or repair (ezdxf), {solids} solids closed (trimesh)")
    if len(sys.argv) > 2:
        check_paper(kit, sys.argv[2])
        print(f"{kit.name}: four parts measured on LibreCAD's print")


main()
