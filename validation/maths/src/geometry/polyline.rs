//! Rows of particles behind walls with corners.

use nalgebra::Vector2;

/// A row at a depth \[m\] behind a line of straight sides, which has the fluid on its left: a particle on
/// each vertex, where sides meet on the line that halves their angle, and others between, about dx apart;
/// places with their spacing.
pub fn row_behind(vertices: &[Vector2<f64>], depth: f64, dx: f64) -> Vec<(Vector2<f64>, f64)> {
    let normals: Vec<Vector2<f64>> = vertices
        .windows(2)
        .map(|ends| (ends[1] - ends[0]).normalize())
        .map(|along| Vector2::new(along.y, -along.x))
        .collect();
    let moved = |k: usize| {
        let [a, b] = [k.saturating_sub(1), k.min(normals.len() - 1)].map(|side| normals[side]);
        vertices[k] + (a + b) * (depth / (1.0 + a.dot(&b)))
    };
    let moved: Vec<Vector2<f64>> = (0..vertices.len()).map(moved).collect();
    let side = |ends: &[Vector2<f64>]| {
        let (start, along) = (ends[0], ends[1] - ends[0]);
        let count = (along.norm() / dx).round().max(1.0);
        (0..count as usize).map(move |k| (start + along * (k as f64 / count), along.norm() / count))
    };
    let last = moved.last().map(|end| (*end, dx));
    moved.windows(2).flat_map(side).chain(last).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Down, along a floor of 1 m, and up, the fluid inside; half a metre behind the floor is twice as long.
    #[test]
    fn a_row_is_as_far_behind_every_side_and_its_corners_are_on_both() {
        let vertices = [[0.0, 1.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]].map(Vector2::from);
        let row = row_behind(&vertices, 0.5, 0.5);
        let corners = [[-0.5, -0.5], [1.5, -0.5], [1.5, 1.0]].map(Vector2::from);
        assert!(corners.iter().all(|corner| row.iter().any(|(x, _)| (x - corner).norm() < 1e-12)));
        assert_eq!(row.len(), 3 + 4 + 3 + 1);
        assert!(row.iter().all(|(_, spacing)| (spacing - 0.5).abs() < 1e-12));
        // A bend by 45 degrees moves its vertex along the line that halves the angle.
        let bent = [[0.0, 0.0], [1.0, 0.0], [2.0, 1.0]].map(Vector2::from);
        let row = row_behind(&bent, 1.0, 10.0);
        assert!((row[1].0 - Vector2::new(2.0_f64.sqrt(), -1.0)).norm() < 1e-12, "{row:?}");
    }
}
