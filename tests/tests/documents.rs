//! The documents as tests: links resolve, numbers equal snapshots and gates, README is short. The commands in
//! them are tested with the arguments of the command line.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use touchstone_base::gate::{Bound, Gate};
use touchstone_harness::{
    case::{Case, Tier},
    convergence::{Convergence, ErrorLevel, convergence},
    plan,
    studies::validation::numerical,
};
use touchstone_tests::{Kept, kept_numbers, kept_work};

use crate::tidy::{assert_none, files, root};

/// Words that README may have outside of code blocks and comments.
const README_WORDS: usize = 450;
/// Allowed number of words of all documents together, counted in the same way.
const ALL_WORDS: usize = 11_900;
/// Folders whose paths, in backquotes, must exist.
const FOLDERS: [&str; 7] =
    ["solver", "validation", "tests", "references", "docs", ".ci", ".github"];

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The reasons for the recommended variants, which state numbers as documents do.
fn reasons() -> impl Iterator<Item = (String, String)> {
    let of = |case: &&'static dyn Case| {
        let name = format!("the reason of {}", case.name());
        (name, case.recommended().because.to_string())
    };
    touchstone_cases::CASES.iter().map(of)
}

/// Path and text of each document, by path.
fn documents() -> BTreeMap<String, String> {
    let named = |path: PathBuf| path.strip_prefix(root()).unwrap().to_string_lossy().into_owned();
    let names = files(&root()).into_iter().map(named).chain(["reports/README.md".into()]);
    names.filter(|name| name.ends_with(".md")).map(|name| (name.clone(), read(&name))).collect()
}

/// A document without the text between two marks, and without the marks.
fn without(text: &str, begin: &str, end: &str) -> String {
    let (mut kept, mut rest) = (String::new(), text);
    while let Some((before, inside)) = rest.split_once(begin) {
        kept += before;
        rest = inside.split_once(end).map_or("", |(_, after)| after);
    }
    kept + rest
}

/// Without blocks of code.
fn prose(text: &str) -> String {
    without(text, "```", "```")
}

/// The name of a heading in an address: small letters, digits, hyphens.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

fn has_anchor(text: &str, wanted: &str) -> bool {
    let text = prose(text);
    let headings = text.lines().filter(|line| line.starts_with('#'));
    headings.map(|line| anchor(line.trim_start_matches('#'))).any(|found| found == wanted)
}

/// Targets of the links of a document to files of the project.
fn links(text: &str) -> Vec<String> {
    let text = without(&prose(text), "`", "`");
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.filter(|target| !target.contains("://")).map(String::from).collect()
}

#[test]
fn links_lead_to_files_and_headings() {
    let mut broken = Vec::new();
    for (path, text) in documents() {
        let folder = Path::new(&path).parent().unwrap().to_path_buf();
        for link in links(&text) {
            let (file, heading) = link.split_once('#').unwrap_or((&link, ""));
            let target = if file.is_empty() { PathBuf::from(&path) } else { folder.join(file) };
            let target = root().join(target);
            let is_found = heading.is_empty()
                || fs::read_to_string(&target).is_ok_and(|text| has_anchor(&text, heading));
            // A book of `docs` holds no other files.
            let leaves_the_book = path.starts_with("docs/") && link.starts_with("..");
            if !target.exists() || !is_found || leaves_the_book {
                broken.push(format!("{path}: {link}"));
            }
        }
    }
    assert_none("a link leads to a file and a heading of it", broken);
}

#[test]
fn paths_in_documents_exist() {
    let mut missing = Vec::new();
    for (path, text) in documents() {
        for quoted in prose(&text).split('`').skip(1).step_by(2) {
            let is_path_like = quoted.chars().all(|c| c.is_alphanumeric() || "_./-".contains(c));
            let folder = quoted.split_once('/').map(|(folder, _)| folder);
            let is_path = folder.map_or(quoted.ends_with(".md"), |f| FOLDERS.contains(&f));
            if is_path_like && is_path && !root().join(quoted).exists() {
                missing.push(format!("{path}: {quoted}"));
            }
        }
    }
    assert_none("a path in backquotes names a file or a folder", missing);
}

#[test]
fn the_summary_lists_every_page_once() {
    let mut listed = links(&read("docs/SUMMARY.md"));
    listed.sort();
    let is_page = |path: &String| path.starts_with("docs/") && path != "docs/SUMMARY.md";
    let pages: Vec<String> = documents().into_keys().filter(is_page).collect();
    assert_eq!(listed.iter().map(|page| format!("docs/{page}")).collect::<Vec<_>>(), pages);
}

