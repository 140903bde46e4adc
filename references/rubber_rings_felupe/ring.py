"""The ring of `rubber_rings` against a rigid frictionless plane by felupe; length L, density 1, bulk sound speed 1.

Central differences with a consistent mass. Contact: the plane pushes with `stiffness` times depth on the outer face,
integrated over its sides by five Gauss points each, so that a side feels the plane between its nodes too.
"""

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

import felupe_motion

BULK, SHEAR, DENSITY = 1.0, 0.22, 1.0
INNER, OUTER, CENTRE = 3.0, 4.0, 5.0


def collide(layers, speed, law="neo_hookean", stiffness=10.0, courant=0.5, until=200.0, sample=0.25):
    """`stiffness` in units of rho cp^2 over the thickness of an element."""
    def place(s, r):
        angle, radius = np.pi * s, INNER + (OUTER - INNER) * r
        return CENTRE - radius * np.cos(angle), radius * np.sin(angle)

    # From the pole at the plane to the far one.
    columns = 11 * layers
    body = felupe_motion.Body(layers, columns, place, felupe_motion.law(law, BULK, SHEAR), DENSITY)
    body.points[np.isin(body.unit[:, 0], (0, 1)), 1] = 0
    body.region.reload()
    body.hold(np.isin(body.unit[:, 0], (0, 1)), axis=1)
    free = body.free
    mass = body.mass[free][:, free].tocsc()
    factor = scipy.sparse.linalg.splu(mass)
    face = Face(body, columns)
    hardness = stiffness * (BULK + 4 / 3 * SHEAR) * layers / (OUTER - INNER)
    whole = body.stiffness(np.zeros(body.size)) + hardness * face.spring(body.size)
    fastest = scipy.sparse.linalg.eigsh(whole[free][:, free], 1, mass, which="LM", Minv=inverse(factor),
                                        return_eigenvectors=False, tol=1e-3)[0]
    every = int(np.ceil(sample / (courant * 2 / np.sqrt(1.1 * fastest))))
    step = sample / every
    ones = np.zeros(body.size)
    ones[::2] = 1
    total = ones @ body.mass @ ones
    x0 = body.points.ravel()
    u, v = np.zeros(body.size), np.zeros(body.size)
    v[::2] = -speed
    rows, impulse = [], 0.0
    steps = every * round(until / sample)
    for n in range(steps + 1):
        push = face.push(x0 + u, hardness)
        a = np.zeros(body.size)
        a[free] = factor.solve((push - body.force(u))[free])
        new = v + (0.5 if n == 0 else 1.0) * step * a
        if n % every == 0:
            now = v if n == 0 else 0.5 * (v + new)
            x = (x0 + u).reshape(-1, 2)
            rows.append(dict(
                t=n * step, x_c=(ones @ body.mass @ (x0 + u)) / total, v_c=(ones @ body.mass @ now) / total,
                x_min=x[:, 0].min(), x_max=x[:, 0].max(), height=2 * x[:, 1].max(), force=2 * push.sum(),
                kinetic=now @ body.mass @ now, strain=2 * body.energy(u),
                contact=2 * face.stored(x0 + u, hardness)))
            if not np.isfinite(rows[-1]["x_c"]):
                raise ArithmeticError("the run diverges")
        v = new
        u = u + step * v
    out = {key: np.array([row[key] for row in rows]) for key in rows[0]}
    return dict(out, step=step, mass=2 * total)




def inverse(factor):
    return scipy.sparse.linalg.LinearOperator(factor.shape, factor.solve)


class Face:
    """The outer arc: sides of three nodes, with Gauss points."""

    def __init__(self, body, columns):
        arc = np.flatnonzero(np.abs(body.unit[:, 1] - 1) < 1e-12)
        arc = arc[np.argsort(body.unit[arc, 0])]
        self.nodes = np.array([arc[2 * k:2 * k + 3] for k in range(columns)])
        s, w = np.polynomial.legendre.leggauss(5)
        self.shape = np.array([s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2])
        slope = np.array([s - 0.5, -2 * s, s + 0.5])
        tangent = np.einsum("eia,ig->ega", body.points[self.nodes], slope)
        self.area = w * np.hypot(*np.moveaxis(tangent, -1, 0))
        self.size = body.size

    def gaps(self, x):
        return x.reshape(-1, 2)[self.nodes, 0] @ self.shape

    def push(self, x, hardness):
        pressure = hardness * np.maximum(-self.gaps(x), 0)
        out = np.zeros((self.size // 2, 2))
        np.add.at(out[:, 0], self.nodes, (pressure * self.area) @ self.shape.T)
        return out.ravel()

    def stored(self, x, hardness):
        return 0.5 * hardness * (self.area * np.minimum(self.gaps(x), 0) ** 2).sum()

    def spring(self, size):
        """Stiffness of the whole arc against the plane, for the limit of the time step."""
        block = np.einsum("eg,ig,jg->eij", self.area, self.shape, self.shape)
        i, j = np.broadcast_arrays(2 * self.nodes[:, :, None], 2 * self.nodes[:, None, :])
        return scipy.sparse.coo_matrix((block.ravel(), (i.ravel(), j.ravel())), (size, size)).tocsr()
