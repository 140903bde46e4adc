"""What the scripts of this folder read of an exported problem, and hand in as a submission."""
import csv, json, os, platform, sys, time

import numpy as np


def value(quantity):
    """The number of `{"value": ..., "unit": ...}`."""
    return quantity["value"]


def machine():
    """Name of the processor."""
    try:
        with open("/proc/cpuinfo") as file:
            names = [line.split(":")[1].strip() for line in file if line.startswith("model name")]
        return names[0]
    except (OSError, IndexError):
        return platform.machine()


class Problem:
    """The problem in the folder in which the script runs."""

    def __init__(self):
        with open("problem.json") as file:
            self.json = json.load(file)
        with open("particles.csv") as file:
            rows = list(csv.reader(file))
        names = [head.split("[")[0] for head in rows[0]]
        self.columns = dict(zip(names, np.array(rows[1:], dtype=float).T))
        material, ours = self.json["material"], self.json["our_method"]
        self.material = {name: value(of) for name, of in material.items()}
        self.rho, self.c0 = self.material["density"], self.material["sound_speed"]
        self.nu = self.material.get("kinematic_viscosity", 0.0)
        self.g = np.array(value(self.json["acceleration"]))
        self.dx, self.times = value(self.json["particles"]["spacing"]), sorted(set(value(self.json["times"])))
        self.support = value(ours["support_radius"])
        domain = self.json["domain"]
        self.low = np.array(value(domain["low"]))
        self.period = [None if of == "none" else value(of) for of in domain["period"]]
        self.fluid = self.columns["role"] == 0
        self.x = np.stack([self.columns["x"], self.columns["y"]], axis=1)
        self.v = np.stack([self.columns["u"], self.columns["v"]], axis=1)

    def planes(self, axis):
        """Where walls begin along an axis: half a spacing before their nearest particles beside the fluid."""
        if self.period[axis] is not None or self.fluid.all():
            return -np.inf, np.inf
        along, across = self.x[:, axis], self.x[:, 1 - axis]
        low, high = across[self.fluid].min() - self.dx / 4, across[self.fluid].max() + self.dx / 4
        beside = along[~self.fluid & (across > low) & (across < high)]
        below, above = (beside[beside < along[self.fluid].min()], beside[beside > along[self.fluid].max()])
        return below.max(initial=-np.inf) + self.dx / 2, above.min(initial=np.inf) - self.dx / 2

    def held(self):
        """Who stands within the support before a plane that holds a body, and the images behind it."""
        for plane in self.json["walls"]["planes"]:
            point, normal = (np.array(value(plane[of])) for of in ("point", "normal_into_the_material"))
            distance = (self.x - point) @ normal
            near = distance < self.support
            yield near, self.x[near] - 2 * distance[near, None] * normal

    def box(self, margin):
        """Lower corner and size of a box that repeats along both axes, wide enough where the problem is open."""
        low, size = self.low.copy(), np.zeros(2)
        for axis in range(2):
            if self.period[axis] is None:
                ends = self.x[:, axis].min() - margin, self.x[:, axis].max() + margin
                low[axis], size[axis] = ends[0], ends[1] - ends[0]
            else:
                size[axis] = self.period[axis]
        return low, size


def describe(method, system):
    """Writes who made the run, and what it took."""
    for name, document in (("method.json", method), ("system.json", system)):
        with open(name, "w") as file:
            json.dump(document, file, indent=1)


class Submission:
    """Frames and clock of a run; seconds are processor time of the time loop."""

    def __init__(self, problem, own=False, density=True):
        """With `own`, particles count as chosen by the code: numbered from 0, with their mass, from t = 0 on."""
        self.problem, self.seconds, self.steps, self.mass = problem, 0.0, 0, None
        self.ids = problem.columns["id"][problem.fluid].astype(int)
        if own:
            self.ids, self.mass = np.arange(len(self.ids)), problem.columns["mass"][problem.fluid]
        self.file = open("results.csv", "w")
        last = ",mass[kg/m]" if own else ",density[kg/m^3]" if density else ""
        self.file.write(f"t[s],id,x[m],y[m],u[m/s],v[m/s]{last}\n")

    def __enter__(self):
        self.began = time.process_time()
        return self

    def __exit__(self, *_):
        self.seconds += time.process_time() - self.began

    def frame(self, t, x, v, density=None):
        """Particles of the fluid in the order of the problem; the density may be None if there is none."""
        last = density if self.mass is None else self.mass
        for row in zip(self.ids, x[:, 0], x[:, 1], v[:, 0], v[:, 1], *([] if last is None else [last])):
            numbers = ",".join(repr(float(of)) for of in row[1:])
            self.file.write(f"{float(t)!r},{row[0]},{numbers}\n")

    def done(self, code, version, scheme, settings, changed, division="closed"):
        self.file.close()
        system = {"machine": machine(), "threads": 1, "seconds": self.seconds, "steps": self.steps,
                  "interactions": "unknown"}
        method = {"code": code, "version": version, "scheme": scheme, "division": division,
                  "settings": settings, "changed": changed}
        describe(method, system)
