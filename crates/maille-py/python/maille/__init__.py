"""How far a chainmail-like weave deforms before it locks.

>>> import maille
>>> record = maille.characterize("1.1", directions=[0, 90], l2=[0])
>>> record.to_numpy()["l1"].round(9).tolist()
[0.44, 0.44]

`maille.characterize("1.1").plot()` draws the limits of all directions. The guide is docs/guide/python.md of the repository.
"""

from __future__ import annotations

from . import errors, geometry
from ._native import __VERSION__ as __version__
from .boundary import Boundary, boundary
from .design import Design, Element, Ring, designs
from .errors import (
    ArgumentError,
    DesignError,
    MailleError,
    RecordError,
    ShapeError,
    UnknownDesignError,
)
from .fit import Fit, fit
from .question import Extreme, StrainLimit, limit, roomiest, tightest
from .record import Record, Sensitivities, State, characterize, read_record
from .roll import Rolls, roll
from .sheet import Sheet, View, show
from .simulate import Simulation, read_simulation, simulate

__all__ = [
    "ArgumentError",
    "Boundary",
    "Design",
    "DesignError",
    "Element",
    "Extreme",
    "Fit",
    "MailleError",
    "Record",
    "RecordError",
    "Ring",
    "Rolls",
    "Sensitivities",
    "ShapeError",
    "Sheet",
    "Simulation",
    "State",
    "StrainLimit",
    "UnknownDesignError",
    "View",
    "__version__",
    "boundary",
    "characterize",
    "designs",
    "errors",
    "fit",
    "geometry",
    "limit",
    "read_record",
    "read_simulation",
    "roll",
    "roomiest",
    "show",
    "simulate",
    "tightest",
]
