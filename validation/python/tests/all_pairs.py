"""A small SPH code in NumPy: weakly compressible, quintic spline, periodic, without walls."""

import numpy as np
import touchstone_sph as ts

VISCOSITY = 1.0  # factor of the viscous term


def slope(q, h):
    """dW/dr of the quintic spline in two dimensions, q = r/h."""
    parts = ((3, 1), (2, -6), (1, 15))
    return -7 / (478 * np.pi * h**3) * sum(5 * c * np.maximum(k - q, 0) ** 4 for k, c in parts)


def solve(problem):
    problem.decline("walls as planes", "walls as particles", "solids", "rigid bodies", "restarts")
    rho0, c0, gamma, nu, background = problem.numbers(
        "density", "sound_speed", "exponent_gamma", "kinematic_viscosity", "background_pressure")
    start, h = problem.particles, problem.spacing
    x, v, rho, m = np.stack([start["x"], start["y"]]), np.stack([start["u"], start["v"]]), start["density"], start["mass"]
    i, j = np.triu_indices(m.size, 1)

    def near(x):
        r = np.stack(problem.nearest(*(x[:, i] - x[:, j])))
        close = (r**2).sum(0) < (3.3 * h) ** 2
        return i[close], j[close]

    def rates(x, v, rho, pairs):
        a, b = pairs
        r, w = np.stack(problem.nearest(*(x[:, a] - x[:, b]))), v[:, a] - v[:, b]
        d = np.sqrt((r**2).sum(0))
        f = slope(d / h, h) / d
        p = background + rho0 * c0**2 / gamma * ((rho / rho0) ** gamma - 1)
        force = -(p[a] / rho[a] ** 2 + p[b] / rho[b] ** 2) * f * r
        force = force + VISCOSITY * 2 * nu * rho0 / (rho[a] * rho[b]) * f * w
        flux = f * (r * w).sum(0)
        add = lambda k, values: np.bincount(k, values, m.size)
        dv = np.stack([add(a, m[b] * one) - add(b, m[a] * one) for one in force])
        return dv + problem.acceleration[:, None], add(a, m[b] * flux) + add(b, m[a] * flux)

    pairs, origin = near(x), x
    for t, count, dt, total in problem.steps(problem.time_step):
        for _ in range(count):
            if np.abs(x - origin).max() > 0.1 * h:
                pairs, origin = near(x), x
            dv, drho = rates(x, v, rho, pairs)
            xm, vm, rhom = x + 0.5 * dt * v, v + 0.5 * dt * dv, rho + 0.5 * dt * drho
            dv, drho = rates(xm, vm, rhom, pairs)
            x, v, rho = x + dt * vm, v + dt * dv, rho + dt * drho
        if not np.isfinite(v).all():
            raise FloatingPointError(f"not finite at t = {t} s")
        yield {"t": t, "x": x[0], "y": x[1], "u": v[0], "v": v[1], "density": rho, "steps": total}


if __name__ == "__main__":
    ts.main(solve, {"code": "all_pairs", "settings": {"time_order": 2}})
