"""One rubber ring against a rigid frictionless plane: explicit finite elements in plane strain.

Units of the ring: length (inner radius 3, outer 4), density 1, bulk sound speed 1.
Half of the ring (y >= 0) is meshed, with rollers on y = 0; the plane is x = 0, the ring is at x > 0.
Results are those of the whole ring, per unit of depth.

Elements: nine-node quadrilaterals (scikit-fem), 3 x 3 Gauss points, total Lagrangian.
Time: central differences with row-sum lumped mass.
All elements of a layer are rotations of each other and the laws are isotropic, so that one column of
elements gives the gradients of all: with respect to axes that turn with the element.
"""

import numpy as np
import skfem

INNER, OUTER, CENTRE = 3.0, 4.0, 5.0
DENSITY, BULK, SHEAR = 1.0, 1.0, 0.22
LAME = BULK - 2 / 3 * SHEAR
P_WAVE = np.sqrt((BULK + 4 / 3 * SHEAR) / DENSITY)
SAMPLE = 0.5


# --- Laws: first Piola-Kirchhoff stress and strain energy from F (plane strain, F33 = 1) -------------

def hencky(f11, f12, f21, f22, energy=False):
    """Cauchy pressure K (1/J - 1), Kirchhoff deviator 2 mu dev ln V: hyperelastic,
    W = K (J - 1 - ln J) + mu |dev ln V|^2."""
    jac = f11 * f22 - f12 * f21
    b11, b22, b12 = f11 * f11 + f12 * f12, f21 * f21 + f22 * f22, f11 * f21 + f12 * f22
    mean, half = 0.5 * (b11 + b22), 0.5 * (b11 - b22)
    q2 = (half * half + b12 * b12) / (mean * mean)
    q = np.sqrt(q2 + 1e-30)
    angle = np.arctanh(q)
    log = np.log(jac)
    if energy:
        return BULK * (jac - 1 - log) + SHEAR * (log * log / 6 + 0.5 * angle * angle)
    ratio = SHEAR * angle / (q * mean)  # 2 mu times the factor of b - mean I in ln V
    sphere = BULK * (jac - 1) + SHEAR * log / 3  # 2 mu (ln J / 2 - ln J / 3)
    return piola(f11, f12, f21, f22, 1 / jac, sphere, ratio * half, ratio * b12)


def piola(f11, f12, f21, f22, inverse, sphere, s11, s12):
    """tau F^-T of the Kirchhoff stress with in-plane mean `sphere` and in-plane deviator s11, s12."""
    t11, t22 = (sphere + s11) * inverse, (sphere - s11) * inverse
    t12 = s12 * inverse
    return t11 * f22 - t12 * f12, t12 * f11 - t11 * f21, t12 * f22 - t22 * f12, t22 * f11 - t12 * f21


def neo_hookean(f11, f12, f21, f22, energy=False):
    """W = mu/2 (J^-2/3 tr b - 3) + K/2 (J - 1)^2, with b33 = 1."""
    jac = f11 * f22 - f12 * f21
    b11, b22, b12 = f11 * f11 + f12 * f12, f21 * f21 + f22 * f22, f11 * f21 + f12 * f22
    scale = SHEAR * jac ** (-2 / 3)
    if energy:
        return 0.5 * (scale * (b11 + b22 + 1) - 3 * SHEAR) + 0.5 * BULK * (jac - 1) ** 2
    third = (b11 + b22 + 1) / 3
    sphere = BULK * jac * (jac - 1) + scale * (0.5 * (b11 + b22) - third)
    return piola(f11, f12, f21, f22, 1 / jac, sphere, 0.5 * scale * (b11 - b22), scale * b12)


def saint_venant(f11, f12, f21, f22, energy=False):
    """W = lambda/2 (tr E)^2 + mu E : E."""
    e11, e22 = 0.5 * (f11 * f11 + f21 * f21 - 1), 0.5 * (f12 * f12 + f22 * f22 - 1)
    e12 = 0.5 * (f11 * f12 + f21 * f22)
    trace = e11 + e22
    if energy:
        return 0.5 * LAME * trace**2 + SHEAR * (e11**2 + e22**2 + 2 * e12**2)
    s11, s22 = LAME * trace + 2 * SHEAR * e11, LAME * trace + 2 * SHEAR * e22
    s12 = 2 * SHEAR * e12
    return f11 * s11 + f12 * s12, f11 * s12 + f12 * s22, f21 * s11 + f22 * s12, f21 * s12 + f22 * s22


