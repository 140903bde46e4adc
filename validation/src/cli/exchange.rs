//! `export` and `submit`: problems for other codes, and their results.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use touchstone_base::{
    files,
    files::OutputFolder,
    record::{Record, Status},
    spec::RunSpec,
    text::short,
};
use touchstone_exchange::{
    challenge,
    flaw::{Flaw, lines},
    problem::{CURVE, ExportedProblem, PROBLEM, ProblemDocument, Sealed},
    read::{RESULTS, Renamed},
    submission::{self, Entry, METHOD, SYSTEM},
    write,
};
use touchstone_harness::{
    case::{self, Case},
    gates::GateIndex,
    problem::Steps,
    relation::Relation,
    store::Store,
    suite, symmetry,
};

use super::{
    Exit, Failure, Outcome, Session, arguments,
    baseline::Baseline,
    judged,
    judged::SubmissionVerdicts,
    metrics, output,
    solve::{self, How},
    submitted,
};

pub fn export(arguments: &arguments::Export, session: &Session) -> Result<(), Failure> {
    let of = &arguments.of;
    if let (Some(seed), Some(method)) = (arguments.sealed, &arguments.method) {
        return sealed(of, seed, method, session);
    }
    let case = touchstone_cases::find_in(session.cases, &of.case)?;
    let variant = of.variant.as_deref().unwrap_or(case.recommended().variant);
    let spec = case::spec(case, variant, &arguments.set)?;
    if arguments.solve {
        estimate(case, &spec, arguments)?;
    }
    let problem = ExportedProblem::seen(case, spec, arguments.relation, arguments.allow_long)?;
    problem.unjudged().iter().for_each(|why| output::say(&format!("note: {why}")));
    let mut files = write::files(&problem, of.format)?;
    let method = solve::method(&problem);
    let own = arguments.solve.then_some((METHOD, method.as_bytes()));
    files.extend(own.map(|(name, bytes)| (name, bytes.to_vec())));
    let folder = prepare(of, &files, if arguments.solve { &RESULTING } else { &[] })?;
    let mut names = put(&files, &folder)?;
    if arguments.solve {
        names.extend(
            solve::results(
                case,
                &problem,
                &folder,
                &How { allow_long: arguments.allow_long, ..How::default() },
                session,
            )?
            .0,
        );
    }
    output::say(&format!("{}: {}", folder.path().display(), names.join(", ")));
    Ok(())
}

/// Prints the estimated cost of a run that solves the problem.
///
/// # Errors
/// If it is refused, or takes more than is allowed.
fn estimate(case: &dyn Case, spec: &RunSpec, of: &arguments::Export) -> Result<(), Failure> {
    let steps = if of.relation.is_some() { Steps::Early } else { Steps::All };
    let size = case.pose(spec)?.size(spec, steps, of.allow_long)?;
    output::say(&format!("estimate: {size}"));
    Ok(())
}

/// Files of a run in addition to its problem and the description of its method.
const RESULTING: [&str; 3] = [RESULTS, CURVE, SYSTEM];

/// The folder of a problem. Refused if it holds files of another problem, or if foreign files would be
/// replaced. Results with an equal description of the method are results of an earlier export.
fn prepare(
    of: &arguments::Written,
    files: &[write::File],
    resulting: &[&str],
) -> Result<OutputFolder, Failure> {
    let path = |name: &str| of.out.join(name);
    let differs = |(name, bytes): &&write::File| match path(name).metadata() {
        Ok(old) if old.len() == bytes.len() as u64 => {
            files::read(&path(name)).map_or(true, |old| old != *bytes)
        }
        found => found.is_ok(),
    };
    let is_other = |name: &str| files.iter().filter(|(own, _)| *own == name).any(|f| differs(&f));
    let has_method = path(METHOD).exists() && !is_other(METHOD);
    let lost = resulting.iter().find(|name| !has_method && path(name).exists());
    let other = files.iter().find(differs).map(|(name, _)| name).or(lost);
    if let (Some(name), false) = (other, of.overwrite) {
        let holds = match is_other(PROBLEM) {
            true => format!("another problem in {PROBLEM}, and files of the two would mix"),
            false => format!("another {name}, which would be replaced"),
        };
        return Err(Failure::usage(format!(
            "the folder {:?} holds {holds}; name another folder by --out, or give --overwrite",
            of.out
        )));
    }
    let folder = OutputFolder::create(&of.out)?;
    if is_other(PROBLEM) {
        let all = write::NAMES.iter().chain(&RESULTING).chain(&[METHOD]);
        all.for_each(|name| drop(std::fs::remove_file(path(name))));
    }
    Ok(folder)
}

