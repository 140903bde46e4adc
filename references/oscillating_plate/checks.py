"""Checks of beam.py and plate.py against what is known or computed in another way. Rows of checks.csv."""

import numpy as np
import scipy.linalg
import scipy.optimize
import scipy.sparse.linalg
import skfem
from skfem.helpers import ddot, dot, eye, sym_grad, trace

import beam
import plane_strain
import plate


def own_frequency(layers):
    """Lowest angular frequency of the plate at rest, with the lumped mass: inverse iteration."""
    body, law = plate.body(layers), plane_strain.SaintVenant(plate.RUBBER)
    factor = body.factor(body.x0, law)
    u = np.zeros_like(body.x0)
    u[1] = plate.start(body)
    for _ in range(20):
        old, u = u, body.solve(factor, body.mass * u)
    return np.sqrt((body.mass * old * u).sum() / (body.mass * u * u).sum())


def other_frequency(layers, can_contract=False):
    """The same by scikit-fem's own assembly of stiffness and consistent mass, on equal elements.
    If the clamped face can contract, only its middle is held in y."""
    columns = round(layers * plate.LENGTH / plate.THICKNESS)
    along = np.linspace(0, plate.LENGTH, columns + 1)
    across = np.linspace(0, plate.THICKNESS, layers + 1)
    mesh = skfem.MeshQuad.init_tensor(along, across)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2()), intorder=5)
    rubber = plate.RUBBER

    @skfem.BilinearForm
    def stiffness(u, v, _):
        return ddot(rubber.lame * eye(trace(sym_grad(u)), 2) + 2 * rubber.shear * sym_grad(u), sym_grad(v))

    @skfem.BilinearForm
    def mass(u, v, _):
        return rubber.density * dot(u, v)

    held = basis.get_dofs(lambda x: np.isclose(x[0], 0))
    if can_contract:
        middle = basis.nodal_dofs[1, (mesh.p[0] < 1e-9) & np.isclose(mesh.p[1], across.mean())]
        held = np.r_[held.all(["u^1"]), middle]
    free = basis.complement_dofs(held)
    k, m = (form.assemble(basis)[free][:, free] for form in (stiffness, mass))
    return np.sqrt(scipy.sparse.linalg.eigsh(k, 1, m, sigma=0)[0][0])


def timoshenko_frequency(shear_factor=5 / 6):
    """Of a beam with shear and rotary inertia, plane strain: moments and shear forces vanish at the end."""
    rubber, h = plate.RUBBER, plate.THICKNESS
    bending = plate.YOUNG / (1 - plate.POISSON**2) * h**3 / 12
    shear, line, turn = shear_factor * rubber.shear * h, rubber.density * h, rubber.density * h**3 / 12

    def end(omega):
        # Deflection, angle, moment, shear force.
        slope = np.array([[0, 1, 0, 1 / shear], [0, 0, 1 / bending, 0],
                          [0, -turn * omega**2, 0, -1], [-line * omega**2, 0, 0, 0]])
        scale = np.array([h, 1, bending / h, bending / h**2])
        transfer = scipy.linalg.expm(slope * scale[None] / scale[:, None] * plate.LENGTH)
        return np.linalg.det(transfer[2:, 2:])

    guess = 2 * np.pi / plate.thin_plate_period()
    return scipy.optimize.brentq(end, 0.9 * guess, 1.1 * guess)


def sag(layers, gravity=1e-3):
    """Deflection of the end at rest under a small weight, over that of a thin plate."""
    body = plate.body(layers)
    x = beam.at_rest(body, plane_strain.Hencky(plate.RUBBER), gravity, loads=1)
    stiffness = plate.YOUNG * plate.THICKNESS**2 / (12 * (1 - plate.POISSON**2))
    thin = plate.RUBBER.density * gravity * plate.LENGTH**4 / 8 / stiffness
    return -x[1, layers, -1] / thin


def rows():
    """check, law, mesh, step, value, expected."""
    out = []
    omega = timoshenko_frequency()
    for layers in (4, 8):
        found = own_frequency(layers)
        out.append(("angular frequency of small swings [rad/s], expected: assembled by scikit-fem on equal "
                    "elements, consistent mass", "", layers, "", found, other_frequency(layers)))
        out.append(("angular frequency of small swings if the clamped face can contract [rad/s], by "
                    "scikit-fem, expected: Timoshenko's beam, shear factor 5/6", "", layers, "",
                    other_frequency(layers, can_contract=True), omega))
    finest = sag(32)
    for layers in (4, 8, 16):
        out.append(("deflection of the end at rest under a small weight over that of a thin plate, "
                    "expected: on 32 elements", "hencky", layers, "", sag(layers), finest))
    slow = plate.run("hencky", 8, plate.STEP, speed=1e-3 * plate.SPEED, until=0.3)
    t, y = slow["t"], slow["path"][:, 0, 1]
    k = np.flatnonzero(y[1:-1] * y[2:] < 0)[1] + 1
    period = t[k] + (t[k + 1] - t[k]) * y[k] / (y[k] - y[k + 1])
    out.append(("period of a swing at a thousandth of the speed [s], expected: of small swings", "hencky",
                8, plate.STEP, period, 2 * np.pi / own_frequency(8)))
    for law in ("hencky", "jaumann"):
        time, path = plate.explicit(law, 2, 0.15)
        implicit = plate.run(law, 2, plate.STEP, until=0.15)
        other = np.array([np.interp(implicit["t"], time, path[:, k]) for k in range(2)]).T
        worst = np.abs(other - implicit["path"][:, 0]).max()
        out.append(("greatest distance of the end from a run by central differences, t up to 0.15 s [m]",
                    law, 2, plate.STEP, worst, 0.0))
    body = plate.body(8)
    out.append(("mass of the plate [kg/m]", "", 8, "", body.mass.sum(),
                plate.RUBBER.density * plate.LENGTH * plate.THICKNESS))
    x, heights = plate.points(10)
    where = (body.station(x, heights) * body.x0).sum(axis=(1, 2))
    out.append(("place of the last column of 10 layers at rest [m]", "", 8, "", where[0], x))
    return out


if __name__ == "__main__":
    for row in rows():
        print(*row, sep=", ", flush=True)
