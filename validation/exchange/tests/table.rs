//! Tables of comma-separated values: names, further columns, and messages.

#![allow(clippy::unwrap_used)] // clippy allows it in tests, not in their helpers

use touchstone_exchange::read::{Renamed, Results, read};

/// The content of tables, or their flaws.
fn read_as(text: &str, map: &[(&str, &str)]) -> Result<Results, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("results.csv"), text).unwrap();
    let renamed = map.iter().map(|(ours, theirs)| (theirs.to_string(), ours.to_string()));
    let lines = |flaws: Vec<touchstone_exchange::flaw::Flaw>| {
        touchstone_exchange::flaw::lines(&flaws).join("\n")
    };
    read(folder.path(), &renamed.collect::<Renamed>()).map_err(lines)
}

const ROWS: &str = "0,0,1,2,3,4,5\n0,1,6,7,8,9,10\n";

/// A density under a usual name is read, in any capitals; under another name a note states that it is not.
#[test]
fn usual_names_are_read_and_others_are_told() {
    for name in ["density", "Density", "rho", "Rhop", "rho[kg/m^3]", "c_rho", "RHO"] {
        let text = format!("Time,Idp,x,y,vx,v_y,{name}\n{ROWS}");
        let results = read_as(&text, &[]).unwrap_or_else(|what| panic!("{name}: {what}"));
        let last = &results.frames[0].particles[1];
        assert_eq!((last.id, last.density), (1, Some(10.0)), "{name}");
        assert_eq!(last.velocity.as_slice(), [8.0, 9.0], "{name}");
        assert!(results.notes().is_empty(), "{:?}", results.notes());
    }
    let results = read_as(&format!("t,id,x,y,u,v,dens\n{ROWS}"), &[]).unwrap();
    assert_eq!(results.frames[0].particles[1].density, None);
    assert_eq!(results.notes(), ["columns that are not read: dens"]);
    let words = read_as(&format!("t,id,x,y,u,v,rho[g/cm^3]\n{ROWS}"), &[]).unwrap_err();
    assert!(words.contains("column density: its unit is g/cm^3; expected kg/m^3"), "{words}");
    let words = read_as(&format!("t,id,x,y,u,rho,Rhop\n{ROWS}"), &[]).unwrap_err();
    assert!(words.contains("rho and Rhop may be it"), "{words}");
    let words = read_as(&format!("t,id,x,y,u,v,x\n{ROWS}"), &[]).unwrap_err();
    assert_eq!(words, "results.csv, line 1, column x: it is there twice; expected once");
}

/// A name of the caller comes before ours, and is there.
#[test]
fn names_of_the_caller_are_there_and_come_first() {
    let text = format!("t,id,x,y,u,v,old\n{ROWS}");
    let of = |map: &[(&str, &str)]| read_as(&text, map);
    let results = of(&[("x", "old"), ("density", "x")]).unwrap();
    let last = &results.frames[0].particles[1];
    assert_eq!((last.position.x, last.density), (10.0, Some(6.0)));
    let results = of(&[("x", "old")]).unwrap();
    assert_eq!(results.notes(), ["columns that are not read: x"]);
    for (map, says) in [
        (&[("density", "Old")][..], "column density: --map names Old, which is not there"),
        (&[("id", "nosuch")], "the columns are t, id, x, y, u, v, old"),
        (&[("front", "x")], "column front: --map names it; the columns to be read are t, id"),
    ] {
        let words = of(map).unwrap_err();
        assert!(words.contains(says), "expected {says:?} in {words}");
    }
    let text = format!("t,id,x,y,vel[0],vel[1],p[m/s]\n{ROWS}");
    let results = read_as(&text, &[("u", "vel[1]"), ("v", "p")]).unwrap();
    assert_eq!(results.frames[0].particles[0].velocity.as_slice(), [4.0, 5.0]);
    let words = read_as(&text, &[("u", "vel[1]"), ("v", "vel[0]"), ("x", "p")]).unwrap_err();
    assert!(words.contains("column x: its unit is m/s; expected m"), "{words}");
}

/// The last number of a table that was cut is another number, and looks whole.
#[test]
fn the_last_line_ends() {
    let text = format!("t,id,x,y,u,v,density\n{ROWS}");
    for cut in 1..8 {
        let words = read_as(&text[..text.len() - cut], &[]).unwrap_err();
        assert_eq!(
            words,
            "results.csv, line 3: the last line does not end; the file was cut short"
        );
    }
    assert!(read_as(&text.replace('\n', "\r\n"), &[]).is_ok());
}

#[test]
fn other_separators_are_named() {
    for (sign, name) in [(";", "semicolons"), ("\t", "tabs"), (" ", "blanks")] {
        let text = format!("t[s],id,x[m],y,u,v,density\n{ROWS}").replace(',', sign);
        let words = read_as(&text, &[]).unwrap_err();
        assert!(words.contains(&format!("line 1: its columns are separated by {name}")), "{words}");
    }
}

