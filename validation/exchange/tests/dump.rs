//! Dumps of LAMMPS: its names, its numbers of atoms, and names that the caller gives.

#![allow(clippy::unwrap_used)] // clippy allows it in tests, not in their helpers

use nalgebra::Vector2;
use touchstone_exchange::read::{Renamed, read};

/// Id, place, velocity and density.
type Row = (u32, Vector2<f64>, Vector2<f64>, Option<f64>);

/// Two atoms at one time, as read.
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

const BOX: &str = "ITEM: BOX BOUNDS pp ss pp\n-1 3\n10 12\n-1 1\n";

/// The content of a dump, or its flaws.
fn read_text(text: &str, map: &[(&str, &str)]) -> Result<Vec<(f64, Vec<Row>)>, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.dump"), text).unwrap();
    let renamed = map.iter().map(|(ours, theirs)| (theirs.to_string(), ours.to_string()));
    let lines = |flaws: Vec<touchstone_exchange::flaw::Flaw>| {
        touchstone_exchange::flaw::lines(&flaws).join("\n")
    };
    let results = read(folder.path(), &renamed.collect::<Renamed>()).map_err(lines)?;
    let row = |p: &touchstone_harness::foreign::ForeignParticle| {
        (p.id, p.position, p.velocity, p.density)
    };
    let frame =
        |of: &touchstone_harness::foreign::Frame| (of.time, of.particles.iter().map(row).collect());
    Ok(results.frames.iter().map(frame).collect())
}

/// A snapshot with this number of atoms in its head, and these rows.
fn snapshot(head: &str, count: usize, columns: &str, rows: &str) -> String {
    format!(
        "ITEM: TIMESTEP\n7\n{head}ITEM: NUMBER OF ATOMS\n{count}\nITEM: ATOMS {columns}\n{rows}"
    )
}

#[test]
fn each_snapshot_has_its_own_time_and_number_of_atoms() {
    let of = |time: f64, ids: &[u32]| {
        let rows: String = ids.iter().map(|id| format!("{id} {id} {time} 0 0\n")).collect();
        snapshot(&format!("ITEM: TIME\n{time}\n"), ids.len(), "id x y vx vy", &rows)
    };
    let text = of(0.0, &[1, 2, 3]) + &of(0.5, &[2]) + &of(1.0, &[]) + &of(1.5, &[3, 1]);
    let frames = read_text(&text, &[]).unwrap();
    let ids = |rows: &[Row]| rows.iter().map(|row| row.0).collect::<Vec<_>>();
    let found: Vec<_> = frames.iter().map(|(time, rows)| (*time, ids(rows))).collect();
    assert_eq!(found, [(0.0, vec![0, 1, 2]), (0.5, vec![1]), (1.5, vec![2, 0])]);
    let without = |item: &str| {
        let second = of(0.5, &[2]);
        let start = second.find(item).unwrap();
        let end = second[start..].match_indices('\n').nth(1).unwrap().0 + start + 1;
        of(0.0, &[1, 2]) + &second[..start] + &second[end..]
    };
    for (item, line) in [("ITEM: NUMBER", 14), ("ITEM: TIME\n", 14)] {
        let words = read_text(&without(item), &[]).unwrap_err();
        let says = format!("a.dump, line {line}: there is no {}", item.trim());
        assert!(words.starts_with(&says), "expected {says} in {words}");
    }
}

/// A row that was cut, or has more numbers than there are columns, is none.
#[test]
fn rows_are_whole() {
    let whole = snapshot("ITEM: TIME\n0\n", 1, "id x y vx vy", "1 0 1 2 345\n");
    assert!(read_text(&whole, &[]).is_ok());
    for cut in 1..3 {
        let words = read_text(&whole[..whole.len() - cut], &[]).unwrap_err();
        assert!(words.starts_with("a.dump, line 8: the last line does not end"), "{words}");
    }
    for (row, count) in [("1 0 1 2 3 4", 6), ("1 0 1 2", 4)] {
        let words = read_text(&whole.replace("1 0 1 2 345", row), &[]).unwrap_err();
        assert!(words.contains(&format!("line 8: it has {count} values; expected 5")), "{words}");
    }
}

