//! Dumps of LAMMPS: one or more snapshots a file, each with its time (`dump_modify time yes`).

use std::collections::BTreeMap;

use super::{MOST_FLAWS, Renamed, Rows, places};
use crate::flaw::Flaw;

/// Names of LAMMPS that need no `--map`. Its numbers of atoms begin at 1, ours at 0.
const KNOWN: [(&str, &str); 3] = [("vx", "u"), ("vy", "v"), ("c_rho", "density")];

/// The rows of the snapshots of a file.
pub fn rows(file: &str, text: &str, renamed: &Renamed) -> Result<Vec<Rows>, Vec<Flaw>> {
    let known = KNOWN.iter().map(|(theirs, ours)| (theirs.to_string(), ours.to_string()));
    let renamed: Renamed = known.chain(renamed.clone()).collect();
    let mut lines = text.lines().enumerate();
    let (mut all, mut time, mut count) = (Vec::new(), None, None);
    let flaw = |line: usize, what: String| vec![Flaw::of(file, what).at(line as u64 + 1)];
    while let Some((line, head)) = lines.next() {
        let Some(item) = head.strip_prefix("ITEM: ") else {
            let what = format!(
                "it begins {:?}; expected ITEM:",
                head.chars().take(20).collect::<String>()
            );
            return Err(flaw(line, what));
        };
        let mut next = |what: &str| {
            let (line, text) =
                lines.next().ok_or_else(|| flaw(line, format!("{what} is missing")))?;
            let number: Result<f64, _> = text.trim().parse();
            number.map_err(|_| flaw(line, format!("{what} is {text:?}; expected a number")))
        };
        match item.split(' ').next().unwrap_or_default() {
            "TIME" => time = Some(next("the time")?),
            "TIMESTEP" => drop(next("the time step")?),
            "NUMBER" => count = Some(next("the number of atoms")?),
            "UNITS" => drop(lines.next()),
            "BOX" => drop((lines.next(), lines.next(), lines.next())),
            "ATOMS" => {
                let Some(time) = time else {
                    let what =
                        "there is no ITEM: TIME before the atoms; write it by dump_modify time yes";
                    return Err(flaw(line, what.into()));
                };
                let heads: Vec<&str> = item.split_whitespace().skip(1).collect();
                let places = places(file, line as u64 + 1, &heads, &renamed, &["t"])?;
                let atoms = count.unwrap_or(0.0) as usize;
                let first_line = line as u64 + 2;
                all.push(snapshot(file, (time, atoms, first_line), &places, &mut lines)?);
            }
            other => return Err(flaw(line, format!("ITEM: {other} is not known"))),
        }
    }
    Ok(all)
}

/// The atoms of one snapshot.
fn snapshot<'a>(
    file: &str,
    (time, atoms, first_line): (f64, usize, u64),
    places: &[(&'static str, usize)],
    lines: &mut impl Iterator<Item = (usize, &'a str)>,
) -> Result<Rows, Vec<Flaw>> {
    let mut columns = BTreeMap::from([("t", Vec::new())]);
    let mut flaws = Vec::new();
    for k in 0..atoms {
        let Some((line, text)) = lines.next().filter(|(_, text)| !text.starts_with("ITEM")) else {
            let what = format!("{k} atoms follow; expected {atoms}");
            return Err(vec![Flaw::of(file, what).at(first_line - 1)]);
        };
        let values: Vec<&str> = text.split_whitespace().collect();
        columns.entry("t").or_default().push(time);
        for (name, place) in places {
            let text = values.get(*place).copied().unwrap_or_default();
            let value = text.parse().unwrap_or_else(|_| {
                let what = format!("it is {text:?}; expected a number");
                flaws.push(Flaw::of(file, what).at(line as u64 + 1).in_column(*name));
                f64::NAN
            });
            let first = if *name == "id" { 1.0 } else { 0.0 };
            columns.entry(name).or_default().push(value - first);
        }
        if flaws.len() >= MOST_FLAWS {
            break;
        }
    }
    if flaws.is_empty() { Ok(Rows { file: file.into(), first_line, columns }) } else { Err(flaws) }
}
