"""Raw results of runs that are kept in a folder: a run whose result is there is not made again."""

import time

import numpy as np


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
