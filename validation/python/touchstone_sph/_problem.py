"""Problems: particles, material, walls and times."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional, Union

import numpy as np

from . import _program

#: Name of the document in the folder of a problem.
DOCUMENT = "problem.json"
#: The role of particles that move.
MOVES = 0


class NotApplicable(Exception):
    """A code raises this on a problem that it cannot solve, with the reason."""


class Quantity(float):
    """A number with a unit. It calculates as a float, and its text is the number alone.

    >>> nu = Quantity(1e-6, "m^2/s")
    >>> nu
    1e-06 m^2/s
    >>> 2 * nu
    2e-06
    >>> f"viscosity {nu}"
    'viscosity 1e-06'
    """

    unit: str

    def __new__(cls, value: float, unit: str) -> Quantity:
        self = super().__new__(cls, value)
        self.unit = unit
        return self

    def __getnewargs__(self) -> tuple[float, str]:
        return float(self), self.unit

    def __repr__(self) -> str:
        return f"{float(self)!r} {self.unit}"

    __str__ = float.__repr__


@dataclass(frozen=True)
class Wall:
    """A plane wall on which the velocity of the fluid is that of the wall."""

    #: A point of the plane [m], shape (2,).
    point: np.ndarray
    #: Unit vector from the wall into the material, shape (2,).
    normal: np.ndarray
    #: [m/s], shape (2,).
    velocity: np.ndarray


@dataclass(frozen=True, repr=False)
class Problem:
    """A problem for any particle code: N particles of which some move, a material, walls, and times.

    >>> flow = problem("couette", rows=10)
    >>> flow
    couette, variant consistent: 60 particles, spacing 0.0001 m, until 1.0 s
    >>> flow.material["kinematic_viscosity"]
    1e-06 m^2/s
    >>> flow.particles["x"].shape
    (60,)
    >>> flow.units["density"]
    'kg/m^3'
    """

    #: Name of the case and of the variant whose problem this is.
    name: str
    variant: str
    #: Every setting by name.
    settings: dict[str, Any]
    #: Columns by name, each of shape (N,): ``id``, ``role``, ``x``, ``y``, ``u``, ``v``, ``density``,
    #: ``pressure``, ``mass``; of solids also stress and body.
    particles: dict[str, np.ndarray]
    #: Unit of each column.
    units: dict[str, str]
    #: Which particles move, shape (N,); the others are of walls.
    moving: np.ndarray
    #: Numbers of the material by name, such as ``density``, ``sound_speed``, ``kinematic_viscosity``.
    material: dict[str, Quantity]
    #: What else drives or describes the problem, by name, such as the wave number ``K`` of a field.
    further: dict[str, Quantity]
    #: Body force per mass [m/s²], shape (2,).
    acceleration: np.ndarray
    #: Lower corner of the domain [m], shape (2,).
    low: np.ndarray
    #: Period of each axis [m], or None.
    period: tuple[Optional[float], Optional[float]]
    #: Walls that are planes; others are particles that do not move.
    walls: list[Wall]
    #: Times of the results [s], shape (T,), ascending.
    times: np.ndarray
    #: Distance of the particles [m].
    spacing: float
    #: Smoothing length, radius of the kernel's support [m] and time step [s] of our own method.
    smoothing_length: float
    support: float
    time_step: float
    #: Stop after this time [s] and keep the state in `folder`; only where a probe interrupts a run.
    stop_after: Optional[float]
    #: Continue from the state in `folder`.
    resume: bool
    #: Number of threads that a code may use.
    threads: int
    #: The folder of the problem, if it has one.
    folder: Optional[Path]
    #: The whole ``problem.json``: equations, boundary conditions, metrics, gates.
    document: dict[str, Any]

    def __repr__(self) -> str:
        return (
            f"{self.name}, variant {self.variant}: {self.moving.size} particles, "
            f"spacing {self.spacing} m, until {self.times[-1]} s"
        )

    def nearest(self, dx: np.ndarray, dy: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distances [m] to the nearest periodic image, any shape.

        >>> problem("shear_wave").nearest(np.array([0.9, -0.2]), np.array([0.0, -0.6]))
        (array([-0.1, -0.2]), array([0. , 0.4]))
        """
        return tuple(d if p is None else d - p * np.round(d / p) for d, p in zip((dx, dy), self.period))

    @property
    def features(self) -> dict[str, bool]:
        """What a code may lack, and whether the problem has it.

        >>> [name for name, has in problem("dam_break").features.items() if has]
        ['walls as particles', 'free surfaces']
        """
        boundary, only_planes = self.document["boundary"], bool(self.moving.all())
        return {
            "solids": "shear_modulus" in self.material,
            "rigid bodies": "rigid_body" in self.document,
            "walls as planes": bool(self.walls) and only_planes,
            "walls as particles": not only_planes,
            "free slip": boundary.startswith("Free slip"),
            "free surfaces": "surface is free" in boundary,
            "restarts": self.stop_after is not None or self.resume,
        }

    def decline(self, *names: str) -> None:
        """Declines the problem if it has one of these `features`, which a code lacks.

        Raises:
            NotApplicable: if the problem has one.
            KeyError: if there is no such feature.

        >>> problem("spinning_disk").decline("restarts", "solids")
        Traceback (most recent call last):
        touchstone_sph._problem.NotApplicable: it has no solids
        """
        for name in names:
            if self.features[name]:
                raise NotApplicable(f"it has no {name}")

    def numbers(self, *names: str) -> list[float]:
        """Numbers of the material without their units; 0 is the number of a name that it lacks.

        >>> problem("couette").numbers("density", "kinematic_viscosity", "shear_modulus")
        [1000.0, 1e-06, 0.0]
        """
        return [float(self.material.get(name, 0.0)) for name in names]

    def box(self, margin: float) -> tuple[np.ndarray, np.ndarray]:
        """Lower corner and size [m] of the domain, shapes (2,); an axis without a period ends `margin` [m] beyond
        its outermost particles."""
        low, size = self.low.copy(), np.zeros(2)
        for axis, (name, period) in enumerate(zip("xy", self.period)):
            if period is None:
                ends = self.particles[name].min() - margin, self.particles[name].max() + margin
                low[axis], size[axis] = ends[0], ends[1] - ends[0]
            else:
                size[axis] = period
        return low, size

    def steps(self, longest: float) -> Iterator[tuple[float, int, float, int]]:
        """Equal steps of at most `longest` [s] to each of the times.

        Yields:
            the time [s], the number of steps since the time before, their length [s], and the number in all.

        >>> [*problem("couette").steps(0.01)][:2]   # to 0.02 and 0.05 s
        [(0.02, 2, 0.01, 2), (0.05, 3, 0.01, 5)]
        """
        now, total = 0.0, 0
        for time in self.times.tolist():
            count = max(1, int(np.ceil((time - now) / longest - 1e-9)))
            total += count
            yield time, count, (time - now) / count, total
            now = time


