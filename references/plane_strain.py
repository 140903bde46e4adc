"""Elastic bodies in plane strain by finite elements, for the references that are computed here.

Elements: nine-node quadrilaterals (scikit-fem), 3 x 3 Gauss points, total Lagrangian, row-sum lumped mass.
A body is a grid of elements, `layers` across and `columns` along; nodes are arrays (2, row, column).
"""

from dataclasses import dataclass

import numpy as np
import skfem


@dataclass(frozen=True)
class Material:
    """An isotropic elastic solid; K and mu are those of three dimensions at small strain."""

    density: float
    bulk: float
    shear: float

    @classmethod
    def from_young(cls, density, young, poisson):
        return cls(density, young / (3 * (1 - 2 * poisson)), young / (2 * (1 + poisson)))

    @property
    def lame(self):
        return self.bulk - 2 / 3 * self.shear

    @property
    def sound_speed(self):
        return np.sqrt(self.bulk / self.density)

    @property
    def p_wave(self):
        return np.sqrt((self.bulk + 4 / 3 * self.shear) / self.density)


# --- Laws: first Piola-Kirchhoff stress and strain energy from F (plane strain, F33 = 1) -------------

class Law:
    """A law with a strain energy. `chunk` tells a law with a memory whose points these are."""

    has_energy = True

    def __init__(self, material):
        self.material = material

    def keep(self):
        """What was computed last belongs to the state from which the next step starts."""


class Hencky(Law):
    """Cauchy pressure K (1/J - 1), Kirchhoff deviator 2 mu dev ln V: hyperelastic,
    W = K (J - 1 - ln J) + mu |dev ln V|^2."""

    @staticmethod
    def _stretches(f11, f12, f21, f22):
        jac = f11 * f22 - f12 * f21
        b11, b22, b12 = f11 * f11 + f12 * f12, f21 * f21 + f22 * f22, f11 * f21 + f12 * f22
        mean, half = 0.5 * (b11 + b22), 0.5 * (b11 - b22)
        q2 = (half * half + b12 * b12) / (mean * mean)
        q = np.sqrt(q2 + 1e-30)
        return jac, mean, half, b12, q, np.arctanh(q), np.log(jac)

    def stress(self, f11, f12, f21, f22, chunk):
        bulk, shear = self.material.bulk, self.material.shear
        jac, mean, half, b12, q, angle, log = self._stretches(f11, f12, f21, f22)
        ratio = shear * angle / (q * mean)  # 2 mu times the factor of b - mean I in ln V
        sphere = bulk * (jac - 1) + shear * log / 3  # 2 mu (ln J / 2 - ln J / 3)
        return piola(f11, f12, f21, f22, 1 / jac, sphere, ratio * half, ratio * b12)

    def energy(self, f11, f12, f21, f22):
        bulk, shear = self.material.bulk, self.material.shear
        jac, _, _, _, _, angle, log = self._stretches(f11, f12, f21, f22)
        return bulk * (jac - 1 - log) + shear * (log * log / 6 + 0.5 * angle * angle)


def piola(f11, f12, f21, f22, inverse, sphere, s11, s12):
    """tau F^-T of the Kirchhoff stress with in-plane mean `sphere` and in-plane deviator s11, s12."""
    t11, t22 = (sphere + s11) * inverse, (sphere - s11) * inverse
    t12 = s12 * inverse
    return t11 * f22 - t12 * f12, t12 * f11 - t11 * f21, t12 * f22 - t22 * f12, t22 * f11 - t12 * f21


class NeoHookean(Law):
    """W = mu/2 (J^-2/3 tr b - 3) + K/2 (J - 1)^2, with b33 = 1."""

    def stress(self, f11, f12, f21, f22, chunk):
        bulk, shear = self.material.bulk, self.material.shear
        jac = f11 * f22 - f12 * f21
        b11, b22, b12 = f11 * f11 + f12 * f12, f21 * f21 + f22 * f22, f11 * f21 + f12 * f22
        scale = shear * jac ** (-2 / 3)
        third = (b11 + b22 + 1) / 3
        sphere = bulk * jac * (jac - 1) + scale * (0.5 * (b11 + b22) - third)
        return piola(f11, f12, f21, f22, 1 / jac, sphere, 0.5 * scale * (b11 - b22), scale * b12)

    def energy(self, f11, f12, f21, f22):
        bulk, shear = self.material.bulk, self.material.shear
        jac = f11 * f22 - f12 * f21
        trace = f11 * f11 + f12 * f12 + f21 * f21 + f22 * f22 + 1
        scale = shear * jac ** (-2 / 3)
        return 0.5 * (scale * trace - 3 * shear) + 0.5 * bulk * (jac - 1) ** 2


