"""Runs the dam break of this folder with pySPlisHSPlasH: python run.py [DFSPH|WCSPH]

The column has our lattice; the radius is half of its spacing, and the support four radii, as always in this code.
The code gives a particle 0.8 d^2 of volume, d twice its radius. Walls are volume maps of a box,
half a spacing behind those of the problem, because particles of the scenes of the code begin one spacing away.
"""
import json, os, sys, time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import numpy as np
import pysplishsplash as sph
from common import Problem, Submission

which = sys.argv[1] if len(sys.argv) > 1 else "DFSPH"
problem = Problem()
dx, fluid = problem.dx, problem.fluid
x0 = problem.x[fluid]
radius = dx / 2
fastest = np.sqrt(2 * abs(problem.g[1]) * x0[:, 1].max())
# Artificial viscosity is that of a fluid with nu = alpha h c0/8.
nu = problem.material["artificial_viscosity_alpha"] * 0.5 * problem.support * problem.c0 / 8
# The walls of the problem: the tank from x = 0 to the first particles behind the far wall; open above.
walls = problem.x[~fluid]
length = walls[walls[:, 1] > 0][:, 0].max() + 0.5 * dx - np.ptp(walls[(walls[:, 1] > 0) & (walls[:, 0] < 0)][:, 0]) - dx
length, height = length + dx, 2.0 * x0[:, 1].max()
columns, rows = (len(np.unique(np.round(x0[:, k] / dx, 3))) for k in range(2))
unit_box = os.path.abspath("box.obj")
corners = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
faces = "1 2 4,1 4 3,5 7 8,5 8 6,1 5 6,1 6 2,3 4 8,3 8 7,1 3 7,1 7 5,2 6 8,2 8 4"
with open(unit_box, "w") as file:
    file.writelines(f"v {x} {y} {z}\n" for x, y, z in corners)
    file.writelines(f"f {face}\n" for face in faces.split(","))
longest = 0.4 * dx / fastest if which == "DFSPH" else 0.25 * 0.5 * problem.support / (1.1 * problem.c0)
scene = {
    "Configuration": {
        "sim2D": True, "particleRadius": radius, "simulationMethod": {"WCSPH": 0, "DFSPH": 4}[which],
        "gravitation": [0.0, float(problem.g[1]), 0.0], "cflMethod": 0, "timeStepSize": longest,
        "boundaryHandlingMethod": 2, "maxIterations": 100, "maxError": 0.01,
        "stiffness": problem.rho * problem.c0**2 / 7, "exponent": 7,
        "DFSPH": {"maxIterations": 100, "maxError": 0.01, "maxIterationsV": 100, "maxErrorV": 0.1,
                  "enableDivergenceSolver": True},
        "WCSPH": {"stiffness": problem.rho * problem.c0**2 / 7, "exponent": 7}},
    "Materials": [{"id": "Fluid", "density0": problem.rho, "viscosityMethod": 1, "viscosity": nu,
                   "Standard viscosity": {"viscosity": nu}}],
    "RigidBodies": [{
        "geometryFile": unit_box, "translation": [0.5 * (length - dx), 0.5 * (height - dx), 0], "scale": [length, height, 0.2],
        "rotationAxis": [1, 0, 0], "rotationAngle": 0, "isDynamic": False, "isWall": True, "mapInvert": True,
        "mapThickness": 0.0, "mapResolution": [60, 30, 6]}],
    "FluidBlocks": [{"denseMode": 0, "start": [0.0, 0.0, -1.0], "end": [2 * radius * (columns + 1), 2 * radius * (rows + 1), 1.0],
                     "translation": [0, 0, 0], "scale": [1, 1, 1]}]}
with open("scene.json", "w") as file:
    json.dump(scene, file, indent=1)
base = sph.Exec.SimulatorBase()
base.init(useGui=False, sceneFile=os.path.abspath("scene.json"), outputDir=os.path.abspath("splish"),
          initialPause=False, useCache=False)
base.initSimulation()
simulation = sph.Simulation.getCurrent()
model, clock = simulation.getFluidModel(0), sph.TimeManager.getCurrent()
assert model.numActiveParticles() == len(x0), (model.numActiveParticles(), len(x0))
field = lambda of: np.asarray(model.getFieldBuffer(of))[:len(x0)]  # behind them are places that are not used
position = field("position")
order = np.lexsort((position[:, 0], position[:, 1]))
ours = np.lexsort((x0[:, 0], x0[:, 1]))
position[order, :2] = x0[ours]
# The code sorts its particles now and then; its own numbers tell which is which.
names = field("id").copy()
number = dict(zip(names[order], ours))
submission = Submission(problem, own=True)


def frame(t):
    back = np.argsort([number[of] for of in field("id")])
    x, v = (field(of)[back, :2] for of in ("position", "velocity"))
    submission.frame(t, x, v)


# Whole steps from time to time; the code calls back after each of them.
steps = []
for start, t in zip(problem.times, problem.times[1:]):
    count = int(np.ceil((t - start) / longest * (1 - 1e-9)))
    steps += [(t - start) / count] * (count - 1) + [(t - start) / count, t]
aside, left = [0.0], [of for of in steps]


def after_step():
    begin = time.process_time()
    if submission.steps == 0:
        aside[0] = begin  # the first step sets up the walls, and is not timed
    submission.steps += 1
    if left and left[0] in ends:
        frame(left.pop(0))
    if left:
        clock.setTimeStepSize(left.pop(0))
    else:
        submission.seconds = time.process_time() - aside[0]
        done()
    aside[0] += time.process_time() - begin


def done():
    submission.done("pySPlisHSPlasH", "2.19.0", which, {"radius": radius, "step": longest, "nu": nu, "tank": length},
                    "volumes of 0.8 dx^2, support of 2 spacings, cubic spline; walls are volume maps; a real viscosity for the artificial one",
                    division="open")
    os._exit(0)  # the loop of the code would go on


ends = set(problem.times)
frame(problem.times[0])
clock.setTimeStepSize(left.pop(0))
base.setValueFloat(base.STOP_AT, 1e9)
base.setTimeStepCB(after_step)
base.runSimulation()
