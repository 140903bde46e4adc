"""The program ``touchstone``, and its answers."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sysconfig
from pathlib import Path
from typing import Any

#: Exit code of a command that cannot be obeyed, and of one that judged nothing.
REFUSED = 2


class Refused(ValueError):
    """The program refuses a setting, a name or results; the text says which and why."""


def find() -> str:
    """Path of the program: of the environment variable ``TOUCHSTONE``, beside this Python, or on the path."""
    named = os.environ.get("TOUCHSTONE")
    if named:
        return named
    name = "touchstone" + (sysconfig.get_config_var("EXE") or "")
    for folder in (sysconfig.get_path("scripts"), sysconfig.get_path("scripts", f"{os.name}_user")):
        path = Path(folder, name)
        if path.exists():
            return str(path)
    found = shutil.which("touchstone")
    if found is None:
        raise FileNotFoundError("the program touchstone is neither beside this Python nor on the path")
    return found


def run(*arguments: str, judged: bool = False) -> str:
    """Standard output of a command. With ``judged``, exit codes 1 and 2 are answers if something was printed.

    Raises:
        Refused: if the command is refused.
    """
    ended = subprocess.run([find(), *arguments], capture_output=True, text=True, encoding="utf-8", check=False)
    if ended.returncode == 0 or (judged and ended.returncode in (1, REFUSED) and ended.stdout.strip()):
        return ended.stdout
    raise Refused(reason(ended.stderr) or f"touchstone ended with exit code {ended.returncode}")


def answer(*arguments: str, judged: bool = False) -> Any:
    """The JSON document that a command prints; see :func:`run`."""
    return json.loads(run(*arguments, judged=judged))


def reason(words: str) -> str:
    """The message of a command, without the name of the program."""
    return words.strip().replace("touchstone: ", "", 1)
