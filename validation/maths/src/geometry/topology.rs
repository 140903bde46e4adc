//! Pieces and holes of a body of particles. A cut ring, which is one piece like a whole ring, has no hole.
//!
//! A particle represents a disc of the radius 0.75 dx. Discs overlap where particles are within 1.5 dx of
//! each other, so a piece of the union is a set of particles connected by such bonds, and a hole exists as
//! long as a closed chain of bonds encloses it. The radius follows from two bounds:
//!
//! - A strained body must count as whole. A layer stretched to less than 1.5 of its length keeps a ring
//!   closed; in bending a layer keeps its length or is shortened, so this is far off. A square lattice of
//!   cells a × b with a² + b² below (1.5 dx)² has no gap at all: at rest, where the sum is (1.41 dx)², and up
//!   to a stretch of 1.28 at constant area. A gap between four particles at larger stretch is a pinhole,
//!   which counts as a hole only above the area that the caller states.
//! - A cut must be open before it is two spacings wide. Rows that face each other 2 dx apart leave
//!   0.5 dx between their discs, rows that are staggered by half a spacing 0.56 dx.
//!
//! Holes are found on scan lines 0.2 dx apart, on which discs are intervals, exactly: a channel along the
//! lines that is narrower than 0.2 dx may be missed. So a cut along the lines counts as open from a distance
//! of 1.5 to 1.7 dx between its rows, depending on where the lines are.

use nalgebra::Vector2;
use std::f64::consts::PI;

use super::corners;

type Point = Vector2<f64>;

/// Particles that are no farther apart hold together \[dx\].
pub const BOND: f64 = 1.5;
/// Distance of scan lines \[dx\].
const LINE: f64 = 0.2;

/// Pieces and holes of the union of discs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    /// Parts that hold together.
    pub pieces: usize,
    /// Enclosed parts of the background of at least the requested area.
    pub holes: usize,
}

impl Topology {
    /// Topology of particles at the spacing `dx` \[m\]; holes of less than `least_hole` \[m²\] do not count.
    ///
    /// A piece closes in its holes alone, so each piece is scanned in its own box: debris far away
    /// costs nothing.
    pub fn of(points: &[Point], dx: f64, least_hole: f64) -> Self {
        let mut pieces = pieces(points, BOND * dx);
        let holes = pieces.iter_mut().map(|piece| holes(piece, dx, least_hole)).sum();
        Self { pieces: pieces.len(), holes }
    }

    /// The least area \[m²\] of a hole that counts as the hole of a ring with these radii \[m\]: the area of
    /// a disc half as wide as the wall is thick, or a quarter of the hole at rest if this is smaller.
    ///
    /// Pinholes and voids inside a wall that holds are far smaller. A ring that is pressed flat until its
    /// walls touch keeps a hole on either side; one without any would count as cut.
    pub fn least_hole_of_ring(inner: f64, outer: f64) -> f64 {
        let wall = outer - inner;
        0.25 * PI * (0.25 * wall * wall).min(inner * inner)
    }
}

/// Particles that were neighbours once.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Bonds(Vec<[usize; 2]>);

impl Bonds {
    /// Pairs of particles that are at most `reach` \[m\] apart.
    pub fn of(points: &[Point], reach: f64) -> Self {
        let mut bonds = Vec::new();
        each_pair(points, reach, |a, b| bonds.push([a, b]));
        Self(bonds)
    }

    /// The largest distance of such a pair where its particles are now \[m\]; 0 without pairs.
    pub fn longest(&self, points: &[Point]) -> f64 {
        let distance2 = |[a, b]: &[usize; 2]| match (points.get(*a), points.get(*b)) {
            (Some(a), Some(b)) => (a - b).norm_squared(),
            _ => 0.0,
        };
        self.0.iter().map(distance2).fold(0.0, f64::max).sqrt()
    }
}