/// Writes files into a folder; their names.
fn put(files: &[write::File], folder: &OutputFolder) -> Result<Vec<String>, Failure> {
    for (name, bytes) in files {
        folder.write(name, bytes)?;
    }
    Ok(files.iter().map(|(name, _)| name.to_string()).collect())
}

/// The recommended variant, or the first that has sealed problems if that one has none.
fn sealed_variant(case: &dyn Case) -> &'static str {
    let (usual, draws) = (case.recommended().variant, case.facts().sealed);
    let names = draws.map_or(&[][..], |draws| draws.variants);
    match names.is_empty() || names.contains(&usual) {
        true => usual,
        false => names[0],
    }
}

/// Writes a problem whose settings are drawn from a seed and a method.
pub fn sealed(
    of: &arguments::Written,
    seed: u64,
    method: &Path,
    session: &Session,
) -> Result<(), Failure> {
    let case = touchstone_cases::find_in(session.cases, &of.case)?;
    let variant = of.variant.as_deref().unwrap_or_else(|| sealed_variant(case));
    case.settings(variant, &[])?;
    let (method, text) = submission::method(method).map_err(|flaws| {
        let flaws: Vec<String> = flaws.iter().map(Flaw::to_string).collect();
        Failure::usage(format!("no submission can have this method:\n  {}", flaws.join("\n  ")))
    })?;
    let set = challenge::draw(case, variant, seed, &method).map_err(Failure::usage)?;
    let sealed = Sealed { seed, method: method.digest() };
    let digest = sealed.method.clone();
    let problem = ExportedProblem::of(case, case::spec(case, variant, &set)?)?.sealed(case, sealed);
    let mut files = write::files(&problem, of.format)?;
    files.push((METHOD, text.into_bytes()));
    let folder = prepare(of, &files, &[])?;
    let names = put(&files, &folder)?;
    output::print(&format!("{}\n", set.join(" ")))?;
    output::say(&format!("{}: {}", folder.path().display(), names.join(", ")));
    output::say(&format!(
        "method {digest}: the draw reveals tuning only if this was published before the seed was known"
    ));
    Ok(())
}

/// The record of the submission in a folder, of the named case or of the case in its problem.json.
///
/// # Errors
/// Everything that is missing or wrong.
pub fn measured(
    case: Option<&str>,
    folder: &Path,
    how: &arguments::Submission,
    session: &Session,
) -> Result<(&'static dyn Case, Record), Failure> {
    let mut entry = read(folder, &how.map)?;
    let asked = entry.asked.as_ref().map(|asked| asked.spec.case.as_str());
    let none =
        || Failure::usage(format!("{} has no {PROBLEM}, which names the case", folder.display()));
    let case = touchstone_cases::find_in(session.cases, case.or(asked).ok_or_else(none)?)?;
    session.check_references(&[case])?;
    let problem = problem(case, &entry, how)?;
    let coarse = entry.scene(case, &problem)?;
    let scene = coarse.as_ref().unwrap_or(&problem);
    entry.particles_from_curve(case, scene).map_err(refused)?;
    entry.results.notes().iter().for_each(|note| output::say(note));
    entry.check(scene).map_err(refused)?;
    let mut record = entry.measure(case, &scene.spec, &problem).map_err(|error| {
        refused(vec![Flaw::of(folder.display().to_string(), error.to_string())])
    })?;
    record.manifest.sources = (session.sources)(case.name());
    Ok((case, record))
}

pub fn submit(arguments: &arguments::Submit, session: &Session) -> Outcome {
    let baseline = Baseline::of(arguments)?;
    let name = Some(arguments.case.as_str());
    let (case, record) = measured(name, &arguments.folder, &arguments.how, session)?;
    let before = baseline.as_ref().map(|of| of.before(&record)).transpose()?.flatten();
    // A check of completeness gives no verdict, but a diverged submission is not complete.
    if arguments.check && record.status == Status::Completed {
        output::say("complete: the submission has all required entries; nothing was recorded");
        return Ok(Exit::Pass);
    }
    let said = match arguments.store.as_ref().filter(|_| !arguments.check) {
        Some(store) => keep(&Store::open(store)?, &record)?.display().to_string(),
        None => "nothing was recorded".into(),
    };
    let index = GateIndex::of(case);
    let run = suite::submitted(&index, record);
    let (mut text, mut exit) = submitted::verdict(&index, &run, arguments.all);
    let verdicts = SubmissionVerdicts::of(case, &run, false);
    let mut verdicts = verdicts.ok_or_else(|| Failure::bug("a submission without its code"))?;
    let changes = before.map(|before| {
        let gates = verdicts.judged.iter().map(|of| &of.gate);
        metrics::changes(Some(&index), gates, [&before.metrics, &verdicts.metrics])
    });
    if let Some(baseline) = &baseline {
        exit = baseline.exit(changes.as_deref().unwrap_or_default(), exit);
        text += &changes.as_deref().map_or(String::new(), |changes| baseline.in_words(changes));
    }
    verdicts.baseline = changes;
    judged::write_junit_of_submission(&verdicts, arguments.junit.as_deref())?;
    let kept = baseline.as_ref().map(|of| of.update(&run.record)).transpose()?.flatten();
    match arguments.json {
        true => output::print_whole(&judged::json_of_submission(&verdicts)?)?,
        false => output::print(&text)?,
    }
    output::say(&said);
    kept.iter().for_each(|kept| output::say(kept));
    Ok(exit)
}

