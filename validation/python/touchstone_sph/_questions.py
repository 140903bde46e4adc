"""Questions to a code, by ``touchstone probe``, and their answers."""

from __future__ import annotations

import json
import os
import platform
import secrets
import socket
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional, Union

from . import _call, _program
from ._problem import DOCUMENT, NotApplicable, Problem, _read
from ._verdicts import Frame, collect, write

#: Exit code of a code that cannot solve a problem.
DECLINES = 77
#: Interval between two looks whether the program has ended [s].
LOOK = 0.05

#: A code: the particles at the times of a problem.
Solver = Callable[[Problem], Iterable[Frame]]


@dataclass(frozen=True)
class Criterion:
    """A number of an answer, and the bounds between which it passes."""

    name: str
    #: None if it is not finite.
    value: Optional[float]
    at_least: Optional[float]
    at_most: Optional[float]
    passes: bool
    #: The reason for the bounds.
    because: str


@dataclass(frozen=True)
class Answer:
    """The answer to a question."""

    id: str
    question: str
    #: ``pass``, ``fail`` or ``not applicable``.
    verdict: str
    #: In words, such as "the viscosity is 1.97 ± 0.03 times the stated one".
    answer: str
    #: The factor by which the code is off [-] and its uncertainty, where the answer is one.
    factor: Optional[float]
    uncertainty: Optional[float]
    criteria: tuple[Criterion, ...]

    def __str__(self) -> str:
        words = f"{self.question} {self.verdict}: {self.answer}"
        for of in self.criteria:
            if not of.passes:
                low, high = of.at_least, of.at_most
                bound = [f"at least {low}"] * (low is not None) + [f"at most {high}"] * (high is not None)
                words += f"\n  {of.name} is {of.value}; expected {', '.join(bound)}, because {of.because}"
        return words


def questions() -> dict[str, str]:
    """All questions by their names.

    >>> questions()["shear-wave"]
    'Does a shear wave decay as exp(-νk²t)?'
    """
    return {of["id"]: of["question"] for of in _program.answer("probe", "--list", "--json")}


def probe(
    code: Union[Solver, str, Iterable[str]],
    only: Union[str, Iterable[str], None] = None,
    method: Optional[Mapping[str, Any]] = None,
    wall_particles: bool = False,
    timeout: float = 60,
) -> list[Answer]:
    """Asks a code questions with one short problem each, by ``touchstone probe``.

    Args:
        code: a function of a `Problem` that returns or yields its particles (see `judge` for the columns), or a
            command that is called with the folder of each problem as its last argument.
        only: names of questions, otherwise all of `questions`.
        method: facts on the method of a function; ``{"settings": {"time_order": 2}}`` states the order of its steps,
            ``{"settings": {"gradient_correction": True}}`` that its gradient is exact for linear fields.
        wall_particles: state walls as particles in place of planes.
        timeout: wall time after which a problem has failed [s].

    A function that raises `NotApplicable` declines a problem; any other exception fails it.

    Raises:
        Refused: if a question is unknown.

    >>> def at_rest(problem):
    ...     if problem.walls:
    ...         raise NotApplicable("it has no walls")
    ...     return [{"t": t, **problem.particles} for t in problem.times]
    >>> for answer in probe(at_rest, only=["shear-wave", "moving-wall"]):
    ...     print(answer.verdict, "-", answer.answer)
    fail - the results do not determine the viscosity
    not applicable - it has no walls
    """
    only = [only] if isinstance(only, str) else list(only or [])
    arguments = ["--json", "--timeout", str(max(1, round(timeout)))]
    arguments += ["--only", ",".join(only)] if only else []
    arguments += ["--wall-particles"] if wall_particles else []
    if callable(code):
        return _serve(code, arguments, method)
    command = [code] if isinstance(code, str) else list(code)
    return answers(_program.answer("probe", *arguments, "--", *command, judged=True))


def answers(document: list[dict[str, Any]]) -> list[Answer]:
    """The answers in the document that ``touchstone probe --json`` prints."""
    return [
        Answer(
            of["id"],
            of["question"],
            of["verdict"],
            of["answer"],
            of.get("factor"),
            of.get("uncertainty"),
            tuple(_criterion(one) for one in of.get("criteria", [])),
        )
        for of in document
    ]


def _criterion(of: dict[str, Any]) -> Criterion:
    value = of["value"] if isinstance(of["value"], (int, float)) else None
    return Criterion(of["name"], value, of.get("at_least"), of.get("at_most"), of["passes"], of["because"])


