"""Runs the problem of this folder with DualSPHysics: python run.py PROGRAMS [mDBC|DBC|none]

PROGRAMS is a folder with `DualSPHysics5.4CPU_linux64` and `bi4`, as `run.sh` builds them. Settings are those
of the examples of the code: `mdbc/02_Poiseuille` for viscous flow between walls, `mdbc/04_Dambreak` for the
dam break, with DBC `main/01_DamBreak`; without walls the defaults, and shifting as for internal flows.
"""
import os, resource, shutil, subprocess, sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import Problem, Submission

programs = os.path.abspath(sys.argv[1])
walls = sys.argv[2] if len(sys.argv) > 2 else "mDBC"
problem = Problem()
dx, rho, c0, nu = problem.dx, problem.rho, problem.c0, problem.nu
h, fluid = problem.support / 2, problem.fluid
gamma, alpha = problem.material["exponent_gamma"], problem.material["artificial_viscosity_alpha"]
mass = problem.columns["mass"][fluid].mean()  # the code has one mass for all
moves = ~fluid & (np.abs(problem.v).max(axis=1) > 0)
# Particles at rest come first, then those of a moving wall, then the fluid.
order = np.concatenate([np.flatnonzero(which) for which in (~fluid & ~moves, moves, fluid)])
counts = [int((~fluid & ~moves).sum()), int(moves.sum()), int(fluid.sum())]
times = [float(t) for t in problem.times if t > 0]

parameters = {"StepAlgorithm": 2, "Kernel": 2, "DensityDT": 3, "DensityDTvalue": 0.1, "ViscoBoundFactor": 1,
              # Laminar; the examples have a turbulence model (SPS) with it, which the problem has not.
              "ViscoTreatment": 3 if nu > 0 else 1, "Visco": nu or alpha, "Shifting": 3, "ShiftTFS": 0}
courant = 0.2
if walls == "DBC":
    parameters |= {"StepAlgorithm": 1, "Boundary": 1, "DensityDT": 2, "Shifting": 0}
elif nu > 0 and not fluid.all():
    parameters |= {"Boundary": 2, "SlipMode": 2, "Shifting": 2, "ShiftTFS": 1.5}
    courant = 0.1
elif not fluid.all():
    parameters |= {"Boundary": 2, "SlipMode": 1, "ViscoBoundFactor": 0, "Shifting": 0}
parameters |= {"SavePosDouble": 1, "RhopOutMin": 0.7 * rho, "RhopOutMax": 1.3 * rho,
               "DtFixedFile": "steps.txt", "TimeMax": times[-1], "TimeOut": times[-1]}
periodic = "".join(name for name, period in zip("XZ", problem.period) if period is not None)
if periodic:
    parameters[{"X": "XPeriodicIncZ", "XZ": "XZPeriodic"}[periodic]] = 0


def planes(axis):
    """Where the fluid ends along an axis: half a spacing before the nearest wall particles beside it."""
    if problem.period[axis] is not None or fluid.all():
        return -np.inf, np.inf
    along, across = problem.x[:, axis], problem.x[:, 1 - axis]
    low, high = across[fluid].min(), across[fluid].max()
    beside = along[~fluid & ((across > low - dx / 4) & (across < high + dx / 4))]
    below, above = beside[beside < along[fluid].min()], beside[beside > along[fluid].max()]
    return (below.max() + dx / 2 if below.size else -np.inf, above.min() - dx / 2 if above.size else np.inf)


def box():
    """The box of the simulation: the period, or as far from the particles as these are apart."""
    low, high = problem.x.min(axis=0), problem.x.max(axis=0)
    margin = (high - low).max()
    for axis, period in enumerate(problem.period):
        if period is None:
            low[axis], high[axis] = low[axis] - margin, high[axis] + margin
        else:
            low[axis], high[axis] = problem.low[axis], problem.low[axis] + period
    return low, high


def steps():
    """Lines of the file of time steps: the rule of the code, shortened so that steps end at the times."""
    height = np.ptp(problem.x[fluid, 1]) + dx if None in problem.period and nu == 0 else 0.0
    fastest = max(np.abs(problem.v).max(), 2 * np.sqrt(np.abs(problem.g).max() * height))
    longest = courant * h / max(c0, 10 * fastest)
    spans = np.diff([0.0] + times)
    # A little longer than fits, so that rounding does not put off an output by a step.
    dts = [span / np.ceil(span / longest * (1 - 1e-9)) * (1 + 1e-9) for span in spans]
    # The symplectic scheme takes the step that it looked up at the start of the step before.
    lag = 1.5 if parameters["StepAlgorithm"] == 2 else 0.5
    yield 0.0, dts[0]
    for t, dt, following in zip(times, dts, dts[1:]):
        yield t - (lag + 0.1) * dt, dt
        yield t - (lag - 0.1) * dt, following
    yield 2 * times[-1], dts[-1]


