"""PySPH: touchstone probe --wall-particles -- python run.py wcsph|tvf|edac

Runs the script that `touchstone export --format pysph` writes.
"""
import os
import runpy
import sys
from pathlib import Path

import touchstone_sph as ts

SCRIPT = Path(__file__).resolve().parents[3] / "validation/exchange/src/write/run_pysph.py"

scheme, folder = sys.argv[1:]
problem = ts.load(folder)
try:
    problem.decline("solids", "rigid bodies", "walls as planes", "free slip")
    if scheme != "wcsph":
        problem.decline("free surfaces")  # the background pressure needs particles all around
except ts.NotApplicable as why:
    sys.exit(print(why, file=sys.stderr) or 77)
os.chdir(folder)
sys.argv[:] = [str(SCRIPT), scheme]
runpy.run_path(str(SCRIPT), run_name="__main__")
