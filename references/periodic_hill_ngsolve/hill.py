"""Steady laminar flow over periodic hills by NGSolve: H = U_b = rho = 1.

Unstructured triangles by Netgen; each cubic piece of the hill is a Bezier curve, so that the wall is exact, and the triangles
at it are curved. Taylor-Hood elements: velocity of order k, continuous pressure of order k - 1. The force per mass is an
unknown whose equation is the mean velocity.
"""

import netgen.occ as occ
import ngsolve as ng
import numpy as np

LENGTH, LID, FLUX, SCALE = 9.0, 3.035, 2.035, 28.0
# ERCOFTAC case 81: from [mm], to [mm], a0 to a3.
CUBICS = [
    (0, 9, 28.0, 0.0, 6.775070969851e-3, -2.124527775800e-3),
    (9, 14, 25.07355893131, 0.9754803562315, -1.016116352781e-1, 1.889794677828e-3),
    (14, 20, 25.79601052357, 0.8206693007457, -9.055370274339e-2, 1.626510569859e-3),
    (20, 30, 40.46435022819, -1.379581654948, 1.945884504128e-2, -2.070318932190e-4),
    (30, 40, 17.92461334664, 0.8743920332081, -5.567361123058e-2, 6.277731764683e-4),
    (40, 54, 56.39011190988, -2.010520359035, 1.644919857549e-2, 2.674976141766e-5),
]
CREST = 6.775070969851e-3 / 2.124527775800e-3  # [mm]: up to here the first cubic exceeds 28 mm and is cut


def lee():
    """Pieces of the lee side: ends, height and slope at the ends, all in H."""
    for start, end, a0, a1, a2, a3 in CUBICS:
        ends = np.array([max(start, CREST), end])
        height = a0 + ends * (a1 + ends * (a2 + ends * a3))
        yield ends / SCALE, height / SCALE, a1 + ends * (2 * a2 + ends * 3 * a3)


def bezier(ends, heights, slopes):
    third = (ends[1] - ends[0]) / 3
    points = [(ends[0], heights[0]), (ends[0] + third, heights[0] + third * slopes[0]),
              (ends[1] - third, heights[1] - third * slopes[1]), (ends[1], heights[1])]
    return occ.BezierCurve([occ.Pnt(x, y, 0) for x, y in points])


def mesh(size, near, corner):
    """Triangles of at most `size`, at the walls `near`, at the kinks `corner`."""
    def line(a, b):
        return occ.Segment(occ.Pnt(*a, 0), occ.Pnt(*b, 0))

    pieces = list(lee())
    kink, foot = pieces[0][0][0], pieces[-1][0][1]
    hill = [line((0, 1), (kink, 1))] + [bezier(*piece) for piece in pieces]
    hill.append(line((foot, 0), (LENGTH - foot, 0)))
    hill += [bezier(LENGTH - e[::-1], h[::-1], -s[::-1]) for e, h, s in pieces[::-1]]
    hill.append(line((LENGTH - kink, 1), (LENGTH, 1)))
    rest = [line((LENGTH, 1), (LENGTH, LID)), line((LENGTH, LID), (0, LID)), line((0, LID), (0, 1))]
    face = occ.Face(occ.Wire([*hill, *rest]))
    edges = {}
    for edge in face.edges:
        x, y = edge.center.x, edge.center.y
        sides = {"left": x < 1e-9, "right": x > LENGTH - 1e-9, "lid": y > LID - 1e-9}
        edge.name = next((name for name, is_it in sides.items() if is_it), "hill")
        edges[edge.name] = edge
        if edge.name in ("hill", "lid"):
            edge.maxh = near if edge.name == "hill" else 2 * near
    for vertex in face.vertices:
        if abs(vertex.p.y - 1) < 1e-6 and min(abs(vertex.p.x - kink), abs(vertex.p.x - LENGTH + kink)) < 1e-6:
            vertex.maxh = corner
    edges["left"].Identify(edges["right"], "period", occ.IdentificationType.PERIODIC,
                           occ.gp_Trsf.Translation(occ.gp_Vec(LENGTH, 0, 0)))
    return ng.Mesh(occ.OCCGeometry(face, dim=2).GenerateMesh(maxh=size, grading=0.2))


