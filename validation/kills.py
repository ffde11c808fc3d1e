#!/usr/bin/env python3
"""Kills maille at random moments, lets it go on, and compares with a run that nobody disturbed.

    python3 validation/kills.py target/debug/maille --kills 46 --seed 1
    python3 validation/kills.py maille --only dask --python .venv/bin/python --kills 20

A trial is a fresh folder. The command is started in it and killed (SIGKILL to its process group) at a moment between 2 ms and the
time of the whole run, up to four times in a row; then it runs to its end. After each kill:

- each file is whole or not there: tables, JSON, pictures and meshes are read to their ends. Only the last line of a journal may be cut;
- no row that was there before is gone, and each row is that of the undisturbed run, digit for digit, but for `wall_s`;
- `maille table` reads a record or says that there is none, and `maille verify` finds nothing false in it.

At the end all files are those of the undisturbed run: tables without `wall_s`, `run.json` without the checksums that follow from it, journals
of boundary sorted; not what shows times. No temporary file is left. Needs Python 3.10 and nothing else; exits with 1 where something differs.
"""

from __future__ import annotations

import argparse
import csv
import io
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

STUDY = """directions = "0:90:15"
l2 = [-0.25, -0.125, 0]
cell = "1x1"
[[designs]]
design = "1.1"
minor_radius = [0.05, 0.1]
[[designs]]
design = "3.1"
"""
COMMANDS = {
    "characterize": "characterize 1.1 --directions 0:180:5 --l2=-0.25,-0.125,0 --cell 1x1 --out out --quiet",
    "sweep": "sweep study.toml --out out --quiet",
    "reproduce": "reproduce --quick --only 1.1 --out out --quiet",
    "boundary": "boundary european-4-in-1 --vertices 162 --tolerance 0.5 --starts 1 --out out --quiet",
    "roll": "roll european-4-in-1 --directions 0:180:15 --axis below --effort low --out out --quiet",
    "simulate": "simulate 1.1 --tile 3x2 --fix left --pull right=5,0,0 --gravity 0,0,-1 --floor -3 --frames out/all --out out --quiet",
    "dask": "-m maille.dask study.toml --workers 1 --out out --quiet",
}
#: Files that show times, or hold them in a form that is not compared here.
TIMES = ("index.html", "6.1-times", ".parquet")


@dataclass
class Figures:
    kills: int = 0
    resumed: int = 0
    ended: int = 0
    trials: int = 0
    temporary: int = 0
    lost: int = 0
    differences: int = 0
    kept: int = 0


