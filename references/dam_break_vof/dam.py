"""A column of water in a tank as a case of OpenFOAM: the scenes, the files of a case, and one run."""

from dataclasses import dataclass, replace

import numpy as np

GRAVITY = 9.81  # [m/s^2]
DENSITY = {"water": 998.0, "air": 1.2}  # [kg/m^3]
VISCOSITY = {"water": 1.0e-6, "air": 1.48e-5}  # kinematic [m^2/s]
TENSION = 0.0728  # of water against air at 20 degrees, where a run has it [N/m]

SENSORS = (0.003, 0.015, 0.030, 0.080)  # heights of P1 to P4 on the far wall [m]
DIAMETER = 0.0042  # of a sensor [m]
PROBES = (0.300, 0.865, 1.114, 1.3625)  # places of H1 to H4 from the back wall [m]
HEIGHT_AT, HEIGHT_OVER = (
    0.2,
    0.05,
)  # where the residual height is read, and half of the width of the mean [width]


@dataclass(frozen=True)
class Scene:
    """Lengths in metres, times in (H/g)^(1/2). The tank ends with its rim; above it is the atmosphere."""

    name: str
    width: float
    height: float
    tank: float
    rim: float
    end: float
    meshes: tuple  # cells along the shorter side of the column

    @property
    def unit(self):
        """(H/g)^(1/2) [s]."""
        return (self.height / GRAVITY) ** 0.5

    @property
    def is_tank(self):
        """Whether the far wall has sensors."""
        return self.name in ("lobovsky", "rest")


INCH = 0.0254
SCENES = {
    scene.name: scene
    for scene in (
        # Fronts of the two columns do not come near the end of the floor by the end of the run.
        Scene("lobovsky", 0.6, 0.3, 1.61, 0.6, 6.0, (30, 60, 120)),
        Scene(
            "martin_moyce", 2.25 * INCH, 4.5 * INCH, 6 * 2.25 * INCH, 5 * 2.25 * INCH / 2, 1.8, (20, 40, 80)
        ),
        Scene("square", 2.25 * INCH, 2.25 * INCH, 6 * 2.25 * INCH, 1.5 * 2.25 * INCH, 2.5, (20, 40, 80)),
    )
}


# The tank filled to the same height, which stays at rest: a check.
REST = Scene("rest", 1.61, 0.3, 1.61, 0.6, 0.5, (30,))


@dataclass(frozen=True)
class Run:
    """What distinguishes runs of one scene."""

    scene: str
    n: int
    solver: str = "interIsoFoam"
    courant: float = 0.2
    tension: float = 0.0
    rim: float = 0.0  # height of the tank [m] if it is not that of the scene

    @property
    def label(self):
        """Name of the folder of the run."""
        extra = "" if not self.rim else f"_rim{self.rim:g}"
        tension = "" if not self.tension else "_tension"
        return f"{self.scene}_{self.n}_{self.solver}_{self.courant:g}{tension}{extra}"

    @property
    def of(self):
        """The scene, with the height of this run."""
        scene = REST if self.scene == REST.name else SCENES[self.scene]
        return replace(scene, rim=self.rim) if self.rim else scene

    @property
    def dx(self):
        """Side of a cell [m]."""
        return min(self.of.width, self.of.height) / self.n

    @property
    def cells(self):
        """Cells along x and y: the mesh ends at the whole cell that is nearest to tank and rim."""
        return tuple(round(side / self.dx) for side in (self.of.tank, self.of.rim))


def released_force(width, height):
    """Force on the back wall of a column that has just been released, over its weight.

    The pressure is harmonic, 0 on top and on the open side, without slope along x at the back wall, and with
    the slope of hydrostatics on the floor: a series of cosines in x.
    """
    k = (np.arange(4000) + 0.5) * np.pi / width
    share = 2.0 * (-1.0) ** np.arange(4000) / (k * width)
    with np.errstate(over="ignore"):
        return (share * (1.0 - 1.0 / np.cosh(np.minimum(k * height, 700.0))) / k**2).sum() / (width * height)


SAMPLE = 0.05  # fields are written so often [(H/g)^(1/2)]


def header(kind, name):
    """The first lines of every file of a case."""
    return f"FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}\n"


def mesh(run):
    """Square cells in one block, one cell deep, free of curves."""
    (nx, ny), dx = run.cells, run.dx
    x, y = nx * dx, ny * dx
    corners = [(a, b, c) for c in (0, dx) for a, b in ((0, 0), (x, 0), (x, y), (0, y))]
    vertices = " ".join(f"({a:.12g} {b:.12g} {c:.12g})" for a, b, c in corners)
    patches = {
        "back": ("wall", "(0 4 7 3)"),
        "far": ("wall", "(2 6 5 1)"),
        "floor": ("wall", "(1 5 4 0)"),
        "top": ("patch", "(3 7 6 2)"),
        "sides": ("empty", "(0 3 2 1) (4 5 6 7)"),
    }
    listed = " ".join(
        f"{name} {{ type {kind}; faces ({faces}); }}" for name, (kind, faces) in patches.items()
    )
    return (
        f"scale 1;\nvertices ({vertices});\n"
        f"blocks (hex (0 1 2 3 4 5 6 7) ({nx} {ny} 1) simpleGrading (1 1 1));\n"
        f"edges ();\nboundary ({listed});\nmergePatchPairs ();\n"
    )


