//! Parts as solids for a printer: binary STL in millimetres.

use hydrostat::fabricate::Part;
use hydrostat::planar::{Contour, Point};

/// Largest distance of a facet from its arc, as a part of the radius.
const FACET: f64 = 1e-3;

type Triangle = [[f64; 3]; 3];

/// A closed surface; engraved areas are cut as deep as they are engraved, lines are left out.
pub(super) fn stl(part: &Part, thickness: f64) -> Vec<u8> {
    let mut triangles = Vec::new();
    let depth = part.pockets.iter().map(|(_, depth)| *depth).fold(0.0, f64::max);
    prism(&mut triangles, &part.outline, &part.holes, 0.0, thickness - depth);
    if let [(channel, depth)] = &part.pockets[..] {
        for side in beside(&part.outline, channel) {
            let inside = |hole: &&Contour| side.contains(hole.bounds().low.lerp(&hole.bounds().high, 0.5));
            let holes: Vec<Contour> = part.holes.iter().filter(inside).cloned().collect();
            prism(&mut triangles, &side, &holes, thickness - depth, thickness);
        }
    }
    encode(&triangles)
}

/// What a channel across leaves of an outline: the two parts beyond its long sides.
fn beside(outline: &Contour, channel: &Contour) -> [Contour; 2] {
    let corners = channel.chords(FACET);
    let middle = channel.bounds().low.lerp(&channel.bounds().high, 0.5);
    let [a, b] = [corners[1] - corners[0], corners[2] - corners[1]];
    let along = if a.norm() > b.norm() { a } else { b };
    let across = Point::new(-along.y, along.x).normalize();
    let half = corners.iter().map(|corner| across.dot(&(corner - middle))).fold(0.0, f64::max);
    [across, -across].map(|out| clipped(&outline.chords(FACET), middle + half * out, out))
}

/// The part of a convex polygon beyond a line through `on`, on the side of `out`.
fn clipped(corners: &[Point], on: Point, out: Point) -> Contour {
    let beyond = |p: Point| out.dot(&(p - on));
    let mut kept = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        if beyond(a) >= 0.0 {
            kept.push(a);
        }
        if beyond(a) * beyond(b) < 0.0 {
            kept.push(a.lerp(&b, beyond(a) / (beyond(a) - beyond(b))));
        }
    }
    Contour::polygon(kept)
}

/// A prism over a contour with holes, from one height to another.
fn prism(triangles: &mut Vec<Triangle>, outline: &Contour, holes: &[Contour], low: f64, high: f64) {
    let rings: Vec<Vec<Point>> =
        std::iter::once(outline).chain(holes).map(|ring| ring.chords(FACET)).collect();
    let corners: Vec<[f64; 2]> = rings.iter().flatten().map(|p| [p.x, p.y]).collect();
    let mut starts = Vec::new();
    let mut count = 0;
    for ring in &rings {
        starts.push(count as u32);
        count += ring.len();
    }
    let mut faces: Vec<u32> = Vec::new();
    earcut::Earcut::new().earcut(corners.iter().copied(), &starts[1..], &mut faces);
    let at = |i: u32, z: f64| [corners[i as usize][0], corners[i as usize][1], z];
    for face in faces.chunks_exact(3) {
        let [mut a, b, mut c] = [face[0], face[1], face[2]];
        if turn(corners[a as usize], corners[b as usize], corners[c as usize]) < 0.0 {
            std::mem::swap(&mut a, &mut c);
        }
        triangles.push([at(a, high), at(b, high), at(c, high)]);
        triangles.push([at(c, low), at(b, low), at(a, low)]);
    }
    for (r, ring) in rings.iter().enumerate() {
        for i in 0..ring.len() {
            let (mut a, mut b) = (starts[r] + i as u32, starts[r] + ((i + 1) % ring.len()) as u32);
            if r > 0 {
                std::mem::swap(&mut a, &mut b); // holes turn the other way
            }
            triangles.push([at(a, low), at(b, low), at(b, high)]);
            triangles.push([at(a, low), at(b, high), at(a, high)]);
        }
    }
}

fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn encode(triangles: &[Triangle]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes[..24].copy_from_slice(b"hydrostat, millimetres  ");
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        let [a, b, c] = triangle.map(nalgebra::Vector3::from);
        let normal = (b - a).cross(&(c - a)).normalize();
        let corners = [a, b, c].map(|corner| corner * super::MM);
        for vector in std::iter::once(normal).chain(corners) {
            bytes.extend(vector.iter().flat_map(|x| (*x as f32).to_le_bytes()));
        }
        bytes.extend([0, 0]);
    }
    bytes
}
