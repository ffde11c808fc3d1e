"""Types: the package and its examples pass mypy and pyright in their strict modes."""

import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    """What mypy has found of the libraries, once for all tests."""
    return str(tmp_path_factory.mktemp("mypy"))


@pytest.mark.parametrize(
    "arguments",
    [
        ["mypy", "-p", "maille"],
        ["mypy", str(PACKAGE / "examples")],
        ["pyright", "--project", str(PACKAGE), "--pythonpath", sys.executable],
    ],
    ids=["mypy-package", "mypy-examples", "pyright-examples"],
)
def test_types_are_complete(arguments, tmp_path, cache):
    name, *others = arguments
    if name == "mypy":
        others += ["--config-file", str(PACKAGE / "pyproject.toml"), "--cache-dir", cache]
    done = subprocess.run([sys.executable, "-m", name, *others], capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_wrong_use_is_found(tmp_path, cache):
    """The checks above see the types: they are not passed by all being Any."""
    (tmp_path / "wrong.py").write_text('import maille\n\nmaille.characterize("1.1").plot(quantity="length")\nmaille.Ring("big")\n')
    config = ["--config-file", str(PACKAGE / "pyproject.toml"), "--cache-dir", cache]
    done = subprocess.run([sys.executable, "-m", "mypy", *config, "wrong.py"], capture_output=True, text=True, cwd=tmp_path, check=False)
    assert "Found 2 errors" in done.stdout, done.stdout
