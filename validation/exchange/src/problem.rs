//! A problem as a document: every number with its unit, every equation with its text.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use touchstone_base::{
    gate::Gate,
    record::{self, MetricName, Profile, ProfileColumn},
    settings::{self, Field},
    spec::RunSpec,
    text::short,
};
use touchstone_harness::{
    case::{self, Case, RunError},
    facts::{Facts, Parameter, SubmittedCurve},
    foreign::ForeignParticle,
    gates::GateIndex,
    method::{Medium, MediumSetting, Properties},
    outline::Outline,
    relation::{Relation, SI, Units},
    sealed,
};

use crate::flaw::Flaw;

/// Version of `problem.json`; raised with every change that an older reader would misread.
pub const SCHEMA: u32 = 1;

/// Name of the document in the folder of a problem.
pub const PROBLEM: &str = "problem.json";

/// Name of the table of a profile or series that a code may submit.
pub const CURVE: &str = "curve.csv";
/// The field that lists its gates.
const JUDGED_BY: &str = "judged_by";
/// Name of the table of its particles.
pub const PARTICLES: &str = "particles.csv";

/// A problem and the run of ours that it is taken from.
pub struct ExportedProblem {
    /// The run.
    pub spec: RunSpec,
    /// The problem in words.
    pub about: &'static str,
    /// Scene and drive.
    pub outline: Outline,
    /// Gates that judge a run of another code with these settings.
    pub gates: Vec<Gate>,
    /// The settings that the variant reads.
    pub fields: Vec<&'static Field>,
    /// The command of the nearest run with a gate for results of another code, if this one has none.
    pub nearest: Option<String>,
    /// The conditions at walls, clamps and surfaces in words.
    pub boundary: &'static str,
    /// Drives in addition to the acceleration.
    pub further: Vec<Parameter>,
    /// Every metric that is measured of results.
    pub metrics: Vec<MetricName>,
    /// Profile or series that may be submitted in place of particles.
    pub curve: Option<SubmittedCurve>,
    /// Origin of a sealed problem.
    pub sealed: Option<Sealed>,
    /// Relation of the observer, if observers are compared.
    pub relation: Option<Relation>,
}

/// Origin of a sealed problem.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sealed {
    /// the seed
    pub seed: u64,
    /// SHA-256 of the code, version, scheme, division and settings of the method at that time
    pub method: String,
}

/// The files of a submission.
const HAND_IN: &str = "A folder with these files:\n\n\
    - `method.json`: `{\"code\": \"...\", \"version\": \"...\", \"scheme\": \"...\", \"division\": \
    \"closed\", \"settings\": {...}, \"changed\": \"what differs from the problem\"}`. The division is \
    `closed` if particles, spacing and support of the kernel are those of the problem, else `open`. Bounds \
    that follow from the theory of our method judge a closed run whose settings state its `kernel`, \
    `support` [m] and `dt` [s]: `kernel`, `support_radius` and `time_step` of `our_method` in \
    `problem.json`.\n\
    - `system.json`: `{\"machine\": \"...\", \"threads\": 1, \"seconds\": 1.5, \"steps\": 1000, \
    \"interactions\": \"unknown\"}`. Each may be \"unknown\"; seconds are those of the time loop.\n\
    - `results.csv` with the columns `t[s],id,x[m],y[m],u[m/s],v[m/s],density[kg/m^3]`, sorted by t, every \
    moving particle at each of the times below. Other formats: LAMMPS dump, `.vtu`, `.vtp`; \
    `touchstone_sph.convert` reads more.\n";

/// The requested run, as read from the document.
#[derive(Debug, Clone, Deserialize)]
pub struct ProblemDocument {
    /// version of the document
    pub schema: u32,
    /// the run
    pub spec: RunSpec,
    /// origin of a sealed problem
    #[serde(default)]
    pub sealed: Option<Sealed>,
    /// name of the relation of the observer
    #[serde(default)]
    pub relation: Option<String>,
    /// other content of the document
    #[serde(flatten)]
    rest: Map<String, Value>,
}

