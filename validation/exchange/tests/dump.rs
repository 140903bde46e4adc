//! Dumps of LAMMPS: its names, its numbers of atoms, and names that the caller gives.

use exchange::read::{Renamed, read};
use nalgebra::Vector2;

/// Id, place, velocity and density.
type Row = (u32, Vector2<f64>, Vector2<f64>, Option<f64>);

/// What two atoms at one time are read as.
fn read_as(renamed: &Renamed) -> Vec<Row> {
    let text = "ITEM: TIMESTEP\n7\nITEM: TIME\n0.5\nITEM: NUMBER OF ATOMS\n2\n\
                ITEM: ATOMS id x y vx vy c_rho\n2 3 4 5 6 1010\n1 0 1 2 -2 990\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.dump"), text).unwrap();
    let results = read(folder.path(), renamed).map_err(|flaws| flaws[0].to_string()).unwrap();
    let [frame] = &results.frames[..] else { panic!("{} frames", results.frames.len()) };
    assert_eq!(frame.time, 0.5);
    frame.particles.iter().map(|p| (p.id, p.position, p.velocity, p.density)).collect()
}

#[test]
fn atoms_are_counted_from_one_and_a_name_of_the_caller_comes_before_that_of_lammps() {
    let of = |x, y| Vector2::new(x, y);
    let plain = read_as(&Renamed::new());
    let expected = [
        (1, of(3.0, 4.0), of(5.0, 6.0), Some(1010.0)),
        (0, of(0.0, 1.0), of(2.0, -2.0), Some(990.0)),
    ];
    assert_eq!(plain, expected);
    let swapped = [("vx", "v"), ("vy", "u")].map(|(theirs, ours)| (theirs.into(), ours.into()));
    let velocities: Vec<_> = read_as(&Renamed::from(swapped)).iter().map(|row| row.2).collect();
    assert_eq!(velocities, [of(6.0, 5.0), of(-2.0, 2.0)]);
}
