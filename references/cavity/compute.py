"""The lid-driven cavity: streamfunction and vorticity by finite differences, on three grids, extrapolated.

Steady flow in a unit square, lid at y = 1 with u = 1: u w_x + v w_y = (w_xx + w_yy)/Re, w = -(psi_xx + psi_yy),
u = psi_y, v = -psi_x. Central differences of second order on a grid that a smooth map refines tenfold at the
walls; the velocity of a wall enters by a point beyond it (Thom). Newton's iteration with a direct solver.
"""

import csv
import sys
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from scipy.interpolate import make_interp_spline
from scipy.optimize import brentq
from scipy.sparse.linalg import splu

import tables

HERE = Path(__file__).parent
GRIDS = (144, 216, 324)
REYNOLDS = (100, 400, 1000)
REFINED = 0.9


def place(s):
    """The map of the grid, s in [0, 1]; spacing is 1 - REFINED of the mean at the walls."""
    return s - REFINED * np.sin(2 * np.pi * s) / (2 * np.pi)


def operators(n):
    """d/dx and d2/dx2 from all n + 1 points to all, with a row of zeros at the walls; and their weight there
    of the point beside a wall, of a function that is 0 at the wall and whose slope at it is given."""
    s = np.arange(-1, n + 2) / n
    x = place(s)
    here, left, right = x[1:-1], np.diff(x)[:-1], np.diff(x)[1:]
    inside = np.arange(1, n)
    first = sp.lil_matrix((n + 1, n + 1))
    second = sp.lil_matrix((n + 1, n + 1))
    for i in inside:
        a, b = left[i], right[i]
        first[i, i - 1: i + 2] = [-b / (a * (a + b)), (b - a) / (a * b), a / (b * (a + b))]
        second[i, i - 1: i + 2] = [2 / (a * (a + b)), -2 / (a * b), 2 / (b * (a + b))]
    return here, first.tocsr(), second.tocsr(), right[0]


def solve(re, n, start):
    """psi at all points, by Newton's iteration."""
    x, d1, d2, a = operators(n)
    one = sp.identity(n + 1, format="csr")
    dx, dy = sp.kron(d1, one, "csr"), sp.kron(one, d1, "csr")
    laplace = sp.kron(d2, one) + sp.kron(one, d2)
    # Vorticity: inside -laplace psi; at a wall -2 (psi_beside + slope a)/a^2, slope of psi into the fluid.
    wall = sp.lil_matrix((n + 1, n + 1))
    wall[0, 1] = wall[n, n - 1] = 2 / a**2
    edges = sp.kron(wall, one) + sp.kron(one, wall)
    k = np.arange((n + 1) ** 2)
    i, j = k // (n + 1), k % (n + 1)
    is_inside = (i > 0) & (i < n) & (j > 0) & (j < n)
    vorticity = -(sp.diags(is_inside.astype(float)) @ laplace + edges).tocsr()
    lid = np.where((j == n) & (i > 0) & (i < n), -2 / a, 0.0)
    inner = np.flatnonzero(is_inside)
    psi = start.copy()
    for _ in range(12):
        w = vorticity @ psi + lid
        wx, wy, u, v = dx @ w, dy @ w, dy @ psi, -(dx @ psi)
        residual = (u * wx + v * wy - laplace @ w / re)[inner]
        jacobian = (sp.diags(u) @ dx + sp.diags(v) @ dy - laplace / re) @ vorticity
        jacobian = (jacobian + sp.diags(wx) @ dy - sp.diags(wy) @ dx).tocsc()[inner][:, inner]
        step = splu(jacobian.tocsc()).solve(-residual)
        psi[inner] += step
        if np.abs(step).max() < 1e-12:
            return x, psi.reshape(n + 1, n + 1)
    raise RuntimeError(f"Re {re}, {n} intervals: no convergence")