impl ProblemDocument {
    /// Checks that the numbers of the document are the numbers of its spec. Its prose may belong to another
    /// version, and it may have more keys than ours.
    ///
    /// # Errors
    /// The first field that differs.
    pub fn agrees(&self, problem: &ExportedProblem) -> Result<(), Flaw> {
        let ours = problem.to_json();
        let both = self.rest.iter().filter_map(|(key, stated)| Some((key, stated, ours.get(key)?)));
        let (gates, facts): (Vec<_>, Vec<_>) = both.partition(|(key, ..)| *key == JUDGED_BY);
        let mut found =
            facts.into_iter().filter_map(|(key, stated, ours)| contradiction(key, stated, ours));
        let found = found
            .next()
            .or_else(|| gates.first().and_then(|(_, stated, ours)| bound(stated, ours)));
        found.map_or(Ok(()), |(field, stated, ours)| {
            let [stated, ours] = [stated, ours].map(|value| short(&value.to_string()));
            let what = format!(
                "it is {stated}, and the settings of its spec give {ours}; expected the document as this \
                 program exports it"
            );
            Err(Flaw::of(PROBLEM, what).in_column(field))
        })
    }
}

/// Where a document and ours say different things: the field and both.
type Contradiction<'a> = (String, &'a Value, &'a Value);

/// The first number, unit or length of a list that differs, except for the last digits.
fn contradiction<'a>(field: &str, stated: &'a Value, ours: &'a Value) -> Option<Contradiction<'a>> {
    let differs = match (stated, ours) {
        (Value::Object(stated), Value::Object(ours)) => {
            let both = stated.iter().filter_map(|(key, value)| Some((key, value, ours.get(key)?)));
            let mut of = both.map(|(key, a, b)| contradiction(&format!("{field}.{key}"), a, b));
            return of.find_map(|found| found);
        }
        // Lists of named items may be longer or shorter in another version.
        (Value::Array(stated), Value::Array(ours))
            if !ours.is_empty() && ours.iter().all(|of| of["name"].is_string()) =>
        {
            let same = |of: &Value| ours.iter().find(|ours| ours["name"] == of["name"]);
            let both = stated.iter().enumerate().filter_map(|(k, of)| Some((k, of, same(of)?)));
            let mut of = both.map(|(k, a, b)| contradiction(&format!("{field}[{k}]"), a, b));
            return of.find_map(|found| found);
        }
        (Value::Array(stated), Value::Array(ours)) if stated.len() == ours.len() => {
            let both = stated.iter().zip(ours).enumerate();
            let mut of = both.map(|(k, (a, b))| contradiction(&format!("{field}[{k}]"), a, b));
            return of.find_map(|found| found);
        }
        (Value::Number(stated), Value::Number(ours)) => {
            let [stated, ours] = [stated, ours].map(|n| n.as_f64().unwrap_or(f64::MAX));
            (stated - ours).abs() > 1e-12 * ours.abs()
        }
        (Value::String(stated), Value::String(ours)) => field.ends_with(".unit") && stated != ours,
        (stated, ours) => stated != ours,
    };
    differs.then(|| (field.into(), stated, ours))
}

/// The first gate of the document whose bound is another one today.
fn bound<'a>(stated: &'a Value, ours: &'a Value) -> Option<Contradiction<'a>> {
    let ours = ours.as_array()?;
    stated.as_array()?.iter().find_map(|gate| {
        let today = ours.iter().find(|of| of["id"] == gate["id"])?;
        let field = format!("{JUDGED_BY} {}", gate["id"].as_str().unwrap_or_default());
        contradiction(&field, &gate["bound"], &today["bound"])
    })
}

/// The settings that the variant of a run reads: others are refused if they are set.
fn fields_read(case: &dyn Case, spec: &RunSpec) -> Vec<&'static Field> {
    let is_read = |field: &&Field| {
        let text = spec.settings.get(field.name).map(settings::text).unwrap_or_default();
        let set = case.settings(&spec.variant, &[format!("{}={text}", field.name)]);
        !matches!(set, Err(RunError::Unused { .. }))
    };
    case.fields().iter().filter(is_read).collect()
}

/// A number with its unit.
fn with_unit(value: impl Serialize, unit: &str) -> Value {
    json!({ "value": value, "unit": unit })
}

impl ExportedProblem {
    /// The problem of a run.
    ///
    /// # Errors
    /// If the run is refused, or has no scene, or its particles take more memory than a run may.
    pub fn of(case: &dyn Case, spec: RunSpec) -> Result<Self, RunError> {
        Self::seen(case, spec, None, false)
    }