/// Shares of the box are made metres by the box of their snapshot, with or without a name of the caller.
#[test]
fn shares_of_the_box_are_made_metres() {
    let time = "ITEM: TIME\n0\n";
    let row = "1 0.25 0.5 0 0\n";
    for (columns, map) in [
        ("id xs ys vx vy", &[][..]),
        ("id xsu ysu vx vy", &[]),
        ("id xs ys vx vy", &[("x", "xs"), ("y", "ys")]),
    ] {
        let text = snapshot(&format!("{time}{BOX}"), 1, columns, row);
        let frames = read_text(&text, map).unwrap();
        assert_eq!(frames[0].1[0].1, Vector2::new(0.0, 11.0), "{columns}");
    }
    let later = snapshot("ITEM: TIME\n1\n", 1, "id xs ys vx vy", row);
    let both = snapshot(&format!("{time}{BOX}"), 1, "id xs ys vx vy", row) + &later;
    let words = read_text(&both, &[]).unwrap_err();
    assert!(words.contains("no ITEM: BOX BOUNDS before these"), "of the snapshot before: {words}");
    let turned = "ITEM: BOX BOUNDS xy xz yz pp pp pp\n-1 3 0\n10 12 0\n-1 1 0\n";
    let odd = "ITEM: BOX BOUNDS pp ss pp\n-1 3\n12 10\n-1 1\n";
    for (head, says) in
        [("", "no ITEM: BOX BOUNDS"), (turned, "not rectangular"), (odd, "ascending")]
    {
        let text = snapshot(&format!("{time}{head}"), 1, "id xs ys vx vy", row);
        let words = read_text(&text, &[("x", "xs"), ("y", "ys")]).unwrap_err();
        assert!(words.contains("column xs") && words.contains(says), "expected {says} in {words}");
    }
    let unwrapped = snapshot(time, 1, "id xu yu vx vy", row);
    assert_eq!(read_text(&unwrapped, &[]).unwrap()[0].1[0].1, Vector2::new(0.25, 0.5));
}

#[test]
fn units_indices_ids_and_the_third_direction_are_as_the_dump_has_them() {
    let of = |head: &str, columns: &str, row: &str| {
        snapshot(&format!("{head}ITEM: TIME\n0\n"), 2, columns, row)
    };
    let rows = "1 0 1 2 3\n2 4 5 6 7\n";
    let vector = of("ITEM: UNITS\nsi\n", "id x y c_vel[1] c_vel[2]", rows);
    let frames = read_text(&vector, &[("u", "c_vel[1]"), ("v", "c_vel[2]")]).unwrap();
    assert_eq!(frames[0].1[1].2, Vector2::new(6.0, 7.0));
    let words = read_text(&vector, &[]).unwrap_err();
    assert!(words.contains("--map u=NAME") && words.contains("c_vel[1], c_vel[2]"), "{words}");
    for units in ["cgs", "real", "SI", ""] {
        let words = read_text(&of(&format!("ITEM: UNITS\n{units}\n"), "id x y vx vy", rows), &[]);
        let words = words.unwrap_err();
        assert!(words.starts_with("a.dump, line 4: units are"), "{units}: {words}");
    }
    let words = read_text(&of("", "id x y vx vy", "0 0 1 2 3\n1 4 5 6 7\n"), &[]).unwrap_err();
    assert!(words.contains("it is 0; expected a whole number, not below 1"), "{words}");
    let own = of("", "serial x y vx vy", "0 0 1 2 3\n1 4 5 6 7\n");
    assert_eq!(read_text(&own, &[("id", "serial")]).unwrap()[0].1[0].0, 0);
    let deep = of("", "id x y z vx vy vz", "1 0 0 1 2 0 3\n2 4 0 5 6 0 7\n");
    let words = read_text(&deep, &[]).unwrap_err();
    assert!(words.contains("--map y=z") && words.contains("--map v=vz"), "{words}");
    let frames = read_text(&deep, &[("y", "z"), ("v", "vz")]).unwrap();
    assert_eq!(frames[0].1[1].1, Vector2::new(4.0, 5.0));
}

/// A dump of many snapshots took the square of their number.
#[test]
fn many_snapshots_are_read_in_no_time() {
    let of = |k: usize| {
        let time = format!("ITEM: TIME\n{k}\n");
        snapshot(&time, 1, "id x y vx vy", "1 0 0 0 0\n")
    };
    let text: String = (0..100_000).map(of).collect();
    let start = std::time::Instant::now();
    assert_eq!(read_text(&text, &[]).unwrap().len(), 100_000);
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

/// Frame 10 comes after frame 9, whatever other numbers precede theirs.
#[test]
fn files_are_in_the_order_of_the_last_number_of_their_names() {
    let folder = tempfile::tempdir().unwrap();
    for (name, time) in [("3d_run2_9", 1), ("3d_run2_10", 2), ("1d_run2_11", 3)] {
        let head = format!("ITEM: TIME\n{time}\nITEM: NUMBER OF ATOMS\n1\n");
        let text = format!("{head}ITEM: ATOMS id x y vx vy\n1 0 0 0 0\n");
        std::fs::write(folder.path().join(format!("{name}.dump")), text).unwrap();
    }
    let results = read(folder.path(), &Renamed::new());
    let results = results.unwrap_or_else(|flaws| panic!("{}", flaws[0]));
    let times: Vec<f64> = results.frames.iter().map(|frame| frame.time).collect();
    assert_eq!(times, [1.0, 2.0, 3.0]);
}