/// Words of a document: what is between spaces and has a letter or a digit, without code and comments.
fn words(text: &str) -> usize {
    let text = without(&prose(text), "<!--", "-->");
    text.split_whitespace().filter(|word| word.chars().any(char::is_alphanumeric)).count()
}

#[test]
fn documents_are_short() {
    let readme = words(&read("README.md"));
    assert!(readme <= README_WORDS, "README has {readme} words, allowed are {README_WORDS}");
    let all: usize = documents().into_values().map(|text| words(&text)).sum();
    assert!(all <= ALL_WORDS, "documents have {all} words, allowed are {ALL_WORDS}");
}

/// Splits a text at the number that ends it, such as `−9.1 %` or `6.0·10⁶`.
fn before_number(text: &str) -> (&str, &str) {
    const POWERS: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹";
    let text = text.trim_end();
    let mantissa = text.trim_end_matches('%').trim_end().trim_end_matches(|c| POWERS.contains(c));
    let mantissa = mantissa.strip_suffix("·10").unwrap_or(mantissa);
    let before = mantissa.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.');
    (before, &text[before.len()..])
}

/// The number that ends a text, as `−9.1 %`, with the unit of its last digit; `None` if there is none.
fn last_number(text: &str) -> Option<(f64, f64)> {
    let (before, number) = before_number(text);
    let (number, scale) = match number.split_once("·10") {
        None => match number.strip_suffix('%') {
            Some(percent) => (percent.trim_end(), 0.01),
            None => (number, 1.0),
        },
        Some((mantissa, power)) => {
            let digit = |c| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|of| of == c);
            let power = power.chars().try_fold(0, |sum, c| Some(10 * sum + digit(c)? as i32))?;
            (mantissa, 10_f64.powi(power))
        }
    };
    let sign = if before.ends_with(['−', '-']) { -1.0 } else { 1.0 };
    let decimals = number.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let value: f64 = number.parse().ok()?;
    Some((sign * value * scale, 10_f64.powi(-(decimals as i32)) * scale))
}

/// The numbers behind the comment of a number in a document: `<!-- snapshot; run; metric -->` a result,
/// `<!-- gate NAME -->` the ends of a bound. For a ladder, coarse to fine, with the resolution first in the
/// name of a run, `<!-- U_num snapshot; run, run; metric -->` is the uncertainty of 95 % by the ladder,
/// `<!-- order … -->` the order of its errors with the ends of its interval, and `<!-- limit … -->` its
/// limit; `None` for any other comment.
fn sources(comment: &str, gates: &[Gate]) -> Option<Vec<f64>> {
    if let Some(name) = comment.strip_prefix("gate ") {
        let gate = gates.iter().find(|gate| gate.id == name);
        return Some(gate.map(ends).unwrap_or_default());
    }
    if let Some((kind, ladder)) = comment.split_once(' ')
        && let "U_num" | "order" | "limit" = kind
    {
        return Some(ladder_says(kind, ladder).unwrap_or_default());
    }
    let [name, run, metric] = comment.split("; ").collect::<Vec<_>>()[..] else { return None };
    // Metrics are in the snapshot of the case, steps and pair interactions in the snapshot of its work.
    let (case, variant) = name.split_once('.')?;
    let of = |kept: Kept| kept.get(&(variant.into(), run.into()))?.get(metric).copied();
    Some([kept_numbers(case), kept_work(case)].into_iter().filter_map(of).collect())
}

/// The result of the ladder in a comment: U_num, the order with the ends of its interval, or the limit.
fn ladder_says(kind: &str, comment: &str) -> Option<Vec<f64>> {
    let [name, runs, metric] = comment.split("; ").collect::<Vec<_>>()[..] else { return None };
    let (case, variant) = name.split_once('.')?;
    let kept = kept_numbers(case);
    let level = |run: &str| {
        let resolution: f64 = run.split(['=', ' ']).nth(1)?.parse().ok()?;
        let value = *kept.get(&(variant.into(), run.into()))?.get(metric)?;
        Some(ErrorLevel { spacing: 1.0 / resolution, value })
    };
    let levels: Vec<ErrorLevel> = runs.split(", ").map(level).collect::<Option<_>>()?;
    match kind {
        "U_num" => Some(vec![numerical(&levels).expanded]),
        "limit" => Some(vec![numerical(&levels).limit]),
        _ => {
            let Convergence { order, interval, .. } = convergence(&levels, None).ok()?;
            Some(vec![order, interval[0], interval[1]])
        }
    }
}

