"""Designs: read, made, varied, saved; and what is wrong with them."""

import sys
from pathlib import Path

import numpy as np
import pytest

import maille
from maille import Design, Element, Ring


def square(**changes):
    fields = dict(
        a1=(2.5, 0, 0),
        a2=(0, 2.5, 0),
        minor_radius=0.1,
        reference_radius=1.0,
        elements=[
            Element("flat", (0, 0, 0), [Ring(1.0)]),
            Element("along-x", (1.25, 0, 0), [Ring(1.0, normal=(0, 1, 0))]),
            Element("along-y", (0, 1.25, 0), [Ring(1.0, normal=(1, 0, 0))]),
        ],
    )
    return Design("square", **{**fields, **changes})


def test_every_built_in_design_is_read_saved_and_read_again(tmp_path):
    names = maille.designs()
    assert len(names) == len(set(names)) > 20
    for name in names:
        design = Design.builtin(name)
        design.check()
        design.save(tmp_path / "design.toml")
        assert Design.load(tmp_path / "design.toml") == design == Design.of(tmp_path / "design.toml")
    assert [file.name for file in tmp_path.iterdir()] == ["design.toml"]


def test_a_design_made_here_is_solved_as_a_file_is(tmp_path):
    made = square()
    assert [e.name for e in made.elements] == ["flat", "along-x", "along-y"]
    assert made.elements[1].rings[0].normal == [0.0, 1.0, 0.0] and made.a1 == (2.5, 0.0, 0.0)
    made.save(tmp_path / "square.toml")
    one, other = (maille.characterize(d, [0, 30], [0]).to_numpy()["l1"] for d in (made, tmp_path / "square.toml"))
    assert np.array_equal(one, other) and np.all(one > 0)


def test_thinner_wire_goes_further():
    design = Design.builtin("1.1")
    thin = maille.characterize(design.with_minor_radius(0.05), [0], [0]).to_numpy()["l1"][0]
    thick = maille.characterize(design, [0], [0], minor_radius=0.12).to_numpy()["l1"][0]
    assert thin > 0.44 > thick


def test_wrong_files_name_file_line_and_field(tmp_path):
    file = tmp_path / "wrong.toml"
    text = Design.builtin("1.1").to_toml().replace("minor_radius = 0.1", "minor_radius = -0.1", 1)
    file.write_text(text)
    with pytest.raises(maille.DesignError) as raised:
        Design.load(file)
    error = raised.value
    assert error.file == str(file) and error.field == "minor_radius"
    assert text.splitlines()[error.line - 1].startswith("minor_radius = -0.1")
    assert "-0.1" in error.problem and "wire" in error.remedy and f"{file}:{error.line}: minor_radius" in str(error)


def test_all_problems_are_listed_at_once():
    with pytest.raises(maille.DesignError) as raised:
        square(minor_radius=-1, a2=(5, 0, 0))
    assert {p.field for p in raised.value.problems} == {"minor_radius", "lattice.a2"}
    assert raised.value.file is None and raised.value.line is None


def test_wrong_values_are_one_readable_error():
    for make in (
        lambda: square(a1=(1, 2)),
        lambda: square(elements=[Element("flat", (0, 0, 0), [Ring(1.0, normal=(0, 0, float("nan")))])]),
        lambda: square(elements=[]),
        lambda: Design.builtin("1.1").with_minor_radius(-0.1),
        lambda: maille.characterize("1.1", [0], [0], minor_radius=0.9),
    ):
        with pytest.raises(maille.DesignError) as raised:
            make()
        assert raised.value.remedy


def test_unknown_designs():
    with pytest.raises(maille.UnknownDesignError, match="did you mean european-4-in-1"):
        Design.of("europaen-4-in-1")
    with pytest.raises(maille.UnknownDesignError, match="built in are 1.1"):
        maille.characterize("9.9")
    with pytest.raises(maille.UnknownDesignError):
        Design.load("none.toml")


def test_what_is_no_design_is_an_argument_error():
    for wrong in (None, 3, ["1.1"]):
        with pytest.raises(maille.ArgumentError) as raised:
            maille.characterize(wrong, [0], [0])
        assert raised.value.argument == "design"
    assert maille.Design.of(b"1.1").name == "1.1"


def test_numbers_that_are_too_large_are_argument_errors():
    for wrong in (dict(threads=1_000_000), dict(seed=2**64), dict(starts=2**40)):
        with pytest.raises(maille.ArgumentError) as raised:
            maille.characterize("1.1", [0], [0], **wrong)
        assert raised.value.argument == next(iter(wrong))
    for tile in (4, (4,), (1, 2, 3), (2**40, 1)):
        with pytest.raises(maille.ArgumentError) as raised:
            maille.simulate("1.1", tile, fix="left", pull={"right": (1, 0, 0)})
        assert raised.value.argument == "tile"


def test_a_bar_that_cannot_be_drawn_stops_nothing(monkeypatch):
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    with pytest.warns(UserWarning, match="without a bar"):
        record = maille.characterize("1.1", [0], [0], progress=True)
    assert len(record) == 1


def test_wrong_arguments():
    for wrong, name in (
        (dict(directions="0:90"), "directions"),
        (dict(directions=[]), "directions"),
        (dict(directions=[float("nan")]), "directions"),
        (dict(l2=[-1.0]), "l2"),
        (dict(l2=[0.0], lateral="free"), "l2"),
        (dict(lateral="loose"), "lateral"),
        (dict(method="magic"), "method"),
        (dict(method="energy", shear="free"), "method"),
        (dict(cell="0x1"), "cell"),
        (dict(threads=0), "threads"),
        (dict(quantity="l7"), "quantity"),
        (dict(energy={"tau": 1}), "energy"),
    ):
        with pytest.raises(maille.ArgumentError) as raised:
            maille.characterize("1.1", **wrong)
        assert raised.value.argument == name, wrong


SQUARE = Path(__file__).parents[3] / "examples/parameters/square.toml"


def test_parameters_give_the_numbers_that_are_computed_from_them():
    design = Design.load(SQUARE)
    assert design.parameters == {"wire": 1.2, "radius": 6.0, "play": 1.0, "tilt": 0.0, "pitch": 15.0}
    free = {"wire": (0.4, 2.0), "radius": (4.0, 8.0), "play": (0.92, 1.2), "tilt": (None, None)}
    assert design.free_parameters == free
    other = design.with_parameters(radius=5, play=1.1)
    assert (other.reference_radius, other.a1) == (5.0, (other.parameters["pitch"], 0.0, 0.0))
    assert other.parameters["pitch"] == pytest.approx(2.5 * 1.1 * 5)
    assert design.parameters["radius"] == 6.0, "the design itself is as it was"
    # By hand: two rings in a row, pulled straight, are 4 R - 4 r long.
    record = maille.characterize(other, [0], [0], cell="1x1")
    assert record.to_numpy()["l1"][0] == pytest.approx((4 * 5 - 4 * 0.6) / 13.75 - 1, abs=1e-8)
    # What another way of setting a number leaves of them.
    assert "wire" not in design.with_minor_radius(0.3).parameters


def test_wrong_parameters_are_named():
    design = Design.load(SQUARE)
    for values, said in (
        (dict(raduis=5), "did you mean radius"),
        (dict(radius=9), "9 is above max = 8"),
        (dict(pitch=9), "is computed as"),
        (dict(tilt=float("nan")), "not finite"),
    ):
        with pytest.raises(maille.DesignError, match=said) as raised:
            design.with_parameters(**values)
        assert raised.value.problems[0].field == f"parameters.{next(iter(values))}"