def problems() -> dict[str, str]:
    """All cases, each with a sentence about its problem.

    >>> problems()["couette"]
    'Water between two plates, one of which starts to move'
    """
    return {case["name"]: case["problem"] for case in _program.answer("list", "--json")}


def problem(name: str, variant: Optional[str] = None, **settings: Union[bool, float, str]) -> Problem:
    """The problem of a case.

    Args:
        name: a case, as in `problems`.
        variant: the variant whose walls and settings it has, otherwise the recommended one.
        settings: settings of the case, such as ``rows=10``; ``touchstone list CASE`` shows them.

    Raises:
        Refused: if there is no such case, variant or setting, or a value outside its range.

    >>> problem("couette", "plain", re=2).walls[1].velocity
    array([0.002, 0.   ])
    >>> problem("couette", rows=3)
    Traceback (most recent call last):
    touchstone_sph._program.Refused: setting rows is "3"; allowed is a whole number, 4 to 2000 [-]
    """
    arguments = [name] if variant is None else [name, "--variant", variant]
    for key, value in settings.items():
        arguments += ["--set", f"{key}={_as_text(value)}"]
    with tempfile.TemporaryDirectory() as folder:
        _program.run("export", *arguments, "--out", folder)
        return _read(Path(folder), None)


def load(folder: Union[str, Path]) -> Problem:
    """The problem in a folder that ``touchstone export`` or ``touchstone probe`` wrote."""
    return _read(Path(folder), Path(folder))


def _read(source: Path, folder: Optional[Path], threads: int = 1) -> Problem:
    document = json.loads((source / DOCUMENT).read_text(encoding="utf-8"))
    columns = document["particles"]["columns"]
    names = [column["name"].replace(" ", "_") for column in columns]
    table = source / document["particles"]["file"]
    values = np.loadtxt(table, delimiter=",", skiprows=1, ndmin=2, encoding="utf-8")
    particles = {name: values[:, place].copy() for place, name in enumerate(names)}
    for name in {"id", "role", "body"} & particles.keys():
        particles[name] = particles[name].astype(np.int64)
    spec, method, call = document["spec"], document["our_method"], document.get("probe", {})
    return Problem(
        name=spec["case"],
        variant=spec["variant"],
        settings=spec["settings"],
        particles=particles,
        units={name: column["unit"] for name, column in zip(names, columns)},
        moving=particles["role"] == MOVES,
        material={name: Quantity(of["value"], of["unit"]) for name, of in document["material"].items()},
        further={of["name"]: Quantity(of["value"], of["unit"]) for of in document["further"]},
        acceleration=np.array(document["acceleration"]["value"]),
        low=np.array(document["domain"]["low"]["value"]),
        period=tuple(None if of == "none" else of["value"] for of in document["domain"]["period"]),
        walls=[_wall(of) for of in document["walls"]["planes"]],
        times=np.array(document["times"]["value"]),
        spacing=document["particles"]["spacing"]["value"],
        smoothing_length=method["smoothing_length"]["value"],
        support=method["support_radius"]["value"],
        time_step=method["time_step"]["value"],
        stop_after=call["stop_after"]["value"] if "stop_after" in call else None,
        resume=call.get("resume", False),
        threads=threads,
        folder=folder,
        document=document,
    )


def _wall(of: dict[str, Any]) -> Wall:
    point, normal, velocity = (
        np.array(of[name]["value"]) for name in ("point", "normal_into_the_material", "velocity")
    )
    return Wall(point, normal, velocity)


def _as_text(value: Union[bool, float, str]) -> str:
    """A value as the program reads it."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return str(value)