class Jaumann:
    """The law of the seed's equations (10) to (12): Cauchy pressure K (1/J - 1), Jaumann rate of the Cauchy
    deviator = 2 mu dev D. No strain energy: the work of the stress stands for it."""

    def __init__(self):
        self.old = {}

    def __call__(self, f11, f12, f21, f22, chunk):
        zero = np.zeros_like(f11)
        old = self.old.get(chunk, (zero + 1, zero, zero, zero + 1, zero, zero, zero))
        o11, o12, o21, o22, s11, s22, s12 = old
        m11, m12, m21, m22 = 0.5 * (f11 + o11), 0.5 * (f12 + o12), 0.5 * (f21 + o21), 0.5 * (f22 + o22)
        d11, d12, d21, d22 = f11 - o11, f12 - o12, f21 - o21, f22 - o22
        inverse = 1 / (m11 * m22 - m12 * m21)
        l11, l12 = (d11 * m22 - d12 * m21) * inverse, (d12 * m11 - d11 * m12) * inverse
        l21, l22 = (d21 * m22 - d22 * m21) * inverse, (d22 * m11 - d21 * m12) * inverse
        turn = np.arctan(0.25 * (l21 - l12))  # half of the angle of the step
        trace = (l11 + l22) / 3
        s11, s22, s12 = rotated(s11, s22, s12, turn)
        s11, s22 = s11 + 2 * SHEAR * (l11 - trace), s22 + 2 * SHEAR * (l22 - trace)
        s12 = s12 + SHEAR * (l12 + l21)
        s11, s22, s12 = rotated(s11, s22, s12, turn)
        self.old[chunk] = tuple(np.array(a) for a in (f11, f12, f21, f22, s11, s22, s12))
        jac = f11 * f22 - f12 * f21
        sphere = BULK * (jac - 1) + 0.5 * jac * (s11 + s22)
        return piola(f11, f12, f21, f22, 1 / jac, sphere, 0.5 * jac * (s11 - s22), jac * s12)


def rotated(s11, s22, s12, angle):
    cos, sin = np.cos(2 * angle), np.sin(2 * angle)
    mean, half = 0.5 * (s11 + s22), 0.5 * (s11 - s22)
    half, s12 = half * cos - s12 * sin, half * sin + s12 * cos
    return mean + half, mean - half, s12


LAWS = {"hencky": hencky, "neo_hookean": neo_hookean, "saint_venant": saint_venant, "jaumann": Jaumann}


# --- Mesh ---------------------------------------------------------------------------------------------

def sector(layers, columns, angle):
    """Polar mesh of nine-node quadrilaterals, isoparametric: angles 0 to `angle`."""
    sides = np.linspace(INNER, OUTER, layers + 1), np.linspace(0, angle, columns + 1)
    flat = skfem.MeshQuad2.from_mesh(skfem.MeshQuad.init_tensor(*sides))
    radius, theta = flat.doflocs
    return skfem.MeshQuad2(np.array([radius * np.cos(theta), radius * np.sin(theta)]), flat.t)


