//! Exported problems: required statements, numbers of the files for other codes, and results that only look
//! right.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{done, read, touchstone};

/// A table of numbers: columns by name without unit.
struct Table {
    head: String,
    columns: BTreeMap<String, usize>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    fn read(path: &Path) -> Self {
        let text = read(path);
        let (head, rows) = text.split_once('\n').unwrap();
        let name = |cell: &str| cell.split('[').next().unwrap().to_string();
        let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
        Self {
            head: head.into(),
            columns: head.split(',').enumerate().map(|(k, cell)| (name(cell), k)).collect(),
            rows: rows.lines().map(row).collect(),
        }
    }

    fn column(&self, name: &str) -> Vec<f64> {
        let k = self.columns[name];
        self.rows.iter().map(|row| row[k]).collect()
    }

    fn write(&self, path: &Path) {
        let row = |row: &Vec<f64>| row.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        let rows: Vec<String> = self.rows.iter().map(row).collect();
        fs::write(path, format!("{}\n{}\n", self.head, rows.join("\n"))).unwrap();
    }
}

/// The rows of a table at other times, by linear interpolation between the frames of `count` rows each.
fn at_times(table: &Table, count: usize, times: &[f64], scale: f64) -> Vec<Vec<f64>> {
    let frames: Vec<&[Vec<f64>]> = table.rows.chunks(count).collect();
    let [t, u, v] = ["t", "u", "v"].map(|name| table.columns[name]);
    let mut all = Vec::new();
    for time in times {
        let wanted = time * scale;
        let next = frames.partition_point(|frame| frame[0][t] < wanted).clamp(1, frames.len() - 1);
        let (a, b) = (frames[next - 1], frames[next]);
        let share = (wanted - a[0][t]) / (b[0][t] - a[0][t]);
        for (a, b) in a.iter().zip(b) {
            let mix = |(a, b): (&f64, &f64)| a + share * (b - a);
            let mut row: Vec<f64> = a.iter().zip(b).map(mix).collect();
            row[t] = *time;
            row[u] *= scale;
            row[v] *= scale;
            all.push(row);
        }
    }
    all
}

/// Fronts, heights and levels are areas over x: water 1 mm high, or ten times as high, and water that falls
/// with 3 % more or less gravity passed every gate that applies to results of particles.
#[test]
fn heights_and_gravity_of_a_dam_break_are_judged() {
    let folder = tempfile::tempdir().unwrap();
    let of = folder.path();
    done(of, "export dam_break --out asked --solve");
    let judged =
        |name: &str| touchstone(of, &format!("submit dam_break {name} --all --store store"));
    let honest = judged("asked");
    assert_eq!(honest.status.code(), Some(0), "{}", String::from_utf8_lossy(&honest.stdout));
    let results = of.join("asked/results.csv");
    let mut table = Table::read(&results);
    let (t, y) = (table.columns["t"], table.columns["y"]);
    let count = table.rows.partition_point(|row| row[t] == 0.0);
    let times: Vec<f64> = table.rows.chunks(count).map(|frame| frame[0][t]).collect();
    let whole = table.rows.clone();
    let fails = |table: &Table, what: &str| {
        table.write(&results);
        let found = judged("asked");
        let told = String::from_utf8_lossy(&found.stdout).into_owned();
        assert_eq!(found.status.code(), Some(1), "{what}: {told}");
        let failed = told.lines().filter(|line| line.starts_with("FAIL"));
        let failed: Vec<&str> = failed.collect();
        assert!(failed.iter().any(|line| line.contains("potential_away")), "{what}: {failed:?}");
    };
    type Height = fn(f64) -> f64;
    for (what, height) in
        [("on one line", (|_| 1e-3) as Height), ("ten times as high", |y| 10.0 * y)]
    {
        table.rows.iter_mut().zip(&whole).for_each(|(row, was)| row[y] = height(was[y]));
        fails(&table, what);
    }
    // A fall with more gravity equals one with a faster clock; a longer one includes all times.
    done(of, "export dam_break --set end=1.85 --out longer --solve");
    let longer = Table::read(&of.join("longer/results.csv"));
    for factor in [0.97_f64, 1.03] {
        table.rows = at_times(&longer, count, &times, factor.sqrt());
        fails(&table, &format!("gravity times {factor}"));
    }
}

/// The value at a path of keys of a document.
fn at<'a>(document: &'a Value, path: &str) -> &'a Value {
    path.split('/').fold(document, |of, key| match key.parse::<usize>() {
        Ok(place) => &of[place],
        Err(_) => &of[key],
    })
}

