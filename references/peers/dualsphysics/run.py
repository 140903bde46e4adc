"""Runs the problem of this folder with DualSPHysics: python run.py PROGRAMS [mDBC|DBC|none]

PROGRAMS is a folder with `DualSPHysics5.4CPU_linux64` and `bi4`, as `run.sh` builds them. Settings are those
of the examples of the code: `mdbc/02_Poiseuille` for viscous flow between walls, `mdbc/04_Dambreak` for the
dam break, with DBC `main/01_DamBreak`; without walls the defaults, and shifting as for internal flows.
An elastic body is a flexible structure (total Lagrangian), with the control of hourglasses of the format's
documentation. A plane that holds it is continued by a mirror image of its first columns, at rest.
"""
import os, resource, shutil, subprocess, sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from common import Problem, Submission

programs = os.path.abspath(sys.argv[1])
walls = sys.argv[2] if len(sys.argv) > 2 else "mDBC"
problem = Problem()
dx, rho, c0, nu = problem.dx, problem.rho, problem.c0, problem.nu
h, material, solid = problem.support / 2, problem.material, "shear_modulus" in problem.material
gamma, alpha = material.get("exponent_gamma", 7.0), material.get("artificial_viscosity_alpha", 0.0)
x, v, density = problem.x, problem.v, problem.columns["density"]
free = problem.fluid  # what the problem asks for
mass = problem.columns["mass"][free].mean()  # the code has one mass for all
for near, images in problem.held() if solid else []:
    x = np.concatenate([x, images])
    v = np.concatenate([v, np.zeros_like(images)])
    density = np.concatenate([density, problem.columns["density"][near]])
    free = np.concatenate([free, np.zeros(near.sum(), bool)])
# Particles at rest come first, then those of a moving wall or an elastic body, then the fluid.
moves = free if solid else ~free & (np.abs(v).max(axis=1) > 0)
fluid = free & ~moves
order = np.concatenate([np.flatnonzero(which) for which in (~fluid & ~moves, moves, fluid)])
counts = [int((~fluid & ~moves).sum()), int(moves.sum()), int(fluid.sum())]
first = counts[0] if solid else counts[0] + counts[1]  # of the particles that the problem asks for
frames = int(os.environ.get("FRAMES", 1)) if solid else 1  # of each of the times
times = [float(t) for t in problem.times if t > 0]
times = [t - (t - before) * (frames - m) / frames for before, t in zip([0.0] + times, times)
         for m in range(1, frames + 1)]

parameters = {"StepAlgorithm": 2, "Kernel": 2, "DensityDT": 3, "DensityDTvalue": 0.1, "ViscoBoundFactor": 1,
              # Laminar; the examples have a turbulence model (SPS) with it, which the problem has not.
              "ViscoTreatment": 3 if nu > 0 else 1, "Visco": nu or alpha, "Shifting": 3, "ShiftTFS": 0}
courant = 0.2
if solid:
    parameters |= {"Boundary": 1, "DensityDT": 0, "Shifting": 0}
elif walls == "DBC":
    parameters |= {"StepAlgorithm": 1, "Boundary": 1, "DensityDT": 2, "Shifting": 0}
elif nu > 0 and not free.all():
    parameters |= {"Boundary": 2, "SlipMode": 2, "Shifting": 2, "ShiftTFS": 1.5}
    courant = 0.1
elif not free.all():
    parameters |= {"Boundary": 2, "SlipMode": 1, "ViscoBoundFactor": 0, "Shifting": 0}
parameters |= {"SavePosDouble": 1, "RhopOutMin": 0.7 * rho, "RhopOutMax": 1.3 * rho,
               "DtFixedFile": "steps.txt", "TimeMax": times[-1], "TimeOut": times[-1]}
periodic = "".join(name for name, period in zip("XZ", problem.period) if period is not None)
if periodic:
    parameters[{"X": "XPeriodicIncZ", "XZ": "XZPeriodic"}[periodic]] = 0


def box():
    """The box of the simulation: the period, or as far from the particles as these are apart."""
    low, high = x.min(axis=0), x.max(axis=0)
    margin = (high - low).max()
    for axis, period in enumerate(problem.period):
        if period is None:
            low[axis], high[axis] = low[axis] - margin, high[axis] + margin
        else:
            low[axis], high[axis] = problem.low[axis], problem.low[axis] + period
    return low, high


