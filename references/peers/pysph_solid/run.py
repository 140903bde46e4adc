"""Runs the solid of this folder, rubber rings or a clamped bar, with the solid mechanics of PySPH: python run.py

ElasticSolidsScheme (Gray, Monaghan & Swift 2001), as in the example `solid_mech.rings` of PySPH, with the particles,
the moduli, the kernel and the viscosity of the problem; the artificial stress is component by component. Particles
that do not move are a solid of their own, as the clamp of its example `solid_mech.oscillating_plate`. FRAMES is the
number of frames up to each of the times.
"""
import os, sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import time

import numpy as np
import pysph
from common import Problem, Submission
from pysph.base.kernels import CubicSpline
from pysph.sph.equation import Equation, Group
from pysph.solver.application import Application
from pysph.solver.solver import Solver
from pysph.solver.utils import iter_output
from pysph.sph.solid_mech.basic import ElasticSolidsScheme, get_particle_array_elastic_dynamics

problem = Problem()
material, settings = problem.material, problem.json["spec"]["settings"]
k, g = material["bulk_modulus"], material["shear_modulus"]
h = problem.support / 2
young, poisson = 9 * k * g / (3 * k + g), (3 * k - 2 * g) / (2 * (3 * k + g))
alpha, beta = settings["alpha"], settings["beta"]
speed = np.abs(problem.v).max()
many = int(os.environ.get("FRAMES", 1))
times = [problem.times[0] * (n + 1) / many for n in range(round(many * problem.times[-1] / problem.times[0]))]
clamped = not problem.fluid.all()
step = 0.25 * h / (np.sqrt((k + 4 * g / 3) / problem.rho) + speed)


class Weight(Equation):
    """The scheme has no weight."""

    def __init__(self, dest, sources, gx, gy):
        self.gx, self.gy = gx, gy
        super().__init__(dest, sources)

    def initialize(self, d_idx, d_au, d_av):
        d_au[d_idx] += self.gx
        d_av[d_idx] += self.gy


class Rings(Application):
    def create_equations(self):
        groups = self.scheme.get_equations()
        if problem.g.any():
            groups.append(Group([Weight("solid", None, float(problem.g[0]), float(problem.g[1]))]))
        return groups

    def create_particles(self):
        constants = {"wdeltap": CubicSpline(dim=2).kernel(rij=problem.dx, h=h), "n": settings["exponent"],
                     "rho_ref": problem.rho, "E": young, "nu": poisson}
        names = {"x": "x", "y": "y", "u": "u", "v": "v", "m": "mass", "rho": "density"}

        def array(name, chosen):
            of = {key: problem.columns[column][chosen] for key, column in names.items()}
            return get_particle_array_elastic_dynamics(name=name, h=h, constants=dict(constants), **of)

        solid = array("solid", problem.fluid)
        solid.add_property("touchstone", data=problem.columns["id"][problem.fluid])
        solid.add_output_arrays(["touchstone", "rho", "u", "v"])
        return [solid] + ([array("clamp", ~problem.fluid)] if clamped else [])

    def create_scheme(self):
        scheme = ElasticSolidsScheme(["solid"], ["clamp"] * clamped, dim=2, artificial_stress_eps=settings["xi"],
                                     xsph_eps=settings["xsph"], alpha=alpha, beta=beta)
        scheme.configure_solver(kernel=CubicSpline(dim=2), dt=step, tf=problem.times[-1] * (1 + 1e-9), pfreq=10**9,
                                output_at_times=times, adaptive_timestep=False)
        return scheme


def timed(self, *given, **named):
    begin = time.process_time()
    whole(self, *given, **named)
    Rings.seconds = time.process_time() - begin  # without setting up and compiling


whole, Solver.solve = Solver.solve, timed
app = Rings(fname="rings")
app.run([])
submission, frames = Submission(problem), {}
for data, array in iter_output(app.output_files, "solid"):
    t = min(times, key=lambda t: abs(t - data["t"]))
    if abs(data["t"] - t) <= 1e-6 * problem.times[-1]:
        frames[t] = array
for t in times:
    array = frames[t]
    of = np.argsort(array.touchstone)
    submission.frame(t, np.stack([array.x, array.y], 1)[of], np.stack([array.u, array.v], 1)[of], array.rho[of])
submission.seconds, submission.steps = Rings.seconds, int(app.solver.count)
submission.done("PySPH", pysph.__version__, "elastic solids of Gray et al.", {"step": step, "E": young, "nu": poisson},
                "artificial stress component by component")