#[track_caller]
fn number(document: &Value, path: &str) -> f64 {
    at(document, path).as_f64().unwrap_or_else(|| panic!("{path} is {}", at(document, path)))
}

/// The exported document and page of a problem.
fn exported(folder: &Path, line: &str) -> (Value, String) {
    done(folder, &format!("export {line} --out out"));
    let out = folder.join("out");
    let document = serde_json::from_str(&read(&out.join("problem.json"))).unwrap();
    let page = read(&out.join("README.md"));
    fs::remove_dir_all(out).unwrap();
    (document, page)
}

/// Cases and variants that can be exported.
fn all_variants(folder: &Path) -> Vec<(String, String)> {
    let listed: Value = serde_json::from_str(&done(folder, "list --json")).unwrap();
    let of = |case: &Value| {
        let name = case["name"].as_str().unwrap().to_string();
        let variants: Value =
            serde_json::from_str(&done(folder, &format!("list {name} --json"))).unwrap();
        let variants = variants["variants"].as_array().unwrap().clone();
        let variants = variants.into_iter().map(|of| of["name"].as_str().unwrap().to_string());
        variants.map(|variant| (name.clone(), variant)).collect::<Vec<_>>()
    };
    let all = listed.as_array().unwrap().iter().flat_map(of);
    let cannot = ["manufactured", "resting_box", "extremes"];
    all.filter(|(case, variant)| {
        !cannot.contains(&case.as_str())
            && (case.as_str(), variant.as_str()) != ("dam_break", "ghosts")
    })
    .collect()
}

