"""Writes SHA256SUMS of all files of a folder into it: python packaging/checksums.py FOLDER"""

import hashlib
import pathlib
import sys

folder = pathlib.Path(sys.argv[1])
files = sorted(file for file in folder.iterdir() if file.name != "SHA256SUMS")
lines = [f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.name}\n" for file in files]
(folder / "SHA256SUMS").write_text("".join(lines), encoding="utf-8", newline="\n")