class SaintVenant(Law):
    """W = lambda/2 (tr E)^2 + mu E : E."""

    @staticmethod
    def _strain(f11, f12, f21, f22):
        e11, e22 = 0.5 * (f11 * f11 + f21 * f21 - 1), 0.5 * (f12 * f12 + f22 * f22 - 1)
        return e11, e22, 0.5 * (f11 * f12 + f21 * f22)

    def stress(self, f11, f12, f21, f22, chunk):
        lame, shear = self.material.lame, self.material.shear
        e11, e22, e12 = self._strain(f11, f12, f21, f22)
        trace = e11 + e22
        s11, s22 = lame * trace + 2 * shear * e11, lame * trace + 2 * shear * e22
        s12 = 2 * shear * e12
        return f11 * s11 + f12 * s12, f11 * s12 + f12 * s22, f21 * s11 + f22 * s12, f21 * s12 + f22 * s22

    def energy(self, f11, f12, f21, f22):
        lame, shear = self.material.lame, self.material.shear
        e11, e22, e12 = self._strain(f11, f12, f21, f22)
        return 0.5 * lame * (e11 + e22) ** 2 + shear * (e11**2 + e22**2 + 2 * e12**2)


class Jaumann(Law):
    """The law of the seed's equations (10) to (12): Cauchy pressure K (1/J - 1), Jaumann rate of the Cauchy
    deviator = 2 mu dev D. No strain energy: the work of the stress stands for it."""

    has_energy = False

    def __init__(self, material):
        super().__init__(material)
        self.old, self.new = {}, {}

    def stress(self, f11, f12, f21, f22, chunk):
        bulk, shear = self.material.bulk, self.material.shear
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
        s11, s22 = s11 + 2 * shear * (l11 - trace), s22 + 2 * shear * (l22 - trace)
        s12 = s12 + shear * (l12 + l21)
        s11, s22, s12 = rotated(s11, s22, s12, turn)
        self.new[chunk] = tuple(np.array(a) for a in (f11, f12, f21, f22, s11, s22, s12))
        jac = f11 * f22 - f12 * f21
        sphere = bulk * (jac - 1) + 0.5 * jac * (s11 + s22)
        return piola(f11, f12, f21, f22, 1 / jac, sphere, 0.5 * jac * (s11 - s22), jac * s12)

    def keep(self):
        self.old.update(self.new)


def rotated(s11, s22, s12, angle):
    cos, sin = np.cos(2 * angle), np.sin(2 * angle)
    mean, half = 0.5 * (s11 + s22), 0.5 * (s11 - s22)
    half, s12 = half * cos - s12 * sin, half * sin + s12 * cos
    return mean + half, mean - half, s12


LAWS = {"hencky": Hencky, "neo_hookean": NeoHookean, "saint_venant": SaintVenant, "jaumann": Jaumann}


# --- Bodies -------------------------------------------------------------------------------------------

def quadrilaterals(across, along, place):
    """Mesh of nine-node quadrilaterals, isoparametric, and the mesh of its parameters."""
    flat = skfem.MeshQuad2.from_mesh(skfem.MeshQuad.init_tensor(across, along))
    return skfem.MeshQuad2(np.array(place(*flat.doflocs)), flat.t), flat


