//! The runs of one case in a store: their errors and costs in a table, without judgement.

use std::collections::{BTreeMap, BTreeSet};

use touchstone_base::{
    record::{MetricName, Record},
    settings::{Field, Value},
};
use touchstone_report::{Cell, Figure, Table, TableColumn, code, sig};

use super::{
    Card, Studies, anchor,
    cost::{LadderPoint, Line, RefiningSetting, error_of, panel},
};
use crate::{
    case::{self, Case},
    runs::Tier,
    section::Section,
};

/// A run and the settings in which it differs from the defaults of its variant, but for its resolution.
struct SweepRow<'a> {
    record: &'a Record,
    /// Place of its variant in the list of the case.
    place: usize,
    others: Vec<String>,
    point: LadderPoint,
}

/// A table of the errors and costs of these runs of a case, and a figure of errors over costs: a line for the
/// runs that differ in their resolution alone.
pub fn section(case: &dyn Case, records: &[Record]) -> Section {
    let studies = case.studies(Tier::Quick);
    let error = studies.error();
    let resolution = RefiningSetting::of(case, &studies);
    let mut rows: Vec<SweepRow> =
        records.iter().map(|of| row(case, of, error, resolution.as_ref())).collect();
    let coarser = |a: &SweepRow, b: &SweepRow| b.point.spacing.total_cmp(&a.point.spacing);
    rows.sort_by(|a, b| {
        (a.place, &a.others).cmp(&(b.place, &b.others)).then_with(|| coarser(a, b))
    });
    let id = anchor(case.name(), "sweep");
    let section = Section::new(&id, &format!("Runs of {}", case.name()));
    let section = match error {
        Some(error) => section.block(figure(&id, error, &rows)),
        None => section,
    };
    section.block(table(case, &studies, &rows))
}

fn row<'a>(
    case: &dyn Case,
    record: &'a Record,
    error: Option<&MetricName>,
    resolution: Option<&RefiningSetting>,
) -> SweepRow<'a> {
    let mut others = case::changes(case, &record.spec());
    others.retain(|(field, _)| resolution.is_none_or(|of| of.setting.name != field.name));
    let value = resolution.and_then(|of| of.value(&record.run.settings));
    let mut seconds = record.cost.alone_s.clone();
    if seconds.is_empty() {
        seconds.push(record.cost.cpu_s);
    }
    seconds.sort_by(f64::total_cmp);
    let point = LadderPoint {
        spacing: resolution.zip(value).map_or(f64::NAN, |(of, value)| of.spacing(value)),
        label: value.map(touchstone_report::exact).unwrap_or_default(),
        error: error.and_then(|error| error_of(error, record)).unwrap_or(f64::NAN),
        seconds,
        pairs: record.cost.pair_interactions as f64,
    };
    let place = case.variants().iter().position(|variant| variant.name == record.run.variant);
    let others = others.into_iter().map(case::assignment).collect();
    SweepRow { record, place: place.unwrap_or(usize::MAX), others, point }
}

/// Errors over run time and over pair interactions.
fn figure(id: &str, error: &MetricName, rows: &[SweepRow]) -> Figure {
    let of_line = |a: &SweepRow, b: &SweepRow| (a.place, &a.others) == (b.place, &b.others);
    let line = |rows: &[SweepRow]| {
        let name = format!("{} {}", rows[0].record.run.variant, rows[0].others.join(" "));
        (name.trim_end().to_string(), rows.iter().map(|row| row.point.clone()).collect::<Vec<_>>())
    };
    let lines: Vec<(String, Vec<LadderPoint>)> = rows.chunk_by(of_line).map(line).collect();
    let lines: Vec<Line> = lines.iter().map(|(name, points)| Line { name, points }).collect();
    let name = code(&error.name);
    let caption =
        format!("The error {name} over run time on one core (left) and over work (right).");
    let title = "Error against run time";
    let time =
        panel([title, "run time on one core [s]", &error.name], &lines, LadderPoint::median, true);
    let title = "Error against work";
    let work = panel([title, "pair interactions [-]", ""], &lines, |point| point.pairs, false);
    let figure = Figure::new(format!("{id}-cost"), caption).columns(2).panel_size(420.0, 300.0);
    figure.panel(time).panel(work)
}

/// A row a run. A column for each setting that is changed in some run.
fn table(case: &dyn Case, studies: &Studies, rows: &[SweepRow]) -> Table {
    let changes = rows.iter().flat_map(|row| case::changes(case, &row.record.spec()));
    let changed: BTreeSet<&str> = changes.map(|(field, _)| field.name).collect();
    let mut fields: Vec<&Field> = case.fields().iter().collect();
    fields.retain(|field| changed.contains(field.name));
    let mut columns = vec![TableColumn::text("variant")];
    columns.extend(fields.iter().map(|field| TableColumn::num(code(field.name), "")));
    columns.push(TableColumn::text("error"));
    columns.extend([TableColumn::num("run time", ""), TableColumn::num("pairs", "")]);
    columns.extend([
        TableColumn::num("particles", ""),
        TableColumn::num("steps", ""),
        TableColumn::text("ended"),
    ]);
    let mut formulas = BTreeMap::new();
    let cells = |row: &SweepRow| {
        let SweepRow { record, point, .. } = row;
        let mut cells = vec![Cell::marked(code(&record.run.variant))];
        let values = fields.iter().map(|field| field.of_json(&record.run.settings));
        cells.extend(values.map(|value| value.map_or_else(|| Cell::text("–"), setting)));
        cells.push(error_in_words(studies, point, record));
        cells.push(Cell::seconds(point.median()));
        cells.push(Cell::sci(point.pairs, 2));
        let [particles, steps] = [record.cost.particles as u64, record.cost.steps];
        cells.extend([Cell::count(particles), Cell::count(steps)]);
        cells.push(Cell::text(record.status.to_string()));
        cells
    };
    let metric = studies.error();
    let formula = rows.iter().filter_map(|row| row.record.metrics.get(&metric?.name));
    formula.for_each(|of| *formulas.entry(of.formula.clone()).or_insert(0) += 1);
    let error = match (metric, formulas.keys().next()) {
        (Some(metric), Some(formula)) => format!("Error: {} = {formula}. ", code(&metric.name)),
        _ => "The case states no error. ".to_string(),
    };
    let caption = format!(
        "{error}Run time: processor time of the time steps on one core. No gate is judged. Settings that \
         have the default of their variant in every run are not shown."
    );
    let table = Table::new(caption, columns);
    rows.iter().map(cells).fold(table, Table::row)
}

/// The error as the case states it.
fn error_in_words(studies: &Studies, point: &LadderPoint, record: &Record) -> Cell {
    let stated = studies.first::<Card>().map(|card| (card.stated)(&record.run));
    match stated {
        _ if point.error.is_nan() => Cell::text("–"),
        Some(stated) => Cell { value: Some(point.error), ..Cell::text(stated.number(point.error)) },
        None => Cell { value: Some(point.error), ..Cell::text(sig(point.error, 3)) },
    }
}

fn setting(value: Value) -> Cell {
    value.number().map_or_else(|| Cell::text(value.to_string()), Cell::exact)
}
