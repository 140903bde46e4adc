"""What is taken of a run: front, depths, energies, pockets of air at regular times; pressures at every step.

Lengths are in H, times in (H/g)^(1/2), pressures in rho g H, energies in M g H/2, the potential energy as
released.
"""

import numpy as np
import scipy.ndimage

import dam

NEAR = 0.25  # water below this counts when the foremost point is looked for, so that spray does not [H]
DEPTHS = (0.02, 0.05)  # depths that define a front [H]
BLOCK = 0.01  # pressures are means over blocks of this length [(H/g)^(1/2)]
POCKET = 0.01  # air that water cuts off from the atmosphere counts from this area on [H^2]


def values(path, count):
    """The cells of a binary field: count rows of as many components as it has."""
    content = path.read_bytes()
    start = content.index(b"internalField")
    line = content[start : content.index(b"\n", start)]
    columns = 3 if b"vector" in line else 1
    if b"nonuniform" not in line:
        inside = line.split(b"uniform", 1)[1].strip(b" ;()").split()
        return np.tile(np.array(inside, float), (count, 1)).squeeze()
    # The number of cells stands before the parenthesis.
    begin = content.index(b"(", start) + 1
    data = np.frombuffer(content, "<f8", count * columns, begin)
    return data.reshape(count, columns).squeeze()


def crossing(curve, level, dx):
    """x where a curve, given at the middles of cells, last falls through a level; 0 if there is none."""
    above = np.flatnonzero(curve >= level)
    if above.size == 0:
        return 0.0
    k = above[-1]
    if k + 1 == len(curve):
        return len(curve) * dx
    return dx * (k + 0.5 + (curve[k] - level) / (curve[k] - curve[k + 1]))


def topmost(column, dx):
    """Height of the topmost water of half a cell in a column."""
    return crossing(column, 0.5, dx)


def fronts(alpha, dx, near):
    """Foremost point with half of water below `near`, then the foremost x with each of the depths [H]."""
    rows = alpha[: int(round(near / dx))]
    depth = rows.sum(axis=0) * dx
    half = max(crossing(row, 0.5, dx) for row in rows)
    unit = near / NEAR
    return [half, *(crossing(depth, share * unit, dx) for share in DEPTHS)]


def cut_off(alpha, dx):
    """Area of the largest region of air that has no way to the top."""
    labels, count = scipy.ndimage.label(alpha < 0.5)
    areas = np.bincount(labels.ravel(), minlength=count + 1)
    areas[0] = 0
    areas[np.unique(labels[-1])] = 0
    return areas.max() * dx * dx


def mean(middles, depth, at, over):
    """Depth about a place, averaged with the hat function of half-width `over`."""
    weight = np.maximum(0.0, 1.0 - np.abs(middles - at) / over)
    return (weight * depth).sum() / weight.sum()


def sample(run, folder):
    """One row: names and values of what is measured at a time."""
    scene, dx, (nx, ny) = run.of, run.dx, run.cells
    h, count = scene.height, nx * ny
    alpha, p = (values(folder / name, count).reshape(ny, nx) for name in ("alpha.water", "p"))
    u = values(folder / "U", count).reshape(ny, nx, 3)
    cell, x, y = dx * dx, (np.arange(nx) + 0.5) * dx, (np.arange(ny) + 0.5) * dx
    water, air = dam.DENSITY["water"], dam.DENSITY["air"]
    volume = scene.width * h
    energy = 0.5 * water * volume * dam.GRAVITY * h
    square = 0.5 * (u**2).sum(axis=2) * cell
    depth = alpha.sum(axis=0) * dx
    row = dict(zip(("front", "front_depth_2", "front_depth_5"), fronts(alpha, dx, NEAR * h), strict=True))
    over = max(dam.HEIGHT_OVER * scene.width, dx)
    row["height"] = mean(x, depth, dam.HEIGHT_AT * scene.width, over)
    row["height_wall"] = depth[0]
    if scene.is_tank:
        for k, place in enumerate(dam.PROBES):
            row[f"H{k + 1}"] = np.interp(place, x, depth)
            row[f"top_H{k + 1}"] = topmost(alpha[:, np.argmin(abs(x - place))], dx)
    row["run_up"] = topmost(alpha[:, -1], dx)
    row = {name: value / h for name, value in row.items()}
    row["pocket"] = cut_off(alpha, dx) / h**2
    row["kinetic"] = water * (alpha * square).sum() / energy
    row["potential"] = water * dam.GRAVITY * (alpha * y[:, None]).sum() * cell / energy
    row["kinetic_air"] = air * ((1 - alpha) * square).sum() / energy
    row["water"] = alpha.sum() * cell / volume
    # For the balance of momentum: of all that is in the tank, and the force of the two side walls on it.
    scale = water * volume * (dam.GRAVITY * h) ** 0.5
    density = air + (water - air) * alpha
    row["momentum"] = (density * u[..., 0]).sum() * cell / scale
    row["force_back"], row["force_far"] = (
        p[:, k].sum() * dx / (water * dam.GRAVITY * volume) for k in (0, -1)
    )
    return row