/// Settings of terms that the variant lacks must be listed apart, each with its term, and the spec has all of
/// them.
fn states_what_is_read(problem: &Value, what: &str) {
    let all = at(problem, "spec/settings").as_object().unwrap();
    let listed: Vec<&str> = problem["settings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|of| of["name"].as_str().unwrap())
        .collect();
    assert!(!listed.is_empty() && listed.iter().all(|name| all.contains_key(*name)), "{what}");
    let terms = at(problem, "our_method/terms").to_string().to_lowercase();
    for (setting, term) in
        [("xsph", "xsph"), ("xi", "artificial stress"), ("diffusion", "density diffusion")]
    {
        if all.contains_key(setting) {
            assert_eq!(
                listed.contains(&setting),
                terms.contains(term),
                "{what}: {setting}, {terms}"
            );
        }
    }
}

/// A problem without gates names one with gates.
#[test]
fn a_problem_that_nothing_judges_names_one_that_is_judged() {
    let folder = tempfile::tempdir().unwrap();
    let mut cases: Vec<String> =
        all_variants(folder.path()).into_iter().map(|(case, _)| case).collect();
    cases.dedup();
    let mut named = Vec::new();
    for case in cases {
        let output = touchstone(folder.path(), &format!("export {case} --out out"));
        let document: Value =
            serde_json::from_str(&read(&folder.path().join("out/problem.json"))).unwrap();
        fs::remove_dir_all(folder.path().join("out")).unwrap();
        let is_judged = !document["judged_by"].as_array().unwrap().is_empty();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(is_judged, !said.contains("No gate judges"), "{case}: {said}");
        if let Some(line) = said.split("is judged: `touchstone export ").nth(1) {
            let line = line.split(" --out").next().unwrap();
            let (other, _) = exported(folder.path(), line);
            assert!(!other["judged_by"].as_array().unwrap().is_empty(), "{case}: {line}");
            named.push(case);
        }
    }
    assert!(named.contains(&"spinning_disk".into()), "{named:?}");
}

/// A problem states whether walls stick or slip, the force and flux of hills, and formulas of metrics; terms
/// that a variant lacks are not listed as material, nor gates that judge no other code among the gates.
#[test]
fn every_problem_states_what_is_needed_to_run_and_to_measure_it() {
    let folder = tempfile::tempdir().unwrap();
    let variants = all_variants(folder.path());
    assert!(variants.len() > 60, "{} variants", variants.len());
    for (case, variant) in variants {
        let what = format!("{case}, {variant}");
        let (problem, page) = exported(folder.path(), &format!("{case} --variant {variant}"));
        let boundary = problem["boundary"].as_str().unwrap();
        let words = ["lip", "No force", "no wall", "no surface", "Clamped"];
        assert!(words.iter().any(|word| boundary.contains(word)), "{what}: {boundary}");
        // All content of the document is on the page.
        let mut said = vec![boundary.to_string()];
        for list in ["further", "settings"] {
            for fact in problem[list].as_array().unwrap() {
                let [name, unit, about] =
                    ["name", "unit", "about"].map(|key| fact[key].as_str().unwrap());
                assert!(!unit.is_empty() && !about.is_empty(), "{what}: {name} of {list}");
                said.extend([format!("| {name} |"), about.replace('|', "\\|")]);
            }
        }
        states_what_is_read(&problem, &what);
        let mut metrics = Vec::new();
        for metric in problem["metrics"].as_array().unwrap() {
            let [name, unit, formula] =
                ["name", "unit", "formula"].map(|key| metric[key].as_str().unwrap());
            assert!(
                !unit.is_empty() && !formula.is_empty() && !formula.contains("{}"),
                "{what}: {name}"
            );
            said.extend([format!("| `{name}` | {unit} |"), formula.replace('|', "\\|")]);
            metrics.push(name);
        }
        let gates = problem["judged_by"].as_array().unwrap();
        for gate in gates {
            let metric = gate["metric"].as_str().unwrap();
            let has_formula = metrics.contains(&metric.split('@').next().unwrap());
            assert!(has_formula, "{what}: {metric} has no formula");
            said.push(gate["id"].as_str().unwrap().into());
        }
        assert_eq!(gates.is_empty(), page.contains("No gate judges"), "{what}");
        let ours = &problem["our_method"];
        said.extend(
            ["kernel", "integrator", "walls"].map(|key| ours[key].as_str().unwrap().into()),
        );
        said.push(format!("support radius {} m", number(ours, "support_radius/value")));
        let terms: Vec<&str> =
            ours["terms"].as_array().unwrap().iter().map(|term| term.as_str().unwrap()).collect();
        assert!(!terms.is_empty(), "{what}: no term");
        said.extend(terms.iter().map(|term| term.to_string()));
        for equation in problem["equations"].as_array().unwrap() {
            said.push(equation["text"].as_str().unwrap().into());
        }
        for words in said {
            assert!(page.contains(&words), "{what}: the page lacks {words}");
        }
        // A strength of artificial viscosity without its equation, or the other way round.
        let is_listed = !at(&problem, "material/artificial_viscosity_alpha").is_null();
        let has_term = terms.iter().any(|term| term.starts_with("artificial viscosity"));
        let is_fluid = at(&problem, "material/shear_modulus").is_null();
        assert!(!is_fluid || is_listed == has_term, "{what}: alpha is listed: {is_listed}");
        if page.contains("dev ") {
            assert!(page.contains("of three dimensions"), "{what}: which deviator?");
        }
    }
}

/// Hills were exported with g = 0 and without the flux that they are driven to.
#[test]
fn hills_state_the_flux_that_their_force_keeps() {
    let folder = tempfile::tempdir().unwrap();
    let (problem, page) = exported(folder.path(), "periodic_hill --set flux=0.5 --set response=2");
    let [flux, force, response] = [0, 1, 2].map(|k| &problem["further"][k]);
    assert_eq!((flux["name"].as_str(), flux["unit"].as_str()), (Some("flux"), Some("m^2/s")));
    assert!((number(flux, "value") - 0.5 * 2.035).abs() < 1e-12);
    assert_eq!((number(force, "value"), number(response, "value")), (0.0, 2.0));
    assert!(page.contains("dv/dt = -(1/ρ) ∇p + ν ∇²v + (f, 0)") && page.contains("1.0175 | m^2/s"));
}

/// A cantilever needs a path over time: submitted at the requested times, every listed gate is judged.
#[test]
fn results_at_the_times_that_are_asked_for_are_judged_by_every_gate_that_is_listed() {
    let folder = tempfile::tempdir().unwrap();
    let of = folder.path();
    done(of, "export cantilever --variant lagrangian --set n=5 --out own");
    let own = of.join("own");
    let problem: Value = serde_json::from_str(&read(&own.join("problem.json"))).unwrap();
    let times = at(&problem, "times/value").as_array().unwrap();
    assert_eq!((times.len(), times[times.len() - 1].as_f64()), (400, Some(4.0)));
    assert_eq!(number(&problem, "curve/least_times"), 400.0);
    let path = |time: &Value| {
        let t = time.as_f64().unwrap();
        let [x, y] = [(0.0143, 2.0), (0.0649, 1.0)]
            .map(|(size, _)| size * (touchstone_base::functions::cos(6.86 * t) - 1.0));
        format!("{t},{x},{y}\n")
    };
    let rows: String = times.iter().map(path).collect();
    fs::write(own.join("curve.csv"), format!("t[s],x[m],y[m]\n{rows}")).unwrap();
    fs::write(
        own.join("method.json"),
        r#"{"code": "a", "version": "1", "scheme": "s", "division": "closed", "settings": {},
            "changed": "nothing"}"#,
    )
    .unwrap();
    let system =
        r#"{"machine": "m", "threads": 1, "seconds": 1, "steps": 1, "interactions": "unknown"}"#;
    fs::write(own.join("system.json"), system).unwrap();
    let output = touchstone(of, "submit cantilever own --all --store store");
    let told = String::from_utf8_lossy(&output.stdout).into_owned()
        + &String::from_utf8_lossy(&output.stderr);
    let gates = problem["judged_by"].as_array().unwrap();
    assert!(gates.len() >= 4, "{gates:?}");
    for gate in gates {
        let id = gate["id"].as_str().unwrap();
        let line = told.lines().find(|line| line.contains(id));
        let line = line.unwrap_or_else(|| panic!("{id} is not judged: {told}"));
        assert!(line.starts_with("pass") || line.starts_with("FAIL"), "{line}");
    }
}

