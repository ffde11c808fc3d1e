"""The notebooks of the repository run, and show what they say."""

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

NOTEBOOKS = sorted((Path(__file__).parents[3] / "examples" / "notebooks").glob("*.ipynb"))
#: Pictures and widgets among the outputs of each.
SHOWN = {"first-limit": (3, 1), "own-weave": (3, 1), "strain-boundary": (3, 0), "wire-radius": (2, 0)}


def test_there_are_four():
    assert [file.stem for file in NOTEBOOKS] == sorted(SHOWN)


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_a_notebook_runs(file, tmp_path, monkeypatch):
    monkeypatch.delenv("MPLBACKEND", raising=False)  # figures go into the notebook
    notebook = nbformat.read(file, 4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "save it without outputs"
    NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(tmp_path)}}).execute()
    kinds = [kind for cell in notebook.cells for output in cell.get("outputs", []) for kind in output.get("data", {})]
    widget = "application/vnd.jupyter.widget-view+json"
    assert (kinds.count("image/png"), kinds.count(widget)) == SHOWN[file.stem]
