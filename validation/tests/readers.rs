//! Results of one run in the formats of other codes: equal metrics for any format, byte order, unit of length
//! and additional columns.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use touchstone_base::record::Record;

use crate::common::{said, touchstone};

/// A row: t, id, x, y, u, v, density.
type Row = [f64; 7];

/// A submission of a small drop in its folder `own`, and its rows.
fn own(folder: &Path) -> Vec<Row> {
    let line = "export elliptic_drop --set n=8 --set end=0.2 --out own --solve";
    let made = touchstone(folder, line);
    assert!(made.status.success(), "{}", said(&made));
    let text = fs::read_to_string(folder.join("own/results.csv")).unwrap();
    let row = |line: &str| -> Row {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        cells.try_into().unwrap()
    };
    text.lines().skip(1).map(row).collect()
}

/// Rows of each time.
fn frames(rows: &[Row]) -> Vec<&[Row]> {
    rows.chunk_by(|a, b| a[0] == b[0]).collect()
}

/// The record of the submission whose results these files are, in place of the table.
fn submitted(folder: &Path, files: &[(String, String)]) -> Result<Record, String> {
    let other = folder.join("other");
    let _ = fs::remove_dir_all(&other);
    fs::create_dir(&other).unwrap();
    for name in ["method.json", "system.json", "problem.json"] {
        fs::copy(folder.join("own").join(name), other.join(name)).unwrap();
    }
    for (name, text) in files {
        fs::write(other.join(name), text).unwrap();
    }
    let _ = fs::remove_dir_all(folder.join("store"));
    let output = touchstone(folder, "submit elliptic_drop other --store store");
    let all = fs::read_dir(folder.join("store")).map_err(|_| said(&output))?;
    let file = all.flatten().next().ok_or_else(|| said(&output))?;
    Record::from_json(&fs::read_to_string(file.path()).unwrap()).map_err(|e| e.to_string())
}

/// A table whose columns have these names.
fn table(rows: &[Row], heads: &str, cells: impl Fn(&Row) -> String) -> Vec<(String, String)> {
    let lines = rows.iter().map(|row| cells(row) + "\n").collect::<String>();
    vec![("results.csv".into(), format!("{heads}\n{lines}"))]
}

fn commas(row: &Row) -> String {
    row.map(|number| number.to_string()).join(",")
}

/// Shares of a box that does not begin at 0, as LAMMPS writes them; ids begin at 1.
fn dump(rows: &[Row], has_time: impl Fn(usize) -> bool) -> Vec<(String, String)> {
    let ([left, right], [bottom, top]) = ([-3.0, 5.0], [-2.5, 7.5]);
    let mut text = String::new();
    for (k, frame) in frames(rows).into_iter().enumerate() {
        if has_time(k) {
            writeln!(text, "ITEM: TIME\n{}", frame[0][0]).unwrap();
        }
        writeln!(text, "ITEM: NUMBER OF ATOMS\n{}", frame.len()).unwrap();
        writeln!(text, "ITEM: BOX BOUNDS ss ss pp\n{left} {right}\n{bottom} {top}\n-1 1").unwrap();
        writeln!(text, "ITEM: ATOMS id xs ys vx vy c_rho").unwrap();
        for [_, id, x, y, u, v, density] in frame {
            let [xs, ys] = [(x - left) / (right - left), (y - bottom) / (top - bottom)];
            writeln!(text, "{} {xs:?} {ys:?} {u:?} {v:?} {density:?}", id + 1.0).unwrap();
        }
    }
    vec![("all.dump".into(), text)]
}

/// Bytes in letters.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |three: &[u8]| -> String {
        let all = (0..3).fold(0, |all, k| all << 8 | u32::from(*three.get(k).unwrap_or(&0)));
        let letter = |k: usize| match k <= three.len() {
            true => char::from(LETTERS[(all >> (18 - 6 * k)) as usize & 63]),
            false => '=',
        };
        (0..4).map(letter).collect()
    };
    bytes.chunks(3).map(group).collect()
}

/// Grids of ParaView, binary, with the most significant byte first or last.
fn grids(rows: &[Row], is_big: bool) -> Vec<(String, String)> {
    let bytes = |number: f64| if is_big { number.to_be_bytes() } else { number.to_le_bytes() };
    let array = |name: &str, components: usize, numbers: Vec<f64>| {
        let length = 8 * numbers.len() as u32;
        let head = if is_big { length.to_be_bytes() } else { length.to_le_bytes() };
        let data: Vec<u8> = head.into_iter().chain(numbers.into_iter().flat_map(bytes)).collect();
        format!(
            "<DataArray type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
             format=\"binary\">{}</DataArray>",
            base64(&data)
        )
    };
    let order = if is_big { "BigEndian" } else { "LittleEndian" };
    let grid = |(k, frame): (usize, &[Row])| {
        let of = |columns: &[usize]| -> Vec<f64> {
            let number = |row: &Row, column: usize| if column > 6 { 0.0 } else { row[column] };
            frame
                .iter()
                .flat_map(|row| columns.iter().map(|c| number(row, *c)).collect::<Vec<_>>())
                .collect()
        };
        let text = format!(
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{order}\" \
             header_type=\"UInt32\"><UnstructuredGrid><FieldData>{}</FieldData>\
             <Piece NumberOfPoints=\"{}\" NumberOfCells=\"0\"><Points>{}</Points>\
             <PointData>{}{}{}</PointData></Piece></UnstructuredGrid></VTKFile>\n",
            array("TimeValue", 1, vec![frame[0][0]]),
            frame.len(),
            array("Points", 3, of(&[2, 3, 7])),
            array("id", 1, of(&[1])),
            array("velocity", 3, of(&[4, 5, 7])),
            array("rho", 1, of(&[6])),
        );
        (format!("frame_{k}.vtu"), text)
    };
    frames(rows).into_iter().enumerate().map(grid).collect()
}

