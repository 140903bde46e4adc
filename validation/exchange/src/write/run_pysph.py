# Runs the problem of this folder with PySPH: python run_pysph.py [edac|tvf|wcsph]
import csv, json, platform, sys, time
import numpy as np
import pysph
from pysph.base.kernels import QuinticSpline
from pysph.base.utils import get_particle_array
from pysph.solver.application import Application
from pysph.solver.solver import Solver
from pysph.base.nnps import DomainManager
from pysph.sph.scheme import TVFScheme, WCSPHScheme
from pysph.sph.wc.edac import EDACScheme

which = sys.argv.pop(1) if len(sys.argv) > 1 and not sys.argv[1].startswith("-") else "edac"
problem = json.load(open("problem.json"))
number = lambda quantity: quantity["value"]
material, ours = problem["material"], problem["our_method"]
rho0, c0, nu = (number(material[name]) for name in ("density", "sound_speed", "kinematic_viscosity"))
gx, gy = number(problem["acceleration"])
h, times = number(ours["support_radius"]) / 3, number(problem["times"])
dx = number(problem["particles"]["spacing"])
with open("particles.csv") as file:
    rows = list(csv.reader(file))
names = [head.split("[")[0] for head in rows[0]]
columns = dict(zip(names, np.array(rows[1:], dtype=float).T))


class Run(Application):
    def create_domain(self):
        low, period = number(problem["domain"]["low"]), problem["domain"]["period"]
        along = {}
        for axis, name in enumerate("xy"):
            if period[axis] != "none":
                along.update({name + "min": low[axis], name + "max": low[axis] + number(period[axis]),
                              "periodic_in_" + name: True})
        return DomainManager(**along) if along else None

    def create_particles(self):
        arrays = []
        for name, is_of in (("fluid", columns["role"] == 0), ("wall", columns["role"] > 0)):
            if not is_of.any():
                continue
            of = {key: columns[key][is_of] for key in ("x", "y", "u", "v")}
            array = get_particle_array(name=name, m=columns["mass"][is_of], rho=columns["density"][is_of],
                                       p=columns["pressure"][is_of], h=h, **of)
            array.add_property("touchstone", data=columns["id"][is_of])
            arrays.append(array)
        self.scheme.setup_properties(arrays, clean=False)
        for array in arrays:
            array.add_output_arrays(["touchstone", "rho", "u", "v"])
            if "V" in array.properties:
                array.V[:] = array.rho / array.m
        return arrays

    def create_scheme(self):
        walls = ["wall"] if (columns["role"] > 0).any() else []
        if which == "wcsph":
            alpha = number(material.get("artificial_viscosity_alpha", {"value": 0.0}))
            return WCSPHScheme(["fluid"], walls, dim=2, rho0=rho0, c0=c0, h0=h, hdx=h / dx, gamma=7.0,
                               alpha=alpha, beta=0.0, nu=nu, gx=gx, gy=gy)
        of = dict(dim=2, rho0=rho0, c0=c0, nu=nu, gx=gx, gy=gy, pb=rho0 * c0**2)
        if which == "tvf":
            return TVFScheme(["fluid"], walls, p0=rho0 * c0**2, h0=h, **of)
        return EDACScheme(["fluid"], walls, h=h, **of)

    def configure_scheme(self):
        step = 0.25 * h / (1.1 * c0)
        if nu > 0:
            step = min(step, 0.125 * h**2 / nu)
        self.scheme.configure_solver(kernel=QuinticSpline(dim=2), dt=step, tf=times[-1] * (1 + 1e-9),
                                     output_at_times=times, adaptive_timestep=False, pfreq=10**9)


def timed(self, *given, **named):
    begin = time.process_time()
    whole(self, *given, **named)
    Run.seconds = time.process_time() - begin  # without setting up and compiling


whole, Solver.solve = Solver.solve, timed
app = Run(fname="pysph")
app.run(["--max-steps", "1"] if "--check" in sys.argv else ["--openmp"] if "--openmp" in sys.argv else [])
seconds = Run.seconds

from pysph.solver.utils import iter_output
with open("results.csv", "w") as file:
    file.write("t[s],id,x[m],y[m],u[m/s],v[m/s],density[kg/m^3]\n")
    nearest = {}
    for data, array in iter_output(app.output_files, "fluid"):
        for wanted in times:
            if abs(data["t"] - wanted) <= 1e-6 * times[-1]:
                nearest.setdefault(wanted, array)
    for t in times:
        array = nearest[t]
        order = np.argsort(array.touchstone)
        density = array.rho
        if which == "edac":  # it carries the pressure; this is the density of the equation of state
            gamma = number(material["exponent_gamma"])
            density = rho0 * np.maximum(1 + gamma * array.p / (rho0 * c0**2), 0) ** (1 / gamma)
        for k in order:
            file.write(f"{t!r},{int(array.touchstone[k])},{array.x[k]!r},{array.y[k]!r},{array.u[k]!r},"
                       f"{array.v[k]!r},{density[k]!r}\n".replace("np.float64(", "").replace(")", ""))
json.dump({"machine": platform.processor() or platform.machine(), "threads": 1, "seconds": seconds,
           "steps": int(app.solver.count), "interactions": "unknown"}, open("system.json", "w"))
json.dump({"code": "PySPH", "version": pysph.__version__, "scheme": which, "division": "closed",
           "settings": {"h": h, "dt": app.solver.dt}, "changed": "nothing"}, open("method.json", "w"))