def particles():
    """The input of `bi4 write`: numbers of particles, constants, the box, and a line a particle."""
    limits = [planes(axis) for axis in range(2)]
    normals = np.stack([np.clip(problem.x[:, k], *limits[k]) - problem.x[:, k] for k in range(2)], axis=1)
    low, high = box()
    constants = (dx, h, rho * c0**2 / gamma, rho, gamma, mass, *low, *high)
    yield " ".join(repr(float(number)) for number in constants)
    yield " ".join(map(str, counts))
    for k in order:
        row = (*problem.x[k], *problem.v[k], problem.columns["density"][k], *normals[k])
        yield " ".join(repr(float(number)) for number in row)


def case():
    """The text of Case.xml."""
    fixed, moving, free = counts
    constants = {"cflnumber": courant, "gamma": gamma, "rhop0": rho, "dp": dx, "h": h,
                 "b": rho * c0**2 / gamma, "massbound": mass, "massfluid": mass}
    blocks, motion, g = "", "", problem.g.tolist()
    if fixed:
        blocks += f'<fixed mkbound="0" mk="10" begin="0" count="{fixed}"/>'
    if moving:
        blocks += f'<moving mkbound="1" mk="11" begin="{fixed}" count="{moving}" refmotion="0"/>'
        u, w = problem.v[moves][0].tolist()
        motion = ('<motion><objreal ref="0"><begin mov="1" start="0"/>'
                  f'<mvrect id="1" duration="{2 * times[-1]!r}"><vel x="{u!r}" y="0" z="{w!r}"/></mvrect>'
                  '</objreal></motion>')
    blocks += f'<fluid mkfluid="0" mk="1" begin="{fixed + moving}" count="{free}"/>'
    values = "".join(f'<{name} value="{float(of)!r}"/>' for name, of in constants.items())
    settings = "".join(f'<parameter key="{key}" value="{of}"/>' for key, of in parameters.items())
    outputs = "".join(f'<tout time="{t!r}" timeout="{2 * times[-1]!r}"/>' for t in [0.0] + times)
    return ('<?xml version="1.0"?><case app="touchstone"><execution>'
            f'<special><timeout>{outputs}</timeout></special><parameters>{settings}</parameters>'
            '<constants><data2d value="true"/><data2dposy value="0"/>'
            f'<gravity x="{g[0]!r}" y="0" z="{g[1]!r}"/>{values}</constants>{motion}'
            f'<particles np="{sum(counts)}" nb="{fixed + moving}" nbf="{fixed}" mkboundfirst="10" '
            f'mkfluidfirst="1">{blocks}</particles></execution></case>')


def seconds(*options):
    """Processor time of a run of the program."""
    shutil.rmtree("out", ignore_errors=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    program = os.path.join(programs, "DualSPHysics5.4CPU_linux64")
    subprocess.run([program, "-cpu", "-ompthreads:1", "-sv:binx", *options, "Case", "out"], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def frame(part):
    """Time, steps, and the fluid of an output in the order of the problem."""
    words = [os.path.join(programs, "bi4"), "read", "out/data", str(part)]
    lines = subprocess.run(words, capture_output=True, text=True, check=True).stdout.splitlines()
    t, count = lines[0].split()
    found = np.array([line.split() for line in lines[1:]], dtype=float)
    free = found[found[:, 0] >= counts[0] + counts[1]]
    if len(free) != counts[2]:
        sys.exit(f"{counts[2] - len(free)} particles were lost before t = {t} s")
    return float(t), int(count), free[np.argsort(free[:, 0])]


with open("Case.xml", "w") as file:
    file.write(case())
with open("steps.txt", "w") as file:
    file.writelines(f"{t!r} {1000 * dt!r}\n" for t, dt in map(lambda row: tuple(map(float, row)), steps()))
words = [os.path.join(programs, "bi4"), "write", "Case"]
subprocess.run(words, input="\n".join(particles()) + "\n", text=True, check=True)
submission = Submission(problem)
setting_up = seconds("-nsteps:1")
submission.seconds = max(seconds() - setting_up, 0.0)
for part, t in enumerate(problem.times, 0 if problem.times[0] == 0 else 1):
    now, submission.steps, free = frame(part)
    if abs(now - t) > 1e-7 * times[-1]:
        sys.exit(f"output at t = {now} s in place of {t} s")
    submission.frame(t, free[:, 1:3], free[:, 3:5], free[:, 5])
scheme = "WCSPH" if fluid.all() else f"WCSPH, {walls}"
submission.done("DualSPHysics", "5.4, commit ef3721a", scheme, parameters | {"h": h, "cflnumber": courant},
                "one mass for all particles, the mean; velocities and densities in single precision")
