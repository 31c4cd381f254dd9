//! Parts as solids for a printer: binary STL in millimetres.
//!
//! The part's plane is cut into triangles along outline, holes and channels; each is raised to its height, and where heights differ
//! a wall stands between them, in layers, so that every edge has two facets.

use hydrostat::fabricate::Part;
use hydrostat::planar::{Contour, Point, inside};
use nalgebra::Vector3;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// Largest distance of a facet from its arc, as a part of the radius.
const FACET: f64 = 1e-4;

type Triangle = [Vector3<f64>; 3];

/// A closed surface; engraved areas are as deep as they are engraved, lines are left out.
pub(super) fn stl(part: &Part, thickness: f64) -> Vec<u8> {
    let plane = triangulate(part);
    let mut levels: Vec<f64> = part.pockets.iter().map(|(_, depth)| thickness - depth).collect();
    levels.extend([0.0, thickness]);
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    let ring = |contour: &Contour| contour.chords(FACET);
    let (outline, holes) = (ring(&part.outline), part.holes.iter().map(ring).collect::<Vec<_>>());
    let pockets: Vec<_> = part.pockets.iter().map(|(pocket, depth)| (ring(pocket), depth)).collect();
    let height = |middle: Point| {
        if !inside(&outline, middle) || holes.iter().any(|hole| inside(hole, middle)) {
            return 0.0;
        }
        let pocket = pockets.iter().find(|(pocket, _)| inside(pocket, middle));
        pocket.map_or(thickness, |(_, depth)| thickness - *depth)
    };
    encode(&raise(&plane, &levels, height))
}

type Plane = ConstrainedDelaunayTriangulation<Point2<f64>>;

fn triangulate(part: &Part) -> Plane {
    let mut plane = Plane::new();
    let rings = std::iter::once(&part.outline)
        .chain(&part.holes)
        .chain(part.pockets.iter().map(|(pocket, _)| pocket));
    for ring in rings.map(|ring: &Contour| ring.chords(FACET)) {
        let insert = |p: &Point| plane.insert(Point2::new(p.x, p.y)).expect("coordinates are finite");
        let corners: Vec<_> = ring.iter().map(insert).collect();
        for (i, from) in corners.iter().enumerate() {
            let to = corners[(i + 1) % corners.len()];
            if *from != to {
                plane.add_constraint_and_split(*from, to, |point| point);
            }
        }
    }
    plane
}

/// Lids and floors of every triangle that is not empty, and the walls between different heights.
fn raise(plane: &Plane, levels: &[f64], height: impl Fn(Point) -> f64) -> Vec<Triangle> {
    let mut triangles = Vec::new();
    let point = |p: Point2<f64>, z: f64| Vector3::new(p.x, p.y, z);
    let heights: Vec<f64> = plane
        .all_faces()
        .map(|face| match face.as_inner() {
            Some(face) => {
                let [a, b, c] = face.positions();
                height(Point::new((a.x + b.x + c.x) / 3.0, (a.y + b.y + c.y) / 3.0))
            }
            None => 0.0,
        })
        .collect();
    for face in plane.inner_faces() {
        let top = heights[face.fix().index()];
        if top > 0.0 {
            let [a, b, c] = face.positions();
            triangles.push([a, b, c].map(|p| point(p, top)));
            triangles.push([c, b, a].map(|p| point(p, 0.0)));
        }
    }
    for edge in plane.directed_edges() {
        let (mine, beyond) = (heights[edge.face().fix().index()], heights[edge.rev().face().fix().index()]);
        let [a, b] = edge.positions();
        let layers = levels.windows(2).filter(|layer| layer[0] >= beyond && layer[1] <= mine);
        for layer in layers {
            let [low, high] = [layer[0], layer[1]];
            triangles.push([point(a, low), point(b, low), point(b, high)]);
            triangles.push([point(a, low), point(b, high), point(a, high)]);
        }
    }
    triangles
}

fn encode(triangles: &[Triangle]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes[..24].copy_from_slice(b"hydrostat, millimetres  ");
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for [a, b, c] in triangles {
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
        let corners = [a, b, c].map(|corner| corner * super::MM);
        for vector in std::iter::once(normal).chain(corners) {
            bytes.extend(vector.iter().flat_map(|x| (*x as f32).to_le_bytes()));
        }
        bytes.extend([0, 0]);
    }
    bytes
}