/// The ends of the bound of a gate and of the bound of its limitation.
fn ends(gate: &Gate) -> Vec<f64> {
    let ends = |bound| match bound {
        Bound::Below(end) | Bound::Above(end) | Bound::Equals(end) => vec![end],
        Bound::Within(low, high) => vec![low, high],
    };
    [gate.bound].into_iter().chain(gate.known).flat_map(ends).collect()
}

/// The statements of a document with their sources: the text before a comment, and the comment.
fn sourced(text: &str) -> Vec<(&str, &str)> {
    let comments = text.match_indices("<!-- ").filter_map(|(at, mark)| {
        let comment = text[at + mark.len()..].split_once(" -->")?.0;
        Some((&text[..at], comment))
    });
    comments.collect()
}

fn all_gates() -> Vec<Gate> {
    let of = |tier| touchstone_cases::CASES.iter().flat_map(move |case| plan::of_case(*case, tier));
    [Tier::Quick, Tier::Full].into_iter().flat_map(of).flat_map(|planned| planned.gates).collect()
}

#[test]
fn numbers_with_a_source_are_those_of_the_source() {
    let (gates, mut wrong, mut count) = (all_gates(), Vec::new(), 0);
    for (path, text) in documents().into_iter().chain(reasons()) {
        for (before, comment) in sourced(&without(&prose(&text), "`", "`")) {
            let Some(found) = sources(comment, &gates) else { continue };
            count += 1;
            let is_shown = |value: &f64| {
                let Some((shown, unit)) = last_number(before) else { return false };
                (value - shown).abs() <= 0.5 * unit * (1.0 + 1e-9)
            };
            if !found.iter().any(is_shown) {
                let shown = last_number(before).map(|(value, _)| value);
                wrong.push(format!("{path}: {shown:?} is {found:?} by {comment}"));
            }
        }
    }
    assert!(count > 50, "{count} numbers have a source");
    assert_none("a number is that of the snapshot or gate that its comment names", wrong);
}

/// The numbers of a text that no comment with a source follows.
fn bare(text: &str, numbers: impl Fn(&str) -> Vec<String>) -> Vec<String> {
    let (mut found, mut rest) = (Vec::new(), text);
    while let Some((before, after)) = rest.split_once("<!-- ") {
        found.extend(numbers(before_number(before).0));
        rest = after.split_once("-->").map_or("", |(_, rest)| rest);
    }
    found.extend(numbers(rest));
    found
}

/// In README's table a cell from the column of errors on has at most one number, before its source.
#[test]
fn results_in_readme_have_sources_and_cells_of_their_own() {
    let text = read("README.md");
    let mut rows = text.lines().skip_while(|line| !line.contains("| Error |"));
    let header: Vec<&str> = rows.next().expect("a table").split('|').map(str::trim).collect();
    let first = header.iter().position(|cell| *cell == "Error").expect("a column");
    let rows: Vec<&str> = rows.skip(1).take_while(|line| line.starts_with('|')).collect();
    let mut wrong = Vec::new();
    for cell in rows.iter().flat_map(|row| row.split('|').skip(first)) {
        wrong.extend(bare(cell, numbers));
        wrong.extend((sourced(cell).len() > 1).then(|| cell.to_string()));
    }
    assert!(rows.len() >= 5, "the five cases: {} rows", rows.len());
    assert_none("a number in README's table has a source and a cell of its own", wrong);
}

/// Shares and numbers with decimals in the reasons for the recommended variants come from runs or gates.
#[test]
fn numbers_of_recommended_variants_have_sources() {
    let named = |(name, text): (String, String)| {
        let found = bare(&text, stated).into_iter();
        found.map(move |number| format!("{name}: {number}"))
    };
    let bare = reasons().flat_map(named).collect();
    assert_none("a number of a reason has a source", bare);
}

/// The words of a text that are results: shares, and numbers with decimals.
fn stated(text: &str) -> Vec<String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let is_result = |pair: &[&str]| {
        let word = pair[0].trim_end_matches([',', ';', ':']);
        let is_number = word.trim_start_matches(['-', '+']).parse::<f64>().is_ok();
        is_number && (word.contains('.') || pair.get(1).is_some_and(|next| next.starts_with('%')))
    };
    let last = words.len().saturating_sub(1);
    let found = (0..words.len()).filter(|k| is_result(&words[*k..=(*k + 1).min(last)]));
    found.map(|k| words[k].to_string()).collect()
}

