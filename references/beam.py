"""A beam in plane strain that is clamped at one end, in time and at rest: implicit finite elements.

The beam lies along x from 0 to `length`, its middle at y = 0. The clamped face is straight, or an arc that
bulges into the beam, as that of a beam behind a cylinder. Time: the method of Hilber, Hughes and Taylor (1977),
of second order, which damps waves that a step does not resolve; Newton's iteration with a tangent that is kept
while it converges.
"""

import numpy as np
import scipy.linalg
import scipy.optimize

import plane_strain

# Stress is singular where the clamp meets the faces: elements are thinner there, in proportion to these.
CLAMP = 0.1  # first element along the beam over the mean one
FACES = 1.34  # angle whose sine spaces the elements across; its cosine is the outermost over the middle one

# Weight of the last step's forces is -ALPHA. With 0 it is the trapezoidal rule, whose waves of the size of an
# element do not decay; with it Newton's iteration failed for one law of the plate, on 16 elements.
ALPHA = -0.1
BETA, GAMMA = (1 - ALPHA) ** 2 / 4, 0.5 - ALPHA


class Beam(plane_strain.Grid):
    """Axis 1 of the nodes goes across the beam, axis 2 along it from the clamp."""

    def __init__(self, material, length, thickness, layers, radius=None):
        self.length, self.thickness = length, thickness
        columns = layers * round(length / thickness) // 4

        def place(u, w):
            y = 0.5 * thickness * np.sin(FACES * u) / np.sin(FACES)
            x = length * (CLAMP * w + (1 - CLAMP) * w * w)
            arc = 0 * y if radius is None else np.sqrt(radius**2 - y**2) - radius
            return arc + (length - arc) * x / length, y

        across, along = np.linspace(-1, 1, layers + 1), np.linspace(0, 1, columns + 1)
        super().__init__(material, across, along, place, columns_are_alike=False)
        self._numbers()

    def _numbers(self):
        """Where the entries of the elements' stiffness go in the lower band of the whole."""
        rows, cols = self.mass.shape
        node = np.arange(rows * cols).reshape(cols, rows).T  # across first: a narrow band
        numbers = np.stack([2 * node, 2 * node + 1])
        own = np.empty((self.layers, 9, 2, self.columns), dtype=int)
        for i in range(3):
            for j in range(3):
                part = numbers[:, i : i + 2 * self.layers - 1 : 2, j : j + 2 * self.columns - 1 : 2]
                own[:, 3 * i + j] = np.swapaxes(part, 0, 1)
        self.held = 2 * rows
        row, col = np.broadcast_arrays(own[:, :, :, None, None], own[:, None, None])
        self.lower = (row >= col) & (col >= self.held)
        row, col = row[self.lower] - self.held, col[self.lower] - self.held
        self.size, self.band = 2 * rows * cols - self.held, (row - col).max() + 1
        self.entry = (row - col) * self.size + col
        self.diagonal = np.repeat(self.mass.T.ravel(), 2)[self.held :]

    def factor(self, x, law, inertia=0.0):
        """Cholesky's factor of inertia times mass plus stiffness, of the free nodes."""
        tangents = self.tangents(x, law)
        # That of a law without an energy is not symmetric, but nearly.
        entries = 0.5 * (tangents + tangents.transpose(0, 3, 4, 1, 2, 5))[self.lower]
        matrix = np.bincount(self.entry, entries, self.band * self.size).reshape(self.band, self.size)
        matrix[0] += inertia * self.diagonal
        return scipy.linalg.cholesky_banded(matrix, lower=True, check_finite=False)

    def solve(self, factor, residual):
        out = np.zeros_like(residual)
        right = residual.transpose(2, 1, 0).ravel()[self.held :]
        found = scipy.linalg.cho_solve_banded((factor, True), right, check_finite=False)
        out[:, :, 1:] = found.reshape(-1, residual.shape[1], 2).transpose(2, 1, 0)
        return out

    def station(self, x, heights=(0.0,)):
        """Weights of the nodes in the mean position of material points at (x, heights); straight clamp."""
        along = quadratics(x, self.x0[0, 0])
        across = sum(quadratics(y, self.x0[1, :, 0]) for y in heights) / len(heights)
        return across[:, None] * along[None]