def _serve(code: Solver, arguments: list[str], method: Optional[Mapping[str, Any]]) -> list[Answer]:
    """Lets the program call `_call.py` for each problem, and solves in this process what comes from there."""
    token = secrets.token_hex()
    with socket.create_server(("127.0.0.1", 0)) as server, tempfile.TemporaryFile() as out, \
            tempfile.TemporaryFile() as err:
        server.settimeout(LOOK)
        called = [sys.executable, "-I", "-S", _call.__file__, str(server.getsockname()[1])]
        command = [_program.find(), "probe", *arguments, "--", *called]
        process = subprocess.Popen(command, stdout=out, stderr=err, env={**os.environ, _call.TOKEN: token})
        try:
            while process.poll() is None:
                try:
                    connection, _ = server.accept()
                except socket.timeout:
                    continue
                with connection:
                    _reply(connection, token, code, method)
        finally:
            process.terminate()
            process.wait()
        out.seek(0), err.seek(0)
        text = out.read().decode()
        if not text.strip():
            raise _program.Refused(_program.reason(err.read().decode()))
        return answers(json.loads(text))


def _reply(connection: socket.socket, token: str, code: Solver, method: Optional[Mapping[str, Any]]) -> None:
    """Solves one problem for the process at the other end."""
    connection.settimeout(None)
    with connection.makefile("rw", encoding="utf-8") as stream:
        asked = json.loads(stream.readline() or "{}")
        if asked.get("token") != token:
            return
        status, words = solve_in(code, Path(asked["folder"]), method, asked["threads"])
        try:
            stream.write(json.dumps({"status": status, "words": words}) + "\n")
            stream.flush()
        except OSError:
            pass  # the program no longer waits: the time was up


def solve_in(code: Solver, folder: Path, method: Optional[Mapping[str, Any]], threads: int) -> tuple[int, str]:
    """Solves the problem in a folder and writes the results there; exit code and reason."""
    started = time.perf_counter()
    try:
        problem = _read(folder, folder, threads)
        results = collect(problem, code(problem))
        system = {"machine": platform.processor() or platform.machine(), "seconds": time.perf_counter() - started}
        write(problem, results, folder, method, system)
    except NotApplicable as why:
        return DECLINES, str(why) or "it gave no reason"
    except Exception as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        words = " ".join(str(error).split())
        return 1, f"{type(error).__name__}: {words} ({Path(place.filename).name}, line {place.lineno})"
    return 0, ""


def main(code: Solver, method: Optional[Mapping[str, Any]] = None) -> None:
    """Makes a program of a function, for ``touchstone probe -- python run.py``.

    The last line of ``run.py`` is ``touchstone_sph.main(solve)``. The program solves the problem in the folder that
    its last argument names, and ends with exit code 77 if the function raises `NotApplicable`. Arguments before the
    folder are for the code.
    """
    folder = Path(sys.argv[-1])
    if len(sys.argv) < 2 or not (folder / DOCUMENT).exists():
        sys.exit(f"usage: {sys.argv[0]} FOLDER (of a problem, written by `touchstone export` or `touchstone probe`)")
    threads = int(os.environ.get("OMP_NUM_THREADS", "1"))
    status, words = solve_in(code, folder, method, threads)
    if status:
        print(words, file=sys.stderr)
        sys.exit(status)


def summary(answers: Iterable[Answer]) -> str:
    """Answers as a table in Markdown, for example for the summary of a job.

    >>> fine = Answer("spin", "Does it turn?", "pass", "as it should", None, None, ())
    >>> print(summary([fine]))
    1 pass, 0 fail, 0 not applicable
    <BLANKLINE>
    | Question | Verdict | Answer |
    |---|---|---|
    | Does it turn? | pass | as it should |
    """
    answers = list(answers)
    verdicts = [of.verdict for of in answers]
    counts = ", ".join(f"{verdicts.count(name)} {name}" for name in ("pass", "fail", "not applicable"))
    rows = [(of.question, f"**{of.verdict}**" if of.verdict == "fail" else of.verdict, of.answer) for of in answers]
    lines = [" | ".join(" ".join(cell.replace("|", "\\|").split()) for cell in row) for row in rows]
    table = "\n".join(f"| {line} |" for line in lines)
    return f"{counts}\n\n| Question | Verdict | Answer |\n|---|---|---|\n{table}"
