//! Runs of points that can be drawn: split at gaps, thinned, clipped.

use super::canvas::{Point, Rect};

/// The positions of the points, split where a point has none.
pub(super) fn runs<P: Copy, T: Copy>(points: &[P], place: impl Fn(P) -> Option<T>) -> Vec<Vec<T>> {
    let places: Vec<Option<T>> = points.iter().map(|point| place(*point)).collect();
    let runs = places.split(Option::is_none).filter(|run| !run.is_empty());
    runs.map(|run| run.iter().copied().flatten().collect()).collect()
}

/// An invisible distance in CSS pixels.
const SEEN: f64 = 0.15;

/// A visually equal curve with fewer points: no point of the original is farther than [`SEEN`] from the line
/// through the remaining ones (Ramer, Douglas and Peucker).
pub(super) fn thin(run: &[Point]) -> Vec<Point> {
    let mut is_kept = vec![false; run.len()];
    let mut pieces = vec![(0, run.len().saturating_sub(1))];
    for end in [is_kept.len().min(1), is_kept.len()] {
        is_kept[..end].last_mut().into_iter().for_each(|kept| *kept = true);
    }
    while let Some((from, to)) = pieces.pop() {
        let off = |i: usize| (i, distance(run[i], (run[from], run[to])));
        let farthest = (from + 1..to).map(off).max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((at, _)) = farthest.filter(|(_, distance)| *distance > SEEN) {
            is_kept[at] = true;
            pieces.extend([(from, at), (at, to)]);
        }
    }
    run.iter().zip(is_kept).filter_map(|(p, kept)| kept.then_some(*p)).collect()
}

/// Distance of a point from a segment.
fn distance(p: Point, (a, b): (Point, Point)) -> f64 {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let square = dx * dx + dy * dy;
    let along = (p.0 - a.0) * dx + (p.1 - a.1) * dy;
    let t = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    (p.0 - a.0 - t * dx).hypot(p.1 - a.1 - t * dy)
}

/// The parts of a line inside an area.
pub(super) fn clip_line(run: &[Point], area: Rect) -> Vec<Vec<Point>> {
    let mut pieces: Vec<Vec<Point>> = Vec::new();
    for pair in run.windows(2) {
        let Some((a, b)) = area.clip(pair[0], pair[1]) else { continue };
        match pieces.last_mut() {
            Some(piece) if piece.last() == Some(&a) => piece.push(b),
            _ => pieces.push(vec![a, b]),
        }
    }
    pieces
}

/// Adds points along a segment, a few pixels apart.
pub(super) fn sample_segment(points: &mut Vec<Point>, a: Point, b: Point) {
    let steps = ((b.0 - a.0).hypot(b.1 - a.1) / 4.0).ceil().clamp(1.0, 2000.0);
    let at = |t: f64| (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1));
    points.extend((0..=steps as usize).map(|i| at(i as f64 / steps)));
}

/// Adds points inside a rectangle, a few pixels apart.
pub(super) fn sample_rect(points: &mut Vec<Point>, rect: Rect) {
    let rows = (rect.height / 4.0).ceil() as usize;
    for i in 0..=rows {
        let y = rect.top + rect.height * i as f64 / rows.max(1) as f64;
        sample_segment(points, (rect.left, y), (rect.right(), y));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Rect = Rect { left: 0.0, top: 0.0, width: 10.0, height: 10.0 };

    #[test]
    fn gaps_split_a_line() {
        let points = [(0.0, 1.0), (1.0, 1.0), (2.0, f64::NAN), (3.0, 1.0)];
        let place = |p: (f64, f64)| p.1.is_finite().then_some(p);
        assert_eq!(runs(&points, place).len(), 2);
        assert!(runs(&[], place).is_empty());
    }

    #[test]
    fn thinning_keeps_peaks() {
        let run: Vec<Point> = (0..100_000)
            .map(|i| (f64::from(i) * 1e-3, if i == 5432 { -7.0 } else { 1.0 }))
            .collect();
        let kept = thin(&run);
        assert!(kept.len() < 10 && kept.iter().any(|p| p.1 == -7.0));
        assert_eq!((thin(&[]), thin(&run[..1]).len(), thin(&run[..2]).len()), (vec![], 1, 2));
    }

    #[test]
    fn a_smooth_curve_needs_few_points() {
        let at = |k: i32| (f64::from(k), 100.0 * (f64::from(k) / 60.0).sin());
        let run: Vec<Point> = (0..400).map(at).collect();
        let kept = thin(&run);
        assert!(kept.len() < 60, "{}", kept.len());
        let off = |p: &Point| {
            let distances = kept.windows(2).map(|pair| distance(*p, (pair[0], pair[1])));
            distances.fold(f64::INFINITY, f64::min)
        };
        assert!(run.iter().all(|p| off(p) <= SEEN));
    }

    #[test]
    fn a_line_that_leaves_and_returns_is_two_pieces() {
        let run = [(1.0, 5.0), (5.0, 15.0), (9.0, 5.0)];
        assert_eq!(clip_line(&run, AREA).len(), 2);
    }
}
