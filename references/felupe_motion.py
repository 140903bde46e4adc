"""Motion of an elastic body in plane strain by felupe: elements, laws, assembly and mass are felupe's.

Eight-node (serendipity) quadrilaterals, 3 x 3 Gauss points, consistent mass; time by the generalised-alpha method of
Chung and Hulbert (1993). It shares no line with plane_strain.py and beam.py, whose results it checks.
"""

import felupe
import numpy as np
import scipy.sparse.linalg


class Law(felupe.NeoHooke):
    """A law of which only the stress is stated. Its tangent is that of felupe's Neo-Hooke of the same moduli: it only decides
    how fast Newton's iteration converges."""

    def _lame(self):
        return self.bulk - 2 / 3 * self.mu


class SaintVenant(Law):
    """W = lambda/2 (tr E)^2 + mu E : E."""

    def gradient(self, x, out=None):
        F, state = x[0], x[-1]
        f = np.moveaxis(F, (0, 1), (-2, -1))
        strain = 0.5 * (np.swapaxes(f, -1, -2) @ f - np.eye(3))
        trace = np.trace(strain, axis1=-2, axis2=-1)[..., None, None]
        stress = f @ (self._lame() * trace * np.eye(3) + 2 * self.mu * strain)
        return [np.ascontiguousarray(np.moveaxis(stress, (-2, -1), (0, 1))), state]

    def function(self, x):
        f = np.moveaxis(x[0], (0, 1), (-2, -1))
        strain = 0.5 * (np.swapaxes(f, -1, -2) @ f - np.eye(3))
        trace = np.trace(strain, axis1=-2, axis2=-1)
        return [0.5 * self._lame() * trace**2 + self.mu * (strain**2).sum((-2, -1))]


class Hencky(Law):
    """W = K (J - 1 - ln J) + mu |dev ln V|^2 in plane strain."""

    @staticmethod
    def _logs(F):
        """Deformation, principal directions of b and logarithms of the stretches, in the plane."""
        f = np.moveaxis(F[:2, :2], (0, 1), (-2, -1))
        squares, directions = np.linalg.eigh(f @ np.swapaxes(f, -1, -2))
        return f, directions, 0.5 * np.log(squares)

    def gradient(self, x, out=None):
        F, state = x[0], x[-1]
        f, directions, logs = self._logs(F)
        log = logs.sum(-1, keepdims=True)
        kirchhoff = self.bulk * np.expm1(log) + 2 * self.mu * (logs - log / 3)
        stress = (directions * kirchhoff[..., None, :]) @ np.swapaxes(directions, -1, -2)
        # tau F^-T across the plane is of no use: F33 = 1 does no work.
        result = np.zeros_like(F)
        result[:2, :2] = np.moveaxis(stress @ np.swapaxes(np.linalg.inv(f), -1, -2), (-2, -1), (0, 1))
        return [result, state]

    def function(self, x):
        logs = self._logs(x[0])[2]
        log = logs.sum(-1)
        return [self.bulk * (np.expm1(log) - log) + self.mu * ((logs**2).sum(-1) - log**2 / 3)]


LAWS = {"neo_hookean": felupe.NeoHooke, "saint_venant": SaintVenant, "hencky": Hencky}


def law(name, bulk, shear):
    return LAWS[name](mu=shear, bulk=bulk)


