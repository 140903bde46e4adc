"""PySPH, patched: touchstone probe --wall-particles -- python run.py wcsph|tvf|edac [--fault NAME] FOLDER

Runs the script that `touchstone export --format pysph` writes.
"""
import os, runpy, sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, ".."))
import pysph.base.kernels as kernels
import pysph.base.utils as utils
import pysph.sph.scheme as scheme
from common import Question
from pysph.sph.integrator import EulerIntegrator
from pysph.sph.integrator_step import EulerStep

problem = Question(sys.argv)
if sys.argv[1] != "wcsph" and "surface is free" in problem.json["boundary"]:
    problem.declines("the background pressure of this scheme needs particles all around")
if problem.slips:
    problem.declines("walls of this scheme have a viscous force")
WCSPH, array, quintic = scheme.WCSPHScheme, utils.get_particle_array, kernels.QuinticSpline.__init__
init, configure = WCSPH.__init__, WCSPH.configure_solver


def planted(self, fluids, solids, **of):
    of.update(nu=problem.nu, gx=problem.g[0], gy=problem.g[1], c0=problem.c0, alpha=problem.alpha)
    init(self, fluids, solids, **of)


def solver(self, **of):
    if problem.fault == "euler":
        of.update(integrator_cls=EulerIntegrator, extra_steppers={"fluid": EulerStep()})
    configure(self, **of)


def particles(**of):
    walls = of["name"] == "wall"
    moved = problem.v[~problem.fluid if walls else problem.fluid]
    return array(**(of | {"u": moved[:, 0], "v": moved[:, 1]}))


def kernel(self, **of):
    quintic(self, **of)
    self.fac *= 1.02 if problem.fault == "normalisation" else 1.0


if problem.fault:
    WCSPH.__init__, WCSPH.configure_solver = planted, solver
    utils.get_particle_array, kernels.QuinticSpline.__init__ = particles, kernel
del sys.argv[2:]
runpy.run_path(os.path.join(HERE, "../../../validation/exchange/src/write/run_pysph.py"), run_name="__main__")
