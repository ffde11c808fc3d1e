"""The Python of README, the guide and the paper runs, one block after the other, as for a reader who follows a page."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
#: Pages, and how many blocks of each run.
PAGES = {"README.md": 1, "docs/guide/python.md": 6, "docs/guide/clusters.md": 1, "paper/paper.md": 1}
#: What a page's own machine has, and what stands for it here.
CLUSTER = 'Client("tcp://10.0.0.1:8786")'


def blocks(page):
    """The blocks of a page, each at its line."""
    text = (ROOT / page).read_text(encoding="utf-8")
    found = re.finditer(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    # Empty lines before a block: errors name lines of the page.
    return ["\n" * text.count("\n", 0, block.start(1)) + block[1] for block in found]


def test_no_page_is_left_out():
    files = [ROOT / "README.md", *ROOT.glob("docs/**/*.md"), *ROOT.glob("examples/**/*.md"), *ROOT.glob("paper/*.md")]
    found = {file.relative_to(ROOT).as_posix() for file in files if "```python" in file.read_text(encoding="utf-8")}
    assert found == set(PAGES)


@pytest.mark.parametrize("page", PAGES)
def test_the_blocks_of_a_page_run(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    names, done = {"__name__": page}, 0
    for block in blocks(page):
        if "SLURMCluster" in block:  # there is no SLURM here
            compile(block, page, "exec")
            continue
        if CLUSTER in block:
            distributed = pytest.importorskip("distributed")
            names["LOCAL"] = distributed.Client(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None)
            block = block.replace(CLUSTER, "LOCAL")
            study = 'directions = [0]\nl2 = [0]\n[[designs]]\ndesign = "1.1"\n'
            (tmp_path / "radius.toml").write_text(study, encoding="utf-8")
        exec(compile(block, page, "exec"), names)
        done += 1
    if "LOCAL" in names:
        names["LOCAL"].close()
    assert done == PAGES[page]
