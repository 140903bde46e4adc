"""Raw results of runs that are kept in a folder: a run whose result is there is not made again."""

import argparse
import time
from pathlib import Path

import numpy as np


def folder(described):
    """The folder that `--runs` names on the command line, made if it is missing."""
    parser = argparse.ArgumentParser(description=described)
    parser.add_argument("--runs", type=Path, required=True, help="folder that keeps the raw results")
    runs = parser.parse_args().runs
    runs.mkdir(parents=True, exist_ok=True)
    return runs


def make(folder, runs, file, simulate, told):
    """Makes the runs, each by its keyword arguments, whose file is missing; prints what `told` says of each."""
    for run in runs:
        path = folder / file(**run)
        if path.exists():
            continue
        start = time.process_time()
        result = simulate(**run)
        seconds = time.process_time() - start
        np.savez_compressed(path, **result, seconds=seconds)
        print(f"{path.stem}: {seconds:.0f} s, {told(run, result)}", flush=True)
