"""Runs the problem of this folder with JAX-SPH: PYTHONPATH=CHECKOUT python run.py [SPH|TVF|RIE]

Density by summation, walls of Adami et al. 2012, quintic spline; TVF with the transport velocity of Adami et
al. 2013, RIE with the Riemann solver of Zhang et al. 2017.
"""
import os, sys

os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1")
os.environ.setdefault("JAX_PLATFORMS", "cpu")
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import jax
import jax.numpy as jnp
import numpy as np
from common import Problem, Submission

jax.config.update("jax_enable_x64", True)
from jax_sph import partition
from jax_sph.eos import RIEMANNEoS, TaitEoS
from jax_sph.integrator import si_euler
from jax_sph.jax_md import space
from jax_sph.jax_md.partition import Sparse
from jax_sph.solver import WCSPH
from jax_sph.utils import Tag

which = sys.argv[1] if len(sys.argv) > 1 else "TVF"
problem = Problem()
low, size = problem.box(2 * problem.support)
h, dx, fluid = problem.support / 3, problem.dx, problem.fluid
walls, speed = problem.columns["role"] > 0, np.abs(problem.v).max(axis=1)
tag = np.where(~walls, int(Tag.FLUID), np.where(speed > 0, int(Tag.MOVING_WALL), int(Tag.SOLID_WALL)))
v0 = jnp.array(problem.v)
fixed = jnp.array(walls)[:, None]
displacement, shift = space.periodic(side=size)
eos = TaitEoS(problem.rho * problem.c0**2, problem.rho, 0.0, 1.0)
if which == "RIE":
    eos = RIEMANNEoS(problem.rho, 0.0, problem.c0 / 10)  # its sound speed is ten times the reference speed
gravity = jnp.where(fixed, 0.0, jnp.array(problem.g))


def walls_stay(state):
    for name in ("u", "v"):
        state[name] = jnp.where(fixed, v0, state[name])
    for name in ("dudt", "dvdt"):
        state[name] = jnp.where(fixed, 0.0, state[name])
    return state


# The rule of the code for the step, with its Courant number 0.25.
longest = 0.25 * min(h / (1.1 * problem.c0), h**2 / max(problem.nu, 1e-300))
solver = WCSPH(displacement, eos, lambda r: gravity, dx, 2, longest, problem.c0, kernel="QSK", h_fac=h / dx,
               solver="RIE" if which == "RIE" else "SPH", is_bc_trick=bool(walls.any()),
               is_rho_evol=which == "RIE")
n = len(tag)
mass = jnp.array(problem.columns["mass"])
rho = jnp.array(problem.columns["density"])
zeros = jnp.zeros((n, 2))
# Normals of walls from the fluid into the wall's opposite, needed by the Riemann solver alone.
side = np.where(problem.x[:, 1] < problem.x[fluid, 1].min(), 1.0, -1.0)
normal = jnp.array(np.stack([np.zeros(n), np.where(walls, side, 0.0)], axis=1))
state = {"r": jnp.array(problem.x - low), "tag": jnp.array(tag), "u": v0, "v": v0, "dudt": zeros, "dvdt": zeros,
         "drhodt": jnp.zeros(n), "rho": rho, "p": eos.p_fn(rho), "mass": mass,
         "eta": jnp.full(n, problem.rho * problem.nu), "dTdt": jnp.zeros(n), "T": jnp.ones(n),
         "kappa": jnp.zeros(n), "Cp": jnp.zeros(n), "nw": normal}
neighbours_of = partition.neighbor_list(
    displacement, size, r_cutoff=solver._kernel_fn.cutoff, backend="jaxmd_vmap", capacity_multiplier=1.25,
    mask_self=False, format=Sparse, num_particles_max=n, num_partitions=1, pbc=np.array([True] * 3))
neighbours = neighbours_of.allocate(state["r"], num_particles=n)
advance = jax.jit(si_euler(1.0 if which == "TVF" else 0.0, solver.forward_wrapper(), shift, walls_stay, None))
advance(0.0, state, neighbours)[0]["r"].block_until_ready()  # compiles

submission, now = Submission(problem), 0.0
for t in problem.times:
    with submission:
        count = int(np.ceil((t - now) / longest * (1 - 1e-9)))
        for _ in range(count):
            next_state, next_neighbours = advance((t - now) / count, state, neighbours)
            if next_neighbours.did_buffer_overflow:
                neighbours = neighbours_of.allocate(state["r"], num_particles=n)
                next_state, next_neighbours = advance((t - now) / count, state, neighbours)
            state, neighbours = next_state, next_neighbours
        state["r"].block_until_ready()
    submission.steps += count
    now = t
    of = {name: np.asarray(state[name])[fluid] for name in ("r", "u", "rho")}
    submission.frame(t, of["r"] + low, of["u"], of["rho"])
submission.done("JAX-SPH", "808f874", which, {"h": h, "longest dt": longest, "jax": jax.__version__}, "nothing")
