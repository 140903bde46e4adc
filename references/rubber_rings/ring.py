"""One rubber ring against a rigid frictionless plane: explicit finite elements in plane strain.

Units of the ring: length (inner radius 3, outer 4), density 1, bulk sound speed 1.
Half of the ring (y >= 0) is meshed, with rollers on y = 0; the plane is x = 0, the ring is at x > 0.
Results are those of the whole ring, per unit of depth.

Elements and laws: plane_strain.py of the folder above. Time: central differences.
"""

import numpy as np

import plane_strain

INNER, OUTER, CENTRE = 3.0, 4.0, 5.0
RUBBER = plane_strain.Material(density=1.0, bulk=1.0, shear=0.22)
SAMPLE = 0.5


def polar(radius, theta):
    return radius * np.cos(theta), radius * np.sin(theta)


class Ring(plane_strain.Grid):
    """Half a ring as a grid of nodes: axis 1 the radius, axis 2 the angle from the far pole to the plane."""

    def __init__(self, layers):
        self.h = (OUTER - INNER) / layers
        angles = np.linspace(0, np.pi, 11 * layers + 1)
        super().__init__(RUBBER, np.linspace(INNER, OUTER, layers + 1), angles, polar, True)
        self.x0[0] += CENTRE
        self.x0[1, :, -1] = 0
        # Simpson's weights of the outer arc: areas of the contact nodes.
        cols = 2 * self.columns + 1
        weights = np.full(cols, 2 / 3) + np.where(np.arange(cols) % 2, 2 / 3, 0)
        weights[[0, -1]] = 1 / 3
        self.area = weights * 0.5 * OUTER * np.pi / self.columns

    def fastest(self, stiffness, steps=60):
        """Highest angular frequency, the contact springs of the whole arc included: power iteration."""
        law = plane_strain.Hencky(RUBBER)
        rng = np.random.default_rng(1)
        u = rng.standard_normal(self.x0.shape)
        size = 1e-6
        for _ in range(steps):
            u /= np.sqrt((self.mass * u**2).sum())
            f = -(self.force(self.x0 + size * u, law) - self.force(self.x0 - size * u, law)) / (2 * size)
            f[:, -1] += stiffness * self.area * u[:, -1]
            value = (u * f).sum()
            u = f / self.mass
        return np.sqrt(value)


# --- Collision ----------------------------------------------------------------------------------------

def collide(layers, speed, law="hencky", penalty=16.0, courant=0.5, until=200.0, seed=0):
    """Runs one collision; `penalty` is the contact stiffness per area in units of rho cp^2 / h,
    None puts penetrating nodes onto the plane (a multiplier for each node, no stiffness).
    A seed other than 0 moves the nodes at the start by about 1e-12.
    Returns arrays by name: samples every `SAMPLE`, and the contact force of every step."""
    ring = Ring(layers)
    stiffness = 0.0 if penalty is None else penalty * RUBBER.density * RUBBER.p_wave**2 / ring.h
    # The margin covers power iteration from below and elements that get thinner.
    limit = 2 / (1.05 * ring.fastest(stiffness))
    every = int(np.ceil(SAMPLE / (courant * limit)))
    dt = SAMPLE / every
    law = plane_strain.LAWS[law](RUBBER)
    x, v = ring.x0.copy(), np.zeros_like(ring.x0)
    v[0] = -speed
    if seed:
        x += 1e-12 * np.random.default_rng(seed).standard_normal(x.shape)
        x[1, :, [0, -1]] = 0
    steps = every * int(round(until / SAMPLE))
    forces, samples = np.zeros(steps + 1), []
    impulse, work, before = 0.0, 0.0, None
    for n in range(steps + 1):
        f = ring.force(x, law)
        law.keep()
        if not law.has_energy:
            if before is not None:
                work -= 0.5 * ((f + before[0]) * (x - before[1])).sum()
            before = f, x
        gap = x[0, -1]
        push = -stiffness * ring.area * np.minimum(gap, 0)
        acceleration = f / ring.mass
        acceleration[0, -1] += push / ring.mass[-1]
        acceleration[1, :, [0, -1]] = 0
        # Velocities are half a step behind, and at the time itself at the start.
        share = 0.5 if n == 0 else 1.0
        new = v + share * dt * acceleration
        if penalty is None:
            stop = np.maximum(-gap / dt - new[0, -1], 0) * (gap + dt * new[0, -1] < 0)
            new[0, -1] += stop
            push = stop * ring.mass[-1] / (share * dt)
        forces[n] = 2 * push.sum()
        if n % every == 0:
            now = v if n == 0 else 0.5 * (v + new)
            spring = stiffness * (ring.area * np.minimum(gap, 0) ** 2).sum()
            strain = 2 * ring.energy(x, law) if law.has_energy else 2 * work
            so_far = impulse + 0.5 * dt * share * forces[n]
            own = dict(t=n * dt, impulse=so_far, strain=strain, contact=spring)
            samples.append(own | sample(ring, x, now))
            if not np.isfinite(strain):
                break
        impulse += share * dt * forces[n]
        v = new
        x = x + dt * v
    result = {key: np.array([one[key] for one in samples]) for key in samples[0]}
    return dict(result, force=forces, dt=dt, mass=2 * ring.mass.sum())


def sample(ring, x, v):
    """What is kept of a state; masses and energies of the whole ring."""
    total, quarter = ring.mass.sum(), 2 * (ring.columns // 3)
    far, near = x[:, 0, :quarter], x[:, 0, -quarter:]  # 60 degrees of the hole from either pole
    j_min, j_max, log_strain = ring.volume_ratios(x)
    return {
        "x_c": (ring.mass * x[0]).sum() / total, "v_c": (ring.mass * v[0]).sum() / total,
        "x_min": x[0, -1].min(), "x_max": x[0].max(), "height": 2 * x[1].max(),
        "kinetic": (ring.mass * v**2).sum(),
        "hole_min": np.hypot(near[0][:, None] - far[0], near[1][:, None] - far[1]).min(),
        "hole_axis": x[0, 0, 0] - x[0, 0, -1], "pole": x[0, -1, -1],
        "j_min": j_min, "j_max": j_max, "log_strain": log_strain,
        "outer": x[:, -1], "inner": x[:, 0],
    }