class Campaign:
    def __init__(self, program: str, python: str, name: str, chance: random.Random) -> None:
        self.program = program
        self.start = [python if name == "dask" else program, *COMMANDS[name].split()]
        self.chance = chance
        self.figures = Figures()
        with tempfile.TemporaryDirectory() as folder:
            begun = time.monotonic()
            self.code = self.run(Path(folder), None)
            self.whole_s = time.monotonic() - begun
            if self.code not in (0, 5):
                sys.exit(f"{name}: the undisturbed run ended with {self.code}")
            out = Path(folder) / "out"
            self.files = contents(out)
            self.rows = rows(out)

    def run(self, folder: Path, kill_s: float | None) -> int | None:
        """Runs to the end, or is killed after a time: None."""
        self.study(folder)
        run = subprocess.Popen(self.start, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True)
        try:
            _, said = run.communicate(timeout=kill_s)
        except subprocess.TimeoutExpired:
            os.killpg(run.pid, signal.SIGKILL)
            run.communicate()
            return None
        if run.returncode not in (0, 5):
            print(said.decode(errors="replace"), file=sys.stderr)
        return run.returncode

    @staticmethod
    def study(folder: Path) -> None:
        (folder / "study.toml").write_text(STUDY)

    def differs(self, words: str) -> None:
        self.figures.differences += 1
        print(f"  {words}", file=sys.stderr)

    def trial(self, kills: int) -> None:
        figures = self.figures
        figures.trials += 1
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "out"
            before: dict[tuple[str, ...], tuple[str, ...]] = {}
            for _ in range(kills):
                if self.run(Path(folder), self.chance.uniform(0.002, self.whole_s)) is not None:
                    figures.ended += 1
                    break
                figures.kills += 1
                there = self.check(out)
                figures.lost += len(lost(before, there, out))
                before = there
            figures.kept += len(before)
            self.goes_on(Path(folder))

    def goes_on(self, folder: Path) -> None:
        """The same command ends as it should, with the files of the undisturbed run and no row less."""
        out = folder / "out"
        before = rows(out)
        # A simulation that is done is not begun again.
        done = (out / "simulation.json").exists() and not (out / "steps.jsonl").exists()
        code = self.code if done else self.run(folder, None)
        self.figures.resumed += 1
        if code != self.code:
            self.differs(f"went on to exit code {code}, not {self.code}")
        found = contents(out)
        self.figures.lost += len(lost(before, rows(out), out))
        for name in sorted(found.keys() | self.files.keys()):
            if found.get(name) != self.files.get(name):
                self.differs(f"{name} differs" if name in found and name in self.files else f"{name} is there, or is not")

    def check(self, out: Path) -> dict[tuple[str, ...], tuple[str, ...]]:
        """What must hold after a kill; gives the rows that are there."""
        for path in files(out):
            if path.name.startswith(".maille-") and path.name.endswith(".tmp"):
                self.figures.temporary += 1
            elif words := broken(path):
                self.differs(f"{path.relative_to(out)}: {words}")
        there = rows(out)
        for key, row in there.items():
            # Steps are gone when all is done.
            if key[0] != "step" and self.rows.get(key) != row:
                self.differs(f"row {key} is false")
        records = [path.parent for path in files(out) if path.name == "run.json"]
        for record in records if len(records) < 3 else self.chance.sample(records, 2):
            for command, allowed in [(["table", "--format", "csv"], (0,)), (["verify", "--quiet"], (0, 5))]:
                said = subprocess.run([self.program, command[0], record, *command[1:]], capture_output=True, text=True)
                empty = "no rows" in said.stderr or "no row" in said.stderr
                if said.returncode not in allowed and not empty:
                    self.differs(f"{command[0]} {record.relative_to(out)}: {said.returncode}: {said.stdout}{said.stderr}")
        return there


def files(out: Path) -> list[Path]:
    return sorted(path for path in out.rglob("*") if path.is_file())


def broken(path: Path) -> str | None:
    """What is wrong with a file, if it is not whole."""
    data = path.read_bytes()
    match path.suffix:
        case ".png":
            return None if data.startswith(b"\x89PNG") and data.endswith(b"IEND\xaeB`\x82") else "cut off"
        case ".parquet":
            return None if data.startswith(b"PAR1") and data.endswith(b"PAR1") else "cut off"
        case ".svg" | ".html":
            return None if data.rstrip().endswith((b"</svg>", b"</html>")) else "cut off"
        case ".lock":
            return None if not data else "not empty"
    text = data.decode()
    lines = text.split("\n")
    if path.suffix in (".journal", ".jsonl"):
        may_be_cut = path.name in ("limits.journal", "boundary.jsonl", "rolls.jsonl", "steps.jsonl")
        try:
            for line in lines[:-1]:
                json.loads(line)
        except ValueError:
            return "a line before the last is cut off"
        return None if may_be_cut or not lines[-1] else "its last line is cut off"
    if text and lines[-1]:
        return "its last line is cut off"
    if path.suffix == ".json":
        try:
            json.loads(text)
        except ValueError as error:
            return str(error)
    if path.suffix == ".csv" and len({len(row) for row in csv.reader(io.StringIO(text))}) != 1:
        return "rows of several lengths"
    return None


def timeless(path: Path) -> list[tuple[str, ...]]:
    """Rows of a table without wall times, the head first."""
    table = [row for row in csv.reader(io.StringIO(path.read_text()))]
    if "wall_s" not in table[0]:
        return [tuple(row) for row in table]
    at = table[0].index("wall_s")
    return [tuple(row[:at] + row[at + 1 :]) for row in table]


