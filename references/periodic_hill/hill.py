"""Steady laminar flow over periodic hills by finite elements on a mesh that fits the hill exactly.

Units: hill height H = 1, bulk velocity over the crest U_b = 1, density 1; so nu = 1/Re, and the force per
mass is in U_b^2/H. The domain is 9 long, from the hill h(x) to the lid at 3.035, periodic in x.

The mesh is one of rectangles in (x, s), y = h(x) + s (3.035 - h(x)), 0 <= s <= 1. Nothing of the geometry is
approximated: derivatives are those of the map, d/dy = (1/G) d/ds and d/dx = d/dx|s - ((1 - s) h'/G) d/ds with
G = 3.035 - h, and the element edges stand where h has its breaks.

Velocity of second order, pressure linear in each rectangle and discontinuous between them: tested with a
constant and with the place along x, continuity says that the same flux passes every edge between columns
and, on average, every column. Edges stand at the stations of the tables, whose flux is therefore exact.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
import skfem
from skfem.element.element_h1 import ElementH1
from skfem.refdom import RefQuad

LENGTH, LID = 9.0, 3.035
GAP = LID - 1.0  # over the crest
FLUX = GAP  # U_b = 1
SCALE = 28.0  # mm a hill height

# h [mm] = a0 + a1 x + a2 x^2 + a3 x^3 from each break [mm] to the next; ERCOFTAC case 81.
BREAKS = np.array([0.0, 9.0, 14.0, 20.0, 30.0, 40.0, 54.0])
PIECES = np.array([
    [28.0, 0.0, 6.775070969851e-3, -2.124527775800e-3],
    [25.07355893131, 0.9754803562315, -1.016116352781e-1, 1.889794677828e-3],
    [25.79601052357, 0.8206693007457, -9.055370274339e-2, 1.626510569859e-3],
    [40.46435022819, -1.379581654948, 1.945884504128e-2, -2.070318932190e-4],
    [17.92461334664, 0.8743920332081, -5.567361123058e-2, 6.277731764683e-4],
    [56.39011190988, -2.010520359035, 1.644919857549e-2, 2.674976141766e-5],
])
# The first piece exceeds 28 mm up to here, where the clip of the definition leaves a kink of 1.2 degrees.
KINK = -PIECES[0, 2] / PIECES[0, 3]


def half(x):
    """h and h' [mm, -] at 0 <= x [mm] <= 126, from the crest to the middle of the trough."""
    k = np.clip(np.searchsorted(BREAKS, x, side="right") - 1, 0, len(PIECES) - 1)
    a0, a1, a2, a3 = np.moveaxis(PIECES[k], -1, 0)
    h, slope = a0 + x * (a1 + x * (a2 + x * a3)), a1 + x * (2 * a2 + x * 3 * a3)
    flat = (x <= KINK) | (x >= BREAKS[-1])
    return np.where(x <= KINK, SCALE, np.where(x >= BREAKS[-1], 0.0, h)), np.where(flat, 0.0, slope)


@dataclass(frozen=True)
class Hill:
    """The lower wall, `height` times as high; 0 is a flat channel whose bulk velocity is still that of a
    gap of 2.035."""

    height: float = 1.0

    def __call__(self, x):
        """h and h' at x."""
        x = np.mod(x, LENGTH)
        windward = x > 0.5 * LENGTH
        h, slope = half(SCALE * np.where(windward, LENGTH - x, x))
        return self.height * h / SCALE, self.height * np.where(windward, -slope, slope)


# Ends of the intervals of x that carry uniform columns, and columns of the coarsest mesh, crest to trough:
# the breaks, and the stations 0.05, 0.5, 1, 2, 3 and 4 H.
ENDS = np.array([0.0, 1.4, KINK, 9.0, 14.0, 20.0, 28.0, 30.0, 40.0, 54.0, 56.0, 84.0, 112.0, 126.0]) / SCALE
COLUMNS = np.array([1, 1, 2, 2, 2, 2, 1, 3, 4, 1, 6, 5, 3])
ROWS = 12


def mesh(level):
    """Rectangles in (x, s): 2^level times the columns and rows of the coarsest mesh."""
    halves = [np.linspace(a, b, n * 2**level + 1)[:-1] for a, b, n in zip(ENDS, ENDS[1:], COLUMNS)]
    left = np.append(np.concatenate(halves), 0.5 * LENGTH)
    x = np.append(left, LENGTH - left[-2::-1])
    t = np.linspace(0.0, 1.0, ROWS * 2**level + 1)
    s = t - 0.75 * np.sin(2 * np.pi * t) / (2 * np.pi)  # four times as fine at the walls as without
    return x, s