/// Keeps the record of a submission. A stored record of equal results must be equal: a record proves nothing
/// beyond its results.
fn keep(store: &Store, record: &Record) -> Result<PathBuf, Failure> {
    match store.find(&record.spec()) {
        Ok(Some(before)) if before.manifest.sources == record.manifest.sources => {
            let differ = differences(&before, record);
            if !differ.is_empty() {
                let path = store.path().join(Store::name(&record.spec()));
                return Err(Failure::usage(format!(
                    "{} has the same method and results, but differs: {}; nothing was recorded; remove that \
                     file to replace it by this record",
                    path.display(),
                    differ.join(", ")
                )));
            }
        }
        Ok(Some(_)) => output::say("note: a record by a build of other sources is replaced"),
        Ok(None) => {}
        Err(error) => output::say(&format!("note: {error}; it is replaced")),
    }
    Ok(store.write(record)?)
}

/// Differences between two records, by name.
fn differences(before: &Record, now: &Record) -> Vec<String> {
    let value = |of: &Record, name: &str| match of.metrics.get(name) {
        Some(metric) => format!("{:?}", metric.value),
        None => "not measured".into(),
    };
    let names: BTreeSet<&String> = before.metrics.keys().chain(now.metrics.keys()).collect();
    let moved = names.into_iter().filter_map(|name| {
        let [was, is] = [before, now].map(|of| value(of, name));
        (was != is).then(|| format!("{name} ({was} there, {is} by the results)"))
    });
    let mut all: Vec<String> = moved.take(MOST_DIFFERENCES).collect();
    let others = [
        ("how the run ended", before.status != now.status),
        ("machine", before.numerics != now.numerics),
        ("cost", format!("{:?}", before.cost) != format!("{:?}", now.cost)),
    ];
    all.extend(others.iter().filter(|(_, differ)| *differ).map(|(name, _)| name.to_string()));
    all
}

/// Number of different metrics that are named.
const MOST_DIFFERENCES: usize = 3;

/// Names of columns, ours by theirs.
///
/// # Errors
/// If one is given twice.
pub fn renamed(map: &[(String, String)]) -> Result<Renamed, Failure> {
    let mut renamed = Renamed::new();
    for (ours, theirs) in map {
        let is_named = renamed.values().any(|of| of == ours);
        if is_named || renamed.insert(theirs.clone(), ours.clone()).is_some() {
            let words =
                format!("--map {ours}={theirs}: {ours} or {theirs} is named twice; expected once");
            return Err(Failure::usage(words));
        }
    }
    Ok(renamed)
}

/// The submission in a folder, with columns of other names.
fn read(folder: &Path, map: &[(String, String)]) -> Result<Entry, Failure> {
    submission::read(folder, &renamed(map)?).map_err(refused)
}

/// The run that a document asks for.
fn spec_of(case: &dyn Case, asked: &ProblemDocument) -> Result<RunSpec, Failure> {
    let RunSpec { case: name, variant, settings, measure, .. } = asked.spec.clone();
    let plain = RunSpec { measure, ..RunSpec::new(&name, &variant, settings) };
    if name != case.name() {
        let words = format!("problem.json is of the case {}, not of {}", short(&name), case.name());
        return Err(Failure::usage(words));
    }
    if plain != asked.spec {
        let words = "problem.json has more than a run of a variant with settings; expected the document as \
                     it was exported";
        return Err(Failure::usage(words));
    }
    Ok(case::resolved(case, plain)?)
}

