//! `probe`: our variants pass, named errors are found by the question that names them, and a code that
//! misbehaves never passes.

#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::common::{TOUCHSTONE, done, names, of, printed, read, said, send, touchstone};

/// Answers of `probe --json` with these arguments, and the exit code.
fn answers(folder: &Path, line: &str) -> (Vec<Value>, i32) {
    let output = touchstone(folder, &format!("probe --json {line}"));
    let all = serde_json::from_str(&printed(&output));
    (
        all.unwrap_or_else(|_| panic!("{line}: {}", said(&output))),
        output.status.code().unwrap_or(-1),
    )
}

fn ids<'a>(answers: &'a [Value], verdict: &str) -> Vec<&'a str> {
    let of = answers.iter().filter(|answer| answer["verdict"] == verdict);
    of.map(|answer| answer["id"].as_str().unwrap()).collect()
}

/// A shell script in a folder, as a code under test; `$1` is the folder of the problem, `$TOUCHSTONE` the
/// program.
fn script(folder: &Path, text: &str) -> String {
    let path = folder.join("code.sh");
    fs::write(&path, format!("TOUCHSTONE={TOUCHSTONE}\n{text}\n")).unwrap();
    format!("-- sh {}", path.display())
}

/// The answers on the page are those of this program, and the recommended variant passes every question.
#[test]
fn stored_answers_are_the_answers_of_our_variants() {
    let folder = tempfile::tempdir().unwrap();
    let stored = Path::new(env!("CARGO_MANIFEST_DIR")).join("../references/peers/probes");
    for variant in ["consistent", "modern", "plain", "seed"] {
        let text = read(&stored.join(format!("touchstone_{variant}.json")));
        let before: Vec<Value> = serde_json::from_str(&text).unwrap();
        let (now, exit) =
            answers(folder.path(), &format!("--variant {variant} --junit {variant}.xml"));
        for verdict in ["pass", "fail", "not applicable"] {
            let words = format!("{variant}: `probe --json` again");
            assert_eq!(ids(&before, verdict), ids(&now, verdict), "{words}");
        }
        assert_eq!(exit == 0, variant == "modern", "{variant}");
        for answer in now.iter().filter(|of| of["verdict"] != "not applicable") {
            let criteria = answer["criteria"].as_array().map_or(0, Vec::len);
            assert!((1..=3).contains(&criteria), "{answer:#}");
        }
        let junit = read(&folder.path().join(format!("{variant}.xml")));
        let document = roxmltree::Document::parse(&junit).unwrap();
        let cases = document.descendants().filter(|node| node.has_tag_name("testcase")).count();
        assert_eq!(cases, now.len());
    }
}

/// Walls of particles are another problem for the same questions.
#[test]
fn walls_of_particles_drag_and_hold_the_fluid() {
    let folder = tempfile::tempdir().unwrap();
    let line = "--variant extrapolating-wall --wall-particles \
                --only moving-wall,no-slip,free-slip,body-force,still-water";
    let (all, exit) = answers(folder.path(), line);
    assert_eq!((ids(&all, "pass").len(), exit), (5, 0), "{all:#?}");
}

/// One constant of our solver is wrong; the question that names it says by which factor, to 5 %.
#[test]
fn a_wrong_constant_fails_the_question_that_names_it_with_its_factor() {
    let folder = tempfile::tempdir().unwrap();
    for (constant, factor, question, expected) in [
        ("viscosity", 2.0, "viscous-force", 2.0),
        ("viscosity", 2.0, "shear-wave", 2.0),
        ("viscosity", 0.9, "shear-wave", 0.9),
        ("body_force", 1.03, "body-force", 1.03),
        ("body_force", 2.0, "body-force", 2.0),
        ("body_force", 2.0, "still-water", 2.0),
        ("wall_speed", 0.5, "moving-wall", 0.5),
        ("wall_speed", -1.0, "moving-wall", -1.0),
        ("sound_speed", 1.1, "sound", 1.1),
        ("sound_speed", 7.0_f64.sqrt(), "sound", 7.0_f64.sqrt()),
        ("sound_speed", 1.1, "gradient", 1.21),
        ("normalisation", 1.02, "density", 1.02),
        ("normalisation", 1.02, "gradient", 1.02),
    ] {
        let line = format!("--variant plain --mutate {constant}={factor} --only {question}");
        let (all, exit) = answers(folder.path(), &line);
        assert_eq!((&all[0]["verdict"], exit), (&"fail".into(), 1), "{line}: {all:#?}");
        let found = all[0]["factor"].as_f64().unwrap();
        assert!((found / expected - 1.0).abs() < 0.05, "{line}: {found}");
    }
}

/// Variants that are wrong by construction.
#[test]
fn a_wall_that_sticks_and_a_stress_by_components_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let (all, _) = answers(folder.path(), "--variant sticking --only free-slip");
    assert_eq!(ids(&all, "fail"), ["free-slip"], "{all:#?}");
    assert!(all[0]["answer"].as_str().unwrap().starts_with("the wall sticks"), "{:#}", all[0]);
    let (all, _) = answers(folder.path(), "--variant componentwise --only turned");
    assert_eq!(ids(&all, "fail"), ["turned"], "{all:#?}");
}

