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
    let (floor, gap) = (hill.wall(x), hill.lid() - hill.wall(x));
    integrated(floor, gap, |share| reference.velocity(x, share, gap).x)
}

/// The flux of a velocity \[U_b\], a function of the share of the gap \[H\] over the floor \[H\].
fn integrated(floor: f64, gap: f64, velocity: impl Fn(f64) -> f64) -> Section {
    const PARTS: usize = 240;
    let (mut flux, step) = (0.0, gap / PARTS as f64);
    let mut section = vec![(floor, 0.0)];
    for k in 0..PARTS {
        flux += step * velocity((k as f64 + 0.5) / PARTS as f64);
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

    /// Of a velocity a + b s over the share s of the gap G, the flux up to s is G (a s + b s²/2): middles of
    /// parts give it exactly, at every height. A part of 1/240 too high or too low is an error of G/240.
    #[test]
    fn the_flux_is_that_up_to_its_height() {
        let (floor, gap, a, b) = (0.4, 2.5, -0.3, 1.7);
        let section = integrated(floor, gap, |s| a + b * s);
        assert_eq!((section[0], section.len()), ((floor, 0.0), 241), "floor and number of heights");
        for (height, flux) in &section {
            let s = (height - floor) / gap;
            let expected = gap * s * (a + 0.5 * b * s);
            assert!(
                (flux - expected).abs() < 1e-12,
                "flux {flux} up to s = {s}, expected {expected}"
            );
        }
        // Backwards below s = 3/17, with the least flux there, and no flux up to 6/17 in all.
        let found = last(&section, 0.0).expect("a height without flux");
        let expected = floor + gap * 6.0 / 17.0;
        assert!(
            (found - expected).abs() < 1e-4 * gap,
            "no flux up to {found}, expected {expected}"
        );
        let least = -gap * 0.3 * 0.5 * 3.0 / 17.0;
        let line = closed(&vec![section; SECTIONS + 1], 0.5 * least);
        // Half of the least flux is passed at s = (1 ± (1/2)^(1/2)) 3/17.
        let ends = [1.0, -1.0].map(|sign| floor + gap * (1.0 + sign * 0.5_f64.sqrt()) * 3.0 / 17.0);
        let [top, bottom] = ends;
        assert_eq!(line.len(), 2 * (SECTIONS + 1) + 1, "below, back above, and to the start");
        for (k, (x, y)) in line.iter().enumerate() {
            let is_above = (SECTIONS + 1..2 * (SECTIONS + 1)).contains(&k);
            let along = if is_above { 2 * SECTIONS + 1 - k } else { k % (SECTIONS + 1) };
            let along = if k == line.len() - 1 { 0 } else { along };
            let place =
                (PERIOD * along as f64 / SECTIONS as f64, if is_above { top } else { bottom });
            let off = (x - place.0).abs().max((y - place.1).abs());
            assert!(
                off < 2e-4 * gap,
                "point {k} of the closed line at ({x}, {y}), expected {place:?}"
            );
        }
    }

    /// The streamlines of the finite elements keep to their shares of the flux: at the lid all of it has
    /// passed, U_b times the height of the crest's gap.
    #[test]
    fn the_lines_of_the_stream_lie_where_their_share_of_the_flux_has_passed() {
        let hill = Hill::new(1.0).expect("a hill");
        let reference = reference(50.0).expect("computed");
        let lines = of_reference(&reference);
        for (line, share) in lines.iter().zip([0.05, 0.2, 0.4, 0.6, 0.8, 0.95]) {
            assert_eq!(
                line.len(),
                SECTIONS + 1,
                "the line of {share} goes through the whole period"
            );
            for k in [0, 150, 500] {
                let (x, y) = line[k];
                assert!(
                    (x - PERIOD * k as f64 / SECTIONS as f64).abs() < 1e-12,
                    "place {k} at {x}"
                );
                // Simpson's rule over 2000 intervals up to the line, and up to the lid.
                let (floor, gap) = (hill.wall(x), hill.lid() - hill.wall(x));
                let flux = |top: f64| {
                    let u = |j: i32| reference.velocity(x, top * f64::from(j) / 2000.0, gap).x;
                    let sum: f64 =
                        (0..1000).map(|j| u(2 * j) + 4.0 * u(2 * j + 1) + u(2 * j + 2)).sum();
                    gap * top * sum / 6000.0
                };
                let found = flux((y - floor) / gap) / flux(1.0);
                assert!(
                    (found - share).abs() < 2e-3,
                    "{found} of the flux below {y} at {x}, not {share}"
                );
            }
        }
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
