//! A solver of another library: finite differences across a channel, which carry the particles along.

use nalgebra::Vector2;
use serde_json::Map;
use touchstone_base::submission::Division;
use touchstone_exchange::{
    library::Solver,
    problem::ExportedProblem,
    submission::{Method, System},
};
use touchstone_harness::foreign::ForeignParticle;

/// u_t = ν u_yy with central differences in space and forward Euler in time.
pub struct FiniteDifferences {
    /// Cells across the channel.
    pub cells: usize,
}

impl Solver for FiniteDifferences {
    fn method(&self) -> Method {
        Method {
            code: "finite differences".into(),
            version: "1".into(),
            scheme: format!("second order, {} cells", self.cells),
            division: Division::Closed,
            settings: Map::new(),
            changed: "no particles interact".into(),
        }
    }

    fn solve(
        &self,
        problem: &ExportedProblem,
        tell: &mut dyn FnMut(f64, Vec<ForeignParticle>),
    ) -> System {
        let outline = &problem.outline;
        let [low, high] = [0, 1].map(|k| &outline.mirrors[k]);
        let dy = (high.point.y - low.point.y) / self.cells as f64;
        let (nu, force) = (outline.medium.nu, outline.medium.acceleration.x);
        let column = |name: &str| outline.particles.column(name);
        let mut places: Vec<Vector2<f64>> =
            column("x").iter().zip(column("y")).map(|(x, y)| Vector2::new(*x, *y)).collect();
        let mut u = vec![0.0; self.cells + 1];
        (u[0], u[self.cells]) = (low.velocity.x, high.velocity.x);
        let (mut now, mut steps) = (0.0, 0);
        for &time in &outline.times {
            let count = ((time - now) / (0.4 * dy * dy / nu)).ceil();
            let dt = (time - now) / count;
            let at = |u: &[f64], y: f64| {
                let place = (y - low.point.y) / dy;
                let k = (place as usize).min(self.cells - 1);
                u[k] + (place - k as f64) * (u[k + 1] - u[k])
            };
            for _ in 0..count as usize {
                let old = u.clone();
                for k in 1..self.cells {
                    u[k] +=
                        dt * (force + nu * (old[k - 1] - 2.0 * old[k] + old[k + 1]) / (dy * dy));
                }
                places.iter_mut().for_each(|place| place.x += dt * at(&u, place.y));
            }
            (now, steps) = (time, steps + count as usize);
            let placed = |(k, place): (usize, &Vector2<f64>)| {
                let velocity = Vector2::new(at(&u, place.y), 0.0);
                ForeignParticle { id: k as u32, position: *place, velocity, density: None }
            };
            tell(time, places.iter().enumerate().map(placed).collect());
        }
        let steps = Some(steps as f64);
        let machine = "unknown".into();
        System { machine, threads: None, seconds: None, steps, interactions: None }
    }
}
