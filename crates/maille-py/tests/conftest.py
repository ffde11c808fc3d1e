"""What the tests share: the program, of the same build as the package."""

import os
import shutil
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def program() -> str:
    """The program `maille`; `cargo xtask` names it in MAILLE."""
    named = os.environ.get("MAILLE") or shutil.which("maille")
    assert named and Path(named).is_file(), "set MAILLE to the program: cargo xtask wheel does"
    return named
