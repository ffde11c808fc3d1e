"""Linking matrix of every frame of a simulated sheet, worked out without maille.

    python links.py FOLDER [--matrix links.csv]

Reads simulation.json and frames.jsonl. Two rings are linked where one of them passes through the disk of the other: the
signs of its passages are added up for every pair of rings that is near enough. Says for each frame how many pairs are
linked and whether the matrix is that of the first frame; ends with exit code 1 if one is not. Needs NumPy.
"""

import argparse
import json
import pathlib
import sys

import numpy as np


def rings_of(design, poses):
    """Centres (N, 3), unit normals (N, 3) and radii (N,) of all rings of a frame."""
    kinds = {element["name"]: element["rings"] for element in design["elements"]}
    rings = [(pose, ring) for pose in poses for ring in kinds[pose["element"].split("@")[0]]]
    turn = np.array([pose["rotation"] for pose, _ in rings])
    centres = np.array([pose["position"] for pose, _ in rings])
    centres = centres + turned(turn, np.array([ring["offset"] for _, ring in rings]))
    normals = turned(turn, np.array([ring["normal"] for _, ring in rings]))
    radii = np.array([ring["major_radius"] for _, ring in rings])
    return centres, normals / np.linalg.norm(normals, axis=1)[:, None], radii


def turned(quaternions, vectors):
    """Each vector, turned by its unit quaternion (w, x, y, z)."""
    w, axis = quaternions[:, :1], quaternions[:, 1:]
    return vectors + 2.0 * np.cross(axis, np.cross(axis, vectors) + w * vectors)


def near_pairs(centres, reach):
    """Pairs (i < j) of points at most `reach` apart, by a grid."""
    boxes = {}
    for index, box in enumerate(map(tuple, np.floor(centres / reach).astype(int))):
        boxes.setdefault(box, []).append(index)
    pairs = []
    for box, here in boxes.items():
        around = [box[0] + np.arange(-1, 2), box[1] + np.arange(-1, 2), box[2] + np.arange(-1, 2)]
        there = [j for x in around[0] for y in around[1] for z in around[2] for j in boxes.get((x, y, z), ())]
        pairs.extend((i, j) for i in here for j in there if i < j)
    pairs = np.array(sorted(pairs))
    apart = np.linalg.norm(centres[pairs[:, 0]] - centres[pairs[:, 1]], axis=1)
    return pairs[apart <= reach]


def linking_numbers(rings, pairs):
    """Passages of the second ring of each pair through the disk of the first, signed and added up."""
    centres, normals, radii = rings
    (a, b) = pairs.T
    # The second ring is c + r (u cos t + v sin t); its height over the plane of the first is h + r |s| cos(t - t0).
    helper = np.where(np.abs(normals[b, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    u = np.cross(normals[b], helper)
    u /= np.linalg.norm(u, axis=1)[:, None]
    v = np.cross(normals[b], u)
    dot = lambda x, y: np.einsum("ij,ij->i", x, y)
    height = dot(centres[b] - centres[a], normals[a])
    along_u, along_v = dot(u, normals[a]) * radii[b], dot(v, normals[a]) * radii[b]
    swing = np.hypot(along_u, along_v)
    crosses = np.abs(height) < swing
    cosine = np.divide(-height, swing, out=np.zeros_like(height), where=crosses)
    total = np.zeros(len(pairs), dtype=int)
    for side in (1, -1):
        t = np.arctan2(along_v, along_u) + side * np.arccos(cosine)
        point = centres[b] + radii[b][:, None] * (u * np.cos(t)[:, None] + v * np.sin(t)[:, None])
        inside = crosses & (np.linalg.norm(point - centres[a], axis=1) < radii[a])
        total[inside] -= side  # after the crest the ring goes down, before it up
    return total


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--matrix", type=pathlib.Path, help="write the linked pairs of first, middle and last frame")
    options = parser.parse_args()
    design = json.loads((options.folder / "simulation.json").read_text())["design"]
    frames = [json.loads(line) for line in (options.folder / "frames.jsonl").read_text().splitlines()]
    matrices, changed = [], 0
    for number, frame in enumerate(frames):
        rings = rings_of(design, frame["poses"])
        pairs = near_pairs(rings[0], 2.0 * rings[2].max())
        numbers = linking_numbers(rings, pairs)
        matrices.append({tuple(pair): n for pair, n in zip(pairs[numbers != 0].tolist(), numbers[numbers != 0].tolist())})
        same = matrices[-1] == matrices[0]
        changed += not same
        height = np.ptp(rings[0][:, 2])
        width = np.ptp(rings[0][:, 0])
        print(
            f"frame {number:3}: {len(rings[2])} rings, {len(pairs)} near pairs, {len(matrices[-1])} linked, "
            f"width {width:.1f}, height {height:.1f}: {'as at first' if same else 'CHANGED'}"
        )
    if options.matrix:
        shown = [0, len(matrices) // 2, len(matrices) - 1]
        lines = ["ring_a,ring_b," + ",".join(f"frame_{k}" for k in shown)]
        for pair in sorted(set().union(*(matrices[k] for k in shown))):
            lines.append(f"{pair[0]},{pair[1]}," + ",".join(str(matrices[k].get(pair, 0)) for k in shown))
        options.matrix.write_text("\n".join(lines) + "\n")
    print(f"{changed} of {len(frames)} frames have other links than the first")
    sys.exit(1 if changed else 0)


main()
