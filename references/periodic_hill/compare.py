"""How far the tables of this folder are from those of another one: `python compare.py FOLDER`.

For each column with an uncertainty: root mean square and largest difference, and how many of them exceed
the larger of the two uncertainties.
"""

import csv
import sys
from pathlib import Path

import numpy as np

COLUMNS = {
    "profiles": {"u": "u_uncertainty", "v": "v_uncertainty"},
    "wall": {"hill_shear": "hill_shear_uncertainty", "lid_shear": "lid_shear_uncertainty"},
    "summary": {"value": "uncertainty"},
}


def read(folder, table):
    with open(Path(folder) / f"{table}.csv", newline="") as file:
        return list(csv.DictReader(file))


for table, columns in COLUMNS.items():
    here, there = (read(folder, table) for folder in (Path(__file__).parent, sys.argv[1]))
    assert len(here) == len(there), table
    for column, doubt in columns.items():
        a, b, a_doubt, b_doubt = (
            np.array([float(row[name]) for row in rows])
            for name in (column, doubt) for rows in (here, there)
        )
        apart = np.abs(a - b)
        over = int((apart > np.maximum(a_doubt, b_doubt)).sum())
        print(f"{table} {column}: rms {np.sqrt(np.mean(apart**2)):.1e}, largest {apart.max():.1e}, "
              f"{over} of {len(apart)} beyond the uncertainty")
