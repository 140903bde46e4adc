"""Checks of ring.py and plane_strain.py against what is known or computed by other code: checks.csv."""

import numpy as np
import scipy.optimize
import scipy.sparse
import scipy.sparse.linalg
import scipy.special
import skfem
from skfem.helpers import ddot, eye, sym_grad, trace

import plane_strain
import ring
from ring import RUBBER


def exact_frequency(wave, low, high):
    """Root in (low, high) of the frequency equation of a free thick ring in plane strain, cos(wave theta)
    in the radial displacement: potentials with Bessel functions, no stress on both circles."""

    def determinant(omega):
        speeds = RUBBER.p_wave, np.sqrt(RUBBER.shear / RUBBER.density)
        rows = []
        for r in (ring.INNER, ring.OUTER):
            normal, tangential = [], []
            for is_shear, speed in enumerate(speeds):
                k = omega / speed
                for f in (scipy.special.jvp, scipy.special.yvp):
                    a, da, dda = f(wave, k * r, 0), k * f(wave, k * r, 1), k * k * f(wave, k * r, 2)
                    if is_shear:
                        normal.append(2 * RUBBER.shear * wave * (da / r - a / r**2))
                        tangential.append(-dda + da / r - wave**2 * a / r**2)
                    else:
                        normal.append(2 * RUBBER.shear * dda - RUBBER.lame * k * k * a)
                        tangential.append(2 * wave * (a / r**2 - da / r))
            rows += [normal, tangential]
        matrix = np.array(rows)
        matrix /= np.abs(matrix).max(axis=0)
        return np.linalg.det(matrix)

    return scipy.optimize.brentq(determinant, low, high, xtol=1e-14)


def assembled(layers):
    """Stiffness by scikit-fem's own assembly on the whole half ring, in the order of Ring's nodes:
    (component, row, column) flattened."""
    grid = ring.Ring(layers)
    rows, cols = grid.mass.shape
    mesh, _ = plane_strain.quadrilaterals(np.linspace(ring.INNER, ring.OUTER, layers + 1),
                                          np.linspace(0, np.pi, grid.columns + 1), ring.polar)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2()), intorder=5)

    @skfem.BilinearForm
    def stiffness(u, v, _):
        stress = RUBBER.lame * eye(trace(sym_grad(u)), 2) + 2 * RUBBER.shear * sym_grad(u)
        return ddot(stress, sym_grad(v))

    matrix = stiffness.assemble(basis)
    # Which component and which node a degree of freedom is: interpolate what tells.
    element = basis.element_dofs
    number = np.empty(basis.N, dtype=int)
    radius, theta = np.hypot(*basis.doflocs), np.arctan2(basis.doflocs[1], basis.doflocs[0])
    i = np.rint((radius - ring.INNER) * 2 * layers).astype(int)
    j = np.rint(np.mod(theta + 1e-6, 2 * np.pi) / np.pi * 2 * grid.columns).astype(int)
    for local in range(element.shape[0]):
        field = np.abs(np.asarray(basis.basis[local][0])).sum(axis=(1, 2))
        dofs = element[local]
        number[dofs] = int(np.argmax(field)) * rows * cols + i[dofs] * cols + j[dofs]
    order = np.argsort(number)
    assert (number[order] == np.arange(basis.N)).all()
    return grid, matrix[order][:, order].tocsr()


def frequencies(grid, matrix, count=6):
    """Lowest angular frequencies with the lumped mass and rollers on y = 0."""
    free = np.ones((2, *grid.mass.shape), dtype=bool)
    free[1, :, [0, -1]] = False
    kept = np.flatnonzero(free.ravel())
    mass = scipy.sparse.diags(np.tile(grid.mass.ravel(), 2)[kept])
    squares = scipy.sparse.linalg.eigsh(matrix[kept][:, kept], count, mass, sigma=-1e-4)[0]
    return np.sqrt(np.abs(np.sort(squares)))


def shear(amount=1.0, steps=2000):
    """Greatest error of the Jaumann law in simple shear: S12 = mu sin(shear), S11 = mu (1 - cos(shear))."""
    law, one, worst = plane_strain.Jaumann(RUBBER), np.ones((1, 1, 1)), 0.0
    for step in range(steps + 1):
        k = amount * step / steps
        stress = law.stress(one, k * one, 0 * one, one, 0)
        law.keep()
        # Cauchy stress = P F^T at J = 1.
        s11, s12 = stress[0] + k * stress[1], stress[1]
        error = max(abs(s11 - RUBBER.shear * (1 - np.cos(k))).max(), abs(s12 - RUBBER.shear * np.sin(k)).max())
        worst = max(worst, error)
    return worst


def rows():
    """check, mesh, value, expected."""
    out = []
    rng = np.random.default_rng(0)
    for layers in (4, 8, 16):
        grid, matrix = assembled(layers)
        found = frequencies(grid, matrix)
        for wave in (2, 3, 4):
            guess = found[wave - 1]
            exact = exact_frequency(wave, 0.98 * guess, 1.02 * guess)
            out.append((f"angular frequency of the free ring, {wave} waves", layers, guess, exact))
        u = rng.standard_normal(grid.x0.shape)
        step = 1e-5 * grid.h
        for law in ("hencky", "neo_hookean", "saint_venant"):
            f = plane_strain.LAWS[law](RUBBER)
            force = (grid.force(grid.x0 + step * u, f) - grid.force(grid.x0 - step * u, f)) / (2 * step)
            want = -(matrix @ u.ravel()).reshape(u.shape)
            error = np.abs(force - want).max() / np.abs(want).max()
            check = f"tangent force of {law} less that of the assembled stiffness, relative"
            out.append((check, layers, error, 0.0))
    grid = ring.Ring(8)
    turned = np.array([0.6 * grid.x0[0] - 0.8 * grid.x0[1], 0.8 * grid.x0[0] + 0.6 * grid.x0[1]])
    bent = grid.x0 + 0.05 * np.array([np.sin(grid.x0[1]), grid.x0[0] * grid.x0[1] / 5])
    way = rng.standard_normal(bent.shape)
    step = 1e-6
    for law in ("hencky", "neo_hookean", "saint_venant"):
        f = plane_strain.LAWS[law](RUBBER)
        out.append((f"force of {law} on a turned ring", 8, np.abs(grid.force(turned, f)).max(), 0.0))
        slope = -(grid.energy(bent + step * way, f) - grid.energy(bent - step * way, f)) / (2 * step)
        out.append((f"force of {law} along a random direction against minus its energy's slope", 8,
                    (grid.force(bent, f) * way).sum(), slope))
    out.append(("error of the Jaumann stress in simple shear 1", 0, shear(), 0.0))
    out.append(("mass of the ring", 8, 2 * grid.mass.sum(), np.pi * (ring.OUTER**2 - ring.INNER**2)))
    return out


if __name__ == "__main__":
    for row in rows():
        print(*row, sep=", ")
