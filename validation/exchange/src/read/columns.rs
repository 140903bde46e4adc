//! Assignment of the columns of a file to ours: by the names of the caller, by our names, and by usual ones.

use touchstone_base::text::{few, short};

use super::{Head, Renamed};
use crate::flaw::Flaw;

/// Columns that a message repeats.
pub const MOST_SHOWN: usize = 12;
/// More than these are no columns of particles.
const MOST_COLUMNS: usize = 10_000;

/// Names that other codes usually give, in small letters without signs between them: of LAMMPS, ParaView,
/// DualSPHysics, SPHinXsys, PySPH, TrixiParticles.
const USUAL: [(&str, &[&str]); 6] = [
    ("t", &["time", "timevalue"]),
    (
        "id",
        &[
            "id",
            "ids",
            "idp",
            "gid",
            "gids",
            "uid",
            "index",
            "particleid",
            "particleids",
            "originalid",
            "originalids",
            "globalid",
            "globalids",
        ],
    ),
    ("u", &["vx", "velocityx"]),
    ("v", &["vy", "velocityy"]),
    ("density", &["density", "rho", "rhop", "crho", "crhoperatom"]),
    ("mass", &["mass", "masses"]),
];

/// Letters that name the directions of a vector. Directions 1 and 2 are the first two, unless there is no 3.
const DIRECTIONS: [[char; 3]; 6] = [
    ['x', 'y', 'z'],
    ['X', 'Y', 'Z'],
    ['u', 'v', 'w'],
    ['U', 'V', 'W'],
    ['1', '2', '3'],
    ['0', '1', '2'],
];

/// Names of the third components of place and velocity, which results do not have.
pub const THIRD: [&str; 2] = ["z", "w"];

/// The columns of a file that are read.
pub struct Places {
    /// Our names with their positions in the heads; then the third components.
    pub of: Vec<(&'static str, usize)>,
    /// The heads that are not read.
    pub unread: Vec<usize>,
}

/// A head without its unit, and the unit. A number in brackets, as in `c_vel[1]`, is part of the name.
fn parts(head: &str) -> (&str, Option<&str>) {
    let head = head.trim();
    match head.split_once('[') {
        Some((name, rest)) => match rest.trim_end().trim_end_matches(']') {
            index if index.bytes().all(|byte| byte.is_ascii_digit()) => (head, None),
            unit => (name.trim(), Some(unit)),
        },
        None => (head, None),
    }
}

/// A name without capitals and punctuation.
fn plain(name: &str) -> String {
    let letters = name.chars().filter(|letter| !matches!(letter, '_' | '-' | '.' | ':' | ' '));
    letters.flat_map(char::to_lowercase).collect()
}

/// The heads of a file.
pub struct Heads<'a> {
    /// As the file has them.
    pub all: Vec<&'a str>,
    /// The column of ours that the caller named it; its name without a unit; that without signs.
    names: Vec<(Option<&'a str>, &'a str, String)>,
    renamed: &'a Renamed,
    known: &'a [(&'a str, &'a str)],
}

impl<'a> Heads<'a> {
    /// Heads with the names of the caller and further names of the format: ours by theirs.
    pub fn new(heads: &[&'a str], renamed: &'a Renamed, known: &'a [(&'a str, &'a str)]) -> Self {
        let all: Vec<&str> = heads.iter().map(|head| head.trim()).collect();
        let name = |head: &&'a str| {
            let (name, _) = parts(head);
            let ours = renamed.get(*head).or_else(|| renamed.get(name));
            (ours.map(String::as_str), name, plain(name))
        };
        Self { names: all.iter().map(name).collect(), all, renamed, known }
    }

    /// The possible positions of one of our columns: named by the caller; else by our name; else by usual
    /// names.
    pub fn of(&self, ours: &str) -> Vec<usize> {
        type Name<'a> = (Option<&'a str>, &'a str, String);
        let usual = USUAL.iter().find(|(of, _)| *of == ours).map_or(&[][..], |(_, names)| names);
        let levels: [&dyn Fn(&Name) -> bool; 3] = [
            &|(named, ..)| *named == Some(ours),
            &|(named, name, _)| named.is_none() && *name == ours,
            &|(named, name, plain)| {
                let is_usual = self.known.contains(&(*name, ours)) || usual.contains(&&**plain);
                named.is_none() && is_usual
            },
        ];
        let places = levels.into_iter().map(|is_one| {
            (0..self.names.len()).filter(|place| is_one(&self.names[*place])).collect::<Vec<_>>()
        });
        places.into_iter().find(|places| !places.is_empty()).unwrap_or_default()
    }
}