def steps():
    """Lines of the file of time steps: the rule of the code, shortened so that steps end at the times."""
    if solid:
        modulus = material["bulk_modulus"] + 4 * material["shear_modulus"] / 3
        longest = courant * h / np.sqrt(modulus / rho)
    else:
        height = np.ptp(x[fluid, 1]) + dx if None in problem.period and nu == 0 else 0.0
        fastest = max(np.abs(v).max(), 2 * np.sqrt(np.abs(problem.g).max() * height))
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
    limits = [problem.planes(axis) for axis in range(2)]
    normals = np.stack([np.clip(x[:, k], *limits[k]) - x[:, k] for k in range(2)], axis=1)
    low, high = box()
    constants = (dx, h, rho * c0**2 / gamma, rho, gamma, mass, *low, *high)
    yield " ".join(repr(float(number)) for number in constants)
    yield " ".join(map(str, counts))
    for k in order:
        row = (*x[k], *v[k], density[k], *normals[k])
        yield " ".join(repr(float(number)) for number in row)


def structure():
    """The elastic body in Case.xml."""
    bulk, shear = material["bulk_modulus"], material["shear_modulus"]
    of = {"density": rho, "youngmod": 9 * bulk * shear / (3 * bulk + shear),
          "poissratio": (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear)), "constitmodel": 1, "hgfactor": 0.1}
    return ('<flexstrucs><flexstrucbody mkbound="1" mkclamp="0">'
            + "".join(f'<{name} value="{number!r}"/>' for name, number in of.items())
            + "</flexstrucbody></flexstrucs>")


def case():
    """The text of Case.xml."""
    fixed, moving, filled = counts
    constants = {"cflnumber": courant, "gamma": gamma, "rhop0": rho, "dp": dx, "h": h,
                 "b": rho * c0**2 / gamma, "massbound": mass, "massfluid": mass}
    blocks, motion, g = "", "", problem.g.tolist()
    if fixed:
        blocks += f'<fixed mkbound="0" mk="10" begin="0" count="{fixed}"/>'
    if moving:
        blocks += f'<moving mkbound="1" mk="11" begin="{fixed}" count="{moving}" refmotion="0"/>'
        u, w = v[moves][0].tolist()
        along = f'<mvrect id="1" duration="{2 * times[-1]!r}"><vel x="{u!r}" y="0" z="{w!r}"/></mvrect>'
        motion = ('<motion><objreal ref="0"><begin mov="1" start="0"/>'
                  f'{"""<mvnull id="1"/>""" if solid else along}</objreal></motion>')
    if filled:
        blocks += f'<fluid mkfluid="0" mk="1" begin="{fixed + moving}" count="{filled}"/>'
    values = "".join(f'<{name} value="{float(of)!r}"/>' for name, of in constants.items())
    settings = "".join(f'<parameter key="{key}" value="{of}"/>' for key, of in parameters.items())
    outputs = "".join(f'<tout time="{t!r}" timeout="{2 * times[-1]!r}"/>' for t in [0.0] + times)
    return ('<?xml version="1.0"?><case app="touchstone"><execution>'
            f'<special><timeout>{outputs}</timeout>{structure() if solid else ""}</special>'
            f'<parameters>{settings}</parameters><constants><data2d value="true"/><data2dposy value="0"/>'
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
    """Time, steps, and the particles of an output that the problem asks for, in its order."""
    words = [os.path.join(programs, "bi4"), "read", "out/data", str(part)]
    lines = subprocess.run(words, capture_output=True, text=True, check=True).stdout.splitlines()
    t, count = lines[0].split()
    found = np.array([line.split() for line in lines[1:]], dtype=float)
    found = found[found[:, 0] >= first]
    if len(found) != sum(counts) - first:
        sys.exit(f"{sum(counts) - first - len(found)} particles were lost before t = {t} s")
    return float(t), int(count), found[np.argsort(found[:, 0])]


with open("Case.xml", "w") as file:
    file.write(case())
with open("steps.txt", "w") as file:
    file.writelines(f"{t!r} {1000 * dt!r}\n" for t, dt in map(lambda row: tuple(map(float, row)), steps()))
words = [os.path.join(programs, "bi4"), "write", "Case"]
subprocess.run(words, input="\n".join(particles()) + "\n", text=True, check=True)
submission = Submission(problem, density=not solid)
setting_up = seconds("-nsteps:1")
submission.seconds = max(seconds() - setting_up, 0.0)
outputs = [0.0] + times if problem.times[0] == 0 else times
for part, t in enumerate(outputs, 0 if problem.times[0] == 0 else 1):
    now, submission.steps, of = frame(part)
    if abs(now - t) > 1e-7 * times[-1]:
        sys.exit(f"output at t = {now} s in place of {t} s")
    submission.frame(t, of[:, 1:3], of[:, 3:5], None if solid else of[:, 5])
changed = "one mass for all particles, the mean; velocities and densities in single precision"
scheme = "WCSPH" if free.all() else f"WCSPH, {walls}"
if solid:
    scheme, changed = "flexible structure", "law of St. Venant and Kirchhoff; velocities in single precision"
parameters |= {"h": h, "cflnumber": courant}
submission.done("DualSPHysics", "5.4, commit ef3721a", scheme, parameters, changed)