#[test]
fn a_code_that_computes_nothing_never_passes() {
    let folder = tempfile::tempdir().unwrap();
    // It writes nothing.
    let (all, exit) = answers(folder.path(), &script(folder.path(), "exit 0"));
    assert_eq!((ids(&all, "fail").len(), exit), (all.len(), 1), "{all:#?}");
    assert!(all[0]["answer"].as_str().unwrap().contains("method.json"), "{:#}", all[0]);
    // It solves, and hands in the start at every time.
    let copy = r#"$TOUCHSTONE solve "$1" || exit
        awk -F, -v OFS=, 'NR == FNR { if ($2 == 0) start[$1] = $3 OFS $4 OFS $5 OFS $6; next }
            FNR == 1 { print; next } { print $1, $2, start[$2], $7 }' \
            "$1/particles.csv" "$1/results.csv" > "$1/new" && mv "$1/new" "$1/results.csv""#;
    let line = format!("--only ran,shear-wave,sound,body-force {}", script(folder.path(), copy));
    let (all, exit) = answers(folder.path(), &line);
    assert_eq!((ids(&all, "fail").len(), exit), (4, 1), "{all:#?}");
    // It hands in a run of another start.
    let other = r#"sed -i 's/"seed": 1/"seed": 2/' "$1/problem.json"; $TOUCHSTONE solve "$1""#;
    let (all, _) = answers(folder.path(), &format!("--only ran {}", script(folder.path(), other)));
    assert_eq!(ids(&all, "fail"), ["ran"], "{all:#?}");
}

#[test]
fn a_code_that_declines_is_not_applicable_and_no_pass() {
    let folder = tempfile::tempdir().unwrap();
    let declines = script(folder.path(), "echo 'no walls here' >&2; exit 77");
    let (all, exit) = answers(folder.path(), &declines);
    assert_eq!((ids(&all, "not applicable").len(), exit), (all.len(), 2));
    assert_eq!(all[0]["answer"], "no walls here");
}

#[test]
fn a_run_that_breaks_must_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let only = |text: &str| {
        answers(
            folder.path(),
            &format!("--timeout 2 --only breaks {}", script(folder.path(), text)),
        )
    };
    let (honest, exit) = only(r#"$TOUCHSTONE solve "$1""#);
    assert_eq!((ids(&honest, "pass"), exit), (vec!["breaks"], 0), "{honest:#?}");
    let (all, exit) = only("echo 'no convergence' >&2; exit 1");
    assert_eq!((ids(&all, "fail"), exit), (vec!["breaks"], 1), "it stops everywhere: {all:#?}");
    for dishonest in [
        // Exit code 0 after a divergence: no results, or results that are no numbers.
        r#"$TOUCHSTONE solve "$1"; exit 0"#,
        r#"$TOUCHSTONE solve "$1"; echo "t[s],id,x[m],y[m],u[m/s],v[m/s]
0.1,0,NaN,0,0,0" > "$1/results.csv"; exit 0"#,
        // It goes on for ever, and so does what it has started.
        "sleep 1000 & sleep 1000",
        // A crash says nothing.
        "kill -SEGV $$",
    ] {
        let mild = r#"grep -q '"dt": 0.2' "$1/problem.json" || exec $TOUCHSTONE solve "$1""#;
        let dishonest = &format!("{mild}\n{dishonest}");
        let started = Instant::now();
        let (all, exit) = only(dishonest);
        assert_eq!((ids(&all, "fail"), exit), (vec!["breaks"], 1), "{dishonest}: {all:#?}");
        assert!(started.elapsed() < Duration::from_secs(30), "{dishonest}");
    }
}