    /// The problem at a few early times in the frame of another observer, if there is a relation.
    ///
    /// # Errors
    /// As [`ExportedProblem::of`], of the memory unless it is allowed, or if the relation is not a
    /// symmetry of the problem.
    pub fn seen(
        case: &dyn Case,
        spec: RunSpec,
        relation: Option<Relation>,
        allow_long: bool,
    ) -> Result<Self, RunError> {
        let outline = case.pose(&spec)?.outline(&spec, relation, allow_long)?;
        let Facts { statement, curve, stepwise, of_methods, costly, .. } = case.facts();
        let ours = [stepwise, of_methods, costly].concat();
        let (mut gates, mut metrics) = (Vec::new(), Vec::new());
        let (mut further, mut fields, mut nearest) = (Vec::new(), Vec::new(), None);
        // Results of other observers are compared, not measured, and settings are in the frame of the first
        // one.
        if relation.is_none() {
            let index = GateIndex::of(case);
            gates = index.gates(&spec);
            gates.retain(|gate| !record::is_of(&ours, &gate.metric));
            metrics = statement.metrics;
            metrics.retain(|metric| !record::is_of(&ours, &metric.name));
            further = statement.further.map_or_else(Vec::new, |of| of(&spec));
            fields = fields_read(case, &spec);
            if gates.is_empty() {
                let judges = |gate: Gate| {
                    let gate = gate.for_submission(false)?;
                    (!record::is_of(&ours, &gate.metric)).then_some(gate)
                };
                nearest = index.nearest(&spec, &judges).map(|(of, _)| case::command(case, &of));
            }
        }
        let (about, boundary, sealed) = (case.about(), statement.boundary, None);
        let curve = curve.filter(|_| relation.is_none());
        Ok(Self {
            spec,
            about,
            outline,
            gates,
            fields,
            nearest,
            boundary,
            further,
            metrics,
            curve,
            sealed,
            relation,
        })
    }

    /// The times of its particles \[s\]: times of measurement, or as many as its path needs.
    pub fn times(&self) -> Vec<f64> {
        let times = &self.outline.times;
        match (self.curve.as_ref().map_or(0, |curve| curve.least), times.last()) {
            (least, Some(end)) if least > times.len() => {
                (1..=least).map(|k| end * k as f64 / least as f64).collect()
            }
            _ => times.clone(),
        }
    }

    /// The sealed problem, with gates that follow from the bounds of judged runs.
    #[must_use]
    pub fn sealed(mut self, case: &dyn Case, sealed: Sealed) -> Self {
        self.gates = sealed::gates(&GateIndex::of(case), &self.spec);
        Self { sealed: Some(sealed), ..self }
    }

    /// The particles that the other code moves: their numbers in the problem.
    pub fn moving(&self) -> Vec<u32> {
        let roles = self.outline.particles.column("role").iter().enumerate();
        roles.filter(|(_, role)| **role == 0.0).map(|(k, _)| k as u32).collect()
    }

    /// The particle with this number at the start, if there is one.
    pub fn start_of(&self, id: u32) -> Option<ForeignParticle> {
        let value = |name| self.outline.particles.column(name).get(id as usize).copied();
        let position = Vector2::new(value("x")?, value("y")?);
        let velocity = Vector2::new(value("u")?, value("v")?);
        Some(ForeignParticle { id, position, velocity, density: Some(value("density")?) })
    }

    /// Is the material an elastic solid?
    pub fn is_solid(&self) -> bool {
        self.outline.medium.shear_modulus > 0.0
    }

