//! Dumps of LAMMPS: one or more snapshots a file, each with its time (`dump_modify time yes`).

use touchstone_base::text::{number, short};

use super::{
    COLUMNS, MOST_FLAWS, MOST_ROWS, Renamed, Rows,
    columns::{self, Heads, Places},
    too_many,
};
use crate::flaw::{CUT, Flaw};

/// Names of places: unwrapped, as shares of the box, and both.
const KNOWN: [(&str, &str); 6] =
    [("xu", "x"), ("yu", "y"), ("xs", "x"), ("ys", "y"), ("xsu", "x"), ("ysu", "y")];
/// Positions relative to the box, for each direction.
const SCALED: [[&str; 2]; 3] = [["xs", "xsu"], ["ys", "ysu"], ["zs", "zsu"]];
/// Systems of units in which numbers are SI, or have no units.
const UNITS: [&str; 2] = ["si", "lj"];

/// Header of a snapshot.
#[derive(Default)]
struct Head {
    time: Option<f64>,
    atoms: Option<usize>,
    /// The ends of the box in each direction, or why they are missing.
    box_ends: Option<Result<[[f64; 2]; 3], &'static str>>,
}

/// The rows of the snapshots of a file.
pub fn rows(file: &str, text: &str, renamed: &Renamed) -> Result<Vec<Rows>, Vec<Flaw>> {
    if !text.is_empty() && !text.ends_with('\n') {
        return Err(vec![Flaw::of(file, CUT).at(text.lines().count() as u64)]);
    }
    let mut lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    let (mut all, mut count, mut head) = (Vec::new(), 0, Head::default());
    let flaw = |line: usize, what: String| vec![Flaw::of(file, what).at(line as u64 + 1)];
    while let Some((line, text)) = lines.next() {
        let Some(item) = text.strip_prefix("ITEM: ") else {
            return Err(flaw(line, format!("it begins {:?}; expected ITEM:", short(text))));
        };
        if item.split(' ').next() == Some("ATOMS") {
            let heads: Vec<&str> = item.split_whitespace().skip(1).collect();
            let heads = Heads::new(&heads, renamed, &KNOWN);
            let of_snapshot = std::mem::take(&mut head);
            all.push(snapshot(file, line, of_snapshot, &heads, &mut lines)?);
            count += all.last().map_or(0, Rows::len);
            if count > MOST_ROWS {
                return Err(vec![too_many(file)]);
            }
        } else {
            let read = head.read(item, &mut lines.by_ref().map(|(_, text)| text));
            read.map_err(|(below, what)| flaw(line + below, what))?;
        }
    }
    if all.is_empty() {
        let what = "it has no snapshot; expected ITEM: ATOMS after ITEM: TIME";
        return Err(vec![Flaw::of(file, what)]);
    }
    Ok(all)
}

impl Head {
    /// Reads an item; an error is the flaw, and its distance in lines from the item's line.
    fn read(
        &mut self,
        item: &str,
        lines: &mut dyn Iterator<Item = &str>,
    ) -> Result<(), (usize, String)> {
        let mut next = |what: &str| {
            let text = lines.next().ok_or_else(|| (0, format!("{what} is missing")))?;
            let read: Result<f64, _> = text.trim().parse();
            read.map_err(|_| (1, format!("{what} is {:?}; expected a number", short(text))))
        };
        match item.split(' ').next().unwrap_or_default() {
            "TIME" => self.time = Some(next("the time")?),
            "TIMESTEP" => drop(next("the time step")?),
            "NUMBER" => {
                let atoms = next("the number of atoms")?;
                if !(0.0..=MOST_ROWS as f64).contains(&atoms) || atoms.fract() != 0.0 {
                    let atoms = number(atoms);
                    let what =
                        format!("it is {atoms} atoms; expected a whole number up to {MOST_ROWS}");
                    return Err((1, what));
                }
                self.atoms = Some(atoms as usize);
            }
            "UNITS" => {
                let stated = lines.next().unwrap_or_default().trim();
                if !UNITS.contains(&stated) {
                    let what = format!(
                        "units are {:?}; expected si, or lj; touchstone_sph.convert reads others",
                        short(stated)
                    );
                    return Err((1, what));
                }
            }
            "BOX" => {
                let ends = [(); 3].map(|()| lines.next().unwrap_or_default());
                self.box_ends = Some(if item.contains("xy") || item.contains("abc") {
                    Err("the box is not rectangular")
                } else {
                    bounds(ends)
                        .ok_or("ITEM: BOX BOUNDS has other lines than two ascending numbers")
                });
            }
            other => return Err((0, format!("ITEM: {} is not known", short(other)))),
        }
        Ok(())
    }
}