/// Every number of a problem equals the run's.
#[test]
fn numbers_of_a_problem_are_those_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let of = |line: &str| exported(folder.path(), line).0;
    let close = |found: f64, expected: f64, what: &str| {
        assert!(
            (found - expected).abs() <= 1e-12 * expected.abs(),
            "{what}: {found}, not {expected}"
        );
    };
    // A bar of 1.4 MPa and Poisson's ratio 0.4: K = E/(3 (1 - 2 ν)), μ = E/(2 (1 + ν)), c0² = K/ρ.
    let bar = of("cantilever --variant lagrangian --set n=4 --set h_over_dx=1.5");
    close(number(&bar, "material/bulk_modulus/value"), 1.4e6 / 0.6, "bulk modulus");
    close(number(&bar, "material/shear_modulus/value"), 1.4e6 / 2.8, "shear modulus");
    close(
        number(&bar, "material/sound_speed/value"),
        (1.4e6 / 0.6 / 1e3_f64).sqrt(),
        "sound speed",
    );
    close(number(&bar, "our_method/smoothing_length/value"), 1.5 * 0.005, "h");
    close(number(&bar, "our_method/support_radius/value"), 2.0 * 1.5 * 0.005, "support of 2 h");
    assert_eq!(at(&bar, "acceleration/value"), &serde_json::json!([0.0, -2.0]));
    // Couette flow, L = 1 mm, ν = 1e-6 m²/s, the quintic spline, whose support is 3 h.
    let plates =
        of("couette --variant extrapolating-wall --set rows=16 --set columns=12 --set re=0.25");
    let dx = 1e-3 / 16.0;
    close(number(&plates, "particles/spacing/value"), dx, "spacing");
    close(number(&plates, "our_method/support_radius/value"), 3.0 * dx, "support of 3 h");
    close(number(&plates, "material/kinematic_viscosity/value"), 1e-6, "viscosity");
    let times = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0];
    for (k, time) in times.into_iter().enumerate() {
        close(number(&plates, &format!("times/value/{k}")), time, "L²/ν is 1 s");
    }
    close(number(&plates, "domain/period/0/value"), 12.0 * dx, "period");
    assert_eq!(at(&plates, "domain/period/1"), "none");
    // Planes at y = 0 and L, of which the upper one moves with U = Re ν/L.
    let planes = of("couette --variant seed --set rows=16 --set re=0.25");
    for (k, (y, normal, u)) in [(0.0, 1.0, 0.0), (1e-3, -1.0, 0.25e-3)].into_iter().enumerate() {
        let plane = |key: &str, axis: usize| {
            number(&planes, &format!("walls/planes/{k}/{key}/value/{axis}"))
        };
        let [x_normal, y_normal] = [0, 1].map(|axis| plane("normal_into_the_material", axis));
        assert_eq!((x_normal, y_normal), (0.0, normal), "into the water");
        close(plane("point", 1), y, "place of the plane");
        close(plane("velocity", 0), u, "velocity of the plane");
    }
    // Water of H = 0.1143 m.
    let dam = of("dam_break --set n=8 --set c0=20 --set end=0.5");
    let fall = (9.81_f64 * 0.1143).sqrt();
    close(number(&dam, "material/sound_speed/value"), 20.0 * fall, "c0");
    close(number(&dam, "end/value"), 0.5 * 0.1143 / fall, "end");
    close(number(&dam, "particles/spacing/value"), 0.05715 / 8.0, "dx");
    assert_eq!(at(&dam, "acceleration/value"), &serde_json::json!([0.0, -9.81]));
    let vortices = of("taylor_green --set n=16 --set re=50");
    for axis in [0, 1] {
        close(number(&vortices, &format!("domain/period/{axis}/value")), 1.0, "L");
        close(number(&vortices, &format!("domain/low/value/{axis}")), 0.0, "corner");
    }
    close(number(&vortices, "material/kinematic_viscosity/value"), 1.0 / 50.0, "ν = U L/Re");
}