class LinearInside(ElementH1):
    """1 and the two places about the middle of a rectangle: linear in each, discontinuous between them."""

    interior_dofs, maxdeg, refdom = 3, 1, RefQuad
    dofnames = ["p", "p_s", "p_x"]  # the mesh numbers the corners of a rectangle along s first
    doflocs = np.full((3, 2), 0.5)

    def lbasis(self, at, i):
        if i == 0:
            return np.ones(at.shape[1:]), np.zeros_like(at)
        gradient = np.zeros_like(at)
        gradient[i - 1] = 1.0
        return at[i - 1] - 0.5, gradient


class Flow:
    """Bases, matrices and the state of one mesh."""

    def __init__(self, level, hill=Hill()):
        self.hill, self.level, self._map = hill, level, None
        self.x, self.s = mesh(level)
        grid = skfem.MeshQuad.init_tensor(self.x, self.s)
        # Degree 9 along x of the convective term, whose integrand is a polynomial on every column.
        self.velocity = skfem.Basis(grid, skfem.ElementQuad2(), intorder=9)
        self.pressure = self.velocity.with_element(LinearInside())
        self.keep_u = self._periodic(self.velocity)
        self.n, self.m = self.keep_u.shape[1], self.pressure.N
        place = self.velocity.doflocs
        wall = np.abs(place[1] - 0.5) > 0.5 - 1e-12
        self.free = np.flatnonzero(self.keep_u.T @ wall.astype(float) == 0)
        self._assemble()
        self.u, self.v = np.zeros(self.n), np.zeros(self.n)
        self.p, self.force = np.zeros(self.m), 0.0

    @staticmethod
    def _periodic(basis):
        """From the unknowns of one period to all degrees of freedom: those at x = 9 are those at x = 0."""
        x, s = basis.doflocs
        key = np.round(np.vstack([np.where(x > LENGTH - 1e-9, 0.0, x), s]), 11)
        _, index = np.unique(key, axis=1, return_inverse=True)
        index = index.ravel()
        shape = len(index), index.max() + 1
        return scipy.sparse.csr_matrix((np.ones(len(index)), (np.arange(len(index)), index)), shape)

    def map(self, w):
        """G, and (1 - s) h' at the quadrature points, which are the same for every form."""
        if self._map is None:
            h, slope = self.hill(w.x[0])
            self._map = LID - h, (1 - w.x[1]) * slope
        return self._map

    @staticmethod
    def grad(f, gap, lean):
        """G times the gradient in (x, y)."""
        return gap * f.grad[0] - lean * f.grad[1], f.grad[1]

    def _assemble(self):
        @skfem.BilinearForm
        def stiffness(u, w_, w):
            gap, lean = self.map(w)
            (ax, ay), (bx, by) = self.grad(u, gap, lean), self.grad(w_, gap, lean)
            return (ax * bx + ay * by) / gap

        def divergence(component):
            @skfem.BilinearForm
            def form(u, q, w):
                return q * self.grad(u, *self.map(w))[component]

            return form.assemble(self.velocity, self.pressure) @ self.keep_u

        @skfem.LinearForm
        def volume(w_, w):
            return self.map(w)[0] * w_

        self.stiffness = self.keep_u.T @ stiffness.assemble(self.velocity) @ self.keep_u
        self.divergence = divergence(0), divergence(1)
        self.volume = self.keep_u.T @ volume.assemble(self.velocity)
        self.pressure_volume = volume.assemble(self.pressure)
        self.area = self.volume.sum()

    def _convection(self):
        """(u.grad) for a scalar, and the mass matrices weighted with the gradients of u and v."""
        fields = {k: self.velocity.interpolate(self.keep_u @ f) for k, f in (("u", self.u), ("v", self.v))}

        @skfem.BilinearForm
        def transport(f, w_, w):
            fx, fy = self.grad(f, *self.map(w))
            return (w["u"] * fx + w["v"] * fy) * w_

        def weighted(name, component):
            @skfem.BilinearForm
            def form(f, w_, w):
                return self.grad(w[name], *self.map(w))[component] * f * w_

            return form

        def matrix(form):
            return self.keep_u.T @ form.assemble(self.velocity, **fields) @ self.keep_u

        return matrix(transport), [[matrix(weighted(k, c)) for c in (0, 1)] for k in ("u", "v")]

    order = "COLAMD"

    def solve(self, re, flux=FLUX, tolerance=1e-12, most=12):
        """Newton's iteration from the present state; returns the sizes of the steps."""
        nu, free, k = 1.0 / re, self.free, len(self.free)
        dx, dy = self.divergence
        zero = np.zeros(k)
        drive = np.concatenate([self.volume[free], zero, np.zeros(self.m - 1)])
        sizes = []
        for _ in range(most):
            transport, ((ux, uy), (vx, vy)) = self._convection()
            plain = (nu * self.stiffness + transport).tocsr()
            residual = np.concatenate([
                (plain @ self.u - dx.T @ self.p - self.force * self.volume)[free],
                (plain @ self.v - dy.T @ self.p)[free],
                # The first, of a constant, is minus the sum of those of the other rectangles.
                -(dx @ self.u + dy @ self.v)[1:],
            ])
            bx, by = dx[1:, free], dy[1:, free]
            matrix = scipy.sparse.bmat([
                [(plain + ux)[free][:, free], uy[free][:, free], -bx.T],
                [vx[free][:, free], (plain + vy)[free][:, free], -by.T],
                [-bx, -by, None],
            ], format="csc")
            factors = scipy.sparse.linalg.splu(matrix, permc_spec=self.order)
            step, driven = -factors.solve(residual), factors.solve(drive)
            # The force is such that the flux is met.
            flow = LENGTH * flux - self.volume @ self.u
            force = (flow - drive @ step) / (drive @ driven)
            step += force * driven
            self.force += force
            self.u[free] += step[:k]
            self.v[free] += step[k : 2 * k]
            self.p[1:] += step[2 * k :]
            self.p[self.pressure.element_dofs[0]] -= self.pressure_volume @ self.p / self.area
            sizes.append(np.abs(step[: 2 * k]).max())
            if sizes[-1] < tolerance:
                return sizes
        raise ArithmeticError(f"Newton's iteration does not end: {sizes}")

    # --- What is read off ------------------------------------------------------------------------------

    def _patches(self, f):
        """Nodal values of a velocity component as (2 columns + 1, 2 rows + 1)."""
        x, s = self.velocity.doflocs
        nodes = [np.unique(np.round(c, 11)) for c in (x, s)]
        index = [np.searchsorted(n, np.round(c, 11)) for n, c in zip(nodes, (x, s))]
        values = np.empty([len(n) for n in nodes])
        values[index[0], index[1]] = self.keep_u @ f
        return values

    def at(self, f, x, s, along=""):
        """The field at points (x, s), or its derivative along "x" at constant s or along "s"."""
        values = self._patches(f)
        i, a, dx = locate(self.x, x)
        j, b, ds = locate(self.s, s)
        in_x = slopes(a) / dx if along == "x" else quadratic(a)
        in_s = slopes(b) / ds if along == "s" else quadratic(b)
        return sum(in_x[k] * in_s[l] * values[2 * i + k, 2 * j + l] for k in range(3) for l in range(3))

    def pressure_at(self, x, s):
        """The periodic part of the pressure; the force stands for the rest."""
        mean, along_s, along_x = self.p[self.pressure.element_dofs]
        i, a, _ = locate(self.x, x)
        j, b, _ = locate(self.s, s)
        inside = i * (len(self.s) - 1) + j
        return mean[inside] + (b - 0.5) * along_s[inside] + (a - 0.5) * along_x[inside]

    def wall_shear(self, x, re):
        """Shear stress nu du_t/dn on the hill at x, [rho U_b^2]."""
        h, slope = self.hill(x)
        u_s, v_s = (self.at(f, x, np.zeros_like(x), "s") for f in (self.u, self.v))
        return (u_s + slope * v_s) / (re * (LID - h))

    def lid_shear(self, x, re):
        """Shear stress on the lid at x, [rho U_b^2], positive where it brakes the flow."""
        return -self.at(self.u, x, np.ones_like(x), "s") / (re * (LID - self.hill(x)[0]))

    def over_section(self, x, integrand):
        """Integral over y of integrand(x, s) at one x."""
        s, weight = gauss(self.s)
        return (LID - float(self.hill(np.array(x))[0])) * weight @ integrand(np.full_like(s, x), s)

    def flux(self, x):
        """Volume flux through the section at x."""
        return self.over_section(x, lambda x, s: self.at(self.u, x, s))

    def column_fluxes(self):
        """Mean volume flux over each column of elements."""
        x, weight = gauss(self.x, 5)
        fluxes = np.array([self.flux(one) for one in x]) * weight
        return fluxes.reshape(-1, 5).sum(axis=1) / np.diff(self.x)

    def momentum(self, x, re):
        """Flux of x momentum and stress through the section at x: that of u^2 + p - nu du/dx."""
        h, slope = (float(a) for a in self.hill(np.array(x)))

        def integrand(x, s):
            u, u_x, u_s = (self.at(self.u, x, s, along) for along in ("", "x", "s"))
            return u * u + self.pressure_at(x, s) - (u_x - (1 - s) * slope * u_s / (LID - h)) / re

        return self.over_section(x, integrand)

    def drag(self, re, upto=LENGTH):
        """Force on the walls from x = 0 on: hill by pressure, hill by shear, lid by shear; sums to force
        times area. The shear is nu du/dn: the other half of the viscous stress, nu (grad v)^T n, is 0 on a
        wall at rest."""
        x, weight = gauss(self.x[self.x <= upto + 1e-9], 5)
        (h, slope), wall = self.hill(x), np.zeros_like(x)
        pressure = weight @ (self.pressure_at(x, wall) * slope)
        shear = weight @ (self.at(self.u, x, wall, "s") * (1 + slope**2) / (re * (LID - h)))
        return pressure, shear, weight @ self.lid_shear(x, re)

    def dissipation(self, re):
        """nu times the integral of |grad v|^2."""
        return (self.u @ self.stiffness @ self.u + self.v @ self.stiffness @ self.v) / re