def field(dimensions, inside, walls, top):
    """A field with one condition for the three walls, one for the top."""
    return (
        f"dimensions {dimensions};\ninternalField {inside};\n"
        f'boundaryField {{ "back|far|floor" {{ {walls} }} top {{ {top} }} sides {{ type empty; }} }}\n'
    )


def fraction(run):
    """The water as it is released: the sides of the column are faces of cells."""
    nx, ny = run.cells
    columns, rows = (round(side / run.dx) for side in (run.of.width, run.of.height))
    alpha = np.zeros((ny, nx), dtype=int)
    alpha[:rows, :columns] = 1
    return "nonuniform List<scalar> " + f"{alpha.size}(\n" + "\n".join(map(str, alpha.ravel())) + "\n)"


def control(run):
    """Times, and what is written."""
    scene = run.of
    sensors = ""
    if scene.is_tank:
        rows = int(np.ceil(0.1 / run.dx)) + 1
        places = " ".join(
            f"({scene.tank:.9g} {(k + 0.5) * run.dx:.9g} {0.5 * run.dx:.9g})" for k in range(rows)
        )
        sensors = (
            f'sensors {{ type patchProbes; libs ("libsampling.so"); patches (far); fields (p);'
            f" writeControl timeStep; writeInterval 1; probeLocations ({places}); }}"
        )
    return (
        f"application {run.solver};\nstartFrom startTime; startTime 0; stopAt endTime;\n"
        f"endTime {scene.end * scene.unit:.12g};\ndeltaT {1e-4 * scene.unit:.12g};\n"
        f"writeControl adjustableRunTime; writeInterval {SAMPLE * scene.unit:.12g};\n"
        f"writeFormat binary; writeCompression off; timePrecision 9;\n"
        f"adjustTimeStep yes; maxCo {2 * run.courant}; maxAlphaCo {run.courant}; maxDeltaT 1;\n"
        f"functions {{ {sensors} }}\n"
    )


SCHEMES = """
ddtSchemes { default Euler; }
gradSchemes { default Gauss linear; }
divSchemes {
    default none;
    div(rhoPhi,U) Gauss linearUpwind grad(U);
    div(phi,alpha) Gauss vanLeer;
    div(phirb,alpha) Gauss linear;
    div(((rho*nuEff)*dev2(T(grad(U))))) Gauss linear;
}
laplacianSchemes { default Gauss linear uncorrected; }
interpolationSchemes { default linear; }
snGradSchemes { default uncorrected; }
"""

SOLUTION = """
solvers {
    "alpha.water.*" {
        nAlphaSubCycles 1; nAlphaCorr 2; cAlpha 1; MULESCorr yes; nLimiterIter 5;
        isoFaceTol 1e-8; surfCellTol 1e-4; nAlphaBounds 3; snapTol 1e-12; clip true;
        solver smoothSolver; smoother symGaussSeidel; tolerance 1e-9; relTol 0;
    }
    "pcorr.*" { solver PCG; preconditioner DIC; tolerance 1e-6; relTol 0; }
    p_rgh { solver GAMG; smoother DICGaussSeidel; tolerance 1e-6; relTol 0.05; }
    p_rghFinal { solver GAMG; smoother DICGaussSeidel; tolerance 3e-7; relTol 0.02; }
    "U.*" { solver smoothSolver; smoother symGaussSeidel; tolerance 1e-7; relTol 0; }
}
PIMPLE { momentumPredictor no; nOuterCorrectors 1; nCorrectors 2; nNonOrthogonalCorrectors 0; }
"""


def write(run, folder):
    """Writes the files of a case."""
    phases = "".join(
        f"{name} {{ transportModel Newtonian; nu {VISCOSITY[name]}; rho {DENSITY[name]}; }}\n"
        for name in ("water", "air")
    )
    slip = "type slip;"
    files = {
        "system/blockMeshDict": ("dictionary", mesh(run)),
        "system/controlDict": ("dictionary", control(run)),
        "system/fvSchemes": ("dictionary", SCHEMES),
        "system/fvSolution": ("dictionary", SOLUTION),
        "constant/transportProperties": (
            "dictionary",
            f"phases (water air);\n{phases}sigma {run.tension};\n",
        ),
        "constant/turbulenceProperties": ("dictionary", "simulationType laminar;\n"),
        "constant/g": (
            "uniformDimensionedVectorField",
            f"dimensions [0 1 -2 0 0 0 0];\nvalue (0 -{GRAVITY} 0);\n",
        ),
        # Pressure without the weight of what is above it, measured from the top, where it is that of the air.
        "constant/hRef": (
            "uniformDimensionedScalarField",
            f"dimensions [0 1 0 0 0 0 0];\nvalue {run.cells[1] * run.dx:.12g};\n",
        ),
        "0/alpha.water": (
            "volScalarField",
            field(
                "[0 0 0 0 0 0 0]",
                fraction(run),
                "type zeroGradient;",
                "type inletOutlet; inletValue uniform 0; value uniform 0;",
            ),
        ),
        "0/U": (
            "volVectorField",
            field(
                "[0 1 -1 0 0 0 0]",
                "uniform (0 0 0)",
                slip,
                "type pressureInletOutletVelocity; value uniform (0 0 0);",
            ),
        ),
        "0/p_rgh": (
            "volScalarField",
            field(
                "[1 -1 -2 0 0 0 0]",
                "uniform 0",
                "type fixedFluxPressure; value uniform 0;",
                "type totalPressure; p0 uniform 0;",
            ),
        ),
    }
    for path, (kind, text) in files.items():
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(header(kind, target.name) + text)