/// The words of a text that begin with a digit.
fn numbers(text: &str) -> Vec<String> {
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '.');
    words.filter(|word| word.starts_with(|c: char| c.is_ascii_digit())).map(String::from).collect()
}

#[test]
fn two_versions_of_a_crate_have_a_reason() {
    let lock = read("Cargo.lock");
    let quoted = |line: &str| line.split('"').nth(1).unwrap_or_default().to_string();
    let mut versions: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for package in lock.split("[[package]]").skip(1) {
        let mut lines = package.lines().skip(1).map(quoted);
        let (name, version) = (lines.next().unwrap(), lines.next().unwrap());
        versions.entry(name).or_default().insert(version);
    }
    let deny = read("deny.toml");
    let entries = deny.split("crate = \"").skip(1).filter_map(|rest| rest.split('"').next());
    let mut excepted: BTreeSet<&str> = entries.collect();
    let mut unexplained = Vec::new();
    for (name, versions) in versions.iter().filter(|(_, versions)| versions.len() > 1) {
        let is_excepted =
            |version: &&String| !excepted.contains(format!("{name}@{version}").as_str());
        if versions.iter().filter(is_excepted).count() > 1 {
            unexplained.push(format!("{name}: {versions:?}"));
        }
        excepted.retain(|entry| !versions.iter().any(|v| *entry == format!("{name}@{v}")));
    }
    unexplained.extend(excepted.into_iter().map(|entry| format!("{entry} is no longer needed")));
    assert_none("deny.toml names the crates of which there are two versions", unexplained);
}

#[test]
fn the_citation_names_this_version() {
    let of = |path: &str, mark: &str| {
        let text = read(path);
        let line = text.lines().find(|line| line.starts_with(mark)).unwrap_or_default();
        line.trim_start_matches(mark).trim_matches([' ', '=', '"']).to_string()
    };
    assert_eq!(of("CITATION.cff", "version:"), of("Cargo.toml", "version"));
}

/// The reader itself, on a text with each kind of fault.
#[test]
fn faults_of_a_document_are_seen() {
    let text = "# A `b` c\n[one](x.md#a-b-c) `[no](y)` ![two](p.png)\n```sh\n[no](z)\n```\n";
    assert_eq!(links(text), ["x.md#a-b-c", "p.png"]);
    assert!(has_anchor(text, "a-b-c") && !has_anchor(text, "a-c"));
    assert_eq!(last_number("is −9.1 %"), Some((-0.091, 0.001)));
    assert_eq!(last_number("+1000"), Some((1000.0, 1.0)));
    assert_eq!(last_number("none"), None);
    assert_eq!(last_number("6.0·10⁶"), Some((6e6, 1e5)));
    assert_eq!(stated("at T = 2 by 3 % or -0.5; 20 rows"), ["3", "-0.5;"]);
    assert_eq!(bare("1.5 %<!-- a --> of 2.5 and 3.0·10⁶<!-- b -->", numbers), ["2.5"]);
    assert_eq!(numbers("U_b at h0, +3 and 0.5"), ["3", "0.5"]);
    let name = "couette.plain.20.l2@0.1";
    let gates: Vec<Gate> = all_gates().into_iter().filter(|gate| gate.id == name).take(1).collect();
    assert_eq!(sources(&format!("gate {name}"), &gates).map(|ends| ends.len()), Some(2));
    assert_eq!(sources("gate none", &gates), Some(Vec::new()), "a missing gate is a fault");
    assert_eq!(sources("couette.plain; rows=20; none", &gates), Some(Vec::new()));
    assert_eq!(sources("a remark", &gates), None);
    let of = |kind, runs: &str| ladder_says(kind, &format!("couette.modern; {runs}; l2_worst"));
    for (kind, count) in [("U_num", 1), ("limit", 1), ("order", 3)] {
        let found = of(kind, "rows=10, rows=14, rows=20").unwrap();
        assert!(found.len() == count && found[0].abs() > 1e-9, "{kind}: {found:?}");
        assert_eq!(of(kind, "rows=10, rows=15, rows=20"), None, "a missing run is a fault");
    }
}
