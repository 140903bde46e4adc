"""Results of a code, their measurement and verdicts."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, Optional, Union

import numpy as np

from . import _program
from ._problem import DOCUMENT, Problem, Quantity

#: Particles at one time: ``t`` [s], arrays ``x``, ``y`` [m], ``u``, ``v`` [m/s] and, if the code has it,
#: ``density`` [kg/m³], of the moving particles in the order of the problem, or of all; ``id`` states another order.
Frame = Mapping[str, Any]

#: What a method is where nothing else is stated.
METHOD = {
    "code": "unnamed",
    "version": "unknown",
    "scheme": "unknown",
    "division": "closed",
    "settings": {},
    "changed": "",
}
SYSTEM = {"machine": "unknown", "threads": 1, "seconds": "unknown", "steps": "unknown", "interactions": "unknown"}
#: What a frame may state of the run so far: the number of steps, and the time [s] of the loop over them.
COST = {"steps": int, "seconds": float}
#: Columns of results, with the format that has all digits of a double.
COLUMNS = {"t": "%.17g", "id": "%d", **dict.fromkeys(("x", "y", "u", "v"), "%.17g")}
DENSITY = "density"


@dataclass(frozen=True)
class Verdict:
    """The verdict of one gate."""

    #: Names of the gate and of the metric that it reads.
    gate: str
    metric: str
    #: ``pass``, ``fail``, ``limitation``, ``expected-failure``, or ``not applicable``.
    verdict: str
    #: The number, None if there is none, and its unit.
    value: Optional[float]
    unit: str
    #: ``{"below": x}``, ``{"above": x}``, ``{"within": [low, high]}`` or ``{"equals": x}``.
    bound: Optional[dict[str, Any]]
    #: The reason for the bound, or why the gate is not applicable.
    because: str


@dataclass(frozen=True)
class Change:
    """A metric in the baseline of a code and now."""

    metric: str
    unit: str
    #: The values; None of a metric that is not measured.
    before: Optional[float]
    now: Optional[float]
    #: The largest difference that counts as none.
    resolution: float
    #: ``same``, ``better``, ``new``, or a failure: ``worse``, ``gone``, ``changed`` (it has no better direction).
    change: str

    @property
    def fails(self) -> bool:
        """Does it break the promise that nothing became worse?"""
        return self.change in ("worse", "gone", "changed")


@dataclass(frozen=True)
class Judgement:
    """How wrong the results of a code are."""

    #: Every metric of the case by name.
    metrics: dict[str, Quantity]
    #: One for each gate of these settings.
    verdicts: list[Verdict]
    #: The whole record, as ``touchstone submit --store`` keeps it.
    record: dict[str, Any]
    #: Every metric of the baseline and of these results; empty without a baseline.
    changes: list[Change] = field(default_factory=list)

    @property
    def passes(self) -> Optional[bool]:
        """Did no gate fail, and no metric of the baseline? None if no gate applies and there is no baseline."""
        fails = [of.verdict == "fail" for of in self.verdicts if of.verdict != "not applicable"]
        fails += [of.fails for of in self.changes]
        return not any(fails) if fails else None


def save(
    problem: Problem,
    frames: Iterable[Frame],
    folder: Union[str, Path],
    method: Optional[Mapping[str, Any]] = None,
    system: Optional[Mapping[str, Any]] = None,
) -> None:
    """Writes results as a submission: problem, method, system and ``results.csv``.

    Args:
        problem: the problem that was solved.
        frames: the particles at each of ``problem.times``, ascending; see `judge`.
        folder: where the files are written.
        method: ``code``, ``version``, ``scheme``, ``division``, ``settings``, ``changed``; each may be left out.
        system: ``machine``, ``threads``, ``seconds``, ``steps``, ``interactions``; each may be left out.

    Raises:
        ValueError: if a frame lacks a column, or its arrays have the wrong length.
    """
    write(problem, collect(problem, frames), folder, method, system)


class Results(NamedTuple):
    """Results of a code as they are written."""

    #: One row for each moving particle and time, shape (rows, columns), and the names of the columns.
    table: np.ndarray
    names: list[str]
    #: Steps and seconds of the run, as far as the frames state them.
    cost: dict[str, float]


def collect(problem: Problem, frames: Iterable[Frame]) -> Results:
    """Copies each frame when it is there: a code may change its arrays in place for the next one."""
    rows, names, cost = [], None, {}
    for frame in frames:
        names = names or ([*COLUMNS, DENSITY] if DENSITY in frame else [*COLUMNS])
        rows.append(_rows(problem, frame, names))
        cost |= {name: kind(frame[name]) for name, kind in COST.items() if name in frame}
    if not rows or names is None:
        raise ValueError("there are no frames; expected one at each of problem.times")
    return Results(np.concatenate(rows), names, cost)


def write(
    problem: Problem,
    results: Results,
    folder: Union[str, Path],
    method: Optional[Mapping[str, Any]],
    system: Optional[Mapping[str, Any]],
) -> None:
    """Writes the files of a submission; see `save`."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name, of in [
        (DOCUMENT, problem.document),
        ("method.json", {**METHOD, **(method or {})}),
        ("system.json", {**SYSTEM, "threads": problem.threads, **(system or {}), **results.cost}),
    ]:
        (folder / name).write_text(json.dumps(of, indent=1, default=_plain), encoding="utf-8")
    formats = [COLUMNS.get(name, "%.17g") for name in results.names]
    with open(folder / "results.csv", "w", encoding="utf-8", newline="\n") as file:
        np.savetxt(file, results.table, formats, ",", header=",".join(results.names), comments="")


