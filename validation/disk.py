#!/usr/bin/env python3
"""Lets the disk run full under maille, or makes it read-only, and compares what it then goes on to with a run that nobody disturbed.

    sudo python3 validation/disk.py target/debug/maille

Each command runs in a small disk in memory, of several sizes: it must end with exit code 1 and say that a file cannot be written, and what
is there must be whole (the checks of `kills.py`). The disk is then made large, and the same command must go on to the files of the undisturbed run.
The same with a disk that is read-only, empty or with what a killed run has left. (A system refuses to make a disk read-only while a run
has its lock there.) Needs the right to mount; exits with 1 where something differs.
"""

from __future__ import annotations

import argparse
import random
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from kills import COMMANDS, Campaign

SIZES_K = (8, 24, 60, 120)
#: Parts of a whole run after which it is killed, before the disk is read-only.
KILLED = (0.0, 0.2, 0.6)


@contextmanager
def disk(options: str) -> Iterator[Path]:
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder], check=True)
        try:
            yield Path(folder)
        finally:
            subprocess.run(["umount", "--lazy", folder], check=True)


def remount(folder: Path, options: str) -> None:
    subprocess.run(["mount", "-o", f"remount,{options}", folder], check=True)


class Trial:
    """One command, and what has come of it."""

    def __init__(self, campaign: Campaign) -> None:
        self.campaign = campaign
        self.failed = self.ended = 0

    def goes_on(self, folder: Path, code: int, said: str, words: str, expected: str) -> None:
        """What must hold after a failure, and that the same command then ends as it should."""
        if code == self.campaign.code:
            self.ended += 1
            return
        self.failed += 1
        if code != 1 or "cannot " not in said or expected not in said:
            self.campaign.differs(f"{words}: exit code {code}: {said}")
        out = folder / "out"
        self.campaign.check(out)
        remount(folder, "rw,size=100m")
        self.campaign.goes_on(folder)

    def run(self, folder: Path) -> tuple[int, str]:
        done = subprocess.run(self.campaign.start, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        return done.returncode, " ".join(done.stderr.split())


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the program maille")
    program = str(Path(parser.parse_args().program).resolve())
    wrong = 0
    print("| command | disk | failures | ended before | rows lost | differences |\n| --- | --- | --- | --- | --- | --- |", flush=True)
    for name in (name for name in COMMANDS if name != "dask"):
        campaign = Campaign(program, sys.executable, name, random.Random(name))
        full, read_only = Trial(campaign), Trial(campaign)
        for size in SIZES_K:
            with disk(f"size={size}k") as folder:
                campaign.study(folder)
                full.goes_on(folder, *full.run(folder), f"{size} k", "No space left")
        shown = (0, 0)
        for trial, words in [(full, "full"), (read_only, "read-only")]:
            for part in KILLED if trial is read_only else ():
                with disk("size=100m") as folder:
                    campaign.study(folder)
                    if part > 0.0:
                        campaign.run(folder, part * campaign.whole_s)
                    remount(folder, "ro")
                    trial.goes_on(folder, *trial.run(folder), f"killed after {part} of a run", "Read-only file system")
            f = campaign.figures
            lost, differences = f.lost - shown[0], f.differences - shown[1]
            print(f"| {name} | {words} | {trial.failed} | {trial.ended} | {lost} | {differences} |", flush=True)
            shown = (f.lost, f.differences)
        wrong += sum(shown)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
