"""Single questions, and the surface of attainable strains."""

import json
import subprocess

import numpy as np
import pytest

import maille


def by_program(program, *arguments):
    done = subprocess.run([program, *arguments, "--json"], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def test_limits_of_strains_are_those_of_the_program(program):
    mine = maille.limit("1.1", maximize="exx", fix={"eyy": 0.05}, free=["exy"])
    its = by_program(program, "limit", "1.1", "--maximize", "exx", "--fix", "eyy=0.05", "--free", "exy")
    assert (mine.value, mine.bound, mine.status) == (its["value"], its["bound"], its["status"])
    assert mine.strain.tolist() == [its["strains"][name]["value"] for name in ("exx", "eyy", "exy")]
    assert mine.state.document["poses"] == its["poses"]
    # Along x a length of 1.44: exx = s + s²/2.
    assert np.isclose(maille.limit("1.1", maximize="exx").value, 0.44 + 0.44**2 / 2)


def test_extremes_are_those_of_the_program(program):
    mine = maille.tightest("european-4-in-1", starts=2)
    its = by_program(program, "tightest", "european-4-in-1", "--starts", "2")
    assert mine.sizes[0].tolist() == [its["sizes"][0][k] for k in ("major_radius", "minor_radius", "aspect_ratio")]
    assert mine.design.name == "european-4-in-1-tightest"
    mine.design.check()
    roomy = maille.roomiest("1.1", starts=1)
    assert roomy.gap == by_program(program, "roomiest", "1.1", "--starts", "1")["gap"] > 0


def test_sensitivities_are_those_of_the_program(program):
    mine = maille.Design.builtin("3.1").sensitivity(90, -0.05, step=0.05)
    its = by_program(program, "sensitivity", "3.1", "--direction", "90", "--l2", "-0.05", "--step", "0.05")
    its.pop("wall_s")
    assert mine == its
    # The wire costs what a thinner one gains, against limits that are solved anew.
    design = maille.Design.builtin("1.1")
    wire = next(row for row in design.sensitivity(30)["numbers"] if row["number"].startswith("minor_radius"))
    limits = [maille.characterize(design.with_minor_radius(0.1 + h), [30], [0]).to_numpy()["l1"][0] for h in (-1e-4, 1e-4)]
    assert np.isclose(wire["derivative"], (limits[1] - limits[0]) / 2e-4, rtol=1e-5)
    for wrong in (dict(step=0.0), dict(direction=np.inf), dict(l2=-1.0)):
        with pytest.raises(maille.ArgumentError):
            design.sensitivity(**wrong)
    apart = design.spaced(10.0)
    with pytest.raises(maille.ArgumentError, match="certified"):
        apart.sensitivity(30)


def test_wrong_questions():
    for wrong in (dict(), dict(maximize="exx", minimize="eyy"), dict(maximize="exz"), dict(maximize="exx", free="exx")):
        with pytest.raises(maille.ArgumentError):
            maille.limit("1.1", **wrong)
    for effort in ("high", "0s", 3):
        for ask in (lambda e: maille.limit("1.1", maximize="exx", effort=e), lambda e: maille.tightest("1.1", effort=e),
                    lambda e: maille.characterize("1.1", [0], [0], effort=e), lambda e: maille.boundary("1.1", effort=e)):
            with pytest.raises(maille.ArgumentError) as raised:
                ask(effort)
            assert raised.value.argument == "effort"
    with pytest.raises(maille.ArgumentError, match="held"):
        maille.limit("1.1", maximize="exx", fix={"eyy": -0.6})


def octahedron():
    """|exx| + |eyy| + |exy| = 1."""
    vertices = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    triangles = [[x, y, z] if (x + y + z) % 2 == 0 else [x, z, y] for x in (0, 1) for y in (2, 3) for z in (4, 5)]
    return maille.Boundary(vertices, np.ones(6), np.array(["local"] * 6), np.array(triangles), 0.0)


def test_points_in_front_of_a_surface_and_behind_it():
    surface = octahedron()
    strains = np.random.default_rng(1).uniform(-1.2, 1.2, (2000, 3))
    total = np.abs(strains).sum(1)
    assert np.array_equal(surface.contains(strains), total <= 1)
    margin = surface.margin(strains)
    # Inside, the nearest face is that of the octant.
    assert np.allclose(margin[total <= 1], (1 - total[total <= 1]) / np.sqrt(3))
    assert np.all(margin[total > 1] < 0)
    projected = surface.project(strains)
    assert np.array_equal(projected[total <= 1], strains[total <= 1])
    outside = strains[total > 1]
    assert np.allclose(np.abs(projected[total > 1]).sum(1), 1)
    # No point of a dense sample of the surface is nearer.
    sample = np.random.default_rng(2).dirichlet([1, 1, 1], 4000)[:, None] * np.sign(outside[:300])
    nearest = np.linalg.norm(sample - outside[:300], axis=2).min(0)
    away = np.linalg.norm(projected[total > 1] - outside, axis=1)[:300]
    assert np.all(away <= nearest + 1e-12) and np.all(nearest - away < 0.1)
    assert surface.contains([0, 0, 0]) and surface.margin([0, 0, 0]) > 0.5
    for wrong in (np.eye(2), [1, 2], np.ones((2, 2, 3))):
        with pytest.raises(maille.ShapeError):
            surface.contains(wrong)


def test_the_surface_of_a_design_is_closed_and_holds_its_limits():
    calls = []
    name, options = "european-4-in-1", {"vertices": 162, "effort": "low"}
    surface = maille.boundary(name, **options, progress=lambda done, total: calls.append((done, total)))
    assert len(surface.vertices) == 162 and calls[-1] == (162, 162)
    edges = np.sort(surface.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert np.all(np.unique(edges, axis=0, return_counts=True)[1] == 2)
    distance = np.linalg.norm(surface.vertices, axis=1)
    assert np.all(distance <= surface.bound + 1e-9)
    assert np.all(surface.contains(0.999 * surface.vertices)) and not np.any(surface.contains(1.001 * surface.vertices))
    most = maille.limit(name, maximize="exx", fix={"eyy": 0.0, "exy": 0.0}).value
    assert surface.contains([0.9 * most, 0, 0]) and not surface.contains([1.1 * most, 0, 0])


def test_rolls_and_tubes():
    rolls = maille.roll("european-4-in-1", directions=[0, 90], threads=1)
    table = rolls.to_numpy()
    assert len(rolls) == 4 and set(table["status"]) == {"local"}
    assert table["neutral_radius"].round(4).tolist() == [9.0175, 9.0175, 23.0437, 23.0437]
    assert np.allclose(table["curvature"][::2], -table["curvature"][1::2], rtol=0, atol=1e-9)
    assert len(rolls.documents[0]["poses"]) == 2
    tubes = maille.roll("european-4-in-1", wrap=[8], axis="below", threads=1)
    table = tubes.to_numpy()
    assert table["sought"].tolist() == ["roomiest", "narrowest", "widest", "shortest", "longest"]
    assert table["neutral_radius"][1].round(4) == 15.1027 and table["wrap"].tolist() == [8.0] * 5
    bent = maille.roll("european-4-in-1", curvature=[0.03], directions=[90], axis="below", lateral="free", threads=1)
    table = bent.to_numpy()
    assert table["neutral_stretch"][2].round(4) == 1.1294 and table["at_curvature"].tolist() == [0.03] * 5
    sheared = maille.roll("european-4-in-1", directions=[90], axis="below", l2=-0.02, gamma=0.03, threads=1).to_numpy()
    assert np.allclose([sheared["l2"][0], sheared["gamma"][0]], [-0.02, 0.03], rtol=0, atol=1e-9)
    assert maille.characterize("cable", threads=1).to_numpy()["l1"].round(4).tolist() == [0.1364]
    assert maille.roll("cable", axis="below", threads=1).to_numpy()["neutral_radius"].round(4).tolist() == [2.1962]
    for asked in ({"wrap": [8], "gamma": 0.1}, {"wrap": [8], "shear": "free"}, {"wrap": [8], "curvature": [0.1]}):
        with pytest.raises(maille.MailleError, match="a tube has its own"):
            maille.roll("european-4-in-1", **asked)
    with pytest.raises(maille.MailleError, match="chain"):
        maille.boundary("cable")
    with pytest.raises(maille.ArgumentError, match="side of the sheet"):
        maille.roll("1.1", axis="left")
    with pytest.raises(maille.MailleError, match="no lattice vector lies along 20"):
        maille.roll("1.1", wrap=[8], directions=[20])