/// Numbers repeated on a page or in a list equal the problem's: end, forces, artificial viscosity, rows of a
/// curve, times of a path, units of an observer, particles.
#[test]
fn pages_and_lists_have_the_numbers_of_their_problem() {
    let folder = tempfile::tempdir().unwrap();
    let (dam, page) =
        exported(folder.path(), "dam_break --variant seed --set n=8 --set alpha=0.25");
    assert!(page.contains("| acceleration g | 0, -9.81 | m/s^2 |"), "{page}");
    assert!(page.contains(&format!("| end | {} | s |", number(&dam, "end/value"))), "{page}");
    assert_eq!(number(&dam, "material/artificial_viscosity_alpha/value"), 0.25);
    let (_, page) = exported(folder.path(), "couette --variant seed --set rows=12");
    assert!(page.contains("`t[s],y[m],u[m/s]`, 12 lines a time"), "{page}");
    let (bar, _) = exported(folder.path(), "cantilever --variant lagrangian --set n=4");
    let times = at(&bar, "times/value").as_array().unwrap();
    assert_eq!(times.len() as f64, number(&bar, "curve/least_times"));
    for (k, time) in times.iter().enumerate() {
        let expected = number(&bar, "end/value") * (k + 1) as f64 / times.len() as f64;
        assert!((time.as_f64().unwrap() / expected - 1.0).abs() < 1e-12, "{time}: {expected}");
    }
    let line = "couette --variant interface-wall --set rows=8";
    let (_, page) = exported(folder.path(), &format!("{line} --relation other-units"));
    assert!(page.contains("read 0.3048 m, 60 s or 1.488163943569554 kg/m"), "{page}");
    // Particles on a wall are among the particles, and do not move.
    done(folder.path(), &format!("export {line} --set end=0.01 --solve --out own"));
    let own = folder.path().join("own");
    let role = Table::read(&own.join("particles.csv")).column("role");
    let problem: Value = serde_json::from_str(&read(&own.join("problem.json"))).unwrap();
    assert_eq!(number(&problem, "particles/count"), role.len() as f64);
    assert!(role.contains(&2.0), "there are particles on the walls");
    let checked = touchstone(folder.path(), "submit couette own --check");
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
    // Results may have any particles, but must include the moving ones.
    let mut moved = Table::read(&own.join("results.csv"));
    let id = moved.columns["id"];
    moved.rows.retain(|row| role[row[id] as usize] == 0.0);
    moved.write(&own.join("results.csv"));
    let checked = touchstone(folder.path(), "submit couette own --check");
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
}

/// The words after a keyword in a file of LAMMPS.
fn words<'a>(text: &'a str, starts: &str) -> Vec<&'a str> {
    let line = text.lines().find(|line| line.starts_with(starts));
    line.unwrap_or_else(|| panic!("no line {starts} in\n{text}")).split_whitespace().collect()
}

/// The rows of a section of a data file.
fn section(text: &str, title: &str) -> Vec<Vec<f64>> {
    let start = text.find(title).unwrap_or_else(|| panic!("no section {title}"));
    let rows = text[start..].lines().skip(2).take_while(|line| !line.is_empty());
    rows.map(|row| row.split_whitespace().map(|word| word.parse().unwrap()).collect()).collect()
}

/// A wall that is a plane is no wall of particles.
#[test]
fn planes_are_not_written_for_codes_without_them() {
    let folder = tempfile::tempdir().unwrap();
    for format in ["lammps", "pysph"] {
        let line =
            format!("export couette --variant seed --set rows=8 --format {format} --out out");
        let output = touchstone(folder.path(), &line);
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && told.contains("planes that mirror"), "{told}");
        assert!(!folder.path().join("out").exists());
    }
}

