//! A problem as a document: every number with its unit, every equation with its text.

use base::{
    gate::Gate,
    record::{Column, Profile},
    spec::RunSpec,
    text::short,
};
use harness::{
    case::{Case, RunError},
    context::Context,
    method::{Medium, Properties},
    outline::{Outline, Sink},
    plan,
    relation::Relation,
    sealed,
};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use crate::flaw::Flaw;

/// Version of `problem.json`; raised with every change that an older reader would misread.
pub const SCHEMA: u32 = 1;

/// Name of the document in the folder of a problem.
pub const PROBLEM: &str = "problem.json";
/// The field that lists its gates.
const JUDGED_BY: &str = "judged_by";
/// Name of the table of its particles.
pub const PARTICLES: &str = "particles.csv";

/// A problem and the run of ours that it is taken from.
pub struct Problem {
    /// The run.
    pub spec: RunSpec,
    /// The problem in words.
    pub about: &'static str,
    /// What scene and drive are made of.
    pub outline: Outline,
    /// What our own method is.
    pub method: Properties,
    /// What a run of these settings is judged by.
    pub gates: Vec<Gate>,
    /// Of a sealed problem, what it was drawn from.
    pub sealed: Option<Sealed>,
    /// If observers are to be compared, how the one differs who sees it so.
    pub relation: Option<Relation>,
}

/// What a sealed problem was drawn from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sealed {
    /// the seed
    pub seed: u64,
    /// SHA-256 of the code, version, scheme, division and settings of the method as they were then
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
    moving particle at each of the times below. Other formats: LAMMPS dump, `.npz`, `.vtu`, `.vtp`.\n";

/// What a reader needs of the document: the run that is asked for.
#[derive(Debug, Clone, Deserialize)]
pub struct Asked {
    /// version of the document
    pub schema: u32,
    /// the run
    pub spec: RunSpec,
    /// what it was drawn from
    #[serde(default)]
    pub sealed: Option<Sealed>,
    /// name of the relation by which it is seen
    #[serde(default)]
    pub relation: Option<String>,
    /// what the document says beside these
    #[serde(flatten)]
    rest: Map<String, Value>,
}

