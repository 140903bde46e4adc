"""``python -m touchstone_sph FILE``: the answers that ``touchstone probe --json`` wrote, as a table in Markdown."""

import json
import sys
from pathlib import Path

from ._questions import answers, summary

if len(sys.argv) != 2:
    sys.exit("usage: python -m touchstone_sph FILE (what `touchstone probe --json` printed)")
print(summary(answers(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))))
