"""The same maps by two programs, and by one on several numbers of threads.

    python validation/determinism.py PROGRAM [OTHER]

Every built-in design at two directions and two l2. By one program on 1, 2 and 4 threads all columns but the wall time must be the
same bits; by two programs (debug and release, or with another instruction set under an emulator) the statuses, and l1 to
1e-10. Needs Python alone.
"""

import csv
import json
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

MAP = ["--directions", "0,37.5", "--l2=-0.125,0", "--cell", "1x1", "--quiet"]


def rows(program, design, threads, folder):
    out = Path(folder) / f"{abs(hash(program))}-{design}-{threads}"
    command = [*shlex.split(program), "characterize", design, *MAP, "--threads", str(threads), "--out", str(out)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 5):
        sys.exit(f"{' '.join(command)}: {done.stderr}")
    with open(out / "limits.csv", newline="") as file:
        table = list(csv.DictReader(file))
    for row in table:
        del row["wall_s"]
    return table, (out / "states.jsonl").read_bytes()


def main():
    programs = sys.argv[1:3]
    listed = subprocess.run([*shlex.split(programs[0]), "designs", "--json"], capture_output=True, check=True)
    designs = [design["name"] for design in json.loads(listed.stdout)["designs"]]
    limits, threads_differ, statuses_differ, worst = 0, 0, 0, 0.0
    with tempfile.TemporaryDirectory() as folder:
        for design in designs:
            first = rows(programs[0], design, 1, folder)
            limits += len(first[0])
            threads_differ += sum(rows(programs[0], design, n, folder) != first for n in (2, 4))
            for other in programs[1:]:
                for mine, its in zip(first[0], rows(other, design, 2, folder)[0], strict=True):
                    if mine["status"] != its["status"] or bool(mine["l1"]) != bool(its["l1"]):
                        statuses_differ += 1
                        print(f"{design} {mine['direction_deg']} {mine['l2']}: {mine['status']}, {its['status']}")
                    elif mine["l1"]:
                        worst = max(worst, abs(float(mine["l1"]) - float(its["l1"])))
    print(f"{limits} limits of {len(designs)} designs; records that differ between 1, 2 and 4 threads: {threads_differ}")
    if programs[1:]:
        print(f"statuses that differ between the programs: {statuses_differ}; largest difference of l1: {worst:.1e}")
    sys.exit(threads_differ > 0 or statuses_differ > 0 or worst > 1e-10)


main()