class Grid:
    """A body with the points place(u, w); u goes across in `layers` equal elements, w along in `columns`.
    If all columns are alike but for a turn, the gradients of the first one serve for all, with respect to
    axes that turn with the element: the laws are isotropic."""

    def __init__(self, material, across, along, place, columns_are_alike):
        self.material = material
        self.layers, self.columns = len(across) - 1, len(along) - 1
        self.kinds = 1 if columns_are_alike else self.columns
        self.batch = self.columns // self.kinds
        u, w = (np.linspace(a[0], a[-1], 2 * len(a) - 1) for a in (across, along))
        shape = len(u), len(w)
        self.x0 = np.array(place(np.broadcast_to(u[:, None], shape), np.broadcast_to(w[None], shape)))
        self._gradients(across, along[: self.kinds + 1], place)
        self.chunk = max(1, round(12000 / (9 * self.batch)))
        self.mass = self._scatter(self._by_layer(np.repeat(self.volumes[:, :, None], self.batch, axis=2)))

    def _gradients(self, across, along, place):
        """From scikit-fem, (kind of element, node, 2 x point): gradients, the same times weight."""
        mesh, flat = quadrilaterals(across, along, place)
        basis = skfem.Basis(mesh, skfem.ElementQuad2(), intorder=5)
        parameters = skfem.Basis(flat, skfem.ElementQuad2(), intorder=5)
        where = parameters.doflocs[:, parameters.element_dofs]  # (2, node, element)
        place_in = []
        for ticks, value in zip((across, along), where, strict=True):
            h = ticks[1] - ticks[0]
            element = np.floor((value.mean(axis=0) - ticks[0]) / h).astype(int)
            place_in.append((element, np.rint((value - ticks[0] - element * h) / h * 2).astype(int)))
        (layer, row), (column, col) = place_in
        kind, node = layer * self.kinds + column, 3 * row + col
        kinds, points = self.layers * self.kinds, basis.dx.shape[1]
        self.gradient = np.zeros((kinds, 9, 2, points))
        self.volumes = np.zeros((kinds, 9))
        self.weight = np.zeros((kinds, points))
        self.weight[kind] = basis.dx
        for local, (field,) in enumerate(basis.basis):
            # field.grad is (2, element, point)
            self.gradient[kind, node[local]] = np.moveaxis(np.asarray(field.grad), 0, 1)
            masses = self.material.density * (np.asarray(field) * basis.dx).sum(axis=1)
            self.volumes[kind, node[local]] = masses
        self.points = points
        flat = (kinds, 9, 2 * points)
        self.down = np.ascontiguousarray(np.swapaxes(self.gradient.reshape(flat), 1, 2))
        self.up = np.ascontiguousarray((self.gradient * self.weight[:, None, None, :]).reshape(flat))

    def _by_kind(self, values):
        """(layer, node, ..., column) -> (kind, node, ..., batch)."""
        values = values.reshape(*values.shape[:-1], self.kinds, self.batch)
        values = np.moveaxis(values, -2, 1)
        return values.reshape(-1, *values.shape[2:])

    def _by_layer(self, values):
        """The inverse."""
        values = np.moveaxis(values.reshape(self.layers, self.kinds, *values.shape[1:]), 1, -2)
        return values.reshape(*values.shape[:-2], self.columns)

    def _gather(self, x):
        """Nodes of the elements: (kind, node, 2 x batch)."""
        nodes = np.empty((self.layers, 9, 2, self.columns))
        for i in range(3):
            for j in range(3):
                part = x[:, i : i + 2 * self.layers - 1 : 2, j : j + 2 * self.columns - 1 : 2]
                nodes[:, 3 * i + j] = np.swapaxes(part, 0, 1)
        return self._by_kind(nodes).reshape(-1, 9, 2 * self.batch)

    def _scatter(self, nodes):
        """Sums (layer, node, column) over elements."""
        out = np.zeros((2 * self.layers + 1, 2 * self.columns + 1))
        for i in range(3):
            for j in range(3):
                out[i : i + 2 * self.layers - 1 : 2, j : j + 2 * self.columns - 1 : 2] += nodes[:, 3 * i + j]
        return out

    def _deformations(self, x):
        """F at all points, by chunks of kinds: four arrays (kind, point, batch)."""
        nodes = self._gather(x)
        for start in range(0, len(nodes), self.chunk):
            part = slice(start, start + self.chunk)
            f = self.down[part] @ nodes[part]
            f = f.reshape(-1, 2, self.points, 2, self.batch)
            yield part, (f[:, 0, :, 0], f[:, 1, :, 0], f[:, 0, :, 1], f[:, 1, :, 1])

    def force(self, x, law):
        """Minus the internal force."""
        out = np.empty((self.layers * self.kinds, 9, 2 * self.batch))
        for part, f in self._deformations(x):
            p = np.empty((f[0].shape[0], 2, self.points, 2, self.batch))
            p[:, 0, :, 0], p[:, 1, :, 0], p[:, 0, :, 1], p[:, 1, :, 1] = law.stress(*f, part.start)
            np.matmul(self.up[part], p.reshape(-1, 2 * self.points, 2 * self.batch), out=out[part])
        out = self._by_layer(out.reshape(-1, 9, 2, self.batch))
        return -np.array([self._scatter(out[:, :, 0]), self._scatter(out[:, :, 1])])

    def energy(self, x, law):
        total = 0.0
        for part, f in self._deformations(x):
            total += np.einsum("lqc,lq->", law.energy(*f), self.weight[part])
        return total

    def tangents(self, x, law, step=1e-5):
        """Stiffness of the elements by differences of the stress: (layer, node, 2, node, 2, column)."""
        out = np.empty((self.layers * self.kinds, 9, 2, 9, 2, self.batch))
        for part, f in self._deformations(x):
            up = self.up[part].reshape(-1, 9, 2, self.points)
            down = self.gradient[part]
            for which in range(4):
                c, d = divmod(which, 2)
                high, low = (law.stress(*(value + sign * step if k == which else value
                                          for k, value in enumerate(f)), part.start) for sign in (1, -1))
                slope = np.array([(b - a) / (2 * step) for a, b in zip(low, high, strict=True)])
                slope = slope.reshape(2, 2, *f[0].shape)
                # P_ab goes with the gradient b of the row's node, F_cd with d of the column's.
                left = np.einsum("knbq,abkqe->kaneq", up, slope, optimize=True)
                term = left.reshape(len(down), -1, self.points) @ np.swapaxes(down[:, :, d], 1, 2)
                term = term.reshape(-1, 2, 9, self.batch, 9)
                term = np.einsum("kanem->kname", term)
                if d == 0:
                    out[part, :, :, :, c] = term
                else:
                    out[part, :, :, :, c] += term
        return self._by_layer(out)

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