#[test]
fn results_of_one_run_have_the_same_metrics_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let rows = own(folder.path());
    let names = "t[s],id,x[m],y[m],u[m/s],v[m/s],density[kg/m^3]";
    let plain = submitted(folder.path(), &table(&rows, names, commas)).unwrap();
    let other_names = "time,Idp,x,y,velocity:x,velocity:y,rho";
    // A column with a usual name in addition to one with our name: the latter is read.
    let both = |row: &Row| format!("7,{}", commas(row));
    for (what, files) in [
        ("usual names", table(&rows, other_names, commas)),
        ("a second density", table(&rows, &format!("rho,{names}"), both)),
        ("shares of a box", dump(&rows, |_| true)),
        ("the least significant byte first", grids(&rows, false)),
        ("the most significant byte first", grids(&rows, true)),
    ] {
        let found =
            submitted(folder.path(), &files).unwrap_or_else(|error| panic!("{what}: {error}"));
        assert!(found.metrics.len() >= 3 && found.metrics.len() == plain.metrics.len(), "{what}");
        for (name, metric) in &found.metrics {
            let (found, own) = (metric.value, plain.metrics[name].value);
            assert!(
                (found - own).abs() < 1e-9 * own.abs().max(1e-3),
                "{what}: {name} {found}, not {own}"
            );
        }
    }
    // The digest identifies equal results, including their times.
    let digest = |files: &[(String, String)]| {
        let record = submitted(folder.path(), files).unwrap_or_else(|error| panic!("{error}"));
        record.run.submission.as_ref().and_then(|of| of.results.clone()).expect("a digest")
    };
    let later = |row: &Row| {
        let mut row = *row;
        row[0] *= 1.0 + 1e-13;
        commas(&row)
    };
    let of_plain = digest(&table(&rows, names, commas));
    assert_eq!(digest(&table(&rows, other_names, commas)), of_plain);
    assert_eq!(digest(&grids(&rows, true)), of_plain);
    assert_ne!(digest(&table(&rows, names, later)), of_plain);
    // A snapshot does not have the time of the one before it.
    let error = submitted(folder.path(), &dump(&rows, |k| k != 1)).err().unwrap_or_default();
    assert!(error.contains("there is no ITEM: TIME"), "{error}");
}

/// Another version is another method, and so is another truth value anywhere among its settings: each has its
/// own problem.
#[test]
fn another_version_or_truth_value_draws_another_sealed_problem() {
    let folder = tempfile::tempdir().unwrap();
    let of = |version: &str, settings: &str| {
        let method = format!(
            "{{\"code\": \"c\", \"version\": \"{version}\", \"scheme\": \"s\", \"division\": \"closed\", \
             \"settings\": {{{settings}}}, \"changed\": \"nothing\"}}"
        );
        fs::write(folder.path().join("method.json"), method).unwrap();
        let line = "export taylor_green --sealed 3 --method method.json --overwrite --out out";
        let made = touchstone(folder.path(), line);
        assert!(made.status.success(), "{}", said(&made));
        let problem = fs::read_to_string(folder.path().join("out/problem.json")).unwrap();
        let problem: serde_json::Value = serde_json::from_str(&problem).unwrap();
        problem["spec"]["settings"].to_string()
    };
    for mut drawn in [
        ["1", "2", "3", "4"].map(|version| of(version, "")),
        ["[true, true]", "[true, false]", "[false, true]", "[false, false]"]
            .map(|settings| of("1", &format!("\"shifting\": {settings}"))),
    ] {
        drawn.sort();
        assert!(drawn.windows(2).any(|two| two[0] != two[1]), "{drawn:?}");
    }
}

/// Other formats are converted by the module of Python, and the message says so.
#[test]
fn a_format_that_the_module_converts_is_named() {
    let folder = tempfile::tempdir().unwrap();
    own(folder.path());
    for name in ["a.npz", "a.hdf5", "a.pvd", "a.vtk", "a.vtu.gz"] {
        let error =
            submitted(folder.path(), &[(name.into(), "x".into())]).err().unwrap_or_default();
        let words = format!("but {name}: convert it with touchstone_sph.convert");
        assert!(error.contains(&words), "{name}: {error}");
    }
}
