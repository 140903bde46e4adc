//! The JSON Schemas of `references/schemas` describe the output of the program, and refuse damaged documents.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use touchstone_base::absent::Absent;
use touchstone_base::mutation::{Constant, Detect, Disorder, Mutation};
use touchstone_base::record::{Metric, Record, Status};
use touchstone_base::spec::{Bisect, EndAfter, Keep, RunSpec, Task};
use touchstone_base::submission::{Division, Submission};

use crate::common::{printed, touchstone};

const NAMES: [&str; 3] = ["record", "problem", "verdicts"];

/// A schema by name.
fn schema(name: &str) -> Value {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../references/schemas");
    let text = fs::read_to_string(folder.join(format!("{name}.json"))).unwrap();
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A validator for the part of JSON Schema that is used here.
struct Validator<'a> {
    root: &'a Value,
    /// Is a key that is not described a fault, even where the schema accepts more?
    is_closed: bool,
}

impl<'a> Validator<'a> {
    /// The faults of a document with their paths.
    fn faults(&self, schema: &'a Value, of: &Value, path: &str) -> Vec<String> {
        let Some(keywords) = schema.as_object() else {
            let is_refused = *schema == json!(false);
            return is_refused
                .then(|| format!("{path}: nothing may be here"))
                .into_iter()
                .collect();
        };
        let check = |(word, rule): (&String, _)| self.keyword(schema, word, rule, of, path);
        keywords.iter().flat_map(check).collect()
    }

    fn keyword(
        &self,
        all: &'a Value,
        word: &str,
        rule: &'a Value,
        of: &Value,
        at: &str,
    ) -> Vec<String> {
        let (object, list) = (of.as_object(), of.as_array());
        let is_sound = match word {
            "$schema" | "$defs" | "title" | "description" => true,
            "type" => one_or_many(rule).any(|kind| is_of_type(of, kind)),
            "const" => rule == of,
            "enum" => rule.as_array().unwrap().contains(of),
            "minimum" => of.as_f64().is_none_or(|value| value >= rule.as_f64().unwrap()),
            "minItems" => list.is_none_or(|list| list.len() as u64 >= rule.as_u64().unwrap()),
            "pattern" => of.as_str().is_none_or(|text| matches(rule.as_str().unwrap(), text)),
            "anyOf" => self.choices(rule, of).count() > 0,
            "oneOf" => self.choices(rule, of).count() == 1,
            "required" => {
                let has =
                    |key: &Value| object.is_none_or(|of| of.contains_key(key.as_str().unwrap()));
                rule.as_array().unwrap().iter().all(has)
            }
            "$ref" => return self.faults(self.definition(rule), of, at),
            "properties" => {
                let known = rule.as_object().unwrap();
                let is_open = self.is_closed && all.get("additionalProperties").is_none();
                let stranger = |key: &&String| is_open && !known.contains_key(*key);
                let strangers = object.into_iter().flat_map(|of| of.keys()).filter(stranger);
                let strangers = strangers.map(|key| format!("{at}/{key} is not described"));
                let below = known.iter().filter_map(|(key, rule)| Some((key, rule, of.get(key)?)));
                let below =
                    below.flat_map(|(key, rule, of)| self.faults(rule, of, &format!("{at}/{key}")));
                return below.chain(strangers).collect();
            }
            "additionalProperties" => {
                let others = object.into_iter().flatten();
                let others =
                    others.filter(|(key, _)| all["properties"].get(key.as_str()).is_none());
                return others
                    .flat_map(|(key, of)| self.faults(rule, of, &format!("{at}/{key}")))
                    .collect();
            }
            "prefixItems" => {
                let pairs =
                    rule.as_array().unwrap().iter().zip(list.into_iter().flatten()).enumerate();
                return pairs
                    .flat_map(|(k, (rule, of))| self.faults(rule, of, &format!("{at}/{k}")))
                    .collect();
            }
            "items" => {
                let first = all["prefixItems"].as_array().map_or(0, Vec::len);
                let items = list.into_iter().flatten().enumerate().skip(first);
                return items
                    .flat_map(|(k, of)| self.faults(rule, of, &format!("{at}/{k}")))
                    .collect();
            }
            other => panic!("{at}: the keyword {other} would be ignored"),
        };
        (!is_sound).then(|| format!("{at} is {of}, against {word} {rule}")).into_iter().collect()
    }