def quadratics(x, nodes):
    """Values at x of the basis functions of the nodes of a line, three an element."""
    element = int(np.clip(np.searchsorted(nodes[::2], x) - 1, 0, len(nodes) // 2 - 1))
    own = slice(2 * element, 2 * element + 3)

    def values(s):
        return np.array([(1 - s) * (1 - 2 * s), 4 * s * (1 - s), s * (2 * s - 1)])

    out = np.zeros(len(nodes))
    out[own] = values(scipy.optimize.brentq(lambda s: values(s) @ nodes[own] - x, -1e-9, 1 + 1e-9))
    return out


def at_rest(beam, law, gravity, loads=4):
    """Positions of the nodes under weight, towards -y."""
    x = beam.x0.copy()
    weight = np.zeros_like(x)
    for load in range(1, loads + 1):
        weight[1] = -beam.mass * gravity * load / loads
        for _ in range(30):
            correction = beam.solve(beam.factor(x, law), beam.force(x, law) + weight)
            x = x + correction
            if np.abs(correction).max() < 1e-11 * beam.length:
                break
        else:
            raise ArithmeticError("Newton's iteration does not converge")
    return x


def swing(beam, law, step, until, stations, speed=None, gravity=0.0):
    """Motion from x0 with the velocities `speed` along y (of the nodes), under gravity towards -y.
    Arrays by name, one entry a step: positions of the stations (step, station, 2), energies."""
    tolerance = 1e-8 * beam.thickness
    x, v = beam.x0.copy(), np.zeros_like(beam.x0)
    if speed is not None:
        v[1] = speed
        v[:, :, 0] = 0
    weight = np.zeros_like(x)
    weight[1] = -beam.mass * gravity
    f = beam.force(x, law)
    law.keep()
    a = (f + weight) / beam.mass
    a[:, :, 0] = 0
    inertia = 1 / (BETA * step**2)  # acceleration over the difference from the guess
    factor, work = None, 0.0
    steps = int(round(until / step))
    path = np.empty((steps + 1, len(stations), 2))
    kinetic, strain, lift = np.empty((3, steps + 1))
    factored = iterations = 0
    shapes = np.array(stations)
    for n in range(steps + 1):
        path[n] = np.einsum("sij,kij->sk", shapes, x)
        kinetic[n] = 0.5 * (beam.mass * v**2).sum()
        lift[n] = (beam.mass * gravity * (x - beam.x0)[1]).sum()
        strain[n] = beam.energy(x, law) if law.has_energy and n % 10 == 0 else work
        if n == steps:
            break
        guess = x + step * v + (0.5 - BETA) * step**2 * a
        before = ALPHA * (f + weight)
        is_fresh, is_done = False, False
        while not is_done:
            new = guess + BETA * step**2 * a
            if factor is None:
                factor, is_fresh = beam.factor(new, law, inertia / (1 + ALPHA)), True
                factored += 1
            for count in range(1, 16):
                force = beam.force(new, law)
                residual = (1 + ALPHA) * (force + weight) - before - beam.mass * inertia * (new - guess)
                correction = beam.solve(factor, residual / (1 + ALPHA))
                new = new + correction
                size = np.abs(correction).max()
                is_done = size < tolerance
                if is_done or not size < beam.length:
                    break
            iterations += count
            if count > 7 or not is_done:
                factor = None
            if is_fresh and not is_done:
                raise ArithmeticError(f"step {n} does not converge: {size}")
        law.keep()
        work -= 0.5 * ((f + force) * (new - x)).sum()
        f = force
        a_new = inertia * (new - guess)
        v = v + step * ((1 - GAMMA) * a + GAMMA * a_new)
        x, a = new, a_new
    if law.has_energy:
        strain = np.interp(np.arange(steps + 1), np.arange(0, steps + 1, 10), strain[::10])
    return dict(t=step * np.arange(steps + 1), path=path, kinetic=kinetic, strain=strain, lift=lift,
                step=step, factored=factored, iterations=iterations / steps)