class Body:
    """A grid of `across` x `along` elements, its points moved from the unit square to place(along, across)."""

    def __init__(self, across, along, place, material, density):
        mesh = felupe.Rectangle(n=(along + 1, across + 1)).add_midpoints_edges()
        self.unit = mesh.points.copy()
        mesh.points[:] = np.array(place(*self.unit.T)).T
        self.region = felupe.RegionQuadraticQuad(mesh)
        self.field = felupe.FieldContainer([felupe.FieldPlaneStrain(self.region, dim=2)])
        self.solid = felupe.SolidBody(material, self.field, density=density)
        self.mass = self.solid.assemble.mass().tocsr()
        self.points = mesh.points
        self.size = self.mass.shape[0]
        self.free = np.arange(self.size)

    def hold(self, points, axis=None):
        """Holds the points whose mask is set, along one axis or both."""
        held = np.outer(points, [axis in (None, 0), axis in (None, 1)]).ravel()
        self.free = np.setdiff1d(self.free, np.flatnonzero(held))

    def _set(self, u):
        self.field[0].values[:] = u.reshape(-1, 2)

    def force(self, u):
        """Internal forces."""
        self._set(u)
        return self.solid.assemble.vector(self.field).toarray().ravel()

    def stiffness(self, u):
        self._set(u)
        return self.solid.assemble.matrix(self.field).tocsr()

    def energy(self, u):
        """Strain energy."""
        self._set(u)
        density = self.solid.umat.function([*self.field.extract(), None])[0]
        return float((density * self.region.dV).sum())

    def at_rest(self, load, u=None):
        """Displacements under a load that does not turn."""
        u = np.zeros(self.size) if u is None else u.copy()
        free = self.free
        for _ in range(300):
            step = scipy.sparse.linalg.spsolve(
                self.stiffness(u)[free][:, free].tocsc(), (load - self.force(u))[free])
            u[free] += step
            if np.abs(step).max() < 1e-12:
                return u
        raise ArithmeticError("Newton's iteration does not converge")

    def move(self, step, until, watched, velocity=None, load=0.0, radius=0.8, tolerance=1e-10):
        """Times, displacements of the point `watched`, total energy. `radius` is the spectral radius at high
        frequencies."""
        am, af = (2 * radius - 1) / (radius + 1), radius / (radius + 1)
        gamma, beta = 0.5 - am + af, 0.25 * (1 - am + af) ** 2
        free, mass = self.free, self.mass[self.free][:, self.free].tocsc()
        load = (load * np.ones(self.size))[free]
        u, v = np.zeros(self.size), np.zeros(len(free))
        if velocity is not None:
            v[:] = velocity[free]
        inner = self.force(u)[free]
        a = scipy.sparse.linalg.splu(mass).solve(load - inner)
        inertia = (1 - am) / (beta * step**2)
        count = round(until / step)
        path, energy = np.zeros((count + 1, 2)), np.zeros(count + 1)
        factor = None
        for n in range(count + 1):
            path[n] = u.reshape(-1, 2)[watched]
            if n % 20 == 0:
                energy[n] = 0.5 * v @ (mass @ v) + self.energy(u) - load @ u[free]
            if n == count:
                break
            guess = u[free] + step * v + (0.5 - beta) * step**2 * a
            new, change = u.copy(), beta * step**2 * a
            new[free] = guess + change
            for trial in range(60):
                if factor is None or trial in (12, 24, 36, 48):
                    matrix = inertia * mass + (1 - af) * self.stiffness(new)[free][:, free]
                    factor = scipy.sparse.linalg.splu(matrix.tocsc())
                outer = self.force(new)[free]
                b = (new[free] - guess) / (beta * step**2)
                residual = load - (1 - af) * outer - af * inner - mass @ ((1 - am) * b + am * a)
                correction = factor.solve(residual)
                new[free] += correction
                if np.abs(correction).max() < tolerance:
                    break
            else:
                raise ArithmeticError(f"step {n} does not converge")
            if trial > 6:
                factor = None
            b = (new[free] - guess) / (beta * step**2)
            u, v, a = new, v + step * ((1 - gamma) * a + gamma * b), b
            inner = self.force(u)[free]
        return dict(t=step * np.arange(count + 1), path=path, energy=energy[::20])


def crossings(t, y, downwards=None):
    """Times at which y changes its sign, by a cubic through four samples."""
    found = []
    for k in np.flatnonzero(y[:-1] * y[1:] < 0):
        if downwards is not None and (y[k] > 0) != downwards:
            continue
        low = min(max(k - 1, 0), len(y) - 4)
        cubic = np.polynomial.Polynomial.fit(t[low:low + 4], y[low:low + 4], 3)
        roots = cubic.roots()
        inside = [r.real for r in roots if abs(r.imag) < 1e-9 and t[k] - 1e-12 <= r.real <= t[k + 1] + 1e-12]
        found.append(inside[0])
    return np.array(found)


def peak(t, y):
    """Greatest value and its time: the quartic through five samples."""
    k = int(np.clip(np.argmax(y), 2, len(y) - 3))
    if np.argmax(y) in (0, len(y) - 1):
        return y[np.argmax(y)], t[np.argmax(y)]
    quartic = np.polynomial.Polynomial.fit(t[k - 2:k + 3], y[k - 2:k + 3], 4)
    fine = np.linspace(t[k - 1], t[k + 1], 4001)
    values = quartic(fine)
    return values.max(), fine[values.argmax()]