/// The ends of a box in each direction.
fn bounds(lines: [&str; 3]) -> Option<[[f64; 2]; 3]> {
    let mut all = [[0.0; 2]; 3];
    for (ends, line) in all.iter_mut().zip(lines) {
        let numbers: Option<Vec<f64>> = line.split_whitespace().map(|n| n.parse().ok()).collect();
        *ends = numbers?.try_into().ok()?;
        if !(ends[0] < ends[1] && ends.iter().all(|end: &f64| end.is_finite())) {
            return None;
        }
    }
    Some(all)
}

/// The atoms of one snapshot, whose head has this line.
fn snapshot<'a>(
    file: &str,
    line: usize,
    head: Head,
    heads: &Heads,
    lines: &mut impl Iterator<Item = (usize, &'a str)>,
) -> Result<Rows, Vec<Flaw>> {
    let (first_line, width) = (line as u64 + 2, heads.all.len());
    let flaw = |what: String| Flaw::of(file, what).at(first_line - 1);
    let lacking = |item: &str| vec![flaw(format!("there is no {item} before these atoms"))];
    let time = head.time.ok_or_else(|| lacking("ITEM: TIME (dump_modify time yes)"))?;
    // The time is not a column.
    let places = columns::places(file, first_line - 1, heads, &COLUMNS[1..])?;
    let atoms = head.atoms.ok_or_else(|| lacking("ITEM: NUMBER OF ATOMS"))?;
    let (mut rows, mut flaws) = (Rows::new(file, first_line, heads, &places), Vec::new());
    for k in 0..atoms {
        let Some((line, text)) = lines.next().filter(|(_, text)| !text.starts_with("ITEM")) else {
            return Err(vec![flaw(format!("{k} atoms follow; expected {atoms}"))]);
        };
        let values: Vec<&str> = text.split_whitespace().collect();
        if values.len() != width {
            let what = format!("it has {} values; expected {width}", values.len());
            flaws.push(Flaw::of(file, what).at(line as u64 + 1));
        }
        rows.add(line as u64 + 1, &places, &values, &mut flaws);
        if flaws.len() >= MOST_FLAWS {
            break;
        }
    }
    scale(&mut rows, &head, heads, &places)
        .map_err(|(name, what)| vec![flaw(what).in_column(name)])?;
    // Numbers of atoms begin at 1; a column named by the caller is used unchanged.
    let is_of_lammps = |(name, place): &(&str, usize)| *name == "id" && heads.all[*place] == "id";
    rows.first_id = if places.of.iter().any(is_of_lammps) { 1.0 } else { 0.0 };
    rows.columns.push(("t", vec![time; rows.len()]));
    if flaws.is_empty() { Ok(rows) } else { Err(flaws) }
}

/// Converts positions relative to the box to metres; `None` for a missing column.
fn scale<'a>(
    rows: &mut Rows,
    head: &Head,
    heads: &Heads<'a>,
    Places { of, .. }: &Places,
) -> Result<(), (&'a str, String)> {
    for ((_, values), (_, place)) in rows.columns.iter_mut().zip(of) {
        let name = heads.all[*place];
        let Some(axis) = SCALED.iter().position(|names| names.contains(&name)) else { continue };
        let ends = head.box_ends.unwrap_or(Err("there is no ITEM: BOX BOUNDS before these atoms"));
        let [low, high] = ends
            .map_err(|why| (name, format!("it is a share of the box, and {why}; write x and y")))?
            [axis];
        values.iter_mut().for_each(|share| *share = low + *share * (high - low));
    }
    Ok(())
}