def over_disk(y, pressures, height):
    """The mean over the disk of a sensor, of a pressure that is linear between the middles of the faces."""
    points = 64
    offset = (np.arange(points) + 0.5) / points * 2 - 1
    chord = np.sqrt(1 - offset**2)
    at = height + 0.5 * dam.DIAMETER * offset
    below = np.clip(np.searchsorted(y, at) - 1, 0, len(y) - 2)
    share = np.clip((at - y[below]) / (y[below + 1] - y[below]), 0, 1)
    weight = np.zeros(len(y))
    np.add.at(weight, below, chord * (1 - share))
    np.add.at(weight, below + 1, chord * share)
    return pressures @ (weight / weight.sum())


def sensors(run, folder):
    """Middles of the blocks and the pressures of the sensors in them."""
    scene = run.of
    rows = np.loadtxt(folder / "postProcessing/sensors/0/p", ndmin=2)
    t, pressures = rows[:, 0] / scene.unit, rows[:, 1:]
    y = (np.arange(pressures.shape[1]) + 0.5) * run.dx
    unit = dam.DENSITY["water"] * dam.GRAVITY * scene.height
    found = np.array([over_disk(y, pressures, height) for height in dam.SENSORS]) / unit
    # The mean over a block of what is linear between steps, so that a block without a step has one too.
    sums = np.array([np.concatenate(([0], np.cumsum(0.5 * (p[1:] + p[:-1]) * np.diff(t)))) for p in found])
    edges = np.arange(0, int(round(min(t[-1], scene.end) / BLOCK)) + 1) * BLOCK
    at_edges = np.array([np.interp(edges, t, one) for one in sums])
    return dict(p_t=edges[:-1] + 0.5 * BLOCK, p=np.diff(at_edges, axis=1) / BLOCK)


def read(run, folder):
    """All that is kept of a run."""
    times = sorted(
        (float(path.name), path)
        for path in folder.iterdir()
        if path.name[0].isdigit() and (path / "p").exists()
    )
    rows = [sample(run, path) for _, path in times]
    kept = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    kept["t"] = np.round(np.array([time for time, _ in times]) / run.of.unit, 6)
    if run.of.is_tank:
        kept |= sensors(run, folder)
    return kept


def load(folder, run):
    """What read.py took of a run, with the state at the release in front, or None if it has not been made."""
    path = folder / f"{run.label}.npz"
    if not path.exists():
        return None
    kept = dict(np.load(path))
    scene = run.of
    first = dict.fromkeys(kept, 0.0) | dict(height=1.0, height_wall=1.0, potential=1.0, water=1.0)
    first |= {name: scene.width / scene.height for name in ("front", "front_depth_2", "front_depth_5")}
    first["force_back"] = dam.released_force(scene.width, scene.height)
    if scene.is_tank:
        first |= dict(H1=1.0, top_H1=1.0)
    for name in kept:
        if name not in ("p", "p_t"):
            kept[name] = np.concatenate(([first[name]], kept[name]))
    return kept


def meshes(folder, scene):
    """The runs of a scene that were made, from coarse to fine."""
    found = [(n, load(folder, dam.Run(scene, n))) for n in dam.SCENES[scene].meshes]
    return [(n, kept) for n, kept in found if kept is not None]
