"""Files are whole or not there, wherever Ctrl-C falls; packages that are missing are named."""

import os

import pytest

from maille import _extra, _files


@pytest.mark.parametrize("renamed", [False, True])
def test_ctrl_c_about_the_renaming(renamed, tmp_path, monkeypatch):
    file = tmp_path / "file"
    file.write_bytes(b"before")
    replace = os.replace

    def interrupted(*names):
        if renamed:
            replace(*names)
        raise KeyboardInterrupt

    monkeypatch.setattr(_files.os, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        _files.write_whole(file, b"after")
    assert file.read_bytes() == (b"after" if renamed else b"before")
    assert list(tmp_path.iterdir()) == [file]


def test_a_missing_package_is_named_with_what_to_install():
    with pytest.raises(ModuleNotFoundError, match=r'^this needs no_such_package: pip install "maille\[plot\]"$') as found:
        with _extra.extra("plot"):
            import no_such_package  # noqa: F401
    assert found.value.name == "no_such_package"
