//! Streamlines: where the flux from the floor up has the same value in every section.

use maths::geometry::Hill;

use super::reference::Reference;

/// Length of the channel \[H\], and sections in it.
const PERIOD: f64 = 9.0;
const SECTIONS: usize = 720;

/// A line, (x, y) \[H\].
type Line = Vec<(f64, f64)>;

/// Flux from the floor to a height: (y \[H\], flux \[U_b H\]), upwards.
type Section = Vec<(f64, f64)>;

/// Where the sections are \[H\].
fn places() -> impl Iterator<Item = f64> {
    (0..=SECTIONS).map(|k| PERIOD * k as f64 / SECTIONS as f64)
}

/// Streamlines of the finite elements: five of the stream, and two of the bubble if there is one.
pub fn of_reference(reference: &Reference) -> Vec<Line> {
    let Ok(hill) = Hill::new(1.0) else { return Vec::new() };
    let sections: Vec<Section> = places().map(|x| section(reference, &hill, x)).collect();
    let all = || sections.iter().flatten().map(|(_, flux)| *flux);
    let (least, most) = (all().fold(0.0, f64::min), all().fold(0.0, f64::max));
    let stream = [0.05, 0.2, 0.4, 0.6, 0.8, 0.95].map(|share| share * most);
    let line = |flux| places().zip(&sections).filter_map(move |(x, s)| Some((x, last(s, flux)?)));
    let mut lines: Vec<Line> = stream.map(|flux| line(flux).collect()).into();
    if least < -1e-3 * most {
        lines.extend([0.25, 0.7].map(|share| closed(&sections, share * least)));
    }
    lines
}

fn section(reference: &Reference, hill: &Hill, x: f64) -> Section {
    const PARTS: usize = 240;
    let (floor, gap) = (hill.wall(x), hill.lid() - hill.wall(x));
    let (mut flux, step) = (0.0, gap / PARTS as f64);
    let mut section = vec![(floor, 0.0)];
    for k in 0..PARTS {
        let middle = (k as f64 + 0.5) / PARTS as f64;
        flux += step * reference.velocity(x, middle, gap).x;
        section.push((floor + step * (k + 1) as f64, flux));
    }
    section
}

/// The height above which the flux stays larger than this.
fn last(section: &Section, flux: f64) -> Option<f64> {
    section.windows(2).rev().find_map(|pair| crossing(pair, flux))
}

/// The line in the bubble on which the flux, which falls from the floor up before it rises, is this.
fn closed(sections: &[Section], flux: f64) -> Line {
    let first = |section: &Section| section.windows(2).find_map(|pair| crossing(pair, flux));
    let both = places().zip(sections).filter_map(|(x, s)| Some((x, first(s)?, last(s, flux)?)));
    let both: Vec<(f64, f64, f64)> = both.collect();
    let below = both.iter().map(|(x, low, _)| (*x, *low));
    let above = both.iter().rev().map(|(x, _, high)| (*x, *high));
    let end = both.first().map(|(x, low, _)| (*x, *low));
    below.chain(above).chain(end).collect()
}

/// Where the flux passes a value between two heights.
fn crossing(pair: &[(f64, f64)], flux: f64) -> Option<f64> {
    let [(low, a), (high, b)] = [pair[0], pair[1]];
    let share = (flux - a) / (b - a);
    (0.0..1.0).contains(&share).then_some(low + share * (high - low))
}

/// The separation line of particles x, y, u, one a square of `dx`: the height up to which those of a section
/// carry no flux, where the flux below is backwards. Empty if they carry none backwards.
pub fn of_particles(particles: &[(f64, f64, f64)], dx: f64) -> Line {
    let width = 4.0 * dx;
    let height = |x: f64| {
        let distance = |p: &(f64, f64, f64)| (p.0 - x) - PERIOD * ((p.0 - x) / PERIOD).round();
        let near = particles.iter().filter(|p| distance(p).abs() < 0.5 * width);
        let mut near: Vec<(f64, f64)> = near.map(|p| (p.1, p.2)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut flux = 0.0;
        let sum = |(y, u): (f64, f64)| {
            flux += u * dx * dx / width;
            (y, flux)
        };
        let section: Section = near.into_iter().map(sum).collect();
        let backwards = section.iter().any(|(_, flux)| *flux < -2e-3);
        last(&section, 0.0).filter(|_| backwards).map(|y| (x, y))
    };
    places().filter_map(height).collect()
}

#[cfg(test)]
mod tests {
    use super::super::reference::reference;
    use super::*;

    /// The line on which the flux is zero is the line between bubble and stream of the reference's own table.
    #[test]
    fn the_separation_line_is_that_of_the_reference() {
        let hill = Hill::new(1.0).expect("a hill");
        let reference = reference(100.0).expect("computed");
        for x in [2.0, 4.0, 6.0] {
            let found = last(&section(&reference, &hill, x), 0.0).expect("a bubble");
            let near = |p: &&(f64, f64)| (p.0 - x).abs() < 0.05;
            let known = reference.line.iter().find(near).expect("a point").1;
            assert!((found - known).abs() < 0.02, "{found} and {known} at {x}");
        }
        assert_eq!(of_reference(&reference).len(), 8);
    }

    #[test]
    fn particles_that_flow_backwards_below_have_a_line_and_others_none() {
        let at = |u: fn(f64) -> f64| -> Vec<(f64, f64, f64)> {
            let places = (0..90).flat_map(|i| (0..30).map(move |j| (i as f64, j as f64)));
            let particle = |(i, j): (f64, f64)| (0.1 * i + 0.05, 0.1 * j + 0.05, u(0.1 * j + 0.05));
            places.map(particle).collect()
        };
        // The flux y²/2 - y/2 is zero at 1.
        let line = of_particles(&at(|y| y - 0.5), 0.1);
        assert!(line.len() > 700 && line.iter().all(|(_, y)| (y - 1.0).abs() < 0.1), "{line:?}");
        assert!(of_particles(&at(|_| 1.0), 0.1).is_empty());
    }
}
