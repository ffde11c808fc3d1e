"""Maps from Python are the program's, bit for bit, and each reads the other's records."""

import json
import os
import pickle
import signal
import subprocess
import threading
from pathlib import Path

import numpy as np
import pytest

from records import content, table

import maille

MAP = dict(directions="0:90:15", l2=[-0.25, 0.0, 0.125])
ARGUMENTS = ["--directions", "0:90:15", "--l2=-0.25,0,0.125"]


@pytest.fixture(scope="module")
def by_program(program, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("program") / "3.1"
    # Exit code 5: some limits are not there at this l2.
    done = subprocess.run([program, "characterize", "3.1", *ARGUMENTS, "--quiet", "--out", out], check=False)
    assert done.returncode in (0, 5)
    return out


def test_limits_and_states_are_those_of_the_program_bit_for_bit(by_program, tmp_path):
    out = tmp_path / "python"
    record = maille.characterize("3.1", **MAP, out=out)
    saved = tmp_path / "saved"
    maille.characterize("3.1", **MAP, threads=1).save(saved)
    for folder in (out, saved):
        assert table(folder / "limits.csv") == table(by_program / "limits.csv")
        for name in ("states.jsonl", "run.json", "polar.svg", "polar.png"):
            assert content(folder / name) == content(by_program / name), name
    assert len(record) == len(table(out / "limits.csv")) == 21


def test_the_package_reads_records_of_the_program(by_program):
    record = maille.read_record(by_program)
    rows = table(by_program / "limits.csv")
    columns = record.to_numpy()
    assert [repr(x) if np.isfinite(x) else "" for x in columns["l1"].tolist()] == [row["l1"] for row in rows]
    assert columns["status"].tolist() == [row["status"] for row in rows]
    lines = [json.loads(line) for line in (by_program / "states.jsonl").read_text().splitlines()]
    assert [state.document for state in record.states] == lines
    state = record.states[0]
    assert state.position.shape == (len(state.elements), 3) and state.rotation.shape == (len(state.elements), 4)
    assert np.allclose(np.linalg.norm(state.rotation, axis=1), 1)
    assert np.allclose(state.lattice @ np.array([0, 0, 1]), 0)


def test_the_program_reads_records_of_the_package(program, tmp_path):
    out = tmp_path / "record"
    record = maille.characterize("1.1", [0, 45], [0.0], out=out)
    done = subprocess.run([program, "table", out, "--format", "json"], check=True, capture_output=True, text=True)
    rows = json.loads(done.stdout)["rows"]
    assert len(rows) == 2 and rows[0]["l1"] == pytest.approx(0.44, abs=1e-12)
    # It goes on from there, too: nothing is left to do, and nothing is refused.
    again = [program, "characterize", "1.1", "--directions", "0,45", "--l2", "0", "--out", out]
    done = subprocess.run(again, check=True, capture_output=True, text=True)
    assert "2 of 2 limits are in" in done.stderr
    calls = []
    same = maille.characterize("1.1", [0, 45], [0.0], out=out, progress=lambda done, total: calls.append((done, total)))
    assert calls == [(0, 0)] and np.array_equal(same.to_numpy()["l1"], record.to_numpy()["l1"])


def test_derivatives_are_those_of_the_program(program, tmp_path):
    arguments = ["--directions", "0,30,60", "--l2=0,-0.125", "--sensitivities", "--quiet"]
    subprocess.run([program, "characterize", "1.1", *arguments, "--out", tmp_path / "program"], check=True)
    its = (tmp_path / "program" / "sensitivities.csv").read_text()
    record = maille.characterize("1.1", [0, 30, 60], [0, -0.125], out=tmp_path / "python", sensitivities=True)
    record.save(tmp_path / "saved", sensitivities=True)
    for folder in ("python", "saved"):
        assert (tmp_path / folder / "sensitivities.csv").read_text() == its
        assert content(tmp_path / folder / "run.json") == content(tmp_path / "program" / "run.json")
    # Without a folder, and of a record that has none: from the forces.
    alone = maille.characterize("1.1", [0, 30, 60], [0, -0.125])
    alone.save(tmp_path / "alone")
    assert not (tmp_path / "alone" / "sensitivities.csv").exists()
    slopes = maille.read_record(tmp_path / "alone").sensitivities()
    assert len(slopes) == 12 and "12 derivatives" in repr(slopes)
    rows = table(tmp_path / "program" / "sensitivities.csv")
    columns = slopes.to_numpy()
    assert columns["number"].tolist() == [row["number"] for row in rows]
    for name in ("direction_deg", "l2", "derivative", "derivative_back"):
        assert columns[name].tolist() == [float(row[name]) for row in rows], name
        assert slopes.to_pandas()[name].tolist() == slopes.to_arrow()[name].to_pylist() == columns[name].tolist()
    # Along 0 degrees l1 = (4 - 4 r)/2.5 - 1 at R = 1.
    assert np.allclose(columns["derivative"][:2], [-1.6, -1.44])


def test_arrow_pandas_and_numpy_hold_the_same(by_program):
    record = maille.read_record(by_program)
    arrow, frame, columns = record.to_arrow(), record.to_pandas(), record.to_numpy()
    assert arrow.column_names == list(columns) == list(frame.columns)
    assert arrow.schema.field("wall_s").metadata[b"unit"] == b"s"
    for name in ("l1", "l2", "bound_l1", "direction_deg"):
        assert np.array_equal(frame[name].to_numpy(dtype=float, na_value=np.nan), columns[name], equal_nan=True), name
    missing = [value is None for value in arrow["zero_modes"].to_pylist()]
    assert np.ma.getmaskarray(columns["zero_modes"]).tolist() == missing
    # What was not earned is not a number, and not 0.
    wide = maille.characterize("1.1", [0, 45], [1.5])
    assert np.all(np.isnan(wide.to_numpy()["l1"])) and wide.to_pandas()["l1"].isna().all()


def test_plot_has_a_curve_for_each_l2_all_round(by_program):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = maille.characterize("1.1", "0:180:30", [-0.125, 0.0]).plot()
    assert axes.name == "polar" and len(axes.lines) == 2
    angle, radius = axes.lines[1].get_data()
    assert len(angle) == 13 and np.isclose(angle[-1], 2 * np.pi) and np.isclose(radius[0], 1.44)
    # Black at l2 = 0, blue below; the centre is the sheet as it is written; all limits are proved, so no marker is hollow.
    assert axes.lines[1].get_color() == "#222222" and axes.lines[0].get_color() not in ("#222222", "C0")
    assert axes.get_rmin() == 1.0 and axes.lines[1].get_marker() == "o"
    with pytest.raises(maille.ArgumentError, match="quantity"):
        maille.read_record(by_program).plot("l7")


def test_plot_tells_proved_limits_from_others_and_marks_gaps():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = maille.characterize("european-4-in-1", [0, 30, 45, 90], [-0.1], cell="1x1").plot()
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels[0] == "l2 = -0.1" and "not proved (local)" in labels and "no limit found" in labels
    hollow = next(line for line in axes.lines if line.get_markerfacecolor() == "white")
    assert np.all(np.isfinite(hollow.get_ydata())) and "proven bound" in labels
    # The bound lies further out than the limits, and does not set the scale.
    limits = axes.lines[0].get_ydata()
    highest = max(np.nanmax(limits), axes.get_rmin() + 0.1)
    assert axes.get_rmax() < highest + 0.2 * (highest - axes.get_rmin())


def test_free_width_and_the_energy_method():
    free = maille.characterize("1.1", [0], lateral="free").to_numpy()
    assert free["lateral"][0] == "free" and free["l2_min"][0] <= free["l2_max"][0]
    energy = maille.characterize("1.1", [0], [0], method="energy", energy={"tau": 0.01})
    assert energy.run["parameters"]["options"]["tau"] == 0.01
    assert abs(energy.to_numpy()["l1"][0] - 0.44) < 0.02
    for wrong in ({"tau": -1}, {"taus": 1}, {"tau": "a"}, {"gradient_tolerance": 0}, {"flat_points": 3}):
        with pytest.raises(maille.ArgumentError) as raised:
            maille.characterize("1.1", [0], [0], method="energy", energy=wrong)
        assert raised.value.argument == "energy"


def test_ctrl_c_ends_a_call_and_what_was_found_stays(tmp_path):
    out = tmp_path / "record"

    def at(done: int, total: int) -> None:
        if done == 2:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        maille.characterize("1.1", "0:180:1", [0.0], out=out, progress=at, threads=1)
    found = maille.read_record(out)
    finished = sum(status != "interrupted" for status in found.to_numpy()["status"])
    assert 2 <= finished < 181


def test_an_exception_of_the_callback_ends_the_call():
    def refuse(done: int, total: int) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        maille.characterize("1.1", "0:180:1", [0.0], progress=refuse)


def test_other_threads_run_meanwhile():
    ticks, stop = [], threading.Event()

    def tick():
        while not stop.wait(0.001):
            ticks.append(1)

    thread = threading.Thread(target=tick)
    thread.start()
    before = len(ticks)
    maille.characterize("3.1", "0:180:5", [-0.25, 0.0])
    during = len(ticks) - before
    stop.set()
    thread.join()
    assert during > 5


def test_records_that_are_wrong(tmp_path, by_program):
    with pytest.raises(maille.errors.NotARecordError) as raised:
        maille.read_record(tmp_path)
    assert raised.value.folder == tmp_path
    with pytest.raises(maille.errors.RecordIOError):
        maille.read_record(tmp_path / "none")
    out = tmp_path / "record"
    maille.characterize("1.1", [0], [0], out=out)
    with pytest.raises(maille.errors.OtherInputsError) as raised:
        maille.characterize("1.1", [0, 90], [0], out=out)
    assert "directions_deg" in raised.value.difference and "overwrite=True" in str(raised.value)
    assert len(maille.characterize("1.1", [0, 90], [0], out=out, overwrite=True)) == 2
    limits = out / "limits.csv"
    text = limits.read_text()
    limits.write_text(text.replace("2.07", "2.08", 1))
    with pytest.raises(maille.errors.EditedRecordError) as raised:
        maille.read_record(out)
    assert raised.value.file.endswith("limits.csv") and raised.value.found != raised.value.expected
    limits.write_text(text.replace("global", "universal"))
    with pytest.raises(maille.errors.MalformedRecordError) as raised:
        maille.read_record(out)
    assert raised.value.line == 2 and raised.value.file.endswith("limits.csv")


def test_designs_travel_to_other_processes():
    design = maille.Design.builtin("3.1").with_minor_radius(0.07)
    again = pickle.loads(pickle.dumps(design))
    assert again == design and again.minor_radius == 0.07


def test_records_travel_to_other_processes():
    record = maille.characterize("1.1", [0, 30], [0, 0.1])
    again = pickle.loads(pickle.dumps(record))
    assert again.to_arrow().equals(record.to_arrow(), check_metadata=True)
    assert again.run == record.run and again.design == record.design
    assert [state.document for state in again.states] == [state.document for state in record.states]