def middle(x, psi):
    """u over y on x = 1/2 and v over x on y = 1/2, as splines."""
    n, (_, d1, _, _) = len(x) - 1, operators(len(x) - 1)
    u, v = d1 @ psi[n // 2], -(d1 @ psi[:, n // 2])
    u[n] = 1.0
    return {"u": make_interp_spline(x, u, 5), "v": make_interp_spline(x, v, 5)}


def extremes(lines):
    """Place and value of the three extremes of the two lines."""
    def at(line, low, high):
        slope = lines[line].derivative()
        found = brentq(slope, low, high)
        return float(lines[line](found)), found
    return {"u_min": at("u", 0.05, 0.7), "v_max": at("v", 0.05, 0.5), "v_min": at("v", 0.7, 0.98)}


def extrapolated(values):
    """Value without the error that goes with the squared spacing, from the two finest grids; its distance from
    that of the two coarsest; the order of the three."""
    coarse, fine = np.diff(values)
    ratio = GRIDS[2] / GRIDS[1]
    pairs = [values[k + 1] + step / (ratio**2 - 1) for k, step in enumerate((coarse, fine))]
    order = np.log(abs(coarse / fine)) / np.log(ratio) if fine else np.nan
    return pairs[1], abs(pairs[1] - pairs[0]), order


def published():
    with (HERE / "published.csv").open() as file:
        return list(csv.DictReader(file))


def uniform():
    """Prints how far the same differences are off at the places of Ghia et al., without refinement at the walls."""
    global REFINED
    REFINED = 0.0
    with (HERE / "lines.csv").open() as file:
        known = [row for row in csv.DictReader(file) if row["source"] == "ghia" and row["quantity"] in "uv"]
    for n in (16, 32, 64, 128):
        psi = np.zeros((n + 1) ** 2)
        for re in range(100, 1001, 100):
            if re > 100 and n == 16:
                continue
            x, psi = solve(re, n, psi.ravel())
            inner = [row for row in known if float(row["re"]) == re and 0 < float(row["place"]) < 1]
            if not inner or re == 400:
                continue
            lines, is_u = middle(x, psi), np.array([row["quantity"] == "u" for row in inner])
            found = np.array([lines[row["quantity"]](float(row["place"])) for row in inner])
            exact = np.array([float(row["value"]) for row in inner])
            u, v = (np.sqrt(np.mean((found - exact)[of] ** 2)) for of in (is_u, ~is_u))
            strength, back = found @ exact / (exact @ exact) - 1, found[is_u].min() / exact[is_u].min() - 1
            print(f"Re {re}, n {n}: u_rms {u:.4f} v_rms {v:.4f} strength {strength:+.4f} return {back:+.4f}, "
                  f"times n^2 {u * n * n:.1f} {v * n * n:.1f} {strength * n * n:.1f} {back * n * n:.1f}", flush=True)


def main():
    flows = {}
    for n in GRIDS:
        psi = np.zeros((n + 1) ** 2)
        for re in REYNOLDS:
            x, psi = solve(re, n, psi.ravel())
            flows[re, n] = middle(x, psi)
            print(re, n, extremes(flows[re, n]), flush=True)
    rows = []
    for row in published():
        re, quantity, where = int(row["re"]), row["quantity"], row["place"]
        if quantity in "uv":
            values = [float(flows[re, n][quantity](float(where))) for n in GRIDS]
        else:
            name, k = quantity.removesuffix("_place"), int(quantity.endswith("_place"))
            values = [extremes(flows[re, n])[name][k] for n in GRIDS]
        value, doubt, order = extrapolated(values)
        print(re, quantity, where, f"{value:.7f} +- {doubt:.1e} order {order:.2f}",
              f"less published {value - float(row['value']):+.1e}")
        rows.append([re, quantity, where, tables.fixed(value, 7), tables.doubt(doubt, 7), *(
            tables.fixed(one, 7) for one in values), row["value"], row["source"]])
    described = [
        ("re", "integer", "-", "Reynolds number U L/nu"),
        ("quantity", "string", "-", "u on x = L/2, v on y = L/2; u_min, v_max, v_min: extremes of these lines; "
         "..._place: where they are [L]"),
        ("place", "number", "L", "y of u, x of v; empty for extremes"),
        ("value", "number", "U", "extrapolated; of a place in L"),
        ("uncertainty", "number", "U", "distance of the extrapolations from the two finest and the two coarsest grids"),
        *((f"grid_{n}", "number", "U", f"on {n} intervals a side") for n in GRIDS),
        ("published", "number", "U", "as published; of a place in L"),
        ("source", "string", "-", "ghia: Ghia, Ghia & Shin 1982; botella: Botella & Peyret 1998"),
    ]
    tables.write(HERE, {"lines": described}, {"lines": rows})


if __name__ == "__main__":
    uniform() if sys.argv[1:] == ["uniform"] else main()
