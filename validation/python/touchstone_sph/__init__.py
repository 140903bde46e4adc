"""Problems for particle codes as NumPy arrays, and answers to how wrong a code is.

A code is a function of a :class:`Problem` that returns the moving particles at its times::

    import touchstone_sph as ts

    def solve(problem):
        ...
        yield {"t": t, "x": x, "y": y, "u": u, "v": v, "density": density}

    print(ts.summary(ts.probe(solve)))

All numbers are in SI units and in two dimensions; masses are per unit depth. The program ``touchstone``, which
comes with this package, measures and judges: verdicts are those of its commands.
"""

from ._convert import convert
from ._program import Refused
from ._questions import Answer, Criterion, main, probe, questions, summary
from ._problem import NotApplicable, Problem, Quantity, Wall, load, problem, problems
from ._verdicts import Change, Judgement, Verdict, judge, records, save

__all__ = [
    "Answer",
    "Change",
    "Criterion",
    "Judgement",
    "NotApplicable",
    "Problem",
    "Quantity",
    "Refused",
    "Verdict",
    "Wall",
    "convert",
    "judge",
    "load",
    "main",
    "probe",
    "problem",
    "problems",
    "questions",
    "records",
    "save",
    "summary",
]