/// Calls `found` once with every pair of particles that are at most `reach` \[m\] apart.
fn each_pair(points: &[Point], reach: f64, mut found: impl FnMut(usize, usize)) {
    // Row and column of the square cell that a particle is in, and its number: rows one after another.
    let cell =
        |(k, p): (usize, &Point)| ((p.y / reach).floor() as i64, (p.x / reach).floor() as i64, k);
    let mut cells: Vec<(i64, i64, usize)> = points.iter().enumerate().map(cell).collect();
    cells.sort_unstable();
    let reach2 = reach * reach;
    // The first in the next row that can be near: it only moves on.
    let mut below = 0;
    for (i, &(row, column, a)) in cells.iter().enumerate() {
        let (next, last) = (row.saturating_add(1), column.saturating_add(1));
        while cells.get(below).is_some_and(|c| *c < (next, column.saturating_sub(1), 0)) {
            below += 1;
        }
        for (row, start) in [(row, i + 1), (next, below.max(i + 1))] {
            let near = cells[start..].iter().take_while(|c| c.0 == row && c.1 <= last);
            for &(_, _, b) in near {
                if (points[a] - points[b]).norm_squared() <= reach2 {
                    found(a, b);
                }
            }
        }
    }
}

/// The pieces that bonds of at most `reach` \[m\] hold together.
fn pieces(points: &[Point], reach: f64) -> Vec<Vec<Point>> {
    let mut joined = Joined((0..points.len()).collect());
    each_pair(points, reach, |a, b| {
        joined.join(a, b);
    });
    // The number of a piece, by the first of its particles.
    let (mut number, mut pieces) = (vec![0; points.len()], Vec::<Vec<Point>>::new());
    for (k, p) in points.iter().enumerate() {
        let first = joined.root(k);
        if first == k {
            number[k] = pieces.len();
            pieces.push(Vec::new());
        }
        pieces[number[first]].push(*p);
    }
    pieces
}

/// Disjoint sets; the first element represents its set.
struct Joined(Vec<usize>);

impl Joined {
    fn root(&mut self, mut k: usize) -> usize {
        while self.0[k] != k {
            self.0[k] = self.0[self.0[k]];
            k = self.0[k];
        }
        k
    }

    /// Joins two sets; returns the representative of the union and the former representative of the other
    /// set.
    fn join(&mut self, a: usize, b: usize) -> Option<(usize, usize)> {
        let (a, b) = (self.root(a), self.root(b));
        let (kept, gone) = (a.min(b), a.max(b));
        self.0[gone] = kept;
        (kept != gone).then_some((kept, gone))
    }
}

/// Holes of one piece, of at least this area \[m²\].
fn holes(piece: &mut [Point], dx: f64, least_hole: f64) -> usize {
    // So that the intervals of a line are nearly in order.
    piece.sort_unstable_by(|a, b| a.x.total_cmp(&b.x));
    let mut background = Background { joined: Joined(vec![OUTSIDE]), area: vec![0.0] };
    let everything = Gap { start: f64::NEG_INFINITY, end: f64::INFINITY, region: OUTSIDE };
    let mut above = vec![everything];
    for mut line in scan_lines(piece, 0.5 * BOND * dx, LINE * dx) {
        line.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut gaps = Vec::with_capacity(4);
        // Where the gap that is open begins, and its number.
        let mut from = f64::NEG_INFINITY;
        for (start, end) in line {
            if start > from {
                let is_outside = from == f64::NEG_INFINITY;
                let area = (start - from) * LINE * dx;
                let region = if is_outside { OUTSIDE } else { background.begin(area) };
                gaps.push(Gap { start: from, end: start, region });
            }
            from = from.max(end);
        }
        gaps.push(Gap { start: from, ..everything });
        background.join_lines(&above, &gaps);
        above = gaps;
    }
    background.join_lines(&above, &[everything]);
    background.closed(least_hole)
}

/// The intervals \[m\] that discs leave on lines a `step` \[m\] apart.
fn scan_lines(piece: &[Point], radius: f64, step: f64) -> Vec<Vec<(f64, f64)>> {
    let [low, high] = corners(piece.iter().copied()).map(|corner| corner.y);
    let (low, high) = (low - radius, high + radius);
    // A piece holds together, so that this is at most its number of particles times 2 radius/step.
    let most = piece.len() as f64 * (2.0 * radius / step) + 1.0;
    let count = ((high - low) / step).clamp(0.0, most) as usize;
    let mut lines = vec![Vec::new(); count];
    for p in piece {
        let first = ((p.y - radius - low) / step - 0.5).ceil().max(0.0) as usize;
        for (k, line) in lines.iter_mut().enumerate().skip(first) {
            let away = low + (k as f64 + 0.5) * step - p.y;
            let half2 = radius * radius - away * away;
            if half2 > 0.0 {
                let half = half2.sqrt();
                line.push((p.x - half, p.x + half));
            } else if away > 0.0 {
                break;
            }
        }
    }
    lines
}