/// LAMMPS takes the dynamic viscosity, and a box where the domain is.
#[test]
fn files_for_lammps_have_the_numbers_of_the_problem() {
    let folder = tempfile::tempdir().unwrap();
    for (line, is_viscous) in [
        ("couette --variant extrapolating-wall --set rows=8", true),
        ("couette --variant extrapolating-wall --set rows=8 --relation mirrored", true),
        ("taylor_couette --set layers=8", true),
        ("dam_break --set n=6 --set end=0.2", false),
        ("poiseuille --variant interface-wall --set rows=8", true),
        ("taylor_green --variant plain --set n=16 --set re=1", true),
    ] {
        done(folder.path(), &format!("export {line} --format lammps --out out"));
        let file = |name: &str| read(&folder.path().join("out").join(name));
        let problem: Value = serde_json::from_str(&file("problem.json")).unwrap();
        let particles = Table::read(&folder.path().join("out/particles.csv"));
        let (data, script) = (file("data.lmp"), file("in.lmp"));
        fs::remove_dir_all(folder.path().join("out")).unwrap();
        let is = |found: &str, expected: f64, what: &str| {
            let found: f64 = found.parse().unwrap_or_else(|_| panic!("{line}, {what}: {found}"));
            assert!(
                (found - expected).abs() <= 1e-12 * expected.abs(),
                "{line}, {what}: {found}, not {expected}"
            );
        };
        let material = |name: &str| number(&problem, &format!("material/{name}/value"));
        let pair = words(&script, "pair_coeff");
        is(pair[3], material("density"), "density");
        is(pair[4], material("sound_speed"), "sound speed");
        let viscosity = match is_viscous {
            true => material("kinematic_viscosity") * material("density"),
            false => material("artificial_viscosity_alpha"),
        };
        is(pair[5], viscosity, "viscosity");
        is(pair[6], number(&problem, "our_method/support_radius/value"), "cut-off");
        let style = words(&script, "pair_style")[1];
        assert_eq!(
            style,
            if is_viscous { "sph/taitwater/morris" } else { "sph/taitwater" },
            "{line}"
        );
        is_of_box(line, [&data, &script], &problem, &particles);
        is_of_atoms(line, [&data, &script], &particles);
        is_of_times(line, &script, &problem, particles.column("mass")[0]);
    }
}

/// The ends of the box of a data file.
fn is_of_box(line: &str, [data, script]: [&str; 2], problem: &Value, particles: &Table) {
    let is = |found: &str, expected: f64, what: &str| {
        let found: f64 = found.parse().unwrap();
        let is_close = (found - expected).abs() <= 1e-12 * expected.abs();
        assert!(is_close, "{line}, {what}: {found}, not {expected}");
    };
    // Periodic axes are where the problem has them; others reach beyond all particles.
    let (boundary, column) = (words(script, "boundary"), |name: &str| particles.column(name));
    for (k, name) in ["x", "y"].into_iter().enumerate() {
        let ends = data.lines().find(|line| line.ends_with(&format!("{name}lo {name}hi"))).unwrap();
        let ends: Vec<&str> = ends.split_whitespace().collect();
        let period = at(problem, &format!("domain/period/{k}"));
        match period["value"].as_f64() {
            Some(period) => {
                let low = number(problem, &format!("domain/low/value/{k}"));
                is(ends[0], low, "low end");
                is(ends[1], low + period, "high end");
                assert_eq!(boundary[1 + k], "p", "{line}");
                let is_inside = |x: f64| (low..low + period).contains(&x);
                assert!(column(name).iter().all(|x| is_inside(*x)), "{line}: outside of its box");
            }
            None => {
                let [low, high] = [0, 1].map(|k| ends[k].parse::<f64>().unwrap());
                assert!(
                    column(name).iter().all(|x| low < *x && *x < high) && boundary[1 + k] == "s"
                );
            }
        }
    }
}

/// Atoms, velocities and masses of a data file.
fn is_of_atoms(line: &str, [data, script]: [&str; 2], particles: &Table) {
    let (atoms, speeds) = (section(data, "Atoms # sph"), section(data, "Velocities"));
    let masses = section(data, "Masses");
    assert_eq!((atoms.len(), speeds.len()), (particles.rows.len(), particles.rows.len()), "{line}");
    let of =
        ["id", "density", "x", "y", "u", "v", "role", "mass"].map(|name| particles.column(name));
    for (k, (atom, speed)) in atoms.iter().zip(&speeds).enumerate() {
        let [id, density, x, y, u, v, role, mass] = [0, 1, 2, 3, 4, 5, 6, 7].map(|j| of[j][k]);
        assert_eq!([atom[0], atom[2], atom[5], atom[6]], [id + 1.0, density, x, y], "{line}, {k}");
        assert_eq!(speed[..3], [id + 1.0, u, v], "{line}, {k}");
        let kind = if role == 0.0 {
            1
        } else if [u, v] == [0.0; 2] {
            2
        } else {
            3
        };
        assert_eq!(atom[1], f64::from(kind), "{line}, {k}");
        // One mass for each type: the first particle's, and a note where others differ.
        assert_eq!(masses[kind as usize - 1][1], of[7][0], "{line}: mass");
        let is_alike = (mass / of[7][0] - 1.0).abs() < 1e-12;
        assert!(is_alike || script.contains("differ by up to"), "{line}: mass {mass}");
    }
}