class Flow:
    def __init__(self, triangles, order):
        triangles.Curve(order + 1)
        self.mesh, self.order = triangles, order
        velocity = ng.Periodic(ng.VectorH1(triangles, order=order, dirichlet="hill|lid"))
        pressure = ng.Periodic(ng.H1(triangles, order=order - 1))
        number = ng.NumberSpace(triangles)
        self.space = velocity * pressure * number * number
        self.state = ng.GridFunction(self.space)
        self.area = ng.Integrate(ng.CoefficientFunction(1), triangles)

    def solve(self, re, tolerance=1e-11):
        """Newton's iteration from the present state; the sizes of the steps."""
        (u, p, f, m), (v, q, g, n) = self.space.TnT()
        nu, dx = 1 / re, ng.dx(bonus_intorder=2 * self.order)
        form = ng.BilinearForm(self.space)
        form += (nu * ng.InnerProduct(ng.grad(u), ng.grad(v)) + ng.InnerProduct(ng.grad(u) * u, v)
                 - p * ng.div(v) - q * ng.div(u) - f * v[0] - g * (u[0] - LENGTH * FLUX / self.area)
                 + m * q + n * p) * dx
        step, residual = self.state.vec.CreateVector(), self.state.vec.CreateVector()
        sizes = []
        for _ in range(15):
            form.Apply(self.state.vec, residual)
            form.AssembleLinearization(self.state.vec)
            step.data = form.mat.Inverse(self.space.FreeDofs(), inverse="umfpack") * residual
            self.state.vec.data -= step
            sizes.append(float(np.abs(step.FV().NumPy()[: self.space.components[0].ndof]).max()))
            if sizes[-1] < tolerance:
                return sizes
        raise ArithmeticError(f"Newton's iteration does not end: {sizes}")

    @property
    def fields(self):
        velocity, pressure, force, _ = self.state.components
        return velocity, pressure, float(force.vec[0])

    def drags(self, re):
        """Of the hill by pressure and by shear, of the lid by shear."""
        velocity, pressure, _ = self.fields
        outward = ng.specialcf.normal(2)
        shear = -(1 / re) * (ng.grad(velocity) * outward)[0]
        order = 4 * self.order

        def over(field, wall):
            return ng.Integrate(field, self.mesh, definedon=self.mesh.Boundaries(wall), order=order)

        flux = ng.BoundaryFromVolumeCF
        return (over(flux(pressure) * outward[0], "hill"), over(flux(shear), "hill"), over(flux(shear), "lid"))

    def walls(self, re, points=7):
        """Shear stress on the hill at so many places of each side of a triangle: x and stress, by sides from left to right."""
        velocity, normal = self.fields[0], ng.specialcf.normal(2)
        inward = ng.BoundaryFromVolumeCF(ng.grad(velocity)) * (-normal)
        stress = ng.InnerProduct(inward, ng.CoefficientFunction((-normal[1], normal[0]))) / re
        at = list(np.linspace(0, 1, points))
        places = self.mesh.MapToAllElements(ng.IntegrationRule([(s, 0) for s in at], [0.0] * points),
                                            self.mesh.Boundaries("hill"))
        x, tau = (np.array(field(places)).reshape(-1, points) for field in (ng.x, stress))
        order = np.argsort(x.mean(axis=1))
        x, tau = x[order], tau[order]
        back = x[:, 0] > x[:, -1]
        x[back], tau[back] = x[back, ::-1], tau[back, ::-1]
        return x, tau

    def shear(self, re, at):
        """Shear stress on the hill at the places `at`: the polynomial of the side."""
        x, tau = self.walls(re)
        side = np.clip(np.searchsorted(x[:, 0], at, side="right") - 1, 0, len(x) - 1)
        return np.array([polynomial(x[k], tau[k])(a) for k, a in zip(side, at, strict=True)])

    def turns(self, re):
        """Where the shear changes its sign."""
        found = []
        for x, tau in zip(*self.walls(re), strict=True):
            if tau.min() < 0 < tau.max():
                roots = polynomial(x, tau).roots()
                found += [r.real for r in roots if abs(r.imag) < 1e-9 and x[0] <= r.real <= x[-1]]
        return found


def polynomial(x, values):
    return np.polynomial.Polynomial.fit(x, values, len(x) - 1)
