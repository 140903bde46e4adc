"""Computes the tables of this folder. `python compute.py` writes them; README.md says what."""

import time
from pathlib import Path

import numpy as np

import checks
import hill
import package
import tables

REYNOLDS = (10.0, 50.0, 100.0)
LEVELS = (0, 1, 2)
STATIONS = (0.05, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)
POINTS = 200
# Of a field to start from, on the middle mesh: closer together where the walls turn.
STARTS = (0.0, 0.125, 0.25, 0.375, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 3.0, 4.0, 5.0, 6.0,
          6.5, 6.75, 7.0, 7.25, 7.5, 7.75, 8.0, 8.25, 8.5, 8.625, 8.75, 8.875)
START_POINTS, START_LEVEL, START_DIGITS = 100, 1, 6
WALL = np.arange(361) * 0.025
LINE = 81
DIGITS = 8  # decimals of the tables


def solve():
    """One flow a level and Reynolds number: what the tables need of it, and the rows of its checks."""
    found, rows = {}, []
    for level in LEVELS:
        flow = hill.Flow(level)
        for re in REYNOLDS:  # each starts from the one before
            start = time.process_time()
            sizes = flow.solve(re)
            found[re, level] = quantities(flow, re)
            rows += checks.balances(flow, re)
            took = time.process_time() - start
            print(f"level {level}, Re {re:g}: {len(sizes)} steps of Newton's iteration, {took:.0f} s, "
                  f"force {flow.force:.8f}, {hill.turning_points(flow, re)}", flush=True)
    return found, rows


def heights(points):
    """The middles of equal parts of a section."""
    return (np.arange(points) + 0.5) / points


def across(flow, x, points):
    """u and v at those heights of the section at x."""
    s = heights(points)
    return tuple(flow.at(f, np.full_like(s, x), s) for f in (flow.u, flow.v))


def quantities(flow, re):
    profiles = {x: across(flow, x, POINTS) for x in STATIONS}
    starts = {x: across(flow, x, START_POINTS) for x in STARTS}
    pressure, shear, lid = flow.drag(re)
    numbers = {"force": flow.force, "hill_pressure_drag": pressure, "hill_shear_drag": shear,
               "lid_shear_drag": lid}
    turns = hill.turning_points(flow, re)
    if turns:
        (numbers["separation"], first), (numbers["reattachment"], second) = turns[:2]
        assert (first, second) == (-1, 1), turns
    hill_shear, lid_shear = flow.wall_shear(WALL, re), flow.lid_shear(WALL, re)
    numbers["hill_shear_max"], numbers["hill_shear_min"] = hill_shear.max(), hill_shear.min()
    line = None
    if len(turns) >= 2:
        xs = np.linspace(turns[0][0], turns[1][0], LINE)
        line = xs, np.concatenate([flow.hill(xs[:1])[0], hill.separation_line(flow, xs[1:-1]),
                                   flow.hill(xs[-1:])[0]])
    return dict(profiles=profiles, starts=starts, wall=(hill_shear, lid_shear), numbers=numbers, line=line,
                turns=turns)


UNITS = {"force": "U_b^2/H", "separation": "H", "reattachment": "H"}


def unit(quantity):
    return UNITS.get(quantity, "rho U_b^2 H" if quantity.endswith("drag") else "rho U_b^2")


# --- From three meshes to a value and its uncertainty ----------------------------------------------------

def order(coarse, middle, fine):
    """Observed order of a field; norms over its points, so that places where two meshes cross do not count."""
    first, second = (np.linalg.norm(np.subtract(a, b)) for a, b in ((middle, coarse), (fine, middle)))
    return np.log2(first / second) if second > 0 else np.nan


def extrapolated(of):
    """Value, uncertainty, order of a field or a number on three meshes. The value is Richardson's
    extrapolation. The uncertainty is Roache's index with an order of at most 2, which derivatives at the
    wall have: 1.25 times what that order would add to the finest mesh, not below the root mean square of
    that over the field. Where the meshes show no order, the finest mesh and 3 times its distance from the
    middle one (Roache 1994)."""
    (_, middle, fine), p = of, order(*of)
    distance = np.subtract(fine, middle)
    if 1.0 <= p <= 6.0:
        added, bound = distance / (2**p - 1), 1.25 * distance / (2 ** min(p, 2.0) - 1)
    else:
        added, bound, p = 0.0 * distance, 3.0 * distance, np.nan
    least = max(np.sqrt(np.mean(bound**2)), 0.5 * 10.0**-DIGITS)
    return fine + added, np.maximum(np.abs(bound), least), p


def fixed(x):
    return f"{x + 0.0:.{DIGITS}f}"


def doubt(x):
    return f"{x:.1e}"


def profile_rows(found):
    s = heights(POINTS)
    for re in REYNOLDS:
        for x in STATIONS:
            h = float(hill.Hill()(np.array(x))[0])
            both = []
            for component in (0, 1):
                both += extrapolated([found[re, level]["profiles"][x][component] for level in LEVELS])[:2]
            for k, y in enumerate(h + s * (hill.LID - h)):
                u, u_doubt, v, v_doubt = (one[k] for one in both)
                yield [f"{re:g}", x, fixed(y), fixed(u), doubt(u_doubt), fixed(v), doubt(v_doubt)]


def start_rows(found):
    s = heights(START_POINTS)
    for re in REYNOLDS:
        for x, both in found[re, START_LEVEL]["starts"].items():
            for share, u, v in zip(s, *both):
                yield [f"{re:g}", x, f"{share:g}", f"{u:.{START_DIGITS}f}", f"{v:.{START_DIGITS}f}"]


def wall_rows(found):
    height = hill.Hill()(WALL)[0]
    for re in REYNOLDS:
        both = []
        for wall in (0, 1):
            both += extrapolated([found[re, level]["wall"][wall] for level in LEVELS])[:2]
        for k, x in enumerate(WALL):
            a, a_doubt, b, b_doubt = (one[k] for one in both)
            yield [f"{re:g}", f"{x:.3f}", fixed(height[k]), fixed(a), doubt(a_doubt), fixed(b), doubt(b_doubt)]


def line_rows(found):
    for re in REYNOLDS:
        line = found[re, LEVELS[-1]]["line"]
        for x, y in zip(*line) if line else ():
            yield [f"{re:g}", fixed(x), fixed(y)]


def summary_rows(found):
    for re in REYNOLDS:
        for name in found[re, LEVELS[-1]]["numbers"]:
            of = [found[re, level]["numbers"][name] for level in LEVELS]
            value, spread, p = extrapolated(of)
            yield [f"{re:g}", name, unit(name), fixed(value), doubt(spread),
                   "" if np.isnan(p) else f"{p:.2f}", *map(fixed, of)]


def check_rows(rows):
    for check, re, mesh, value, expected in rows:
        yield [check, "" if re == "" else f"{re:g}", mesh, f"{value:.10g}",
               "" if expected == "" else f"{expected:g}"]


if __name__ == "__main__":
    every, balance = solve()
    known = [*checks.geometry()]
    for mesh in LEVELS[:2]:
        known += [*checks.flat(mesh), *checks.creeping(mesh)]
    tables.write(Path(__file__).parent, package.TABLES, {
        "profiles": profile_rows(every), "starts": start_rows(every),
        "wall": wall_rows(every), "line": line_rows(every), "summary": summary_rows(every), "checks": check_rows(known + balance),
    })