/// Compares the results of another code for two observers of a problem, the first of relation `same`.
pub fn relate(
    case: &str,
    [base, turned]: [&Path; 2],
    map: &[(String, String)],
    allow_long: bool,
    session: &Session,
) -> Outcome {
    let case = touchstone_cases::find_in(session.cases, case)?;
    let observed = |folder: &Path| -> Result<_, Failure> {
        let entry = read(folder, map)?;
        let usage = |what: &str| Failure::usage(format!("{}: {what}", folder.display()));
        let none = || usage("expected a problem.json that `export --relation` wrote");
        let asked = entry.asked.as_ref().ok_or_else(none)?;
        let by = Relation::named(asked.relation.as_ref().ok_or_else(none)?);
        let by = by.map_err(|what| usage(&format!("relation: {what}")))?;
        let problem = ExportedProblem::seen(case, spec_of(case, asked)?, Some(by), allow_long)?;
        asked.agrees(&problem).map_err(|flaw| refused(vec![flaw]))?;
        entry
            .results
            .notes()
            .iter()
            .for_each(|note| output::say(&format!("{}: {note}", folder.display())));
        entry.check(&problem).map_err(refused)?;
        if let Some(far) = symmetry::far_away((&problem.outline, &entry.results.frames)) {
            let (file, line) = &entry.results.places[far.frame];
            return Err(refused(vec![Flaw::of(file, far.words).at(line + far.row as u64)]));
        }
        if let Some(few) = entry.few_digits(&problem) {
            let words = format!(
                "the comparison to round-off needs these quantities, which are missing: {few}"
            );
            return Err(usage(&words));
        }
        Ok((entry, problem, by))
    };
    let ((ours, same, first), (theirs, other, by)) = (observed(base)?, observed(turned)?);
    if first != Relation::Same || same.spec.key() != other.spec.key() {
        return Err(Failure::usage(format!(
            "expected two problems of the same variant and settings, the first of relation same; the first \
             is {}, relation {}; the second {}, relation {}",
            same.spec.variant,
            first.name(),
            other.spec.variant,
            by.name()
        )));
    }
    let most = symmetry::most_steps(&same.outline, &other.outline);
    let mut steps: f64 = 1.0;
    for (entry, problem, folder) in [(&ours, &same, base), (&theirs, &other, turned)] {
        steps = steps.max(entry.steps(problem));
        if steps > most {
            return Err(Failure::usage(format!(
                "{}: steps of {SYSTEM} is {steps}, after which round-off would explain any error; a \
                 comparison is a test after at most {most} steps",
                folder.display()
            )));
        }
    }
    let (ours, theirs) = (&*ours.results.frames, &*theirs.results.frames);
    let found = symmetry::difference((&same.outline, ours), (&other.outline, theirs), steps);
    super::symmetry::show(vec![super::symmetry::row(case, &same.spec, by, &found)])?;
    Ok(if found.is_round_off() { Exit::Pass } else { Exit::GateFailed })
}

/// The problem that the folder states, or that the arguments describe.
fn problem(
    case: &dyn Case,
    entry: &Entry,
    how: &arguments::Submission,
) -> Result<ExportedProblem, Failure> {
    let is_given = how.variant.is_some() || !how.set.is_empty();
    let spec: RunSpec = match &entry.asked {
        Some(_) if is_given => {
            let words = "the folder has a problem.json, which states variant and settings; leave out \
                         --variant and --set";
            return Err(Failure::usage(words));
        }
        Some(asked) if asked.relation.is_some() => {
            let words = "problem.json was written by `export --relation` and has only a few steps; \
                         `touchstone symmetry --results` compares them";
            return Err(Failure::usage(words));
        }
        Some(asked) => spec_of(case, asked)?,
        None => {
            let variant = how.variant.as_deref().unwrap_or(case.recommended().variant);
            case::spec(case, variant, &how.set)?
        }
    };
    let sealed = entry.asked.as_ref().and_then(|asked| asked.sealed.as_ref());
    let check = |sealed| challenge::check(case, sealed, &entry.method, &spec);
    sealed.map_or(Ok(()), check).map_err(Failure::usage)?;
    let mut problem = ExportedProblem::seen(case, spec, None, how.allow_long)?;
    if let Some(sealed) = sealed {
        problem = problem.sealed(case, sealed.clone());
    }
    let agrees = entry.asked.as_ref().map_or(Ok(()), |asked| asked.agrees(&problem));
    agrees.map_err(|flaw| refused(vec![flaw]))?;
    Ok(problem)
}

/// All flaws as the reason why nothing is judged.
fn refused(flaws: Vec<Flaw>) -> Failure {
    let lines: Vec<String> = lines(&flaws).iter().map(|line| format!("  {line}")).collect();
    Failure::usage(format!(
        "the submission is refused, and nothing is judged:\n{}",
        lines.join("\n")
    ))
}
