"""Studies of `maille sweep` on a cluster."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import _native
from ..design import Design, designs
from ..errors import ArgumentError, MailleError
from ..record import Progress
from ._maps import Keep, run
from ._results import Results

if TYPE_CHECKING:
    import distributed


def sweep(
    study: str | os.PathLike[str],
    *,
    out: str | os.PathLike[str] | None = None,
    client: distributed.Client | None = None,
    overwrite: bool = False,
    retries: int = 2,
    progress: Progress = None,
) -> Results:
    """What `maille sweep STUDY` does, on a cluster: the same study file, the same records and joint table in `out`.

    `out` is by default `maille-out/STUDY`. A design that cannot be used is in `.failures`, and stops nothing else. The other
    arguments are those of `characterize`.
    """
    file = Path(study)
    if file.is_dir():
        raise ArgumentError("study", f"{file} is a folder, not a study", "give a TOML file")
    try:
        text = file.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ArgumentError("study", f"there is no study {file}", "`maille sweep --example` prints one") from None
    except UnicodeDecodeError:
        raise ArgumentError("study", f"{file} is not a text file", "give a TOML file, encoded in UTF-8") from None
    plan = _plan(json.loads(_native.study(str(file), text)), file.parent)
    if out is None:
        out = Path("maille-out") / _native.folder_name(file.stem)
    return run(plan, out, client, Keep("stretch", overwrite, sensitivities=False), retries=retries, progress=progress)


def _plan(of_study: list[dict[str, Any]], folder: Path) -> dict[str, tuple[Design | MailleError, str]]:
    plan: dict[str, tuple[Design | MailleError, str]] = {}
    for item in of_study:
        named = item["design"]
        design: Design | MailleError
        try:
            design = Design.of(named if named in designs() else folder / named)
            stem = design.name
        except MailleError as error:
            design, stem = error, named
        for suffix, *values in item["variants"]:
            name = _native.folder_name(item["name"] or stem) + suffix
            if name in plan:
                help = "name each design and value once, or give one of them another `name`"
                raise ArgumentError("study", f"{name} is in the study twice", help)
            plan[name] = (_varied(design, *values), json.dumps(item["question"]))
    return plan


def _varied(
    design: Design | MailleError,
    minor_radius: float | None,
    numbers: list[tuple[str, float]],
    spacing: float | None,
    keep_links: bool,
) -> Design | MailleError:
    if not isinstance(design, Design) or (minor_radius is None and not numbers and spacing is None):
        return design
    try:
        values = [(path, value) for path, value in numbers]
        return Design._of(design._inner.varied(minor_radius, values, spacing, keep_links))
    except MailleError as error:
        return error
