"""A closed tube of `maille roll --wrap` against the same tube as a finite sheet of `maille simulate`.

    python3 tube_against_sheet.py DESIGN CELLS ROWS[,ROWS...] [--alpha 1e4,1e5,1e6] [--tau 0.002]
                                  [--goal longest|shortest] [--start roomiest] [--hold ELEMENT,...] [--effort low]
                                  [--maille maille] [--work FOLDER]

`roll` finds the tube by periodic images. Here all its rings, CELLS round and ROWS along, are written as one
design that has no images, in the state --start. `simulate` moves the first and the last row to their places in
the longest (shortest) state, and then apart (together) until the sheet locks. The places of the end rows'
elements (--hold: of some of them) are held, so their radius is, too; all others are free, and every ring may
turn. The direction is 0, a1 along x, the axis below. Printed is l2, that of the exact tube and of the simulated one, over its whole length and over its middle half.
"""
import argparse
import json
import math
import subprocess
from pathlib import Path


def turned(v, angle):
    """v turned about the y axis, as `roll` turns its images."""
    c, s = math.cos(angle), math.sin(angle)
    return [v[0] * c + v[2] * s, v[1], v[2] * c - v[0] * s]


def rotated(q, v):
    """v rotated by the quaternion q = (w, x, y, z)."""
    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    t = [2 * k for k in cross(q[1:], v)]
    return [x + q[0] * y + z for x, y, z in zip(v, t, cross(q[1:], t))]


def places(state, cells, rows):
    """{(element, n, m): (place, its turn)} of a tube whose axis is the y axis."""
    t1, t2 = state["roll"]["turn_rad"]
    axis = state["a1"][0] / t1  # the axis is this far below the origin
    result = {}
    for m in range(rows):
        for n in range(cells):
            for pose in state["poses"]:
                x, y, z = pose["position"]
                angle, shift = n * t1 + m * t2, n * state["a1"][1] + m * state["a2"][1]
                center = turned([x, y, z + axis], angle)
                result[pose["element"], n, m] = ([center[0], center[1] + shift, center[2]], angle)
    return result


def numbers(values):
    return "[" + ", ".join(repr(float(v)) for v in values) + "]"


def write_tube(path, design, state, cells, rows):
    """All rings of the tube as elements of a design whose lattice is so wide that it does not matter."""
    rotation = {pose["element"]: pose["rotation"] for pose in state["poses"]}
    rings = {element["name"]: element["rings"] for element in design["elements"]}
    out = ['schema = 1', 'name = "tube"', f'minor_radius = {design["minor_radius"]}',
           f'reference_radius = {design["reference_radius"]}', '[lattice]', 'a1 = [1e4, 0.0, 0.0]', 'a2 = [0.0, 1e4, 0.0]']
    for (name, n, m), (center, angle) in places(state, cells, rows).items():
        out += ["[[elements]]", f'name = "{name}-{n}-{m}"', f"center = {numbers(center)}"]
        parts = []
        for ring in rings[name]:
            normal, offset = (turned(rotated(rotation[name], ring[key]), angle) for key in ("normal", "offset"))
            wire = f', minor_radius = {ring["minor_radius"]}' if ring.get("minor_radius") else ""
            parts.append(f'{{ major_radius = {ring["major_radius"]}{wire}, normal = {numbers(normal)}, offset = {numbers(offset)} }}')
        out.append(f'rings = [{", ".join(parts)}]')
    path.write_text("\n".join(out) + "\n")


def pull(start, goal, held, m, beyond):
    """Arguments that move row m from its places in `start` to those in `goal`, and then by `beyond` along the axis."""
    fixed, arguments = [], []
    for (name, n, row), (place, _) in goal.items():
        if row == m and name in held:
            first = [b - a for a, b in zip(start[name, n, row][0], place)]
            second = [first[0], first[1] + beyond, first[2]]
            path = [vector for vector in (first, second) if any(abs(v) > 1e-9 for v in vector)]
            text = "/".join(",".join(f"{v:.12f}" for v in vector) for vector in path)
            if path:
                arguments.append(f"--pull={name}-{n}-{m}={text}")
            else:
                fixed.append(f"{name}-{n}-{m}")
    return ["--fix=" + ",".join(fixed)] * bool(fixed) + arguments


