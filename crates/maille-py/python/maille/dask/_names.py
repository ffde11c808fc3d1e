"""Designs with the names of their folders."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Union

from .. import _native
from ..design import Design, DesignLike
from ..errors import ArgumentError, MailleError

#: One design or several; with names where several have the same one.
Designs = Union[DesignLike, Sequence[DesignLike], Mapping[str, DesignLike]]


def named(designs: Designs) -> dict[str, Design | MailleError]:
    """Each design by its name; what cannot be read is an error in its place."""
    if isinstance(designs, Mapping):
        given = [(str(name), _read(design)) for name, design in designs.items()]
    else:
        several = [designs] if isinstance(designs, (Design, str, os.PathLike)) else list(designs)
        read = [(design, _read(design)) for design in several]
        given = [(d.name if isinstance(d, Design) else str(design), d) for design, d in read]
        often = Counter(name for name, _ in given)
        given = [(_with_radius(name, d) if often[name] > 1 else name, d) for name, d in given]
    out: dict[str, Design | MailleError] = {}
    for name, design in given:
        name = _native.folder_name(name)
        if name in out:
            raise ArgumentError("designs", f"two have the name {name}", "give a dictionary with a name for each")
        out[name] = design
    if not out:
        raise ArgumentError("designs", "there is none", "give one or more")
    return out


def _with_radius(name: str, design: Design | MailleError) -> str:
    return f"{name}-r{design.minor_radius:g}" if isinstance(design, Design) and design.minor_radius is not None else name


def _read(design: DesignLike) -> Design | MailleError:
    try:
        return Design.of(design)
    except MailleError as error:
        return error
