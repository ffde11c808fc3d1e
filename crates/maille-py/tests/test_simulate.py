"""Finite sheets from Python are the program's; and sheets that are shown."""

import json
import subprocess

import numpy as np
import pytest

import maille

SHEET = dict(fix="left", pull={"right": (3, 0, 0)}, steps=4)


def test_a_sheet_is_that_of_the_program(program, tmp_path):
    out = tmp_path / "program"
    command = [program, "simulate", "1.1", "--tile", "2x2", "--fix", "left", "--pull", "right=3,0,0", "--steps", "4"]
    subprocess.run([*command, "--quiet", "--out", out], check=True)
    calls = []
    mine = maille.simulate("1.1", (2, 2), **SHEET, out=tmp_path / "python", progress=lambda *step: calls.append(step))
    its = maille.read_simulation(out)
    assert mine.end == its.end == "locked" and 0 < mine.share < 1 and mine.links_ok
    assert mine.document == its.document == json.loads((tmp_path / "python" / "simulation.json").read_text())
    assert np.array_equal(mine.position, its.position) and np.array_equal(mine.rotation, its.rotation)
    assert maille.read_simulation(tmp_path / "python").frames == its.frames
    for name in ("frames.jsonl", "forces.csv"):
        assert (tmp_path / "python" / name).read_bytes() == (out / name).read_bytes()
    assert calls[0] == (0, 4) and calls[-1][0] < 4
    # The program draws what the package has written.
    subprocess.run([program, "render", "--from", tmp_path / "python", "--size", "80x60", "--quiet", "--out", tmp_path / "x.png"], check=True)


def test_its_columns_and_its_plot():
    sheet = maille.simulate("1.1", (1, 2), fix="top", gravity=(0, -1, 0), steps=1)
    frame = sheet.to_pandas()
    count = len(sheet.frame_share) * len(sheet.elements)
    assert len(frame) == count and sheet.position.shape == (len(sheet.frame_share), len(sheet.elements), 3)
    assert frame.x.to_numpy().tolist() == sheet.position[..., 0].ravel().tolist()
    assert np.allclose((frame[["qw", "qi", "qj", "qk"]] ** 2).sum(axis=1), 1)
    assert sheet.to_polars().shape == frame.shape
    assert sheet.plot().get_title().endswith(sheet.end)


def test_forces_are_columns():
    sheet = maille.simulate("1.1", (2, 2), **SHEET)
    forces = sheet.forces
    assert all(len(column) == len(sheet.frame_share) for column in forces.values())
    assert forces["share"].tolist() == sheet.frame_share.tolist() and forces["energy"].tolist() == sheet.energy.tolist()
    # Free, then a stop: 5.4 long at most where 3.75 was.
    assert forces["stretch"][-1] == pytest.approx(1.44, abs=1e-3) and forces["mean_force"][-1] > 0.1
    assert np.abs(forces["mean_force"][forces["stretch"] < 1.43]).max() < 1e-3
    assert np.allclose(forces["force_left_x"] + forces["force_right_x"], 0, atol=1e-2)
    assert np.isnan(forces["floor_force"]).all()
    # Of F, the same map by NumPy.
    start, end = (x - x.mean(axis=0) for x in (sheet.position[0, :, :2], sheet.position[-1, :, :2]))
    gradient = np.linalg.lstsq(start, end, rcond=None)[0].T
    assert np.allclose(gradient.ravel(), [forces[name][-1] for name in ("f_xx", "f_xy", "f_yx", "f_yy")], atol=1e-12)
    assert sheet.plot_force().get_title().endswith("locked")
    # What hangs is held with its weight, and is pulled nowhere.
    hanging = maille.simulate("1.1", (1, 2), fix="top", gravity=(0, -1, 0), steps=1)
    assert hanging.forces["force_top_y"][-1] == pytest.approx(len(hanging.elements), rel=1e-2)
    with pytest.raises(maille.ArgumentError):
        hanging.plot_force()


