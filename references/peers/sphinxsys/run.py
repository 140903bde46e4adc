"""Runs the problem of this folder with SPHinXsys: python run.py PROGRAM

PROGRAM is what `CMakeLists.txt` builds of `main.cpp`. Schemes are those of the examples
`poiseuille_flow`, `taylor_green` and `dambreak` of the code: density by summation, Riemann solver, two
time steps; with viscosity transport velocity, between walls also gradients exact for linear fields. A bar
runs as its `oscillating_beam`: total Lagrangian, law of St. Venant and Kirchhoff, its numerical damping.
A bar that a plane holds is continued behind it by particles at rest, a mirror image of those in front.
Rings have the Neo-Hookean law and the contact forces of its `three_ring_impact`.
"""
import os, subprocess, sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import Problem, Submission

problem = Problem()
fluid, margin = problem.fluid, 2 * problem.support
# Its constants assume lengths, velocities and densities near 1.
low, high = problem.x[fluid].min(axis=0) - problem.dx / 2, problem.x[fluid].max(axis=0) + problem.dx / 2
length, speed = (high - low).max(), problem.c0 / 10
if "body" in problem.columns:  # cells as far as bodies may come
    margin = length / 2
time = length / speed


material, elastic = problem.material, "shear_modulus" in problem.material
young = poisson = 0.0
if elastic:
    k, g = material["bulk_modulus"], material["shear_modulus"]
    young, poisson = 9 * k * g / (3 * k + g), (3 * k - 2 * g) / (2 * (3 * k + g))


def copies():
    """Wall particles, and their copies beyond the ends of a period; of a solid what holds it."""
    walls = np.concatenate([problem.x, problem.v], axis=1)[~fluid]
    for _, images in problem.held():
        walls = np.concatenate([walls, np.concatenate([images, np.zeros_like(images)], axis=1)])
    for axis, period in enumerate(problem.period):
        if period is not None and len(walls):
            step = np.zeros(4)
            step[axis] = period
            walls = np.concatenate([walls, walls + step, walls - step])
            middle = problem.low[axis] + period / 2
            walls = walls[np.abs(walls[:, axis] - middle) < period / 2 + margin]
    return walls


def lines():
    """The input of the program."""
    walls, (box_low, box_high) = copies(), (low - margin, high + margin)
    for axis, period in enumerate(problem.period):
        if period is not None:
            low[axis], high[axis] = problem.low[axis], problem.low[axis] + period
            if not len(walls):
                box_low[axis], box_high[axis] = low[axis], high[axis]
    if len(walls):
        box_low = np.minimum(box_low, walls[:, :2].min(axis=0) - margin)
        box_high = np.maximum(box_high, walls[:, :2].max(axis=0) + margin)
    box = np.concatenate([low, high, box_low, box_high]) / length
    yield [*box, *(problem.g * time / speed), *(int(period is not None) for period in problem.period)]
    yield [problem.dx / length, problem.support / length, problem.nu / (length * speed)]
    yield [young / (problem.rho * speed**2), poisson]
    yield [len(times), *(t / time for t in times)]
    volumes = problem.columns["mass"] / problem.rho / length**2
    yield [int(fluid.sum())]
    for x, v, volume in zip(problem.x[fluid], problem.v[fluid], volumes[fluid]):
        yield [*(x / length), *(v / speed), volume]
    limits = np.array([problem.planes(axis) for axis in range(2)]).T
    yield [len(walls)]
    for wall in walls:
        volume = volumes[0] if elastic else (problem.dx / length) ** 2
        yield [*(wall[:2] / length), *(wall[2:] / speed), volume]
        yield (np.clip(wall[:2], *limits) - wall[:2]) / length


# The path of the end of a bar needs many frames.
frames = max(int(os.environ.get("FRAMES", 1)), 1) if elastic else 1
times = [t for t in problem.times if t > 0]
if frames > 1:
    times = [times[0] * (m + 1) / frames for m in range(round(frames * times[-1] / times[0]))]
submission = Submission(problem)
text = "\n".join(" ".join(repr(float(of)) for of in line) for line in lines())
with open("input.txt", "w") as file:
    file.write(text + "\n")
with open("input.txt") as file:
    out = subprocess.run([os.path.abspath(sys.argv[1])], stdin=file, capture_output=True, text=True)
rows = out.stdout.splitlines()
start = next((k for k, row in enumerate(rows) if row.startswith("frame ")), None)
if out.returncode or start is None:
    sys.exit(f"ended with {out.returncode}: {out.stderr[-2000:]}")
states, count = {}, int(fluid.sum())
for k in range(start, len(rows)):
    if rows[k].startswith("frame "):
        _, t, steps, seconds = rows[k].split()
        frame = [row.split() for row in rows[k + 1 : k + 1 + count]]
        states[round(float(t), 9)] = np.array(frame, dtype=float)
        submission.steps, submission.seconds = int(steps), float(seconds)
for t in [t for t in problem.times if t == 0] + times:
    if t == 0:
        submission.frame(t, problem.x[fluid], problem.v[fluid], problem.columns["density"][fluid])
        continue
    of = states[round(t / time, 9)]
    submission.frame(t, of[:, :2] * length, of[:, 2:4] * speed, of[:, 4] * problem.rho)
h = 0.5 * problem.support
scheme = "Riemann solver" + (", transport velocity" if problem.nu else "")
if elastic:
    scheme = "total Lagrangian, second Piola-Kirchhoff stress"
law = "Neo-Hookean law" if "body" in problem.columns else "law of St. Venant and Kirchhoff"
changed = f"{law} in place of Hencky's" if elastic else "nothing"
submission.done("SPHinXsys", "commit 9f33297", scheme,
                {"h": h, "kernel": "Wendland C2", "time steps": "its own"}, changed)
