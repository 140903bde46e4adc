"""``pytest --touchstone run.py``: one test for each question of ``touchstone probe``.

The diagnosis is the text of a failure; a question that is not applicable is skipped, with its reason.
``-k viscous-force`` selects a question, ``-m touchstone`` all of them.
"""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Any

import pytest

from . import _program
from ._questions import answers, questions


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("touchstone", "questions to a particle code")
    group.addoption(
        "--touchstone",
        metavar="PATH",
        help="the code: a Python file or a program, which is called with the folder of each problem, or a folder "
        "with a probe.toml",
    )
    group.addoption(
        "--touchstone-args",
        metavar="ARGS",
        default="",
        help="options of `touchstone probe`, such as '--wall-particles --timeout 300'",
    )


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "touchstone: a question of `touchstone probe`")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(session: pytest.Session, config: pytest.Config, items: list[pytest.Item]) -> None:
    named = config.getoption("touchstone")
    if named is not None:
        code = Code.from_parent(session, path=Path(named).resolve())
        items.extend(code.collect())


class Code(pytest.File):
    """The code under test."""

    def collect(self) -> list[pytest.Item]:
        if not self.path.exists():
            raise pytest.UsageError(f"--touchstone {self.path}: there is no such file")
        return [Question.from_parent(self, name=name, text=text) for name, text in questions().items()]

    def command(self) -> list[str]:
        """The arguments of `probe` that name the code."""
        if self.path.is_dir():
            return ["--code", str(self.path)]
        return ["--", *([sys.executable] if self.path.suffix == ".py" else []), str(self.path)]


class Wrong(AssertionError):
    """The code is wrong; the text is the diagnosis."""


class Question(pytest.Item):
    """One question."""

    def __init__(self, *, text: str, **of: Any) -> None:
        super().__init__(**of)
        self.text = text
        self.add_marker("touchstone")

    def runtest(self) -> None:
        options = shlex.split(self.config.getoption("touchstone_args"))
        arguments = ["probe", "--json", "--only", self.name, *options, *self.parent.command()]
        (answer,) = answers(_program.answer(*arguments, judged=True))
        if answer.verdict == "not applicable":
            pytest.skip(answer.answer)
        if answer.verdict != "pass":
            raise Wrong(str(answer))

    def repr_failure(self, excinfo: Any, style: Any = None) -> Any:
        if isinstance(excinfo.value, (Wrong, _program.Refused)):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, None, str]:
        return self.path, None, f"{self.name}: {self.text}"