impl Asked {
    /// Are the numbers of the document those that its spec gives? Its prose may be that of another version, and
    /// it may have keys that ours lacks.
    ///
    /// # Errors
    /// The first field that says something else.
    pub fn agrees(&self, problem: &Problem) -> Result<(), Flaw> {
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

/// A number with its unit.
fn with_unit(value: impl Serialize, unit: &str) -> Value {
    json!({ "value": value, "unit": unit })
}

impl Problem {
    /// The problem of a run.
    ///
    /// # Errors
    /// If the run is refused, or is none of a scene, or its particles take more memory than a run may.
    pub fn of(case: &dyn Case, spec: RunSpec) -> Result<Self, RunError> {
        Self::seen(case, spec, None, false)
    }

    /// The problem at a few early times as another observer sees it, if there is a relation.
    ///
    /// # Errors
    /// As [`Problem::of`], of the memory unless it is allowed, or if the relation is no symmetry of the problem.
    pub fn seen(
        case: &dyn Case,
        spec: RunSpec,
        relation: Option<Relation>,
        allow_long: bool,
    ) -> Result<Self, RunError> {
        let sink = Sink::of(relation, false);
        let context = Context { outline: Some(sink.clone()), allow_long, ..Context::default() };
        let (outline, method) = sink.of_run(case.run(&spec, &context), case.name())?;
        let gates = if relation.is_none() { plan::gates_of(case, &spec) } else { Vec::new() };
        Ok(Self { spec, about: case.about(), outline, method, gates, sealed: None, relation })
    }

    /// The same, sealed: judged by what follows from the bounds of judged runs.
    #[must_use]
    pub fn sealed(mut self, case: &dyn Case, sealed: Sealed) -> Self {
        self.gates = sealed::gates(case, &self.spec);
        Self { sealed: Some(sealed), ..self }
    }

    /// The particles that the other code moves: their numbers in the problem.
    pub fn moving(&self) -> Vec<u32> {
        let roles = self.outline.particles.column("role").iter().enumerate();
        roles.filter(|(_, role)| **role == 0.0).map(|(k, _)| k as u32).collect()
    }

    /// Is the material an elastic solid?
    pub fn is_solid(&self) -> bool {
        self.outline.medium.shear_modulus > 0.0
    }

    /// The document.
    pub fn to_json(&self) -> Value {
        let Self { outline, method, .. } = self;
        let Outline { medium: m, domain, mirrors, times, dt, .. } = outline;
        let plane = |wall: &solver::PlaneWall| {
            json!({
                "point": with_unit(wall.point.as_slice(), "m"),
                "normal_into_the_material": with_unit(wall.normal.as_slice(), "-"),
                "velocity": with_unit(wall.velocity.as_slice(), "m/s"),
            })
        };
        let gate =
            |gate: &Gate| json!({ "id": gate.id, "metric": gate.metric, "bound": gate.bound });
        let column = |column: &Column| json!({ "name": column.name, "unit": column.unit });
        let mut document = json!({
            "schema": SCHEMA,
            "spec": self.spec.to_value(),
            "about": self.about,
            "dimensions": 2,
            "equations": self.equations().map(|(name, text)| json!({ "name": name, "text": text })),
            "material": material(m, self.is_solid()),
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
            "times": with_unit(times, "s"),
            "end": with_unit(times.last(), "s"),
            JUDGED_BY: self.gates.iter().map(gate).collect::<Vec<_>>(),
            "our_method": {
                "kernel": method.kernel,
                "smoothing_length": with_unit(m.h, "m"),
                "support_radius": with_unit(method.support * m.h, "m"),
                "integrator": method.integrator,
                "walls": method.walls,
                "time_step": with_unit(dt, "s"),
            },
        });
        if let Some(sealed) = &self.sealed {
            document["sealed"] = json!(sealed);
        }
        if let Some(relation) = self.relation {
            document["relation"] = json!(relation.name());
        }
        document
    }

    /// All particles, with the number of the body to which each belongs if there are bodies.
    pub fn particles(&self) -> Profile {
        let Outline { particles, bodies, .. } = &self.outline;
        let bodies: Vec<f64> = bodies.iter().map(|body| f64::from(*body)).collect();
        let particles = particles.clone();
        if bodies.is_empty() { particles } else { particles.with("body", "-", bodies) }
    }

    /// The equations in words.
    pub fn equations(&self) -> [(&'static str, &'static str); 3] {
        let continuity = ("continuity", "dρ/dt = -ρ ∇·v");
        if let Some(energy) = self.method.law {
            let momentum = "ρ0 dv/dt = ∇·P + ρ0 g, P = ∂w/∂F, in the configuration without stress";
            return [continuity, ("momentum", momentum), ("stored energy, plane strain", energy)];
        }
        if self.is_solid() {
            let material =
                "p = c0² (ρ - ρ0); dS/dt = 2 μ (ε̇ - tr(ε̇) I/3) + S·Ωᵀ + Ω·S (Jaumann rate)";
            let momentum = ("momentum", "dv/dt = (1/ρ) ∇·σ + g, σ = -p I + S");
            return [continuity, momentum, ("material, plane strain", material)];
        }
        [
            continuity,
            ("momentum", "dv/dt = -(1/ρ) ∇p + ν ∇²v + g"),
            ("state", "p = p_b + (ρ0 c0²/γ) ((ρ/ρ0)^γ - 1)"),
        ]
    }

    /// A page that a person can work from.
    pub fn page(&self) -> String {
        let Outline { medium: m, times, .. } = &self.outline;
        let quantity = |(name, value): (&String, &Value)| {
            let unit = value["unit"].as_str().unwrap_or_default();
            format!("| {} | {} | {unit} |\n", name.replace('_', " "), value["value"])
        };
        let material = material(m, self.is_solid());
        let material: String = material.as_object().into_iter().flatten().map(quantity).collect();
        let equations: String =
            self.equations().iter().map(|(name, text)| format!("- {name}: {text}\n")).collect();
        let gates: String = self
            .gates
            .iter()
            .map(|gate| format!("| `{}` | `{}` | {} |\n", gate.id, gate.metric, gate.bound))
            .collect();
        let times: Vec<String> = times.iter().map(f64::to_string).collect();
        let case = &self.spec.case;
        let then = match self.relation.map(Relation::name) {
            None => format!("`touchstone submit {case} DIR --store STORE` measures and judges it."),
            Some(by) => format!(
                "All is seen by an observer ({by}), and `touchstone relate {case} SAME DIR` compares it."
            ),
        };
        format!(
            "# {case}, variant {variant}\n\n{about}\n\nAll numbers are in SI units, in two dimensions, \
             masses per unit depth. `{PROBLEM}` has every number with its unit.\n\n## Equations\n\n\
             {equations}\n## Material and forces\n\n| quantity | value | unit |\n|---|---|---|\n\
             {material}| acceleration g | {gx}, {gy} | m/s^2 |\n| spacing of particles | {dx} | m |\n\
             | end | {end} | s |\n\n## Particles\n\n`{PARTICLES}` has one line a particle. Role 0 moves; \
             role 1 is behind a wall and role 2 on it, and neither moves except along the wall with its \
             velocity. Axes with a period repeat.\n\n## What to hand in\n\n{HAND_IN}\
             - `{PROBLEM}`, as it is here.\n\n{then}\n\n\
             Times [s]: {times}\n\n## How it is judged\n\n| gate | metric | bound |\n\
             |---|---|---|\n{gates}",
            variant = self.spec.variant,
            about = self.about,
            gx = m.acceleration.x,
            gy = m.acceleration.y,
            dx = m.dx,
            end = times.last().map_or("", String::as_str),
            times = times.join(", "),
        )
    }
}

/// The parameters of the material.
fn material(m: &Medium, is_solid: bool) -> Value {
    let (density, sound_speed) = (m.eos.density, m.eos.sound_speed);
    let common =
        [("density", with_unit(density, "kg/m^3")), ("sound_speed", with_unit(sound_speed, "m/s"))];
    let own = match is_solid {
        true => vec![
            ("bulk_modulus", with_unit(density * sound_speed * sound_speed, "Pa")),
            ("shear_modulus", with_unit(m.shear_modulus, "Pa")),
        ],
        false => vec![
            ("kinematic_viscosity", with_unit(m.nu, "m^2/s")),
            ("exponent_gamma", with_unit(m.eos.gamma, "-")),
            ("background_pressure", with_unit(m.eos.background, "Pa")),
            ("artificial_viscosity_alpha", with_unit(m.alpha, "-")),
        ],
    };
    let mut all = serde_json::Map::new();
    for (name, value) in common.into_iter().chain(own) {
        all.insert(name.into(), value);
    }
    all.into()
}