    /// The document.
    pub fn to_json(&self) -> Value {
        let Outline { medium: m, domain, mirrors, dt, method, .. } = &self.outline;
        let times = self.times();
        let plane = |wall: &touchstone_solver::PlaneWall| {
            json!({
                "point": with_unit(wall.point.as_slice(), "m"),
                "normal_into_the_material": with_unit(wall.normal.as_slice(), "-"),
                "velocity": with_unit(wall.velocity.as_slice(), "m/s"),
            })
        };
        let gate =
            |gate: &Gate| json!({ "id": gate.id, "metric": gate.metric, "bound": gate.bound });
        let equation = |(name, text): &(&str, &str)| json!({ "name": name, "text": text });
        let column = |column: &ProfileColumn| json!({ "name": column.name, "unit": column.unit });
        let mut document = json!({
            "schema": SCHEMA,
            "spec": self.spec.to_value(),
            "about": self.about,
            "dimensions": 2,
            "equations": self.equations().iter().map(equation).collect::<Vec<_>>(),
            "material": material(m, method),
            "acceleration": with_unit(m.acceleration.as_slice(), "m/s^2"),
            "domain": {
                "low": with_unit(domain.low.as_slice(), "m"),
                "period": domain.period.map(|p| p.map_or(json!("none"), |p| with_unit(p, "m"))),
            },
            "walls": {
                "planes": mirrors.iter().map(plane).collect::<Vec<_>>(),
                "of_particles": "particles of role 1 or 2, at rest or with their velocity along the wall",
            },
            "particles": {
                "file": PARTICLES,
                "count": self.outline.particles.column("id").len(),
                "spacing": with_unit(m.dx, "m"),
                "roles": { "0": "moves", "1": "behind a wall", "2": "on a wall" },
                "columns": self.particles().columns.iter().map(column).collect::<Vec<_>>(),
            },
            "times": with_unit(&times, "s"),
            "end": with_unit(times.last(), "s"),
            JUDGED_BY: self.gates.iter().map(gate).collect::<Vec<_>>(),
            "our_method": {
                "kernel": method.kernel,
                "smoothing_length": with_unit(m.h, "m"),
                "support_radius": with_unit(method.support * m.h, "m"),
                "integrator": method.integrator,
                "walls": method.walls,
                "time_step": with_unit(dt, "s"),
                "terms": method.terms,
            },
        });
        self.state(&mut document);
        if let Some(sealed) = &self.sealed {
            document["sealed"] = json!(sealed);
        }
        if let Some(relation) = self.relation {
            document["relation"] = json!(relation.name());
        }
        document
    }

    /// Adds everything but the scene: boundaries, drive, settings, metrics, the curve in place of particles.
    fn state(&self, document: &mut Value) {
        let stated = |name: &str, value: Value, [unit, about]: [&str; 2]| {
            let mut all = json!({ "name": name, "unit": unit, "about": about });
            all["value"] = value;
            all
        };
        let fact = |of: &Parameter| stated(of.name, json!(of.value), [of.unit, of.about]);
        let setting = |(field, value): (&Field, &Value)| {
            stated(field.name, value.clone(), [field.unit, field.doc])
        };
        let metric = |of: &MetricName| json!({ "name": of.name, "unit": of.unit(), "formula": of.formula() });
        document["boundary"] = json!(self.boundary);
        document["further"] = self.further.iter().map(fact).collect();
        document["settings"] = self.settings().map(setting).collect();
        document["metrics"] = self.metrics.iter().map(metric).collect();
        if let Some(curve) = &self.curve {
            let column = |(name, unit): &(&str, &str)| json!({ "name": name, "unit": unit });
            document["curve"] = json!({
                "file": CURVE,
                "columns": curve.columns.iter().map(column).collect::<Vec<_>>(),
                "rows_at_a_time": (curve.rows)(&self.spec),
                "least_times": curve.least,
                "about": curve.about,
            });
        }
    }

    /// All particles, with the number of the body to which each belongs if there are bodies.
    pub fn particles(&self) -> Profile {
        let Outline { particles, bodies, .. } = &self.outline;
        let bodies: Vec<f64> = bodies.iter().map(|body| f64::from(*body)).collect();
        let particles = particles.clone();
        if bodies.is_empty() { particles } else { particles.with("body", "-", bodies) }
    }

    /// The settings that the variant reads, with their values in this run.
    pub fn settings(&self) -> impl Iterator<Item = (&Field, &Value)> {
        let value = |field: &&'static Field| Some((*field, self.spec.settings.get(field.name)?));
        self.fields.iter().filter_map(value)
    }

    /// The equations in words.
    pub fn equations(&self) -> Vec<(&'static str, &'static str)> {
        let continuity = ("continuity", "dρ/dt = -ρ ∇·v");
        if let Some(energy) = self.outline.method.law {
            let momentum = "ρ0 dv/dt = ∇·P + ρ0 g, P = ∂w/∂F, in the configuration without stress; F = \
                            ∂x/∂X, J = det F";
            let mut all =
                vec![continuity, ("momentum", momentum), ("stored energy, plane strain", energy)];
            let deviator = "dev A = A - (A_xx + A_yy + A_zz) I/3 of three dimensions, A_zz = 0 for plane \
                            strain: |dev A|² = A_xx² + A_yy² + 2 A_xy² - (A_xx + A_yy)²/3";
            all.extend(energy.contains("dev ").then_some(("deviator", deviator)));
            return all;
        }
        if self.is_solid() {
            let material = "p = c0² (ρ - ρ0); dS/dt = 2 μ (ε̇ - tr(ε̇) I/3) + S·Ωᵀ + Ω·S (Jaumann rate); S \
                            of three dimensions, S_zz = -(S_xx + S_yy)";
            let momentum = ("momentum", "dv/dt = (1/ρ) ∇·σ + g, σ = -p I + S");
            return vec![continuity, momentum, ("material, plane strain", material)];
        }
        vec![
            continuity,
            ("momentum", "dv/dt = -(1/ρ) ∇p + ν ∇²v + g"),
            ("state", "p = p_b + (ρ0 c0²/γ) ((ρ/ρ0)^γ - 1)"),
        ]
    }