/// Force, steps and times of a script.
fn is_of_times(line: &str, script: &str, problem: &Value, mass: f64) {
    let g = [0, 1].map(|k| number(problem, &format!("acceleration/value/{k}")));
    let force = script.lines().find(|line| line.starts_with("fix force"));
    match force.map(|line| line.split_whitespace().collect::<Vec<_>>()) {
        Some(words) => {
            for k in [0, 1] {
                let found: f64 = words[4 + k].parse().unwrap();
                assert!(
                    (found - g[k] * mass).abs() <= 1e-12 * (g[k] * mass).abs(),
                    "{line}: {found}"
                );
            }
        }
        None => assert_eq!(g, [0.0; 2], "{line} has no force"),
    }
    let (mut time, mut times, mut step) = (0.0, Vec::new(), 0.0_f64);
    let (h, c0) = (
        number(problem, "our_method/smoothing_length/value"),
        number(problem, "material/sound_speed/value"),
    );
    let nu = at(problem, "material").get("kinematic_viscosity").map(|of| number(of, "value"));
    for row in script.lines() {
        let words: Vec<&str> = row.split_whitespace().collect();
        match words[..] {
            ["timestep", of] => step = of.parse().unwrap(),
            ["run", "0"] => {}
            ["run", steps] => {
                time += step * steps.parse::<f64>().unwrap();
                times.push(time);
                let dx = number(problem, "particles/spacing/value");
                assert!(step * c0 <= 0.15 * dx * (1.0 + 1e-12), "{line}: a step of {step} s");
                let of_viscosity = nu.map_or(f64::INFINITY, |nu| 0.125 * h * h / nu);
                assert!(
                    step < of_viscosity,
                    "{line}: {step} s, against {of_viscosity} s of Morris"
                );
            }
            _ => {}
        }
    }
    let asked = at(problem, "times/value").as_array().unwrap();
    assert_eq!(times.len(), asked.iter().filter(|t| t.as_f64() != Some(-1.0)).count(), "{line}");
    for (found, asked) in times.iter().zip(asked) {
        let asked = asked.as_f64().unwrap();
        assert!((found - asked).abs() <= 1e-9 * (asked + step), "{line}: {found} s for {asked} s");
    }
}

/// −∇p/ρ of each particle of a periodic unit square, summed pair by pair with the quintic spline, from the
/// pressures of both sides or of the particle itself alone.
fn pressure_forces(particles: &Table, h: f64, of_both: bool) -> Vec<[f64; 2]> {
    let [x, y, density, mass, pressure] =
        ["x", "y", "density", "mass", "pressure"].map(|name| particles.column(name));
    let part = |q: f64, of: f64| (of - q).max(0.0).powi(4);
    let slope = |r: f64| {
        let q = r / h;
        let all = part(q, 3.0) - 6.0 * part(q, 2.0) + 15.0 * part(q, 1.0);
        -5.0 * 7.0 / (478.0 * std::f64::consts::PI * h * h * h) * all
    };
    let share = |k: usize| pressure[k] / (density[k] * density[k]);
    let nearest = |d: f64| d - d.round();
    let force = |i: usize| {
        let mut sum = [0.0; 2];
        for j in (0..x.len()).filter(|j| *j != i) {
            let [dx, dy] = [nearest(x[i] - x[j]), nearest(y[i] - y[j])];
            let r = (dx * dx + dy * dy).sqrt();
            let both = share(i) + if of_both { share(j) } else { 0.0 };
            let factor = -mass[j] * both * slope(r) / r;
            sum[0] += factor * dx;
            sum[1] += factor * dy;
        }
        sum
    };
    (0..x.len()).map(force).collect()
}