/// Where each column of ours is among the heads.
///
/// # Errors
/// Columns that are missing, ambiguous, or in another unit; missing names of the caller.
pub fn places(file: &str, line: u64, heads: &Heads, columns: &[Head]) -> Result<Places, Vec<Flaw>> {
    let (mut of, mut flaws) = (Vec::new(), Vec::new());
    let flaw = |name: &str, what: String| Flaw::of(file, what).at(line).in_column(name);
    let Heads { all, names, renamed, .. } = heads;
    if all.len() > MOST_COLUMNS {
        let what = format!("it has {} columns; expected at most {MOST_COLUMNS}", all.len());
        return Err(vec![Flaw::of(file, what).at(line)]);
    }
    let shown = || few(all, MOST_SHOWN);
    for (theirs, ours) in *renamed {
        if !columns.iter().any(|(name, ..)| name == ours) {
            let names = few(columns.iter().map(|(name, ..)| name), MOST_SHOWN);
            flaws.push(flaw(ours, format!("--map names it; the columns to be read are {names}")));
        } else if !all.contains(&&**theirs) && !names.iter().any(|(_, name, _)| name == theirs) {
            let what =
                format!("--map names {theirs}, which is not there; the columns are {}", shown());
            flaws.push(flaw(ours, what));
        }
    }
    for (name, unit, may_lack) in columns.iter().copied() {
        match heads.of(name)[..] {
            [place] => {
                of.push((name, place));
                let stated = parts(all[place]).1.filter(|stated| *stated != unit);
                let what = |stated| format!("its unit is {}; expected {unit}", short(stated));
                flaws.extend(stated.map(|stated| flaw(name, what(stated))));
            }
            [first, second, ..] if all[first] != all[second] => {
                let both = [first, second].map(|place| short(all[place])).join(" and ");
                let what = format!("{both} may be it; expected one of them, or --map {name}=NAME");
                flaws.push(flaw(name, what));
            }
            [_, ..] => flaws.push(flaw(name, "it is there twice; expected once".into())),
            [] if !may_lack && !renamed.values().any(|ours| ours == name) => {
                let what = format!(
                    "it is missing; expected a column {name} in {unit}, or --map {name}=NAME; the columns \
                     are {}",
                    shown()
                );
                flaws.push(flaw(name, what));
            }
            [] => {}
        }
    }
    if !flaws.is_empty() {
        return Err(flaws);
    }
    for (third, both) in THIRD.into_iter().zip([["x", "y"], ["u", "v"]]) {
        let place = both.map(|name| of.iter().find(|(of, _)| *of == name).map(|(_, place)| *place));
        if let [Some(a), Some(b)] = place
            && let Some(c) = third_of(names, [a, b])
            && !of.iter().any(|(_, place)| *place == c)
        {
            of.push((third, c));
        }
    }
    let is_read = |place: &usize| of.iter().any(|(_, read)| read == place);
    let unread = (0..all.len()).filter(|place| !is_read(place)).collect();
    Ok(Places { of, unread })
}

/// The third component of a vector of which these two are components, if they are: they differ in one letter,
/// which names the direction.
fn third_of(names: &[(Option<&str>, &str, String)], two: [usize; 2]) -> Option<usize> {
    let [a, b] = two.map(|place| names[place].1);
    if a.len() != b.len() {
        return None;
    }
    let mut differ = a.char_indices().zip(b.chars()).filter(|((_, a), b)| a != b);
    let (Some(((k, a_is), b_is)), None) = (differ.next(), differ.next()) else { return None };
    let families = DIRECTIONS.iter().filter(|of| of.contains(&a_is) && of.contains(&b_is));
    let thirds = families.flatten().filter(|letter| ![a_is, b_is].contains(letter));
    let head = |letter: &char| format!("{}{letter}{}", &a[..k], &a[k + a_is.len_utf8()..]);
    let mut heads = thirds.map(head);
    heads.find_map(|head| names.iter().position(|(_, name, _)| *name == head))
}