/// Of vectors with any names the third component is constant, or named.
#[test]
fn a_third_component_is_not_lost() {
    let rows = "0,0,1,2,3,4\n0,1,2,2,5,5\n";
    for (heads, map, third) in [
        ("t,id,x,y,z,u,v", &[][..], "--map y=z"),
        (
            "t,id,Points:0,Points:1,Points:2,u,v",
            &[("x", "Points:0"), ("y", "Points:1")],
            "--map y=Points:2",
        ),
        ("t,id,p_1,p_2,p_3,u,v", &[("x", "p_1"), ("y", "p_2")], "--map y=p_3"),
        ("t,id,p[1],p[2],p[3],u,v", &[("x", "p[1]"), ("y", "p[2]")], "--map y=p[3]"),
    ] {
        let rows = rows.replace('\n', ",0\n");
        let words = read_as(&format!("{heads}\n{rows}"), map).unwrap_err();
        assert!(words.contains(third) && words.contains("from 3 to 5"), "{heads}: {words}");
    }
    let words = read_as(&format!("t,id,x,y,u,v,w\n{ROWS}"), &[]).unwrap_err();
    assert!(words.contains("column w: it is from 5 to 10"), "{words}");
    let words = read_as("t,id,x,y,z,u,v\n0,0,1,2,3,4,5\n0,1,6,7,NaN,9,10\n", &[]).unwrap_err();
    assert!(words.contains("column z: it is from 3 to 3"), "a place that is no number: {words}");
    // Names that differ in more than the direction are no vector.
    let map = [("x", "x1"), ("y", "y2")];
    assert!(read_as(&format!("t,id,x1,y2,z1,u,v\n{ROWS}"), &map).is_ok());
    let level = format!("t,id,x,y,u,v,w\n{ROWS}").replace(",5\n", ",10\n");
    assert!(read_as(&level, &[]).is_ok(), "constant");
}

/// Particles of a code that chose its own start where its first rows have them.
#[test]
fn own_particles_start_in_the_first_frame() {
    let rows = "0,0,1,2,3,4,1.5\n0,1,6,7,8,9,2.5\n1,0,2,2,3,4,1.5\n1,1,7,7,8,9,2.5\n";
    let results = read_as(&format!("t,id,x,y,u,v,mass\n{rows}"), &[]).unwrap();
    let starts: Vec<_> = results.own.iter().map(|own| own.start).collect();
    assert_eq!(starts, results.frames[0].particles);
    assert_eq!(results.own.iter().map(|own| own.mass).collect::<Vec<_>>(), [1.5, 2.5]);
}

/// Each particle has one mass and one role at all times.
#[test]
fn mass_and_role_do_not_change() {
    let of = |later: &str| {
        format!(
            "t,id,x,y,u,v,mass,role\n0,0,0,0,0,0,1.5,0\n0,1,0,1,0,0,1.5,1\n1,0,0,0,0,0,{later}\n"
        )
    };
    let stated = read_as(&of("1.50003,0"), &[]).unwrap().stated;
    assert_eq!(stated[&1], (1.5, Some(touchstone_solver::Role::Wall)));
    for (later, says) in [
        ("1.6,0", "line 4, column mass: it is 1.6, and was 1.5 before"),
        ("1.4,0", "line 4, column mass: it is 1.4, and was 1.5 before"),
        ("1.5,1", "line 4, column role: particle 0 had another one before"),
    ] {
        let words = read_as(&of(later), &[]).unwrap_err();
        assert!(words.contains(says), "expected {says:?} in {words}");
    }
}

/// Files of one submission must have the same columns: a density in some files only would be the initial one
/// in the others.
#[test]
fn files_have_the_same_columns() {
    let folder = tempfile::tempdir().unwrap();
    let all = [("id x y vx vy c_rho", "1 0 0 0 0 9"), ("id x y vx vy", "1 0 0 0 0")];
    for (first, says) in [(0, "it is not here, but in 1.dump"), (1, "it is here and not in 1.dump")]
    {
        for (k, (columns, row)) in [(1, all[first]), (2, all[1 - first])] {
            let head = format!("ITEM: TIME\n{k}\nITEM: NUMBER OF ATOMS\n1\n");
            let text = format!("{head}ITEM: ATOMS {columns}\n{row}\n");
            std::fs::write(folder.path().join(format!("{k}.dump")), text).unwrap();
        }
        let flaws = read(folder.path(), &Renamed::new()).unwrap_err();
        assert_eq!(flaws[0].to_string(), format!("2.dump, column density: {says}"));
    }
}

/// Messages repeat the beginning of a file's content, three of a kind, and a count.
#[test]
fn messages_are_short_whatever_a_file_says() {
    let heads = |count: usize| "a,".repeat(count) + "b";
    let long = "x".repeat(1 << 20);
    for text in [
        heads(3 << 20) + "\n",
        heads(9000) + "\n",
        "\0".repeat(4 << 20),
        "\0".repeat(4 << 20) + "\n",
        format!("{long},{long}\n"),
        format!("t[{long}],id,x,y,u,v\n"),
        format!("t,id,x,y,u,v\n{}", format!("{long},{long},1,1,1,1\n").repeat(4)),
        format!("t,id,x,y,u,v\n{}", "1e308,-1e308,1e308,x,y,z\n".repeat(10_000)),
        format!("t,id,x,y,u,v\n{}", "0,0,NaN,inf,-inf,1\n".repeat(10_000)),
    ] {
        let words = read_as(&text, &[]).unwrap_err();
        assert!(words.len() < 4000, "{} characters: {words:.1000}", words.len());
        assert!(words.lines().count() <= 24, "{words:.2000}");
    }
    let words =
        read_as(&format!("t,id,x,y,u,v\n{}", "0,-1e308,0,0,0,0\n".repeat(9)), &[]).unwrap_err();
    assert!(words.contains("it is -1e308") && words.ends_with("and 6 more like this"), "{words}");
}