@pytest.mark.parametrize(
    "wrong",
    [
        dict(),
        dict(pull={"right": (1, 0)}),
        dict(pull={"right": (np.nan, 0, 0)}),
        dict(pull={"nowhere": (1, 0, 0)}),
        dict(fix="left", pull={"left": (1, 0, 0)}),
        dict(gravity=(0, 0, -1), steps=0),
        dict(gravity=(0, 0, -1), tau=-1),
        dict(gravity=[(0, 0, -1), (0, 0, 1)]),
    ],
)
def test_wrong_plans(wrong):
    with pytest.raises(maille.ArgumentError):
        maille.simulate("1.1", (1, 1), **wrong)


def test_a_folder_without_a_simulation(tmp_path):
    with pytest.raises(maille.errors.NotARecordError):
        maille.read_simulation(tmp_path)
    (tmp_path / "simulation.json").write_text("{}\n")
    (tmp_path / "frames.jsonl").write_text("")
    with pytest.raises(maille.errors.MalformedRecordError, match=r"simulation\.json:1"):
        maille.read_simulation(tmp_path)


def test_a_sheet_is_shown_as_a_widget_and_as_a_picture(tmp_path):
    view = maille.show("1.1", tile=(2, 2), size=(120, 90))
    bundle = view._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in bundle and "image/png" in bundle
    plot = view.widget()
    assert [mesh.name for mesh in plot.objects] == ["flat", "standing-0", "standing-90"]
    picture = maille.show("1.1", size=(120, 90), interactive=False)
    assert "application/vnd.jupyter.widget-view+json" not in picture._repr_mimebundle_()
    picture.save(tmp_path / "1.1.png")
    assert (tmp_path / "1.1.png").read_bytes()[:4] == b"\x89PNG"
    with pytest.raises(maille.ArgumentError):
        picture.widget()
    for wrong in (dict(view="sideways"), dict(tile=(0, 1)), dict(color="blue"), dict(color="load")):
        with pytest.raises(maille.ArgumentError):
            maille.show("1.1", interactive=False, **wrong)


def test_the_mesh_is_where_the_tori_are():
    design = maille.Design.builtin("1.1")
    state = maille.characterize(design, [30], [0.0]).states[0]
    # Every vertex is a minor radius away from the core circle of one of its kind.
    meshes = state.show(tile=(1, 1))._native.mesh((1, 1), 24, 8)
    for kind, (name, vertices, triangles) in enumerate(meshes):
        circle = np.concatenate([points for of, points in state.circles(2000) if of == kind])
        away = np.linalg.norm(vertices[:, None] - circle[None], axis=2).min(axis=1)
        assert name == design.elements[kind].name and triangles.max() < len(vertices)
        assert np.allclose(away, design.minor_radius, atol=1e-4)


def test_states_are_drawn_from_above():
    record = maille.characterize("1.1", [45], [0.0])
    axes = record.states[0].plot(tile=(2, 3))
    assert len(axes.lines) == 3 * 2 * 3
    assert len(maille.limit("1.1", maximize="exx").plot().lines) == 12
    assert maille.tightest("1.1", starts=1).to_polars()["minor_radius"][0] == pytest.approx(1 - np.sqrt(0.5))


def test_a_sheet_is_bent_onto_a_surface():
    bent = maille.simulate("1.1", (3, 3), bend=(0.03, -0.03), steps=3)
    assert bent.end == "reached" and bent.forces["bend_force"][-1] < 0.1
    with pytest.raises(maille.ArgumentError, match="two curvatures"):
        maille.simulate("1.1", (3, 3), bend=(0.03,))


def test_files_of_others_are_not_replaced(tmp_path):
    (tmp_path / "forces.csv").write_text("mine\n")
    with pytest.raises(maille.MailleError, match="holds no record"):
        maille.simulate("1.1", (2, 1), fix="left", pull={"right": (3, 0, 0)}, steps=3, out=tmp_path)
    assert [file.name for file in tmp_path.iterdir()] == ["forces.csv"] and (tmp_path / "forces.csv").read_text() == "mine\n"