    /// In which units numbers are.
    fn units(&self) -> String {
        let units @ Units { length, time, mass } = self.outline.view.units();
        if units == SI {
            return "All numbers are in SI units, in two dimensions, masses per unit depth.".into();
        }
        format!(
            "All numbers are in the units of this reference frame, in two dimensions, masses per unit \
             depth: where a head or `{PROBLEM}` says m, s or kg/m, read {length} m, {time} s or {mass} \
             kg/m."
        )
    }

    /// A page that a person can work from.
    pub fn page(&self) -> String {
        let (case, variant) = (&self.spec.case, &self.spec.variant);
        let further = |of: &Parameter| {
            [of.name.into(), of.value.to_string(), of.unit.into(), of.about.into()]
        };
        let setting = |(field, value): (&Field, &Value)| {
            [field.name.into(), settings::text(value), field.unit.into(), field.doc.into()]
        };
        let metric = |of: &MetricName| [format!("`{}`", of.name), of.unit().into(), of.formula()];
        let measured = ["metric", "unit", "formula"];
        let parts = [
            format!("# {case}, variant {variant}\n\n{}\n\n{}", self.about, self.units()),
            format!("`{PROBLEM}` has every number with its unit."),
            "## Equations".into(),
            list(self.equations().iter().map(|(name, text)| format!("{name}: {text}"))),
            format!("Boundaries: {}", self.boundary),
            "## Material and forces".into(),
            self.quantities(),
            titled("## What drives it", HEAD, self.further.iter().map(further)),
            titled("## Settings", HEAD, self.settings().map(setting)),
            "## Particles".into(),
            format!(
                "`{PARTICLES}` has one line a particle. Role 0 moves; role 1 is behind a wall and role 2 on \
                 it, and neither moves except along the wall with its velocity. Axes with a period repeat."
            ),
            "## Our method".into(),
            self.ours(),
            list(self.outline.method.terms.iter().map(|term| (*term).into())),
            format!("## What to hand in\n\n{HAND_IN}{}", self.of_curve()),
            self.then(),
            titled("## What is measured", measured, self.metrics.iter().map(metric)),
            "## How it is judged".into(),
            self.judged(),
        ];
        let said = parts.iter().filter(|part| !part.is_empty());
        said.map(|part| format!("{}\n", part.trim_end())).collect::<Vec<_>>().join("\n")
    }

    /// The table of material and forces.
    fn quantities(&self) -> String {
        let m = &self.outline.medium;
        let quantity = |(name, value): (&String, &Value)| {
            let unit = value["unit"].as_str().unwrap_or_default();
            [name.replace('_', " "), value["value"].to_string(), unit.into()]
        };
        let material = material(m, &self.outline.method);
        let [gx, gy] = [m.acceleration.x, m.acceleration.y];
        let end = self.outline.times.last().copied().unwrap_or_default();
        let more = [
            ["acceleration g".into(), format!("{gx}, {gy}"), "m/s^2".into()],
            ["spacing of particles".into(), m.dx.to_string(), "m".into()],
            ["end".into(), end.to_string(), "s".into()],
        ];
        let all = material.as_object().into_iter().flatten().map(quantity).chain(more);
        table(["quantity", "value", "unit"], all)
    }

    /// Our method, of which the closed division takes the support radius.
    fn ours(&self) -> String {
        let Outline { method, medium: m, dt, .. } = &self.outline;
        format!(
            "The closed division requires these particles, spacing and support radius; all else is free. \
             Kernel: {}, smoothing length h = {} m, support radius {} m. Integrator: {}, time step {dt} s. \
             Walls: {}. Terms:",
            method.kernel,
            m.h,
            method.support * m.h,
            method.integrator,
            method.walls
        )
    }

    /// The gates, or why there is none.
    fn judged(&self) -> String {
        let gate = |gate: &Gate| {
            [format!("`{}`", gate.id), format!("`{}`", gate.metric), gate.bound.to_string()]
        };
        match (self.gates.is_empty(), self.relation) {
            (false, _) => table(["gate", "metric", "bound"], self.gates.iter().map(gate)),
            (true, Some(_)) => "No gate judges it: two reference frames are compared.".into(),
            (true, None) => self.unjudged().unwrap_or_default(),
        }
    }

