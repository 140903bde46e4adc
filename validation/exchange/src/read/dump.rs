//! Dumps of LAMMPS: one or more snapshots a file, each with its time (`dump_modify time yes`).

use super::{COLUMNS, MOST_FLAWS, MOST_ROWS, Renamed, Rows, known_too, places, too_many};
use crate::flaw::Flaw;

/// Names of LAMMPS that need no `--map`. Its numbers of atoms begin at 1, ours at 0.
const KNOWN: [(&str, &str); 3] = [("vx", "u"), ("vy", "v"), ("c_rho", "density")];

/// The rows of the snapshots of a file.
pub fn rows(file: &str, text: &str, renamed: &Renamed) -> Result<Vec<Rows>, Vec<Flaw>> {
    let renamed = known_too(&KNOWN, renamed);
    if !text.is_empty() && !text.ends_with('\n') {
        let what = "the last line does not end; the file was cut short";
        return Err(vec![Flaw::of(file, what).at(text.lines().count() as u64)]);
    }
    let mut lines = text.trim_start_matches('\u{feff}').lines().enumerate();
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
            "NUMBER" => {
                let atoms = next("the number of atoms")?;
                if !(0.0..=MOST_ROWS as f64).contains(&atoms) || atoms.fract() != 0.0 {
                    let what =
                        format!("it is {atoms} atoms; expected a whole number up to {MOST_ROWS}");
                    return Err(flaw(line + 1, what));
                }
                count = Some(atoms as usize);
            }
            "UNITS" => drop(lines.next()),
            "BOX" => drop((lines.next(), lines.next(), lines.next())),
            "ATOMS" => {
                let Some(time) = time else {
                    let what =
                        "there is no ITEM: TIME before the atoms; write it by dump_modify time yes";
                    return Err(flaw(line, what.into()));
                };
                // The time is none of the columns.
                let heads: Vec<&str> = item.split_whitespace().skip(1).collect();
                let places = places(file, line as u64 + 1, &heads, &renamed, &COLUMNS[1..])?;
                let Some(atoms) = count.take() else {
                    let what = "there is no ITEM: NUMBER OF ATOMS before the atoms";
                    return Err(flaw(line, what.into()));
                };
                let (first_line, width) = (line as u64 + 2, heads.len());
                all.push(snapshot(file, (time, atoms, first_line), (&places, width), &mut lines)?);
                if all.iter().map(Rows::len).sum::<usize>() > MOST_ROWS {
                    return Err(vec![too_many(file)]);
                }
            }
            other => return Err(flaw(line, format!("ITEM: {other} is not known"))),
        }
    }
    if all.is_empty() {
        let what = "it has no snapshot; expected ITEM: ATOMS after ITEM: TIME";
        return Err(vec![Flaw::of(file, what)]);
    }
    Ok(all)
}

/// The atoms of one snapshot.
fn snapshot<'a>(
    file: &str,
    (time, atoms, first_line): (f64, usize, u64),
    (places, width): (&[(&'static str, usize)], usize),
    lines: &mut impl Iterator<Item = (usize, &'a str)>,
) -> Result<Rows, Vec<Flaw>> {
    let (mut rows, mut flaws) = (Rows::new(file, first_line, places), Vec::new());
    for k in 0..atoms {
        let Some((line, text)) = lines.next().filter(|(_, text)| !text.starts_with("ITEM")) else {
            let what = format!("{k} atoms follow; expected {atoms}");
            return Err(vec![Flaw::of(file, what).at(first_line - 1)]);
        };
        let values: Vec<&str> = text.split_whitespace().collect();
        if values.len() != width {
            let what = format!("it has {} values; expected {width}", values.len());
            flaws.push(Flaw::of(file, what).at(line as u64 + 1));
        }
        rows.add(line as u64 + 1, places, &values, &mut flaws);
        if flaws.len() >= MOST_FLAWS {
            break;
        }
    }
    let ids = rows.columns.iter_mut().filter(|(name, _)| *name == "id");
    ids.flat_map(|(_, ids)| ids).for_each(|id| *id -= 1.0);
    rows.columns.push(("t", vec![time; rows.len()]));
    if flaws.is_empty() { Ok(rows) } else { Err(flaws) }
}