/// A restart from rounded places, and one that does not stop.
#[test]
fn an_approximate_restart_fails() {
    let folder = tempfile::tempdir().unwrap();
    let only =
        |text| answers(folder.path(), &format!("--only restart {}", script(folder.path(), text)));
    assert_eq!(only(r#"$TOUCHSTONE solve "$1""#).1, 0);
    // The second call begins again with a viscosity that is 1 % larger.
    let rounded = r#"if grep -q '"resume": true' "$1/problem.json"; then
            sed -i 's/"resume": true/"x": 1/' "$1/problem.json"
            $TOUCHSTONE solve --mutate viscosity=1.01 "$1"
        else $TOUCHSTONE solve "$1"; fi"#;
    let (all, exit) = only(rounded);
    assert_eq!((ids(&all, "fail"), exit), (vec!["restart"], 1), "{all:#?}");
    let deaf = r#"sed -i 's/"stop_after"/"x"/' "$1/problem.json"; $TOUCHSTONE solve "$1""#;
    assert_eq!(only(deaf).1, 2, "it does not stop, so nothing can be said");
    let deaf_in_another_format = r#"rm -f "$1"/*.vtu
        sed -i 's/"stop_after"/"deaf"/; s/"resume": true/"y": 1/' "$1/problem.json"; $TOUCHSTONE solve "$1"
        if grep -q '"deaf"' "$1/problem.json"; then mv "$1/results.csv" "$1/results.vtu"; fi"#;
    assert_eq!(only(deaf_in_another_format).1, 2, "results of any name are looked at");
}

#[test]
fn a_setting_that_nothing_reads_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let deaf = r#"sed -i 's/"re": 200.0/"re": 100.0/' "$1/problem.json"; $TOUCHSTONE solve "$1""#;
    let (all, _) =
        answers(folder.path(), &format!("--only settings {}", script(folder.path(), deaf)));
    assert_eq!(ids(&all, "fail"), ["settings"], "{all:#?}");
    assert_eq!(all[0]["answer"], "nothing changes with the viscosity");
}

#[test]
fn arguments_that_name_no_code_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let inside = |name: &str, text: &str| {
        fs::create_dir_all(folder.path().join(name)).unwrap();
        fs::write(folder.path().join(name).join("probe.toml"), text).unwrap();
    };
    inside("empty", "command = []");
    inside("blank", "command = ['']");
    inside("other", "# ours\ncommand = ['true']\nshell = true");
    inside("lacking", "");
    inside("twice", "command = ['true']\ncommand = ['false']");
    inside("word", "command = 'true'");
    inside("cut", "command = ['true");
    inside("huge", &"#".repeat(100_000));
    fs::create_dir_all(folder.path().join("folder/probe.toml")).unwrap();
    fs::create_dir(folder.path().join("none")).unwrap();
    for (line, words) in [
        ("probe", "required"),
        ("probe --variant modern -- true", "cannot be used with"),
        ("probe --only nothing --variant modern", "--only nothing: there are ran, density"),
        ("probe -- ./no-such-program", "cannot be called"),
        ("probe --code empty", "names no command"),
        ("probe --code blank", "names no command; expected command = [\"python\", \"run.py\"]"),
        ("probe --code other", "other/probe.toml\": unknown field `shell`, expected `command`"),
        ("probe --code lacking", "missing field `command`"),
        ("probe --code twice", "duplicate key: `command` at line 2"),
        (
            "probe --code word",
            "invalid type: string \"true\", expected a sequence for key `command`",
        ),
        ("probe --code cut", "unterminated string at line 1"),
        ("probe --code huge", "it has 100000 bytes; allowed are at most 65536"),
        ("probe --code folder", "not a regular file"),
        ("probe --code none", "probe.toml\" cannot be read: No such file"),
        ("probe --variant modern --keep none", "exists"),
        ("probe --mutate viscosity=2 -- true", "cannot be used with"),
        ("probe --variant modern --mutate nothing=2 --only sound", "nothing"),
        ("solve none", "cannot be read"),
    ] {
        let (text, exit) = of(folder.path(), line);
        assert!(exit != 0 && text.contains(words), "{line}: {exit} {text}");
    }
    inside("named", "command = ['sh', 'here.sh']  # called in this folder");
    fs::write(folder.path().join("named/here.sh"), "echo mine >&2; exit 77").unwrap();
    let (all, exit) = answers(folder.path(), "--only sound --code named");
    assert_eq!((all[0]["answer"].as_str(), exit), (Some("mine"), 2), "called in its folder");
    done(folder.path(), "probe --list");
}

/// A code under way ends with the program, and so does its folder.
#[test]
fn an_interrupt_ends_the_code_and_leaves_no_folder() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("code.sh");
    fs::write(&path, format!("echo $$ > {}/pid; sleep 1000", folder.path().display())).unwrap();
    let mut child = Command::new(TOUCHSTONE)
        .current_dir(folder.path())
        .env("TMPDIR", folder.path())
        .args(["probe", "--only", "sound", "--", "sh", "code.sh"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let started = Instant::now();
    let pid =
        || fs::read_to_string(folder.path().join("pid")).ok().filter(|pid| pid.ends_with('\n'));
    while pid().is_none() {
        assert!(started.elapsed() < Duration::from_secs(60));
        sleep(Duration::from_millis(20));
    }
    send("-INT", &child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let lives =
        Command::new("kill").args(["-0", pid().unwrap().trim()]).stderr(Stdio::null()).status();
    assert!(!lives.unwrap().success(), "the code still runs");
    assert_eq!(names(folder.path()), ["code.sh", "pid"]);
}

/// The folder of each problem is kept on request, under any name, with standard error of any length.
#[test]
fn problems_are_kept_where_asked() {
    let folder = tempfile::tempdir().unwrap();
    let noisy = script(folder.path(), r#"head -c 3000000 /dev/zero >&2; $TOUCHSTONE solve "$1""#);
    let arguments = ["probe", "--only", "shear-wave", "--keep", "a folder/of mine", "--"];
    let code: Vec<&str> = noisy.trim_start_matches("-- ").split(' ').collect();
    let output =
        Command::new(TOUCHSTONE).current_dir(folder.path()).args(arguments).args(code).output();
    let output = output.unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let kept = folder.path().join("a folder/of mine");
    assert_eq!(names(&kept), ["01-shear_wave"]);
    assert!(names(&kept.join("01-shear_wave")).contains(&"results.csv".into()));
}