def _plain(value: Any) -> Any:
    """A scalar or array of NumPy as JSON has it."""
    return np.asarray(value).tolist()


def _rows(problem: Problem, frame: Frame, names: list[str]) -> np.ndarray:
    """The moving particles of a frame, shape (N, columns)."""
    ids = problem.particles["id"]
    missing = [name for name in names if name != "id" and name not in frame]
    if missing:
        raise ValueError(f"a frame lacks {', '.join(missing)}; it has {', '.join(frame)}")
    count = np.size(frame["x"])
    if "id" in frame:
        number = np.asarray(frame["id"], dtype=np.int64).ravel()
    elif count == ids.size:
        number = ids
    else:
        number = ids[problem.moving]
    table = np.empty((number.size, len(names)))
    for place, name in enumerate(names):
        values = number if name == "id" else np.asarray(frame[name], dtype=float)
        if name != "t" and values.size != number.size:
            expected = f"{np.count_nonzero(problem.moving)} moving, or {ids.size} in all"
            raise ValueError(f"{name} has {values.size} numbers; expected one for each particle: {expected}")
        table[:, place] = values.ravel() if name != "t" else float(values)
    return table[np.isin(number, ids[problem.moving])]


def judge(
    problem: Problem,
    frames: Iterable[Frame],
    method: Optional[Mapping[str, Any]] = None,
    system: Optional[Mapping[str, Any]] = None,
    store: Union[str, Path, None] = None,
    baseline: Union[str, Path, None] = None,
    update_baseline: bool = False,
) -> Judgement:
    """Measures and judges the results of a code, by ``touchstone submit``.

    Args:
        problem: the problem that was solved.
        frames: one for each of ``problem.times``: ``t`` [s] and arrays ``x``, ``y`` [m], ``u``, ``v`` [m/s] and
            ``density`` [kg/m³] of the moving particles in the order of the problem, shape (M,), or of all, shape (N,).
            ``density`` may be left out of all frames. ``steps`` and ``seconds`` may state the number of steps so far,
            and the time of the loop over them.
        method: ``code``, ``version``, ``scheme``, ``settings`` and so on; see `save`.
        system: ``seconds`` of the time loop and so on; see `save`.
        store: a folder that keeps the record.
        baseline: a file with the metrics of an earlier version of the code, with which these are compared.
        update_baseline: writes the metrics into that file, which may be absent, and fails no change.

    Raises:
        Refused: if results are incomplete or not those of the problem; the text names every fault.
        ValueError: if a frame lacks a column, or its arrays have the wrong length.

    >>> from touchstone_sph import problem
    >>> rest = problem("couette", rows=10)
    >>> found = judge(rest, [{"t": t, **rest.particles} for t in rest.times])
    >>> round(found.metrics["l2@0.1"], 6)   # the plate does not drag this fluid: all of the velocity is missing
    1.0
    >>> found.passes
    False
    """
    with tempfile.TemporaryDirectory() as folder:
        submission, kept = Path(folder, "submission"), Path(folder, "store")
        save(problem, frames, submission, method, system)
        options = ["--baseline", str(baseline)] if baseline is not None else []
        options += ["--update-baseline"] if update_baseline else []
        submit = ["submit", problem.name, str(submission), "--json", "--store"]
        of = _program.answer(*submit, str(kept), *options, judged=True)
        if store is not None:
            _program.run(*submit, str(store), judged=True)
        (path,) = kept.glob("*.json")
        record = json.loads(path.read_text(encoding="utf-8"))
    metrics = {name: _quantity(metric) for name, metric in of.get("metrics", {}).items()}
    verdicts = [*map(_verdict, of["judged"]), *map(_skipped, of["not_applicable"].items())]
    changes = [] if update_baseline else [_change(change) for change in of.get("baseline", [])]
    return Judgement(metrics, verdicts, record, changes)


def _number(value: Any) -> Any:
    """A number of a document, in which infinities and NaN are objects."""
    return float(value["not_finite"]) if isinstance(value, dict) else value


def _quantity(metric: dict[str, Any]) -> Quantity:
    return Quantity(_number(metric["value"]), metric["unit"])


def _change(of: dict[str, Any]) -> Change:
    before, now, resolution = map(_number, (of["before"], of["now"], of["resolution"]))
    return Change(of["metric"], of["unit"], before, now, resolution, of["change"])


def _verdict(of: dict[str, Any]) -> Verdict:
    return Verdict(of["gate"], of["metric"], of["verdict"], of["value"], of["unit"], of["bound"], of["because"])


def _skipped(of: tuple[str, str]) -> Verdict:
    gate, because = of
    return Verdict(gate, "", "not applicable", None, "", None, because)


def records(store: Union[str, Path]) -> list[dict[str, Any]]:
    """The records of a store as rows of a table, for example for ``pandas.DataFrame``.

    A row has ``case``, ``variant``, ``status``, ``settings.NAME``, ``metrics.NAME``, ``cost.NAME`` and, of other
    codes, ``submission.NAME``; what a run lacks has no key.

    >>> records("a folder without records")
    []
    """
    rows = []
    for path in sorted(Path(store).glob("*.json")):
        of = json.loads(path.read_text(encoding="utf-8"))
        if "case" not in of or "metrics" not in of:
            continue
        row = {"case": of["case"], "variant": of["variant"], "status": of["status"]["kind"]}
        metrics = {name: float(_quantity(metric)) for name, metric in of["metrics"].items()}
        groups = {**of, "metrics": metrics}
        for group in ("submission", "settings", "metrics", "cost"):
            values = groups.get(group) or {}
            row.update({f"{group}.{name}": value for name, value in values.items() if not isinstance(value, dict)})
        rows.append(row)
    return rows
