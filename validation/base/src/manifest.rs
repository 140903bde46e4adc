//! The manifest: the program, compiler and machine that computed a result. An unknown entry is `unknown`.
//!
//! A manifest names no person, host or folder, so that a record can be published unchanged.

use std::fs;
use std::sync::OnceLock;
use std::thread;

use serde::{Deserialize, Serialize};

/// Program, compiler and machine of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// version of touchstone
    pub touchstone: String,
    /// git commit of the sources, or `unknown`
    pub commit: String,
    /// did tracked files differ from the commit?
    pub dirty: Answer,
    /// digest of the sources of solver, harness and case on which the result depends, or `unknown`
    pub sources: String,
    /// the compiler's own version line
    pub rustc: String,
    /// `debug` or `release`
    pub profile: String,
    /// optimisation level, which in this project is high in both profiles
    pub opt_level: String,
    /// the target triple
    pub target: String,
    /// instruction sets that the compiler was allowed to use, which determine the speed
    pub features: Vec<String>,
    /// instruction sets of the processor by which the solver or the C library choose code at run time; no
    /// bits depend on them
    #[serde(default)]
    pub cpu_features: Vec<String>,
    /// operating system
    pub os: String,
    /// name of the processor
    pub cpu: String,
    /// threads that the machine can run at once
    pub cores: usize,
    /// threads that the run was given
    pub threads: usize,
}

/// The sources of the program, set at its start with [`tell_source`]: the commit is compiled into the binary
/// only, so that a commit without a change of sources rebuilds no library.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Source {
    /// git commit
    pub commit: &'static str,
    /// did tracked files differ from it?
    pub dirty: Answer,
}

/// Text for unknown values.
pub const UNKNOWN: &str = "unknown";

impl Source {
    const UNKNOWN: Self = Self { commit: UNKNOWN, dirty: Answer::Unknown };
}

static SOURCE: OnceLock<Source> = OnceLock::new();

/// States the sources of this process; the first call counts.
pub fn tell_source(source: Source) {
    let _ = SOURCE.set(source);
}

/// An answer that may be missing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Answer {
    /// yes
    Yes,
    /// no
    No,
    /// there was no git, or no repository
    #[default]
    Unknown,
}

impl Manifest {
    /// The manifest of this process, for a run on `threads` threads.
    pub fn of_this_process(threads: usize) -> Self {
        let source = SOURCE.get().copied().unwrap_or(Source::UNKNOWN);
        let features = env!("TOUCHSTONE_FEATURES").split(',').map(String::from).collect();
        Manifest {
            touchstone: env!("CARGO_PKG_VERSION").into(),
            commit: source.commit.into(),
            dirty: source.dirty,
            sources: UNKNOWN.into(),
            rustc: env!("TOUCHSTONE_RUSTC").into(),
            profile: env!("TOUCHSTONE_PROFILE").into(),
            opt_level: env!("TOUCHSTONE_OPT_LEVEL").into(),
            target: env!("TOUCHSTONE_TARGET").into(),
            features,
            cpu_features: cpu_features(),
            os: std::env::consts::OS.into(),
            cpu: cpu().unwrap_or_else(|| "unknown".into()),
            cores: thread::available_parallelism().map_or(1, usize::from),
            threads,
        }
    }

    /// The commit, and whether there were changes.
    pub fn state(&self) -> String {
        let changes = match self.dirty {
            Answer::Yes => " with uncommitted changes",
            Answer::No => "",
            Answer::Unknown => " (state of the sources unknown)",
        };
        format!("commit {:.12}{changes}", self.commit)
    }

    /// Can the times of two runs be compared? Same processor, threads, compiler and optimisation.
    pub fn is_same_machine(&self, other: &Self) -> bool {
        let machine = |of: &Self| {
            let Manifest { cpu, target, rustc, profile, opt_level, .. } = of.clone();
            let sets = (of.features.clone(), of.cpu_features.clone());
            (cpu, of.cores, of.threads, target, rustc, profile, opt_level, sets)
        };
        self.cpu != "unknown" && machine(self) == machine(other)
    }
}

#[cfg(target_arch = "x86_64")]
fn cpu_features() -> Vec<String> {
    let all = [
        ("avx2", is_x86_feature_detected!("avx2")),
        ("fma", is_x86_feature_detected!("fma")),
        ("avx512f", is_x86_feature_detected!("avx512f")),
        ("avx512vl", is_x86_feature_detected!("avx512vl")),
    ];
    all.iter().filter(|(_, has)| *has).map(|(name, _)| name.to_string()).collect()
}

#[cfg(not(target_arch = "x86_64"))]
fn cpu_features() -> Vec<String> {
    Vec::new()
}

fn cpu() -> Option<String> {
    field(&fs::read_to_string("/proc/cpuinfo").ok()?, "model name").map(String::from)
}

/// The first value of `key : value` lines.
fn field<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let value = |line: &'a str| {
        let (name, value) = line.split_once(':')?;
        (name.trim() == key).then_some(value.trim())
    };
    text.lines().find_map(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_manifest_round_trips_and_says_something_everywhere() {
        let manifest = Manifest::of_this_process(2);
        let text = serde_json::to_string(&manifest).unwrap();
        assert_eq!(serde_json::from_str::<Manifest>(&text).unwrap(), manifest);
        assert!(!text.contains("null") && !text.contains("\"\""), "{text}");
        assert!(manifest.cores >= 1 && manifest.threads == 2);
        let is_hash = manifest.commit.len() >= 40;
        assert!(is_hash || manifest.commit == "unknown", "{}", manifest.commit);
    }

    #[test]
    fn times_compare_on_the_same_machine_only() {
        let two = Manifest { cpu: "a".into(), ..Manifest::of_this_process(2) };
        assert!(two.is_same_machine(&two.clone()));
        assert!(two.is_same_machine(&Manifest { commit: "other".into(), ..two.clone() }));
        assert!(!two.is_same_machine(&Manifest { threads: 1, ..two.clone() }));
        let unknown = Manifest { cpu: "unknown".into(), ..two };
        assert!(!unknown.is_same_machine(&unknown.clone()));
    }

    #[test]
    fn a_manifest_from_before_the_features_of_the_processor_were_named_is_read() {
        let mut text = serde_json::to_value(Manifest::of_this_process(1)).unwrap();
        text.as_object_mut().unwrap().remove("cpu_features").unwrap();
        assert!(serde_json::from_value::<Manifest>(text).unwrap().cpu_features.is_empty());
    }

    #[test]
    fn system_texts_are_read_or_left() {
        let info = "processor\t: 0\nmodel name\t: A: CPU\nmodel name\t: B\n";
        assert_eq!(field(info, "model name"), Some("A: CPU"));
    }
}