def heights(frame, held, rows):
    """Mean place along the axis of the elements of each row, of those kinds that are held in the end rows."""
    sums = [[0.0, 0] for _ in range(rows)]
    for pose in frame["poses"]:
        name, _, row = pose["element"].rsplit("-", 2)
        if name in held:
            sums[int(row)][0] += pose["position"][1]
            sums[int(row)][1] += 1
    return [total / count for total, count in sums]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("design")
    parser.add_argument("cells", type=int)
    parser.add_argument("rows")
    parser.add_argument("--alpha", default="1e4,1e5,1e6")
    parser.add_argument("--tau", default="0.002")
    parser.add_argument("--goal", default="longest", choices=["longest", "shortest"])
    parser.add_argument("--start", default="roomiest")
    parser.add_argument("--hold", help="elements that are held in the end rows, with commas [default: all]")
    parser.add_argument("--effort", default="low", help="of the exact search")
    parser.add_argument("--maille", default="maille")
    parser.add_argument("--work", type=Path, default=Path("tube-against-sheet"))
    arguments = parser.parse_args()

    cells, work = arguments.cells, arguments.work
    work.mkdir(parents=True, exist_ok=True)
    record = work / "roll"
    subprocess.run([arguments.maille, "roll", arguments.design, "--wrap", str(cells), "--axis", "below", "--threads", "1", "--effort", arguments.effort,
                    "--out", record, "--overwrite", "-q"], check=True)
    design = json.loads((record / "roll.json").read_text())["design"]
    lines = [json.loads(line) for line in (record / "rolls.jsonl").read_text().splitlines()]
    states = {line["sought"]: line for line in lines if "sought" in line}
    start, goal = states[arguments.start], states[arguments.goal]
    held = arguments.hold.split(",") if arguments.hold else [element["name"] for element in design["elements"]]
    written = design["lattice"]["a2"][1]
    sign = 1 if arguments.goal == "longest" else -1
    print(f"{arguments.design}, {cells} cells round: exact l2 of the {arguments.goal} tube {goal['l2']:.6f}, "
          f"of the start {start['l2']:.6f}, tau {arguments.tau}")
    print("rows   alpha  end     share  l2, whole    - exact l2, middle   - exact  radius   (exact)       gap links  iter.      s")
    for rows in map(int, arguments.rows.split(",")):
        write_tube(work / "tube.toml", design, start, cells, rows)
        first, last = places(start, cells, rows), places(goal, cells, rows)
        beyond = sign * 0.02 * written * (rows - 1)
        for alpha in arguments.alpha.split(","):
            # the first row stops at its places in the goal (share 0.5), the last one goes on
            moves = pull(first, last, held, 0, 0.0) + pull(first, last, held, rows - 1, beyond)
            result = work / f"{arguments.goal}-{rows}-{alpha}"
            command = [arguments.maille, "simulate", work / "tube.toml", "--tile", "1x1", "--alpha", alpha, "--tau", arguments.tau,
                       "--steps", "20", "--out", result, "--overwrite", "--json", *moves]
            run = subprocess.run(command, capture_output=True, text=True)
            if run.returncode not in (0, 5):
                raise SystemExit(run.stderr)
            outcome = json.loads(run.stdout)
            frame = json.loads((result / "frames.jsonl").read_text().splitlines()[-1])
            y = heights(frame, held, rows)
            first_row, last_row = rows // 4, rows - 1 - rows // 4
            whole = (y[-1] - y[0]) / (rows - 1) / written - 1
            middle = (y[last_row] - y[first_row]) / (last_row - first_row) / written - 1
            radius = [math.hypot(pose["position"][0], pose["position"][2]) for pose in frame["poses"]
                      if first_row <= int(pose["element"].rsplit("-", 1)[1]) <= last_row]
            end = outcome["outcome"]
            print(f"{rows:4} {alpha:>7}  {end['end']:<7} {end['share']:6.4f} {whole:9.6f} {whole - goal['l2']:+10.6f}  {middle:9.6f} "
                  f"{middle - goal['l2']:+10.6f}  {sum(radius) / len(radius):8.4f} {goal['neutral_radius']:8.4f} "
                  f"{end['smallest_gap']:10.1e} {str(end['links_ok']):>5} {end['iterations']:6} {outcome['wall_s']:6.1f}", flush=True)


main()