/// On a lattice a pressure of one side alone has an equal sum, so that no gate can see it.
#[test]
fn a_pressure_force_that_lacks_one_side_fails_on_disordered_particles() {
    let folder = tempfile::tempdir().unwrap();
    let of = folder.path();
    done(of, "export operators --variant quintic-gradient --set n=24 --out own --solve");
    let own = of.join("own");
    let problem: Value = serde_json::from_str(&read(&own.join("problem.json"))).unwrap();
    let (h, end) =
        (number(&problem, "our_method/smoothing_length/value"), number(&problem, "end/value"));
    let particles = Table::read(&own.join("particles.csv"));
    let [id, x, y, density] = ["id", "x", "y", "density"].map(|name| particles.column(name));
    for (of_both, code) in [(true, 0), (false, 1)] {
        let row = |(k, force): (usize, &[f64; 2])| {
            let [u, v] = force.map(|force| force * end);
            format!("{end:?},{},{:?},{:?},{u:?},{v:?},{:?}\n", id[k], x[k], y[k], density[k])
        };
        let forces = pressure_forces(&particles, h, of_both);
        let rows: String = forces.iter().enumerate().map(row).collect();
        let head = "t[s],id,x[m],y[m],u[m/s],v[m/s],density[kg/m^3]";
        fs::write(own.join("results.csv"), format!("{head}\n{rows}")).unwrap();
        let output = touchstone(of, "submit operators own --all --store store");
        let told = String::from_utf8_lossy(&output.stdout).into_owned();
        assert_eq!(output.status.code(), Some(code), "both sides: {of_both}: {told}");
        let word = if of_both { "pass" } else { "FAIL" };
        let judged = told.lines().any(|line| line.starts_with(word) && line.contains("sum_error"));
        assert!(judged, "both sides: {of_both}: {told}");
    }
}

/// Means over the last quarter of a run are no means over its last half.
#[test]
fn still_water_over_a_wedge_is_measured_over_the_last_quarter() {
    let folder = tempfile::tempdir().unwrap();
    let (problem, _) = exported(folder.path(), "still_wedge");
    let end = number(&problem, "end/value");
    let times = at(&problem, "times/value").as_array().unwrap();
    assert_eq!(times.len(), 40, "eight times a period, of five of 20 periods");
    for (k, time) in times.iter().enumerate() {
        let expected = end * (0.75 + 0.25 * (k + 1) as f64 / 40.0);
        assert!((time.as_f64().unwrap() / expected - 1.0).abs() < 1e-12, "{time}: {expected}");
    }
}

/// An observer who renumbers particles also renumbers wall particles, and each kind keeps its own numbers.
#[test]
fn particles_of_each_kind_are_renumbered_among_themselves() {
    let folder = tempfile::tempdir().unwrap();
    let of = |by: &str| {
        let line = "export couette --variant extrapolating-wall --set rows=8";
        done(folder.path(), &format!("{line} --relation {by} --out {by}"));
        let table = Table::read(&folder.path().join(by).join("particles.csv"));
        let columns = ["id", "role", "x", "y", "u"].map(|name| table.column(name));
        (0..columns[0].len()).map(|k| columns.each_ref().map(|of| of[k])).collect::<Vec<_>>()
    };
    let (same, other) = (of("same"), of("renumbered"));
    for moves in [true, false] {
        let of_kind = |all: &[[f64; 5]]| -> Vec<[f64; 5]> {
            all.iter().filter(|[_, role, ..]| (*role == 0.0) == moves).copied().collect()
        };
        let (mut a, mut b) = (of_kind(&same), of_kind(&other));
        let stay = a.iter().zip(&b).filter(|(a, b)| a == b).count();
        assert!(a.len() > 30 && stay < a.len() / 4, "moves: {moves}; {stay} of {} stay", a.len());
        let ids = |of: &[[f64; 5]]| of.iter().map(|row| row[0]).collect::<Vec<_>>();
        assert_eq!(ids(&a), ids(&b), "moves: {moves}");
        for all in [&mut a, &mut b] {
            all.iter_mut().for_each(|row| row[0] = 0.0);
            all.sort_by(|a, b| {
                a.iter()
                    .zip(b)
                    .fold(std::cmp::Ordering::Equal, |all, (a, b)| all.then(a.total_cmp(b)))
            });
        }
        assert_eq!(a, b, "moves: {moves}");
    }
}

/// One violated relation of one variant fails the whole battery, whatever holds after it.
#[test]
fn a_symmetry_that_is_broken_fails_whatever_comes_after_it() {
    let folder = tempfile::tempdir().unwrap();
    let line = "symmetry rubber_rings --set centre=4.05 --set spacing=0.25";
    let output = touchstone(folder.path(), line);
    let told = String::from_utf8_lossy(&output.stdout);
    let verdicts: Vec<bool> = told
        .lines()
        .filter(|line| line.contains("rubber_rings"))
        .map(|line| line.contains("not the same"))
        .collect();
    assert!(verdicts.contains(&true) && verdicts.last() == Some(&false), "{told}");
    assert_eq!(output.status.code(), Some(1), "{told}");
}