def rows(out: Path) -> dict[tuple[str, ...], tuple[str, ...]]:
    """Results that are on the disk, by what they are of: rows of tables, lines of journals."""
    found: dict[tuple[str, ...], tuple[str, ...]] = {}
    for path in files(out):
        below = str(path.parent.relative_to(out))
        if path.name == "limits.csv" and (path.parent / "run.json").exists():
            head, *table = timeless(path)
            places = [head.index(name) for name in ("direction_deg", "l2", "status", "l1")]
            for row in table:
                direction, l2, status, l1 = (row[k] for k in places)
                if status != "interrupted":
                    found[below, repr(float(direction)), repr(float(l2))] = (status, l1 and repr(float(l1)))
        elif path.name == "limits.journal":
            for row in (json.loads(line)["row"] for line in path.read_text().split("\n")[:-1]):
                l1 = "" if row["l1"] is None else repr(float(row["l1"]))
                if row["status"] != "interrupted":
                    found[below, repr(float(row["direction_deg"])), repr(float(row["l2"]))] = (row["status"], l1)
        elif path.name == "boundary.jsonl":
            for line in path.read_text().split("\n")[1:-1]:
                found["ray", *map(repr, json.loads(line)["direction"])] = (line,)
        elif path.name == "rolls.jsonl":
            for roll in map(json.loads, path.read_text().split("\n")[1:-1]):
                found["roll", repr(roll["direction_deg"]), str(roll["axis"])] = (roll["status"],)
        elif path.name == "steps.jsonl":
            for line in path.read_text().split("\n")[1:-1]:
                found["step", str(json.loads(line)["step"]["runs"])] = (line,)
    return found


def lost(before: dict[tuple[str, ...], tuple[str, ...]], there: dict[tuple[str, ...], tuple[str, ...]], out: Path) -> set:
    """Results that were on the disk and are not. Steps of a simulation go when it is done."""
    done = not (out / "steps.jsonl").exists()
    return {key for key in before.keys() - there.keys() if key[0] != "step" or not done}


def contents(out: Path) -> dict[str, object]:
    """All files, without times."""
    found: dict[str, object] = {}
    for path in files(out):
        name = str(path.relative_to(out))
        if any(times in name for times in TIMES):
            found[name] = None
        elif path.suffix == ".csv":
            found[name] = timeless(path)
        elif path.name in ("run.json", "roll.json"):
            run = json.loads(path.read_text())
            run.pop("files", None)  # older records have none
            found[name] = json.dumps(run)
        elif path.name == "boundary.jsonl":
            found[name] = sorted(path.read_text().split("\n"))
        elif path.name == "rolls.jsonl":
            lines = [json.loads(line) for line in path.read_text().splitlines()]
            found[name] = sorted(json.dumps({key: line[key] for key in line if key not in ("wall_s", "sum")}) for line in lines)
        else:
            found[name] = path.read_bytes()
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the program maille")
    parser.add_argument("--kills", type=int, default=46, help="kills of each command [default: 46]")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=COMMANDS, action="append", help="this command; dask needs the Python package")
    parser.add_argument("--python", default=sys.executable, help="the Python that has the package")
    args = parser.parse_args()
    program = str(Path(args.program).resolve()) if os.sep in args.program else args.program
    print("| command | whole run | kills | ended before | resumed to the end | rows kept by kills | temporary files seen | rows lost | differences |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |", flush=True)
    wrong = 0
    for name in args.only or [name for name in COMMANDS if name != "dask"]:
        campaign = Campaign(program, args.python, name, random.Random(f"{args.seed} {name}"))
        f = campaign.figures
        while f.kills < args.kills:
            campaign.trial(min(campaign.chance.randint(1, 4), args.kills - f.kills))
        cells = [f.kills, f.ended, f.resumed, f.kept, f.temporary, f.lost, f.differences]
        print(f"| {name} | {campaign.whole_s:.1f} s | {' | '.join(map(str, cells))} |", flush=True)
        wrong += f.lost + f.differences
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