    fn definition(&self, reference: &Value) -> &'a Value {
        let name =
            reference.as_str().and_then(|name| name.strip_prefix("#/$defs/")).expect("a name");
        self.root["$defs"].get(name).unwrap_or_else(|| panic!("{name} is not defined"))
    }

    /// The alternatives that a document satisfies.
    fn choices(&self, all: &'a Value, of: &Value) -> impl Iterator<Item = &'a Value> {
        all.as_array().unwrap().iter().filter(|schema| self.faults(schema, of, "").is_empty())
    }

    /// The objects of a document, each with the schema that lists its keys and with its path.
    fn objects(
        &self,
        schema: &'a Value,
        of: &Value,
        at: String,
        found: &mut Vec<(String, &'a Value)>,
    ) {
        if let Some(reference) = schema.get("$ref") {
            self.objects(self.definition(reference), of, at.clone(), found);
        }
        for all in ["anyOf", "oneOf"].iter().filter_map(|word| schema.get(word)) {
            self.choices(all, of).for_each(|schema| self.objects(schema, of, at.clone(), found));
        }
        let below = |key: &str| format!("{at}/{}", key.replace('~', "~0").replace('/', "~1"));
        for (key, value) in of.as_object().into_iter().flatten() {
            let own = schema.get("properties").and_then(|rules| rules.get(key));
            if let Some(rule) = own.or(schema.get("additionalProperties")) {
                self.objects(rule, value, below(key), found);
            }
        }
        for (k, value) in of.as_array().into_iter().flatten().enumerate() {
            let own = schema.get("prefixItems").and_then(|rules| rules.get(k));
            if let Some(rule) = own.or(schema.get("items")) {
                self.objects(rule, value, below(&k.to_string()), found);
            }
        }
        if schema.get("properties").is_some() && of.is_object() {
            found.push((at, schema));
        }
    }
}

fn one_or_many(rule: &Value) -> impl Iterator<Item = &str> {
    let many = rule.as_array().into_iter().flatten();
    rule.as_str().into_iter().chain(many.filter_map(Value::as_str))
}

fn is_of_type(of: &Value, kind: &str) -> bool {
    match kind {
        "null" => of.is_null(),
        "boolean" => of.is_boolean(),
        "string" => of.is_string(),
        "number" => of.is_number(),
        "integer" => of.is_u64() || of.is_i64(),
        "array" => of.is_array(),
        "object" => of.is_object(),
        other => panic!("{other} is no type"),
    }
}

/// Patterns of one kind only: `^[characters and ranges]{least,most}$`.
fn matches(pattern: &str, text: &str) -> bool {
    let inside = pattern.strip_prefix("^[").and_then(|rest| rest.strip_suffix("}$"));
    let (class, counts) = inside.and_then(|inside| inside.split_once("]{")).expect("a pattern");
    let (least, most) = counts.split_once(',').unwrap_or((counts, counts));
    let class: Vec<char> = class.chars().collect();
    let has = |c: char| {
        let is_in_range = class.windows(3).any(|of| of[1] == '-' && (of[0]..=of[2]).contains(&c));
        is_in_range || class.contains(&c)
    };
    let count = text.chars().count();
    (least.parse().unwrap()..=most.parse().unwrap()).contains(&count) && text.chars().all(has)
}

fn parsed(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// Records with rare content: other tasks, another code, a deliberate error, an interruption, numbers not
/// finite.
fn rare_records(record: &Record) -> Vec<Value> {
    let mut rare = record.clone();
    rare.status = Status::Interrupted { step: 3, time: f64::INFINITY };
    rare.metrics.insert("none".into(), Metric::new(f64::NAN, "-", "0/0"));
    rare.absent.insert("order".into(), Absent::because("there is one level"));
    rare.run.allow_unstable = true;
    rare.run.keep = Keep { particles: true };
    rare.run.mutation = Some(Mutation { of: Constant::BodyForce, factor: 1.03 });
    rare.run.disorder = Some(Disorder { most: 1e-6, seed: 1 });
    let [code, version, scheme, method, results] =
        ["code", "1", "WCSPH", "abc", "def"].map(String::from);
    let (division, results, seed, states_our_method) =
        (Division::Closed, Some(results), Some(1), true);
    let submission =
        Submission { code, version, scheme, division, method, results, seed, states_our_method };
    rare.run.submission = Some(Box::new(submission));
    rare.cost.alone_s = vec![0.1, 0.2];
    rare.cost.resumed = 1;
    let end = Some(EndAfter { steps: 100.0, unit: 1.0 });
    let setting = "dt".to_string();
    let bisect = Task::Bisect(Bisect { setting, guess: 1.0, unit: 2.0, resolution: 0.1, end });
    let detect = Task::Detect(Detect { of: Constant::Xsph, only_allowed: true });
    let of = |task| {
        let run = RunSpec { task, ..rare.spec() };
        parsed(&Record { run, ..rare.clone() }.to_json().unwrap())
    };
    [bisect, detect, Task::Simulate].map(of).into()
}

/// Documents that the program writes, each with the name of its schema.
fn documents() -> Vec<(&'static str, Value)> {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let of = |line: &str| printed(&touchstone(at, line));
    let text = of("run couette --set rows=8 --set end=0.05 --profile --json");
    let record = Record::from_json(&text).unwrap();
    let diverged = of("run couette --set rows=8 --set end=5 --set dt=0.1 --allow-unstable --json");
    let too_long = record.spec().with_setting("dt", 0.5);
    fs::write(at.join("refused.jsonl"), too_long.canonical() + "\n").unwrap();
    of("run --specs refused.jsonl --store store");
    let refused = fs::read_dir(at.join("store")).unwrap().map(|entry| entry.unwrap().path());
    let refused = refused.map(|path| fs::read_to_string(path).unwrap());
    let mut records: Vec<Value> =
        [text, diverged].into_iter().chain(refused).map(|text| parsed(&text)).collect();
    let kinds: Vec<_> = records.iter().map(|record| &record["status"]["kind"]).collect();
    assert_eq!(kinds, ["completed", "diverged", "refused"]);
    records.extend(rare_records(&record));

    let method = json!({ "code": "a", "version": "1", "scheme": "b", "division": "closed", "settings": {},
        "changed": "nothing" });
    fs::write(at.join("method.json"), method.to_string()).unwrap();
    of("export dam_break --relation turned --out fluid");
    of("export elastic_bar --out solid");
    of("export periodic_hill --set n=6 --out driven");
    of("export couette --sealed 1 --method method.json --out sealed");
    let problem =
        |name: &str| parsed(&fs::read_to_string(at.join(name).join("problem.json")).unwrap());
    let problems = ["fluid", "solid", "driven", "sealed"].map(problem);

    fs::create_dir(at.join("empty")).unwrap();
    let mut verdicts = parsed(&of("verify --no-runs couette hydrostatic --store empty --json"));
    assert!(verdicts["counts"]["fail"].as_u64() > Some(0));
    // The smaller document is as good, and is validated often.
    verdicts["runs"].as_array_mut().unwrap().dedup_by_key(|run| run["variant"].clone());
    of("export couette --set rows=8 --set end=0.05 --out own --solve");
    of("submit couette own --baseline baseline.json --update-baseline");
    let submission = parsed(&of("submit couette own --baseline baseline.json --json"));
    verdicts["submissions"].as_array_mut().unwrap().push(submission);
    let records = records.into_iter().map(|record| ("record", record));
    let problems = problems.into_iter().map(|problem| ("problem", problem));
    records.chain(problems).chain([("verdicts", verdicts)]).collect()
}

/// All objects of a schema that list keys.
fn all_objects<'a>(schema: &'a Value, found: &mut Vec<&'a Value>) {
    if schema.get("properties").is_some_and(Value::is_object) && schema["type"] == "object" {
        found.push(schema);
    }
    let objects = schema.as_object().into_iter().flat_map(|of| of.values());
    objects
        .chain(schema.as_array().into_iter().flatten())
        .for_each(|below| all_objects(below, found));
}

/// Does the reader of the program accept the document, as far as types go?
fn is_read(name: &str, document: &Value) -> Option<bool> {
    let mut document = document.clone();
    match name {
        "record" => {
            // The digest is taken off before the rest is read.
            let had_digest = document.as_object_mut().unwrap().remove("digest").is_some();
            Some(had_digest && serde_json::from_value::<Record>(document).is_ok())
        }
        "problem" => Some(serde_json::from_value::<RunSpec>(document["spec"].take()).is_ok()),
        _ => None,
    }
}

/// Removes, adds and damages each key of one object; returns the differences between schema and expectation.
fn damage(name: &str, schema: &Value, document: &Value, at: &str, object: &Value) -> Vec<String> {
    let [open, closed] = [false, true].map(|is_closed| Validator { root: schema, is_closed });
    let is_strict = object.get("additionalProperties").is_some();
    let is_ours = name == "record" || at.starts_with("/spec");
    let mut wrong = Vec::new();
    let mut expect = |what: String, is_refused: bool, expected: bool| {
        if is_refused != expected {
            wrong.push(format!("{name}{at}: {what}: refused is {is_refused}"));
        }
    };
    let changed = |change: &dyn Fn(&mut serde_json::Map<String, Value>)| {
        let mut changed = document.clone();
        change(changed.pointer_mut(at).unwrap().as_object_mut().unwrap());
        let refused = [&open, &closed].map(|by| !by.faults(schema, &changed, "").is_empty());
        (refused, is_read(name, &changed).filter(|_| is_ours))
    };
    for key in document.pointer(at).unwrap().as_object().unwrap().keys() {
        let required = object["required"].as_array();
        let is_required = required.is_some_and(|all| all.contains(&json!(key)));
        let ([is_refused, _], is_read) = changed(&|of| drop(of.remove(key)));
        expect(format!("without {key}"), is_refused, is_required);
        if let Some(is_read) = is_read {
            expect(format!("without {key}, by the reader"), !is_read, is_required);
        }
        let ([is_refused, _], _) = changed(&|of| drop(of.insert(key.clone(), json!([null]))));
        expect(format!("wrong {key}"), is_refused, true);
    }
    let (is_refused, is_read) = changed(&|of| drop(of.insert("stranger".into(), json!(1))));
    expect("with a stranger".into(), is_refused[0], is_strict);
    expect("with a stranger, closed".into(), is_refused[1], true);
    // Serde does not deny an unknown key next to the tag of a variant without fields.
    let is_bare = object["properties"].as_object().unwrap().keys().eq(["kind"]);
    if let Some(is_read) = is_read.filter(|_| !is_bare) {
        expect("with a stranger, by the reader".into(), !is_read, is_strict);
    }
    wrong
}

/// The output of the program is described to the last key, every description matches some output, and a key
/// that is missing, unknown or of the wrong type is refused, as by the reader of the program.
#[test]
fn schemas_describe_what_is_written_and_refuse_what_is_damaged() {
    let schemas = NAMES.map(schema);
    let (mut seen, mut wrong) = (BTreeSet::new(), Vec::new());
    for (name, document) in documents() {
        let schema = &schemas[NAMES.iter().position(|of| *of == name).unwrap()];
        let validator = Validator { root: schema, is_closed: true };
        let faults = validator.faults(schema, &document, "");
        assert!(faults.is_empty(), "{name}: {faults:#?}");
        let mut objects = Vec::new();
        validator.objects(schema, &document, String::new(), &mut objects);
        for (at, object) in objects {
            // One object of each kind and set of keys.
            let keys: Vec<&String> =
                document.pointer(&at).unwrap().as_object().unwrap().keys().collect();
            if seen.insert((name, object.to_string(), format!("{keys:?}"))) {
                wrong.extend(damage(name, schema, &document, &at, object));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    let seen: BTreeSet<String> = seen.into_iter().map(|(_, object, _)| object).collect();
    let mut all = Vec::new();
    schemas.iter().for_each(|schema| all_objects(schema, &mut all));
    let unseen: Vec<&Value> =
        all.into_iter().filter(|object| !seen.contains(&object.to_string())).collect();
    assert!(unseen.is_empty(), "no document has these objects: {unseen:#?}");
}

/// Each key has a description, which ends with the unit in brackets if the key holds a number.
#[test]
fn every_key_has_a_description_and_every_number_a_unit() {
    let mut count = 0;
    let schemas = NAMES.map(schema);
    let mut objects = Vec::new();
    schemas.iter().for_each(|schema| all_objects(schema, &mut objects));
    for (key, rule) in
        objects.into_iter().flat_map(|object| object["properties"].as_object().unwrap())
    {
        let text =
            rule["description"].as_str().unwrap_or_else(|| panic!("{key} has no description"));
        assert!(!text.is_empty(), "{key}");
        let kinds = [rule].into_iter().chain(rule["anyOf"].as_array().into_iter().flatten());
        let is_number = kinds.into_iter().any(|rule| {
            let is_of_numbers =
                ["number", "integer"].contains(&rule["type"].as_str().unwrap_or_default());
            is_of_numbers || rule["$ref"] == "#/$defs/number" || rule["const"].is_number()
        });
        assert!(!is_number || text.ends_with(']'), "{key} has no unit: {text}");
        count += 1;
    }
    assert!(count > 150, "{count} keys");
}

/// Equal names in two schemas have equal definitions.
#[test]
fn schemas_agree_on_what_they_share() {
    let schemas = NAMES.map(schema);
    let mut shared = 0;
    for (k, one) in schemas.iter().enumerate() {
        assert_eq!(one["$schema"], "https://json-schema.org/draft/2020-12/schema");
        for (name, definition) in one["$defs"].as_object().unwrap() {
            for other in schemas[k + 1..].iter().filter_map(|other| other["$defs"].get(name)) {
                assert_eq!(definition, other, "{name}");
                shared += 1;
            }
        }
    }
    assert!(shared > 5, "{shared} definitions are shared");
}

/// The validator itself, on each keyword.
#[test]
fn the_validator_refuses() {
    let is_sound = |schema: Value, of: Value| {
        Validator { root: &schema, is_closed: false }.faults(&schema, &of, "").is_empty()
    };
    let number = json!({ "type": "number" });
    for (schema, good, bad) in [
        (json!({ "type": ["string", "null"] }), json!(null), json!(1)),
        (json!({ "type": "integer", "minimum": 0 }), json!(0), json!(-1)),
        (json!({ "type": "integer" }), json!(2), json!(2.5)),
        (json!({ "enum": ["a", "b"] }), json!("b"), json!("c")),
        (json!({ "const": 3 }), json!(3), json!(2)),
        (json!({ "pattern": "^[0-9a-f]{2,3}$" }), json!("0af"), json!("0ag")),
        (json!({ "pattern": "^[0-9a-f]{2}$" }), json!("0a"), json!("0af")),
        (
            json!({ "prefixItems": [number, number], "items": false }),
            json!([1, 2]),
            json!([1, 2, 3]),
        ),
        (json!({ "items": number, "minItems": 1 }), json!([1]), json!([])),
        (json!({ "items": number }), json!([1]), json!(["1"])),
        (json!({ "oneOf": [number, { "const": 1 }] }), json!(2), json!(1)),
        (json!({ "anyOf": [number, { "const": "x" }] }), json!("x"), json!("y")),
        (json!({ "$ref": "#/$defs/n", "$defs": { "n": number } }), json!(1), json!("1")),
        (json!({ "required": ["a"] }), json!({ "a": 1 }), json!({ "b": 1 })),
        (json!({ "properties": { "a": number } }), json!({ "b": "" }), json!({ "a": "" })),
        (json!({ "properties": {}, "additionalProperties": false }), json!({}), json!({ "a": 1 })),
        (json!({ "additionalProperties": number }), json!({ "a": 1 }), json!({ "a": "" })),
    ] {
        assert!(is_sound(schema.clone(), good), "{schema}");
        assert!(!is_sound(schema.clone(), bad), "{schema}");
    }
}
