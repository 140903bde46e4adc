"""The module against the program that comes with it."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import all_pairs
import numpy as np
import pytest
import touchstone_sph as ts
from touchstone_sph import _program, _verdicts

CODE = Path(__file__).with_name("all_pairs.py")


def touchstone(*arguments):
    return subprocess.run([_program.find(), *arguments], capture_output=True, text=True, encoding="utf-8")


def test_every_case_has_a_problem():
    count = 0
    for name in ts.problems():
        try:
            of = ts.problem(name)
        except ts.Refused as why:
            assert "no scene" in str(why), name
            continue
        count += 1
        assert of.moving.any() and of.times[-1] > 0 and of.spacing > 0, name
        assert all(column.shape == of.moving.shape for column in of.particles.values()), name
        assert of.material["density"].unit == "kg/m^3", name
    assert count > 15


def test_settings_are_those_of_the_program():
    of = ts.problem("couette", "modern", rows=10, nu=np.float64(2e-6), wall_curvature=False)
    assert (of.settings["rows"], of.settings["nu"], of.settings["wall_curvature"]) == (10, 2e-6, False)
    assert of.walls[1].velocity.tolist() == [0.001, 0.0] and of.walls[1].normal.tolist() == [0, -1]
    with pytest.raises(ts.Refused, match="no case"):
        ts.problem("nothing")


def test_a_baseline_fails_what_gets_worse(tmp_path):
    of, file = ts.problem("couette", rows=10), tmp_path / "baseline.json"

    def judged(factor, **options):
        frames = [{"t": t, **of.particles, "u": factor * of.particles["u"]} for t in of.times]
        return ts.judge(of, frames, baseline=file, **options)

    with pytest.raises(ts.Refused, match="no baseline"):
        judged(1.0)
    first = judged(1.0, update_baseline=True)
    assert file.exists() and first.changes == []
    again = judged(1.0)
    assert {change.change for change in again.changes} == {"same"} and again.passes is False, "gates fail"
    of.particles["v"] = of.particles["v"] + 1e-5
    worse = {change.metric: change for change in judged(1.0).changes if change.fails}
    assert worse["v_rms"].before == 0 and worse["v_rms"].now > 10 * worse["v_rms"].resolution


def test_verdicts_are_those_of_the_command(tmp_path):
    own = tmp_path / "own"
    assert touchstone("export", "couette", "--solve", "--out", str(own)).returncode == 0
    columns = {}
    if (own / "results.csv").exists():
        rows = np.genfromtxt(own / "results.csv", delimiter=",", skip_header=1)
        heads = next(csv.reader(open(own / "results.csv")))
        columns = {head.split("[")[0]: rows[:, k] for k, head in enumerate(heads)}
    frames = [{k: v[columns["t"] == t] for k, v in columns.items()} | {"t": t} for t in np.unique(columns["t"])]
    method = json.loads((own / "method.json").read_text())
    found = ts.judge(ts.load(own), frames, method, store=tmp_path / "ours")
    assert found.passes and found.verdicts[0].gate == "couette.consistent.20.l2@0.1"
    ended = touchstone("submit", "couette", str(own), "--store", str(tmp_path / "theirs"))
    assert ended.returncode == 0
    ours, theirs = (ts.records(tmp_path / name) for name in ("ours", "theirs"))
    assert len(ours) == 1 and ours[0]["metrics.l2@0.1"] == found.metrics["l2@0.1"]
    metrics = [{k: v for k, v in row.items() if k.startswith("metrics.")} for (row,) in (ours, theirs)]
    assert metrics[0] == metrics[1]


def test_a_wrong_velocity_fails_its_gate():
    problem = ts.problem("couette")
    frames = [{"t": t, **problem.particles} for t in problem.times]
    found = ts.judge(problem, frames)
    assert found.passes is False
    (gate,) = [of for of in found.verdicts if of.verdict == "fail"]
    assert gate.metric == "l2@0.1" and gate.value > 0.99 and gate.bound == {"below": 0.0204114}


def test_faults_of_frames_are_named():
    problem = ts.problem("shear_wave")
    start = dict(problem.particles)
    with pytest.raises(ValueError, match="no frames"):
        ts.judge(problem, [])
    with pytest.raises(ValueError, match="lacks u"):
        ts.judge(problem, [{"t": 0, "x": start["x"], "y": start["y"], "v": start["v"]}])
    with pytest.raises(ValueError, match="y has 3 numbers; expected .* 256"):
        ts.judge(problem, [{"t": 0, **start, "y": start["y"][:3]}])
    with pytest.raises(ts.Refused, match="refused"):
        ts.judge(problem, [{"t": 0.1, **start}])


def test_frames_whose_arrays_change_in_place_are_kept():
    problem = ts.problem("couette")

    def moves():
        x = problem.particles["x"].copy()
        for t in problem.times:
            yield {"t": t, **problem.particles, "x": x}
            x += 0.01

    found = _verdicts.collect(problem, moves())
    x = found.table[:, found.names.index("x")].reshape(problem.times.size, -1)
    assert x[1] - x[0] == pytest.approx(0.01) and x[-1] - x[-2] == pytest.approx(0.01)


def test_what_a_code_lacks_is_declined_by_name():
    tank, disk = ts.problem("dam_break", n=10), ts.problem("spinning_disk")
    tank.decline(*tank.features.keys() - {"walls as particles", "free surfaces"})
    with pytest.raises(ts.NotApplicable, match="no free surfaces"):
        tank.decline("solids", "free surfaces")
    with pytest.raises(KeyError, match="gravity"):
        disk.decline("gravity")
    low, size = tank.box(0.1)
    x = tank.particles["x"]
    assert (low[0], low[0] + size[0]) == (x.min() - 0.1, pytest.approx(x.max() + 0.1))


def test_the_factor_of_a_planted_fault_is_found(monkeypatch):
    monkeypatch.setattr(all_pairs, "VISCOSITY", 1.94)
    (answer,) = ts.probe(all_pairs.solve, "viscous-force")
    assert answer.verdict == "fail" and abs(answer.factor / 1.94 - 1) < 0.01
    assert "expected at least" in str(answer) and "**fail**" in ts.summary([answer])


def test_a_function_and_its_program_have_equal_answers():
    command = [sys.executable, str(CODE), "--argument-of-the-code"]
    (one,), (other,) = ts.probe(all_pairs.solve, "mirrored"), ts.probe(command, "mirrored")
    assert one == other and one.verdict == "pass"


def test_the_end_of_a_function_is_an_answer():
    def declines(problem):
        raise ts.NotApplicable("it has no\nwalls")

    def breaks(problem):
        raise KeyError("gamma")

    (answer,) = ts.probe(declines, "spin")
    assert (answer.verdict, answer.answer) == ("not applicable", "walls")
    (answer,) = ts.probe(breaks, "spin")
    assert answer.verdict == "fail" and "KeyError: 'gamma' (test_module.py, line" in answer.answer
    (answer,) = ts.probe(lambda problem: [], "spin")
    assert answer.verdict == "fail" and "no frames" in answer.answer
    with pytest.raises(ts.Refused, match="there are ran, density"):
        ts.probe(breaks, "nothing")


def test_a_late_function_fails_and_the_next_question_is_asked():
    def sleeps(problem):
        import time

        time.sleep(1.5 if problem.name == "spinning_disk" else 0)
        raise ts.NotApplicable("awake")

    spin, wave = sorted(ts.probe(sleeps, ["spin", "shear-wave"], timeout=1), key=lambda of: of.id, reverse=True)
    assert spin.verdict == "fail" and "did not end within 1 s" in spin.answer
    assert (wave.verdict, wave.answer) == ("not applicable", "awake")


def test_a_program_without_a_folder_says_how_it_is_used():
    ended = subprocess.run([sys.executable, str(CODE)], capture_output=True, text=True)
    assert ended.returncode == 1 and "FOLDER" in ended.stderr


def test_answers_of_the_program_are_a_table(tmp_path):
    file = tmp_path / "probe.json"
    file.write_text(touchstone("probe", "--json", "--only", "spin", "--variant", "lagrangian").stdout, "utf-8")
    ended = subprocess.run([sys.executable, "-m", "touchstone_sph", str(file)], capture_output=True, encoding="utf-8")
    assert ended.returncode == 0 and "| Does a spinning disk" in ended.stdout


def test_pytest_asks_one_question_a_test(pytester):
    code = pytester.makepyfile(
        run="""
        import sys, touchstone_sph as ts, all_pairs
        all_pairs.VISCOSITY = 0.5
        ts.main(all_pairs.solve)
        """
    )
    code.with_name("all_pairs.py").write_text(CODE.read_text("utf-8"), "utf-8")
    ended = pytester.runpytest_subprocess("--touchstone", "run.py", "-rs", "-k", "viscous-force or spin or mirrored")
    ended.assert_outcomes(passed=1, failed=1, skipped=1, deselected=22)
    ended.stdout.fnmatch_lines(["*the viscous force is 0.500* times the stated one*", "*SKIPPED*no solids*"])
    ended = pytester.runpytest_subprocess("--touchstone", "nothing.py")
    ended.stderr.fnmatch_lines(["*there is no such file*"])


def test_the_example_of_the_documents_prints_what_they_show(tmp_path):
    folders = Path(__file__).parents
    pages = [page for page in (folders[1] / "python.md", folders[3] / "docs" / "python.md") if page.exists()]
    page = pages[0].read_text("utf-8")
    block = lambda language: page.split(f"```{language}\n")[1].split("\n```")[0]
    code = tmp_path / "run.py"
    code.write_text(block("python"), "utf-8")
    command, *shown = block("text").split("\n")
    words = command.split("#")[0].split()[2:]
    ended = touchstone(*(str(code) if word == "run.py" else word for word in words))
    assert ended.returncode == 1, ended.stderr
    assert all(line in ended.stdout for line in shown), ended.stdout