class Ring:
    """Half a ring as a grid of nodes: axis 1 the radius, axis 2 the angle from the far pole to the plane."""

    def __init__(self, layers, chunk=None):
        self.layers, self.columns = layers, 11 * layers
        self.h = (OUTER - INNER) / layers
        rows, cols = 2 * layers + 1, 2 * self.columns + 1
        radius = np.linspace(INNER, OUTER, rows)[:, None]
        theta = np.linspace(0, np.pi, cols)[None, :]
        self.x0 = np.array([CENTRE + radius * np.cos(theta), radius * np.sin(theta)])
        self.x0[1, :, -1] = 0
        self._gradients()
        self.chunk = chunk or max(1, round(12000 / (9 * self.columns)))
        self.mass = self._scatter(np.repeat(self.volumes[:, :, None], self.columns, axis=2))
        # Simpson's weights of the outer arc: areas of the contact nodes.
        weights = np.full(cols, 2 / 3) + np.where(np.arange(cols) % 2, 2 / 3, 0)
        weights[[0, -1]] = 1 / 3
        self.area = weights * 0.5 * OUTER * np.pi / self.columns

    def _gradients(self):
        """From scikit-fem, for one column: (layer, node, 2 x point) gradients, the same times weight."""
        angle = np.pi / self.columns
        basis = skfem.Basis(sector(self.layers, 1, angle), skfem.ElementQuad2(), intorder=5)
        where = basis.doflocs[:, basis.element_dofs]  # (2, node, element)
        radius, theta = np.hypot(*where), np.arctan2(where[1], where[0])
        layer = np.floor((radius.mean(axis=0) - INNER) / self.h).astype(int)
        row = np.rint((radius - INNER - layer * self.h) / self.h * 2).astype(int)
        node = 3 * row + np.rint(theta / angle * 2).astype(int)
        points = basis.dx.shape[1]
        self.gradient = np.zeros((self.layers, 9, 2, points))
        self.volumes = np.zeros((self.layers, 9))
        self.weight = np.zeros((self.layers, points))
        self.weight[layer] = basis.dx
        for local, (field,) in enumerate(basis.basis):
            # field.grad is (2, element, point)
            self.gradient[layer, node[local]] = np.moveaxis(np.asarray(field.grad), 0, 1)
            self.volumes[layer, node[local]] = DENSITY * (np.asarray(field) * basis.dx).sum(axis=1)
        self.points = points
        flat = (self.layers, 9, 2 * points)
        self.down = np.ascontiguousarray(np.swapaxes(self.gradient.reshape(flat), 1, 2))
        self.up = np.ascontiguousarray((self.gradient * self.weight[:, None, None, :]).reshape(flat))

    def _gather(self, x):
        """Nodes of the elements: (layer, node, 2 x column)."""
        nodes = np.empty((self.layers, 9, 2, self.columns))
        for i in range(3):
            for j in range(3):
                part = x[:, i : i + 2 * self.layers - 1 : 2, j : j + 2 * self.columns - 1 : 2]
                nodes[:, 3 * i + j] = np.swapaxes(part, 0, 1)
        return nodes.reshape(self.layers, 9, 2 * self.columns)

    def _scatter(self, nodes):
        """Sums (layer, node, column) over elements."""
        out = np.zeros((2 * self.layers + 1, 2 * self.columns + 1))
        for i in range(3):
            for j in range(3):
                out[i : i + 2 * self.layers - 1 : 2, j : j + 2 * self.columns - 1 : 2] += nodes[:, 3 * i + j]
        return out

    def _deformations(self, x):
        """F at all points, by chunks of layers: four arrays (layer, point, column)."""
        nodes = self._gather(x)
        for start in range(0, self.layers, self.chunk):
            part = slice(start, start + self.chunk)
            f = self.down[part] @ nodes[part]
            f = f.reshape(-1, 2, self.points, 2, self.columns)
            yield part, (f[:, 0, :, 0], f[:, 1, :, 0], f[:, 0, :, 1], f[:, 1, :, 1])

    def force(self, x, law):
        """Minus the internal force."""
        out = np.empty((self.layers, 9, 2 * self.columns))
        has_memory = isinstance(law, Jaumann)
        for part, f in self._deformations(x):
            stress = law(*f, part.start) if has_memory else law(*f)
            p = np.empty((f[0].shape[0], 2, self.points, 2, self.columns))
            p[:, 0, :, 0], p[:, 1, :, 0], p[:, 0, :, 1], p[:, 1, :, 1] = stress
            np.matmul(self.up[part], p.reshape(-1, 2 * self.points, 2 * self.columns), out=out[part])
        out = out.reshape(self.layers, 9, 2, self.columns)
        return -np.array([self._scatter(out[:, :, 0]), self._scatter(out[:, :, 1])])

    def energy(self, x, law):
        total = 0.0
        for part, f in self._deformations(x):
            total += np.einsum("lqc,lq->", law(*f, energy=True), self.weight[part])
        return total

    def volume_ratios(self, x):
        """Least and largest J, largest principal logarithmic strain."""
        low, high, strain = np.inf, -np.inf, 0.0
        for _, (a, b, c, d) in self._deformations(x):
            jac = a * d - b * c
            mean = 0.5 * (a * a + b * b + c * c + d * d)
            angle = 0.5 * np.arccosh(np.maximum(mean / jac, 1))
            low, high = min(low, jac.min()), max(high, jac.max())
            strain = max(strain, (np.abs(0.5 * np.log(jac)) + angle).max())
        return low, high, strain

    def fastest(self, stiffness, law=hencky, steps=60):
        """Highest angular frequency, the contact springs of the whole arc included: power iteration."""
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
    stiffness = 0.0 if penalty is None else penalty * DENSITY * P_WAVE**2 / ring.h
    # The margin covers power iteration from below and elements that get thinner.
    limit = 2 / (1.05 * ring.fastest(stiffness))
    every = int(np.ceil(SAMPLE / (courant * limit)))
    dt = SAMPLE / every
    is_rate = law == "jaumann"
    stress = LAWS[law]() if is_rate else LAWS[law]
    x, v = ring.x0.copy(), np.zeros_like(ring.x0)
    v[0] = -speed
    if seed:
        x += 1e-12 * np.random.default_rng(seed).standard_normal(x.shape)
        x[1, :, [0, -1]] = 0
    steps = every * int(round(until / SAMPLE))
    forces, samples = np.zeros(steps + 1), []
    impulse, work, before = 0.0, 0.0, None
    for n in range(steps + 1):
        f = ring.force(x, stress)
        if is_rate:
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
            strain = 2 * work if is_rate else 2 * ring.energy(x, stress)
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