def gauss(edges, points=3):
    """Places and weights of Gauss points in every interval."""
    t, w = np.polynomial.legendre.leggauss(points)
    a, width = edges[:-1, None], np.diff(edges)[:, None]
    return (a + width * 0.5 * (t + 1)).ravel(), (0.5 * width * w).ravel()


def locate(edges, at):
    """Element, place in it (0 to 1), its width."""
    k = np.clip(np.searchsorted(edges, at, side="right") - 1, 0, len(edges) - 2)
    width = edges[k + 1] - edges[k]
    return k, (at - edges[k]) / width, width


def quadratic(t):
    return (1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)


def slopes(t):
    return np.array([4 * t - 3, 4 - 8 * t, 4 * t - 1])


def turning_points(flow, re):
    """Where the wall shear on the hill turns negative (sign -1) and positive (sign 1), in the order of x."""
    x = np.sort(np.concatenate([[0.0], 0.5 * (flow.x[1:] + flow.x[:-1]), flow.x[1:-1]]))
    tau = flow.wall_shear(x, re)
    found = []
    for k in np.flatnonzero(np.sign(tau[1:]) != np.sign(tau[:-1])):
        low, high = x[k], x[k + 1]
        for _ in range(60):
            middle = 0.5 * (low + high)
            same = np.sign(flow.wall_shear(np.array([middle]), re)[0]) == np.sign(tau[k])
            low, high = (middle, high) if same else (low, middle)
        found.append((0.5 * (low + high), -int(np.sign(tau[k]))))
    return found


def separation_line(flow, xs):
    """y at each x where the volume flux above the hill is 0 again: the line between bubble and stream."""
    ys = []
    for x in xs:
        h = float(flow.hill(np.array(x))[0])
        s, weight = gauss(flow.s)
        sums = np.cumsum((weight * flow.at(flow.u, np.full_like(s, x), s)).reshape(-1, 3).sum(axis=1))
        k = int(np.flatnonzero(sums > 0)[0])
        low, high, below = flow.s[k], flow.s[k + 1], sums[k - 1] if k else 0.0
        start = low
        for _ in range(60):
            middle = 0.5 * (low + high)
            t, w = gauss(np.array([start, middle]))
            rest = below + w @ flow.at(flow.u, np.full_like(t, x), t)
            low, high = (middle, high) if rest <= 0 else (low, middle)
        ys.append(h + 0.5 * (low + high) * (LID - h))
    return np.array(ys)
