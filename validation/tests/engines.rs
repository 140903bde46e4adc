//! Plans made by existing engines, with the files of `validation/contrib`: the records equal a local run's.
//! An engine that is not installed is skipped, with a message.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use touchstone_base::record::{Cost, Record};
use touchstone_harness::store::Store;

const PROGRAM: &str = env!("CARGO_BIN_EXE_touchstone");

fn contrib(name: &str) -> String {
    format!("{}/contrib/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// A command in a folder that knows the program by the variable that the files of the engines read.
fn command(program: &str, folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(program);
    command.current_dir(folder).args(arguments).env("TOUCHSTONE", PROGRAM);
    command
}

fn succeeds(mut command: Command) -> bool {
    command.output().is_ok_and(|output| output.status.success())
}

#[track_caller]
fn run(mut command: Command) {
    let output = command.output().unwrap();
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{command:?}: {words}");
}

/// A sweep of short runs, among them one that diverges, in a file of JSON lines.
fn plan(folder: &Path, end: &str) -> PathBuf {
    let plan = |rest: &[&str]| {
        let arguments = [&["plan", "couette", "--set=rows=8,10"], rest].concat();
        let output = command(PROGRAM, folder, &arguments).output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let sound = plan(&["--variant=seed,plain", &format!("--set=end={end}")]);
    let far_beyond = plan(&["--variant=plain", "--set=dt=0.05", "--set=end=20"]);
    let diverges =
        far_beyond.lines().next().unwrap().replacen('{', r#"{"allow_unstable":true,"#, 1);
    let lines = format!("{sound}{diverges}\n");
    fs::write(folder.join("plan.jsonl"), lines).unwrap();
    folder.join("plan.jsonl")
}

/// The records of a store, without time and memory.
fn records(store: &Path) -> Vec<Record> {
    let without_times = |record: Record| {
        let (wall_s, cpu_s, observing_s, solver_bytes) = (0.0, 0.0, 0.0, 0);
        let cost = Cost { wall_s, cpu_s, observing_s, solver_bytes, ..record.cost };
        Record { cost, ..record }
    };
    Store::all(store).unwrap().into_iter().map(without_times).collect()
}

/// Makes the plan here and by an engine, twice, as when it is submitted again.
#[track_caller]
fn gives_the_records_of_a_local_run(folder: &Path, engine: impl Fn(&str, &str) -> Command) {
    let specs = plan(folder, "0.02");
    let specs = specs.to_str().unwrap();
    let here = command(PROGRAM, folder, &["run", "--specs", specs, "--store", "here"]).output();
    assert_eq!(here.unwrap().status.code(), Some(3), "one diverges");
    run(engine(specs, "there"));
    run(engine(specs, "there"));
    let [here, there] = ["here", "there"].map(|store| records(&folder.join(store)));
    assert_eq!(here.len(), 5);
    assert!(here == there, "records differ");
}

#[test]
fn hyperqueue() {
    let folder = tempfile::tempdir().unwrap();
    let python = |arguments: &[&str]| command("python3", folder.path(), arguments);
    if !succeeds(python(&["-c", "import hyperqueue"])) {
        return println!("skipped: python3 has no package hyperqueue");
    }
    let script = contrib("hyperqueue_tasks.py");
    let engine = |specs: &str, store: &str| python(&[&script, specs, store, "2"]);
    gives_the_records_of_a_local_run(folder.path(), engine);
}

#[test]
fn snakemake() {
    let folder = tempfile::tempdir().unwrap();
    let snakemake = |arguments: &[&str]| command("snakemake", folder.path(), arguments);
    if !succeeds(snakemake(&["--version"])) {
        return println!("skipped: there is no snakemake");
    }
    let file = contrib("Snakefile");
    gives_the_records_of_a_local_run(folder.path(), |specs, store| {
        let [specs, store] = [format!("specs={specs}"), format!("store={store}")];
        snakemake(&["-s", &file, "--cores", "2", "--config", &specs, &store])
    });
}

/// A Slurm of this machine that stops at the end.
struct Node(PathBuf);

impl Node {
    fn go(&self, action: &str) -> bool {
        let (script, port) = (contrib("slurm_node.sh"), 20_000 + std::process::id() % 20_000);
        let mut script = command("sh", &self.0, &[&script, action, "."]);
        // Daemons keep the pipes of their parent.
        script.env("SLURM_PORT", port.to_string()).stdout(Stdio::null()).stderr(Stdio::null());
        script.status().is_ok_and(|status| status.success())
    }

    fn command(&self, program: &str, arguments: &[&str]) -> Command {
        let mut command = command(program, &self.0, arguments);
        command.env("SLURM_CONF", self.0.join("slurm.conf"));
        command
    }
}

impl Drop for Node {
    fn drop(&mut self) {
        self.go("stop");
    }
}

#[test]
fn slurm() {
    let folder = tempfile::tempdir().unwrap();
    let node = Node(folder.path().to_path_buf());
    if !node.go("start") {
        return println!(
            "skipped: slurmctld, slurmd and munged cannot be started; this needs root"
        );
    }
    let start = Instant::now();
    while !succeeds(node.command("srun", &["--immediate=2", "true"])) {
        assert!(start.elapsed() < Duration::from_secs(60), "the node does not come up");
        sleep(Duration::from_millis(200));
    }
    let script = contrib("slurm.sh");
    gives_the_records_of_a_local_run(folder.path(), |specs, store| {
        node.command("sh", &[&script, specs, store, "2", "--wait"])
    });
}

/// A mock of `sbatch`, which runs the tasks of an array one after the other.
const SBATCH: &str = "#!/bin/sh
cat >job; last=${1#--array=0-}; k=0; exit=0
while [ $k -le $last ]; do SLURM_ARRAY_TASK_ID=$k sh job || exit=1; k=$((k + 1)); done
exit $exit
";

/// `slurm.sh` in a folder with that mock.
fn mocked(folder: &Path, arguments: &[&str]) -> Option<i32> {
    let path = format!("{}:{}", folder.display(), std::env::var("PATH").unwrap_or_default());
    let script = contrib("slurm.sh");
    let mut command = command("sh", folder, &[&[&*script], arguments].concat());
    command.env("PATH", path).output().unwrap().status.code()
}

/// A task must not execute `$(…)` in the path of the plan, blank lines must not make a task, and an empty
/// plan must be reported.
#[test]
fn a_path_is_no_command_and_a_plan_without_runs_is_told() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sbatch"), SBATCH).unwrap();
    fs::set_permissions(at.join("sbatch"), fs::Permissions::from_mode(0o755)).unwrap();
    let line = r#"{"case":"couette","variant":"seed","settings":{"rows":8,"end":0.01}}"#;
    let odd = [
        "plain",
        "g$(touch pwned)",
        "h`touch pwned`",
        "a $HOME b",
        "it's \"quoted\"; touch pwned",
        "-x",
    ];
    for name in odd {
        fs::create_dir(at.join(name)).unwrap();
        let other = line.replace("0.01", "0.02");
        let longer = line.replace("0.01", "0.03");
        fs::write(at.join(name).join("p"), format!("{line}\n \n\n{other}\n\t\n{longer}\n"))
            .unwrap();
        let [specs, store] = ["p", "st"].map(|of| format!("./{name}/{of}"));
        assert_eq!(mocked(at, &[&specs, &store, "2"]), Some(0), "{name}");
        assert_eq!(records(&at.join(name).join("st")).len(), 3, "{name}");
        assert!(fs::read_to_string(at.join("job")).unwrap().contains("--index"));
        assert!(!at.join("pwned").exists(), "{name}");
    }
    for lines in ["0", "-1", "x", "", "1.5", "08", "99999999999999999999"] {
        fs::remove_file(at.join("job")).unwrap_or_default();
        assert_eq!(mocked(at, &["plain/p", "st", lines]), Some(2), "{lines:?} lines");
        assert!(!at.join("job").exists(), "{lines}");
    }
    fs::write(at.join("empty"), "\n \n").unwrap();
    for specs in ["empty", "missing", "plain"] {
        assert_eq!(mocked(at, &[specs, "st"]), Some(2), "{specs}");
    }
    assert_eq!(mocked(at, &["plain/p"]), Some(2));
    // A refused line fails its task, whatever diverges in other lines.
    let specs = plan(at, "0.01");
    let whole = fs::read_to_string(&specs).unwrap();
    assert_eq!(mocked(at, &["plan.jsonl", "there"]), Some(0), "one diverges");
    fs::write(&specs, whole + "{}\n").unwrap();
    assert_eq!(mocked(at, &["plan.jsonl", "there"]), Some(1));
    let here = command(PROGRAM, at, &["run", "--specs", "plan.jsonl", "--store", "here"]).output();
    assert_eq!(here.unwrap().status.code(), Some(2), "one diverges, and one is refused");
}

/// Completed work is kept, interrupted work is reported, and the same command completes it with the same
/// record.
#[test]
fn a_worker_that_is_killed_costs_its_run_alone() {
    let folder = tempfile::tempdir().unwrap();
    plan(folder.path(), "20");
    let run = |store: &str, index: &str| {
        let specs = ["run", "--specs", "plan.jsonl", "--threads", "1"];
        let rest = ["--store", store, "--index", index];
        command(PROGRAM, folder.path(), &[&specs[..], &rest].concat())
    };
    let store = folder.path().join("store");
    let begun = || {
        let names = fs::read_dir(&store).into_iter().flatten().flatten();
        names.filter(|entry| entry.file_name().to_string_lossy().starts_with(".begun-")).count()
    };
    assert_eq!(run("store", "4").output().unwrap().status.code(), Some(3));
    let mut worker = run("store", "2").stderr(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    while begun() == 0 && start.elapsed() < Duration::from_secs(20) {
        sleep(Duration::from_millis(1));
    }
    worker.kill().unwrap(); // SIGKILL
    worker.wait().unwrap();
    assert_eq!((begun(), records(&store).len()), (1, 1), "it was killed in mid-run");
    assert!(succeeds(run("store", "2")) && succeeds(run("whole", "2")));
    assert_eq!((begun(), records(&store).len()), (0, 2));
    assert!(records(&store).contains(&records(&folder.path().join("whole"))[0]));
}

/// A package `hyperqueue` that writes the tasks of a job into a file, a word a line, and runs none.
const HYPERQUEUE: &str = "
class Job:
    def __init__(self, max_fails=None): self.tasks = []
    def program(self, words, name=None): self.tasks.append(words)
class LocalCluster:
    def __enter__(self): return self
    def __exit__(self, *_): pass
    def start_worker(self, _): pass
    def client(self): return self
    def submit(self, job): open('tasks', 'w').write('\\n'.join(word for task in job.tasks for word in task))
    def wait_for_jobs(self, jobs, raise_on_error): return True
";

/// 0 lines a task were a traceback, and −1 made an empty job that succeeded.
#[test]
fn tasks_of_hyperqueue_keep_odd_paths_and_refuse_what_is_no_plan() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let package = at.join("packages/hyperqueue");
    fs::create_dir_all(&package).unwrap();
    fs::write(package.join("__init__.py"), HYPERQUEUE).unwrap();
    let cluster = "class WorkerConfig:\n    def __init__(self, cores): pass\n";
    fs::write(package.join("cluster.py"), cluster).unwrap();
    let script = contrib("hyperqueue_tasks.py");
    let python = |arguments: &[&str]| {
        let mut python = command("python3", at, &[&[&*script], arguments].concat());
        python.env("PYTHONPATH", at.join("packages"));
        python
    };
    if !succeeds(command("python3", at, &["--version"])) {
        return println!("skipped: there is no python3");
    }
    let odd = "it's a $(touch pwned) `touch pwned` {x} \"y\"";
    fs::create_dir(at.join(odd)).unwrap();
    fs::write(at.join(odd).join("p"), "a\n \n\nb\nc\n").unwrap();
    let [specs, store] = ["p", "st"].map(|of| at.canonicalize().unwrap().join(odd).join(of));
    run(python(&[specs.to_str().unwrap(), store.to_str().unwrap(), "2"]));
    let told = fs::read_to_string(at.join("tasks")).unwrap();
    let tasks: Vec<&str> = told.lines().collect();
    let paths = [specs.to_str().unwrap(), store.to_str().unwrap()];
    assert_eq!(tasks.len(), 28, "{tasks:?}");
    for (task, index) in tasks.chunks(14).zip(["0..2", "2..4"]) {
        assert_eq!(task[5..7], ["run", "--specs"], "{task:?}");
        assert_eq!([task[7], task[9], task[13]], [paths[0], paths[1], index], "{task:?}");
    }
    fs::write(at.join("empty"), "\n \n").unwrap();
    let specs = specs.to_str().unwrap();
    for arguments in
        [&[specs, "st", "0"][..], &[specs, "st", "-1"], &[specs, "st", "x"], &["empty", "st"]]
    {
        fs::remove_file(at.join("tasks")).unwrap_or_default();
        let output = python(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {output:?}");
        assert!(!at.join("tasks").exists() && !at.join("pwned").exists(), "{arguments:?}");
    }
}