    /// A note that no gate judges results of another code, and a problem with gates; `None` if there are
    /// gates.
    pub fn unjudged(&self) -> Option<String> {
        let is_judged = !self.gates.is_empty() || self.relation.is_some();
        let of = |run: &String| {
            let export = run.replacen("touchstone run", "touchstone export", 1);
            format!("The nearest problem that is judged: `{export} --out DIR`.")
        };
        let other = self.nearest.as_ref().map(of);
        let other = other.unwrap_or_else(|| "No settings of this case have such a gate.".into());
        (!is_judged).then(|| {
            format!(
                "No gate judges results of another code with these settings: they are measured, and nothing \
                 is judged. {other}"
            )
        })
    }

    /// Profile or series that may be submitted in place of particles.
    fn of_curve(&self) -> String {
        let Some(curve) = &self.curve else { return String::new() };
        let columns = curve.columns.iter().map(|(name, unit)| format!(",{name}[{unit}]"));
        let times = match curve.least {
            0 => "the times below".into(),
            least => format!("at least {least} times, equally far apart, until the end"),
        };
        format!(
            "- In place of the particles there may be `{CURVE}` with the columns `t[s]{}`, {} a time, at \
             {times}: {}. Metrics that need particles are not measured then.\n",
            columns.collect::<String>(),
            match (curve.rows)(&self.spec) {
                1 => "one line".into(),
                rows => format!("{rows} lines"),
            },
            curve.about,
        )
    }

    /// The document itself, the command that measures results, and their times.
    fn then(&self) -> String {
        let case = &self.spec.case;
        let then = match self.relation.map(Relation::name) {
            None => format!("`touchstone submit {case} DIR --store STORE` measures and judges it."),
            Some(by) => format!(
                "All numbers are in another reference frame ({by}), and `touchstone symmetry {case} \
                 --results SAME DIR` compares it."
            ),
        };
        let times: Vec<String> = self.times().iter().map(f64::to_string).collect();
        format!("- `{PROBLEM}`, as it is here.\n\n{then}\n\nTimes [s]: {}", times.join(", "))
    }
}

/// Heads of a table of numbers.
const HEAD: [&str; 4] = ["name", "value", "unit", "meaning"];

/// A list in Markdown.
fn list(items: impl Iterator<Item = String>) -> String {
    items.map(|item| format!("- {item}\n")).collect()
}

/// A table in Markdown.
fn table<const N: usize>(heads: [&str; N], rows: impl IntoIterator<Item = [String; N]>) -> String {
    let row = |row: [String; N]| {
        format!("| {} |\n", row.map(|cell| cell.replace('|', "\\|")).join(" | "))
    };
    let rows: String = rows.into_iter().map(row).collect();
    format!("{}|{}\n{rows}", row(heads.map(String::from)), "---|".repeat(N))
}

/// A table with its title, or nothing if it has no rows.
fn titled<const N: usize>(
    title: &str,
    heads: [&str; N],
    rows: impl Iterator<Item = [String; N]>,
) -> String {
    let mut rows = rows.peekable();
    if rows.peek().is_none() {
        return String::new();
    }
    format!("{title}\n\n{}", table(heads, rows))
}

/// The parameters of the material.
fn material(m: &Medium, method: &Properties) -> Value {
    let (density, sound_speed) = (m.eos.density, m.eos.sound_speed);
    let common =
        [("density", with_unit(density, "kg/m^3")), ("sound_speed", with_unit(sound_speed, "m/s"))];
    let mut own = match m.shear_modulus > 0.0 {
        true => vec![
            ("bulk_modulus", with_unit(density * sound_speed * sound_speed, "Pa")),
            ("shear_modulus", with_unit(m.shear_modulus, "Pa")),
        ],
        false => vec![
            ("kinematic_viscosity", with_unit(m.nu, "m^2/s")),
            ("exponent_gamma", with_unit(m.eos.gamma, "-")),
            ("background_pressure", with_unit(m.eos.background, "Pa")),
        ],
    };
    if m.shear_modulus == 0.0 && method.uses.contains(&MediumSetting::Alpha) {
        own.push(("artificial_viscosity_alpha", with_unit(m.alpha, "-")));
    }
    common.into_iter().chain(own).collect()
}
