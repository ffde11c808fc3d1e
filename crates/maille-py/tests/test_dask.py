"""Maps, studies and surfaces on a cluster are those of one process, bit for bit, whatever happens to the workers."""

import csv
import json
import operator
import os
import pickle
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pyarrow.dataset
import pytest

from records import content, table

import maille
from maille.errors import ChainError, OtherInputsError, StudyError

distributed = pytest.importorskip("distributed")
import maille.dask  # noqa: E402
from maille import _native  # noqa: E402
from maille.dask import __main__ as command  # noqa: E402
from maille.dask import _study  # noqa: E402
from maille.dask._client import results  # noqa: E402

STUDY = """\
directions = "0:90:30"
l2 = [-0.125, 0, 0.0625]
starts = 2
[[designs]]
design = "1.1"
minor_radius = [0.05, 0.1]
[[designs]]
design = "mine.toml"
spacing = [0.98, 1]
"""
MAPS = ["1.1-r0.05", "1.1-r0.1", "3.1-s0.98", "3.1-s1"]


@pytest.fixture(scope="module")
def client():
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster:
        with distributed.Client(cluster) as client:
            yield client


@pytest.fixture(scope="module")
def study(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("study")
    maille.Design.builtin("3.1").save(folder / "mine.toml")
    (folder / "study.toml").write_text(STUDY)
    return folder / "study.toml"


@pytest.fixture(scope="module")
def by_program(program, study, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("program") / "swept"
    done = subprocess.run([program, "sweep", study, "--quiet", "--out", out], check=False)
    assert done.returncode in (0, 5)
    return out


def same_run(mine: Path, its: Path) -> None:
    assert table(mine / "limits.csv") == table(its / "limits.csv")
    assert sorted(os.listdir(mine / "records")) == sorted(os.listdir(its / "records"))
    for name in os.listdir(its / "records"):
        a, b = mine / "records" / name, its / "records" / name
        assert sorted(os.listdir(a)) == sorted(os.listdir(b))
        assert table(a / "limits.csv") == table(b / "limits.csv")
        for file in ("states.jsonl", "run.json", "polar.svg", "polar.png"):
            assert content(a / file) == content(b / file), (name, file)


def executed(client) -> int:
    """Tasks that the workers have begun, all together."""
    return sum(client.run(lambda dask_worker: dask_worker.state.executed_count).values())


def test_a_study_is_that_of_the_program_and_is_done_once(client, study, by_program, tmp_path, capsys):
    out = tmp_path / "out"
    arguments = [str(study), "--scheduler", client.scheduler.address, "--out", str(out)]
    before = executed(client)
    code = command.main(arguments)
    assert code in (0, 5) and "8 of 8 chains now" in capsys.readouterr().out
    assert executed(client) - before == 8
    same_run(out, by_program)
    assert command.main(arguments) == code and "0 of 8 chains now" in capsys.readouterr().out
    again = maille.dask.sweep(study, client=client, out=out)
    assert (again.solved, again.chains, again.failures) == (0, 8, ())
    assert executed(client) - before == 8
    same_run(out, by_program)
    # All rows once, also with other readers.
    everything = pyarrow.dataset.dataset(out / "chains", partitioning="hive").to_table()
    keys = ["record", "direction_deg", "l2"]
    assert len(set(zip(*(everything[key].to_pylist() for key in keys)))) == everything.num_rows == 48
    frame = again.to_pandas().sort_values(keys)
    assert sorted(set(frame["record"])) == MAPS and "state" not in frame
    rows = sorted(table(out / "limits.csv"), key=lambda row: (row["record"], float(row["direction_deg"]), float(row["l2"])))
    assert [row["l1"] for row in rows] == ["" if x is None or np.isnan(x) else repr(x) for x in frame["l1"]]


def test_the_program_goes_on_with_it_and_it_with_the_programs(client, program, study, by_program, tmp_path):
    before = executed(client)
    out = tmp_path / "out"
    shutil.copytree(by_program, out)
    mine = maille.dask.sweep(study, client=client, out=out)
    assert mine.solved == 0 and mine.dataset().count_rows() == 48
    # The records lost, the chains there.
    shutil.rmtree(out / "records")
    mine = maille.dask.sweep(study, client=client, out=out)
    assert mine.solved == 0
    same_run(out, by_program)
    assert executed(client) == before
    # A damaged chain without a record is computed again.
    shutil.rmtree(out / "records" / MAPS[0])
    file = sorted((out / "chains" / f"record={MAPS[0]}").iterdir())[0]
    file.write_bytes(file.read_bytes()[:100])
    assert maille.dask.sweep(study, client=client, out=out).solved == 1
    done = subprocess.run([program, "sweep", study, "--out", out], capture_output=True, text=True, check=False)
    assert "48 of 48 limits are in" in done.stderr
    same_run(out, by_program)


def test_a_worker_is_killed_at_work(client, tmp_path):
    # No two of them are images of each other.
    ask = dict(directions="1:28:3", l2=[-0.25, -0.125, 0.0], starts=2)
    killed = []

    def kill(done: int, total: int) -> None:
        if done == 0 or killed:
            return
        # A worker may just have handed in its chain: kill one that is at work.
        at_work = [address for address, keys in client.processing().items() if keys]
        if at_work:
            pid = client.run(os.getpid)[at_work[0]]
            os.kill(pid, signal.SIGKILL)
            killed.append(pid)

    found = maille.dask.characterize("3.1", **ask, out=tmp_path, client=client, progress=kill)
    assert killed and not found.failures
    alone = maille.characterize("3.1", **ask)
    mine, its = found.records["3.1"].to_numpy(), alone.to_numpy()
    assert mine["l1"].size == 30
    for name in its:
        if name != "wall_s":
            equal = np.ma.allequal if np.ma.isMaskedArray(its[name]) else np.array_equal
            assert equal(mine[name], its[name], *([] if its[name].dtype.kind != "f" else [True])), name
    assert [s.document for s in found.records["3.1"].states] == [s.document for s in alone.states]
    assert found.dataset().count_rows() == 30
    client.wait_for_workers(2)


def test_maps_have_derivatives(client, tmp_path):
    arguments = dict(directions=[0, 45], l2=[0.0], client=client)
    without = maille.dask.characterize(["1.1"], **arguments, out=tmp_path / "out")
    file = tmp_path / "out" / "records" / "1.1" / "sensitivities.csv"
    assert without.solved == 2 and not file.exists()
    # What is there is not solved again.
    done = maille.dask.characterize(["1.1"], **arguments, out=tmp_path / "out", sensitivities=True)
    assert done.solved == 0
    alone = maille.characterize("1.1", [0, 45], [0.0], out=tmp_path / "alone", sensitivities=True)
    assert file.read_text() == (tmp_path / "alone" / "sensitivities.csv").read_text()
    mine, its = done.records["1.1"].sensitivities().to_numpy(), alone.sensitivities().to_numpy()
    assert all(np.array_equal(mine[name], its[name]) for name in its)


def test_a_fit_has_many_starts(client):
    free = ["elements.standing-*.rings.major_radius=20%"]
    found = maille.dask.fit("1.1", {0: 0.5, 90: 0.4}, starts=3, client=client, free_each=free)
    # Along both chains l1 = 0.8 (1 + R - 2 r) - 1 with r = 0.1.
    assert found.ended == "reached" and found.worst_miss < 1e-6
    assert np.allclose(list(found.numbers.values()), [1.075, 0.95], atol=1e-5)
    alone = maille.fit("1.1", {0: 0.5, 90: 0.4}, free_each=free)
    assert np.allclose(list(alone.numbers.values()), [1.075, 0.95], atol=1e-5)
    with pytest.raises(maille.ArgumentError):
        maille.dask.fit("1.1", {0: 0.5}, starts=1, client=client, free=["minor_radius=2"])


def test_what_cannot_be_used_stops_nothing_else(client, tmp_path):
    base = maille.Design.builtin("3.1")
    designs = ["1.1", base.with_minor_radius(0.6), "nowhere.toml", base.with_minor_radius(0.05)]
    found = maille.dask.characterize(designs, [0, 90], [0.0], out=tmp_path, client=client)
    assert list(found.records) == ["1.1", "3.1-r0.05"]
    # 0 and 90 are one chain of 1.1, whose images they are.
    assert found.solved == 3
    assert [(failure.name, type(failure.error)) for failure in found.failures] == [
        ("3.1-r0.6", maille.DesignError),
        ("nowhere.toml", maille.UnknownDesignError),
    ]
    assert "overlap" in str(found.failures[0]) and "\n" not in str(found.failures[0])
    assert sorted(path.name for path in (tmp_path / "records").iterdir()) == ["1.1", "3.1-r0.05"]


def test_files_of_others_are_not_replaced(client, tmp_path):
    (tmp_path / "limits.csv").write_text("mine\n")
    with pytest.raises(maille.MailleError, match="holds no record"):
        maille.dask.characterize("1.1", [0], [0.0], out=tmp_path, client=client, overwrite=True)
    assert [file.name for file in tmp_path.iterdir()] == ["limits.csv"]
    assert (tmp_path / "limits.csv").read_text() == "mine\n"


def test_other_inputs_are_refused_or_replace_what_differs(client, tmp_path):
    first = maille.dask.characterize("1.1", [0, 45], [0.0], out=tmp_path, client=client)
    with pytest.raises(OtherInputsError, match="directions_deg"):
        maille.dask.characterize("1.1", [0, 45, 90], [0.0], out=tmp_path, client=client)
    shutil.rmtree(tmp_path / "records")
    with pytest.raises(OtherInputsError, match="chains of other inputs"):
        maille.dask.characterize("1.1", [45, 90], [0.0], out=tmp_path, client=client)
    # A chain that is part of both stays.
    more = maille.dask.characterize("1.1", [45, 90], [0.0], out=tmp_path, client=client, overwrite=True)
    assert (first.solved, more.solved) == (2, 1)
    assert sorted(more.to_pandas()["direction_deg"]) == [45, 90]
    other = maille.dask.characterize("1.1", [45, 90], [0.0], seed=2, out=tmp_path, client=client, overwrite=True)
    assert other.solved == 2 and other.dataset().count_rows() == 2


def test_wrong_arguments(client, tmp_path):
    with pytest.raises(maille.ArgumentError, match="dictionary"):
        maille.dask.characterize(["1.1", "1.1"], [0], [0], out=tmp_path, client=client)
    with pytest.raises(maille.ArgumentError, match="retries"):
        maille.dask.characterize("1.1", [0], [0], out=tmp_path, client=client, retries=-1)
    with pytest.raises(maille.ArgumentError, match="client"):
        maille.dask.characterize("1.1", [0], [0], out=tmp_path, client="tcp://a:1")
    assert not list(tmp_path.iterdir())


def test_the_same_design_under_two_names(client, tmp_path):
    found = maille.dask.characterize({"a": "1.1", "b": "1.1"}, [0], [0.0], out=tmp_path, client=client)
    assert found.solved == 1 and len(found.records["a"]) == len(found.records["b"]) == 1


def test_a_task_that_raises_to_the_end_is_a_chain_error(client):
    given = dict(results(client, operator.truediv, {"maille-a": (1, 2), "maille-b": (1, 0)}, retries=1))
    assert given["maille-a"] == 0.5
    assert isinstance(given["maille-b"], ChainError) and "ZeroDivisionError" in str(given["maille-b"])


def test_a_result_that_is_lost_before_it_is_fetched_is_computed_again(client):
    before = executed(client)
    calls = {f"maille-lost-{k}": (k, 1) for k in range(4)}
    found = results(client, operator.add, calls, retries=0)
    given = dict([next(found)])
    while executed(client) - before < len(calls) or any(client.processing().values()):
        time.sleep(0.01)
    pids = client.run(os.getpid)
    held = [address for address, keys in client.has_what().items() if any(key in calls for key in keys)]
    assert held
    for address in held:
        os.kill(pids[address], signal.SIGKILL)
    while set(held) & set(client.scheduler_info()["workers"]):
        time.sleep(0.01)
    given.update(found)
    assert given == {f"maille-lost-{k}": k + 1 for k in range(4)}
    client.wait_for_workers(2)


def test_errors_travel():
    with pytest.raises(maille.DesignError) as raised:
        maille.Design.builtin("3.1").with_minor_radius(0.6).check()
    for error in (raised.value, StudyError("a", "b", "c", 1, 2), OtherInputsError("p", Path("f"), "d")):
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is type(error) and str(again) == str(error) and again.__dict__ == error.__dict__


DESIGN = "european-4-in-1"


def test_a_surface_is_that_of_one_process(client, program, tmp_path):
    ask = dict(vertices=170, tolerance=0.005, starts=1)
    before = executed(client)
    mine = maille.dask.boundary([DESIGN, "nowhere.toml"], **ask, out=tmp_path, client=client)
    assert [failure.name for failure in mine.failures] == ["nowhere.toml"] and mine.solved >= 170
    its, surface = maille.boundary(DESIGN, **ask), mine.surfaces[DESIGN]
    for name in ("vertices", "bound", "status", "triangles"):
        assert np.array_equal(getattr(surface, name), getattr(its, name)), name
    assert surface.arch == its.arch and executed(client) > before
    assert pyarrow.dataset.dataset(tmp_path / "rays", partitioning="hive").count_rows() == len(its.vertices)
    # The program goes on from there: no ray is left.
    out = tmp_path / DESIGN
    arguments = ["boundary", DESIGN, "--vertices", "170", "--tolerance", "0.005", "--starts", "1", "--out", out]
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    assert f"{len(its.vertices)} rays already in" in done.stderr and "\n0 rays in" in f"\n{done.stdout}"
    with open(out / "boundary.csv", newline="") as text:
        exx = [row["exx"] for row in csv.DictReader(text)]
    assert exx == [repr(x) if x or x == 0 else "" for x in its.vertices[:, 0].tolist()]
    with pytest.raises(OtherInputsError):
        maille.dask.boundary(DESIGN, **ask, seed=2, out=tmp_path, client=client)
    # A line that was cut off is solved again.
    journal = out / "boundary.jsonl"
    journal.write_bytes(journal.read_bytes()[:-10])
    again = maille.dask.boundary(DESIGN, **ask, out=tmp_path, client=client)
    assert np.array_equal(again.surfaces[DESIGN].vertices, its.vertices)


def run(*arguments, **more) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "maille.dask", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, **more)


def test_errors_of_the_command_are_one_line_with_an_exit_code(tmp_path, capsys):
    wrong = tmp_path / "wrong.toml"
    wrong.write_text('directions = [0]\nangle = 3\n[[designs]]\ndesign = "1.1"\n')
    nobody = {**os.environ, "DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "1s"}
    cases = [
        (["none.toml", "--workers", "1"], 2, "there is no study none.toml"),
        ([wrong, "--workers", "1"], 2, "wrong.toml:2: unknown field `angle`"),
        ([wrong, "--workers", "0"], 2, "at least one is needed"),
        ([wrong, "--scheduler", "tcp://127.0.0.1:9"], 1, "tcp://127.0.0.1:9"),
        ([wrong, "--scheduler-file", tmp_path / "none.json"], 1, "there is no scheduler file"),
    ]
    for arguments, code, words in cases:
        done = run(*arguments, env=nobody, cwd=tmp_path)
        last = done.stderr.strip().splitlines()[-1]
        assert done.returncode == code and words in last and "error" in last, done.stderr
        assert "Traceback" not in done.stderr
    with pytest.raises(SystemExit) as left:
        command.main(["--help"])
    assert left.value.code == 0 and "Examples:" in capsys.readouterr().out


def test_ctrl_c_leaves_what_was_found_and_the_same_command_goes_on(study, by_program, tmp_path):
    out = tmp_path / "out"
    arguments = [sys.executable, "-m", "maille.dask", str(study), "--workers", "1", "--out", str(out)]
    # Tests that run in a shell's background inherit that SIGINT is ignored.
    usual = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "start_new_session": True}
    child = subprocess.Popen(arguments, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL), **usual)
    while child.poll() is None and not list(out.glob("chains/*/*.parquet")):
        time.sleep(0.01)
    os.killpg(child.pid, signal.SIGINT)  # as from a terminal: to the workers, too
    _, stderr = child.communicate()
    assert child.returncode == 130, stderr
    assert stderr.strip().splitlines()[-1] == "interrupted; the same command continues from here" and "Traceback" not in stderr
    found = len(list(out.glob("chains/*/*.parquet")))
    assert 0 < found < 8
    done = run(*arguments[3:])
    assert done.returncode in (0, 5) and f"{8 - found} of 8 chains now" in done.stdout
    same_run(out, by_program)


def test_variants_with_parameters_are_those_of_the_program(program, tmp_path):
    """Parameters are set first: a minor radius that is set before leaves none of `wire`."""
    example = Path(__file__).parents[3] / "examples/parameters/square.toml"
    text = 'directions = 0\nstarts = 1\n[[designs]]\ndesign = "square.toml"\nminor_radius = 0.5\n[designs.vary]\n'
    (tmp_path / "square.toml").write_text(example.read_text())
    (tmp_path / "study.toml").write_text(text + "radius = [5, 9]\nwire = 1.1\n")
    out = tmp_path / "swept"
    done = subprocess.run([program, "sweep", tmp_path / "study.toml", "--quiet", "--out", out], check=False)
    assert done.returncode == 6
    plan = _study._plan(json.loads(_native.study("study.toml", (tmp_path / "study.toml").read_text())), tmp_path)
    made, refused = (plan[f"square-r0.5-radius{radius}-wire1.1"][0] for radius in (5, 9))
    assert made == maille.read_record(out / "records/square-r0.5-radius5-wire1.1").design
    assert made.minor_radius == 0.5 and made.reference_radius == 5.0
    assert isinstance(refused, maille.DesignError) and "9 is above max = 8" in str(refused)