/// The region outside of everything.
const OUTSIDE: usize = 0;

/// A part of a line that no disc covers.
#[derive(Clone, Copy)]
struct Gap {
    /// \[m\].
    start: f64,
    /// \[m\].
    end: f64,
    /// Number of its region of the background.
    region: usize,
}

/// Regions of the background, joined as lines connect them. The outside is the first element and so
/// represents its set.
struct Background {
    joined: Joined,
    /// \[m²\].
    area: Vec<f64>,
}

impl Background {
    fn begin(&mut self, area: f64) -> usize {
        let region = self.area.len();
        self.joined.0.push(region);
        self.area.push(area);
        region
    }

    /// Joins the gaps of two lines that overlap.
    fn join_lines(&mut self, above: &[Gap], below: &[Gap]) {
        let (mut i, mut j) = (0, 0);
        while let (Some(a), Some(b)) = (above.get(i), below.get(j)) {
            let overlap = a.start.max(b.start) < a.end.min(b.end);
            if overlap && let Some((kept, gone)) = self.joined.join(a.region, b.region) {
                self.area[kept] += self.area[gone];
            }
            if a.end < b.end { i += 1 } else { j += 1 }
        }
    }

    /// Regions that are closed in, of at least this area \[m²\].
    fn closed(&self, least: f64) -> usize {
        let is_hole = |&k: &usize| self.joined.0[k] == k && self.area[k] >= least;
        (OUTSIDE + 1..self.area.len()).filter(is_hole).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;
    use touchstone_base::{
        functions::{rotation, sin_cos},
        random::Random,
    };

    const DX: f64 = 0.1;

    /// Concentric layers from radius 3 to 4, as the rings of `rubber_rings` have them.
    fn annulus() -> Vec<Point> {
        let layer = |k: usize| {
            let r = 3.0 + (k as f64 + 0.5) * DX;
            let count = 4 * (TAU * r / (4.0 * DX)).round() as usize;
            (0..count).map(move |j| {
                let (sin, cos) = sin_cos(TAU * (j as f64 + 0.5) / count as f64);
                Point::new(r * cos, r * sin)
            })
        };
        (0..10).flat_map(layer).collect()
    }

    fn of(points: &[Point]) -> (usize, usize) {
        let topology = Topology::of(points, DX, Topology::least_hole_of_ring(3.0, 4.0));
        (topology.pieces, topology.holes)
    }

    /// Turned about the origin by this angle \[rad\].
    fn turned(points: &[Point], angle: f64) -> Vec<Point> {
        points.iter().map(|p| rotation(angle) * p).collect()
    }

    /// Opens the annulus at its left pole: the upper part moves up and the lower part down, so that adjacent
    /// rows become `apart` \[dx\] apart.
    fn cut(apart: f64, angle: f64) -> Vec<Point> {
        let open = |p: &Point| {
            let moved = if p.x < 0.0 { 0.5 * (apart - 1.0) * DX * p.y.signum() } else { 0.0 };
            Point::new(p.x, p.y + moved)
        };
        turned(&annulus().iter().map(open).collect::<Vec<_>>(), angle)
    }

    #[test]
    fn a_disc_has_no_hole_and_an_annulus_has_one() {
        let dx = Vector2::repeat(DX);
        let square = (-20..=20).flat_map(|i| (-20..=20).map(move |j| (f64::from(i), f64::from(j))));
        let disc: Vec<Point> = square
            .map(|(i, j)| Point::new(i, j).component_mul(&dx))
            .filter(|p| p.norm() <= 2.0)
            .collect();
        assert_eq!(of(&disc), (1, 0));
        // Not even a pinhole.
        assert_eq!(Topology::of(&disc, DX, 0.0), Topology { pieces: 1, holes: 0 });
        assert_eq!(of(&annulus()), (1, 1));
        assert_eq!(Topology::of(&annulus(), DX, 0.0), Topology { pieces: 1, holes: 1 });
        assert_eq!(of(&[]), (0, 0));
        assert_eq!(of(&[Point::zeros()]), (1, 0));
    }

    /// In every direction, because the scan lines have one.
    #[test]
    fn a_cut_is_open_before_it_is_two_spacings_wide_and_closed_at_one_and_a_half() {
        for k in 0..24 {
            let angle = TAU * (f64::from(k) + 0.1) / 24.0;
            for (apart, holes) in [(1.0, 1), (1.45, 1), (1.71, 0), (2.0, 0), (3.0, 0)] {
                assert_eq!(of(&cut(apart, angle)), (1, holes), "{apart} dx apart at {angle}");
            }
        }
    }

    /// A cut through nine of ten layers does not open a ring.
    #[test]
    fn one_layer_keeps_a_ring_closed() {
        let layers = [3.0, 3.5, 3.9];
        for kept in layers {
            let is_kept = |p: &Point| {
                let r = p.norm();
                p.x > 0.0 || p.y.abs() > 2.0 * DX || (kept..kept + DX).contains(&r)
            };
            let notched: Vec<Point> = annulus().into_iter().filter(is_kept).collect();
            assert_eq!(of(&notched), (1, 1), "kept at {kept}");
        }
    }

    #[test]
    fn rings_that_touch_are_one_piece_with_two_holes() {
        let ring = annulus();
        let right = |gap: f64| ring.iter().map(move |p| p + Point::new(8.0 + gap, 0.0));
        let pair = |gap: f64| ring.iter().copied().chain(right(gap)).collect::<Vec<_>>();
        assert_eq!(of(&pair(0.0)), (1, 2));
        assert_eq!(of(&pair(2.0 * DX)), (2, 2));
        // One inside the hole of the other.
        let inside = ring.iter().map(|p| 0.4 * p);
        let nested: Vec<Point> = ring.iter().copied().chain(inside).collect();
        assert_eq!(of(&nested), (2, 2));
    }

    #[test]
    fn strain_and_disorder_tear_nothing() {
        let mut stream = Random::new(1);
        let mut random = || 2.0 * stream.uniform() - 1.0;
        for angle in [0.0, 0.4, TAU / 4.0] {
            let strained = |p: Point| Point::new(1.3 * p.x, p.y);
            let jittered: Vec<Point> = turned(&annulus(), angle)
                .into_iter()
                .map(|p| strained(p) + 0.2 * DX * Point::new(random(), random()))
                .collect();
            assert_eq!(of(&jittered), (1, 1));
        }
    }

    #[test]
    fn a_ring_in_two_pieces_has_no_hole() {
        let apart: Vec<Point> = annulus().into_iter().filter(|p| p.y.abs() > 1.5 * DX).collect();
        assert_eq!(of(&apart), (2, 0));
        // Debris far away costs neither time nor memory.
        let mut debris = annulus();
        debris.push(Point::new(1e9, -1e9));
        assert_eq!(of(&debris), (2, 1));
    }

    #[test]
    fn bonds_know_how_far_neighbours_have_come_apart() {
        let ring = annulus();
        let bonds = Bonds::of(&ring, 1.2 * DX);
        // Two in the layer, and 1.3 to each side, each counted once.
        let of_each = bonds.0.len() as f64 / ring.len() as f64;
        assert!((2.1..2.4).contains(&of_each), "{of_each} a particle");
        let rest = bonds.longest(&ring);
        assert!(rest > DX && rest <= 1.2 * DX, "{rest}");
        // The bonds across the cut are longer by the width of the gap.
        let opened = bonds.longest(&cut(4.0, 0.3)) / DX;
        assert!((4.0..4.1).contains(&opened), "{opened} dx");
        let swollen: Vec<Point> = ring.iter().map(|p| 1.5 * p).collect();
        assert!((bonds.longest(&swollen) / rest - 1.5).abs() < 1e-12);
        assert_eq!(Bonds::of(&[], DX).longest(&[]), 0.0);
    }
}
