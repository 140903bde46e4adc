"""JAX-SPH: touchstone probe --wall-particles -- python probe.py SPH|TVF"""
import sys
import jax
import jax.numpy as jnp
import touchstone_sph as ts
from jax_sph import eos, integrator, partition, solver
from jax_sph.jax_md import space

jax.config.update("jax_enable_x64", True)


def solve(problem):
    problem.decline("solids", "rigid bodies", "walls as planes", "free slip", "free surfaces")
    rho, c0, nu = problem.numbers("density", "sound_speed", "kinematic_viscosity")
    of, h, (low, size) = problem.particles, problem.support / 3, problem.box(2 * problem.support)
    x, v = (jnp.stack([of[a], of[b]], axis=1) for a, b in ("xy", "uv"))
    wall, n, (away, shift) = ~problem.moving[:, None], len(x), space.periodic(side=size)
    longest = 0.25 * min(h / (1.1 * c0), h**2 / nu if nu > 0 else jnp.inf)
    flow = solver.WCSPH(
        away, eos.TaitEoS(rho * c0**2, rho, 0.0, 1.0), lambda r: problem.acceleration * ~wall,
        problem.spacing, 2, longest, c0, h_fac=h / problem.spacing, is_bc_trick=bool(wall.any()))
    rest = {"u": v, "v": v, "dudt": 0.0 * v, "dvdt": 0.0 * v}
    state = {"r": x - low, **rest, "nw": 0.0 * v, "rho": of["density"], "mass": of["mass"],
             "eta": jnp.full(n, rho * nu), "tag": jnp.where(problem.moving, 0, 1 + v.any(axis=1)),
             **dict.fromkeys(("p", "drhodt", "T", "dTdt", "kappa", "Cp"), jnp.zeros(n))}
    hold = lambda state: state | {name: jnp.where(wall, rest[name], state[name]) for name in rest}
    model, tvf = flow.forward_wrapper(), 1.0 if sys.argv[1] == "TVF" else 0.0
    advance = jax.jit(integrator.si_euler(tvf, model, shift, hold, None))
    near = partition.neighbor_list(away, size, flow._kernel_fn.cutoff, capacity_multiplier=2.0,
                                   mask_self=False).allocate(state["r"], num_particles=n)
    state, near = advance(0.0, state, near)  # a step takes the forces of the one before
    for t, count, step, total in problem.steps(longest):
        for _ in range(count):
            state, near = advance(step, state, near)
        assert not near.did_buffer_overflow, "the list of neighbours is full"
        yield {"t": t, **dict(zip("xy", (state["r"] + low).T)), **dict(zip("uv", state["u"].T)),
               "density": state["rho"], "steps": total}


ts.main(solve, {"code": "JAX-SPH", "version": "808f874", "scheme": sys.argv[1]})
