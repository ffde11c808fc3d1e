"""The same questions to maille and to engines for rigid bodies, with the tables of docs/peers.md.

    pip install ./crates/maille-py -r validation/peers.txt
    python validation/peers.py [--write docs/peers.md] [--only "rapier,MuJoCo,MuJoCo torus,Bullet,Coal"] [--facets 32]

1. A pull with a known answer. A piece of design 1.1, 3 x 3 cells with free edges. The centres of the flat rings of
   the first column are held, those of the last are pulled along x, each with the same force. Taut chains along x are
   straight, so the stretch between the two columns is known: 2 (2R - 2r) / 2.5 R = 1.44 at r = 0.1 R. Each engine
   runs with nine settings: its default time step, a quarter of it and four times it; forces 1, 10 and 100. MuJoCo
   runs once more with its torus, and the default time step.
2. The same pull of European 4-in-1, 4 x 4 cells, with default time steps. maille simulate gives the stretch.
3. The gaps between random rings, against distances of meshes.

A ring is 32 capsules (--facets) with their ends on the core circle; only MuJoCo has a torus, a signed distance on which
it searches for contacts. R is 1. Bodies have mass 1, no friction, no gravity, and velocities decay as exp(-t). A run
ends when the stretch changes by less than 1e-6 in a unit of time, or after 40; it is stopped after two minutes. The
links and the smallest gap of the end are computed by maille, from the poses, for round rings. Times are processor times
of all threads; building a scene does not count.
"""
import argparse
import importlib.metadata
import math
import os
import platform
import sys
import tempfile
import time
from pathlib import Path

import maille
import numpy as np

TAUT = 1.44
FORCES = (1.0, 10.0, 100.0)
FINER = (4.0, 1.0, 0.25)  # the default time step, divided by these
MOST_S = 120.0  # of processor time, for one run
MARK = "<!-- made by `python validation/peers.py --write docs/peers.md` from here on -->"


class Piece:
    """A piece of cells x cells at the start, in units of R: names, centres, normals; which rings are held and pulled."""

    def __init__(self, design, cells, facets):
        self.design, self.cells, self.facets = maille.Design.of(design), cells, facets
        self.unit = self.design.reference_radius
        self.wire = self.design.minor_radius / self.unit
        self.names, centers, normals = [], [], []
        for j in range(cells):
            for i in range(cells):
                for element in self.design.elements:
                    self.names.append(f"{element.name}@{i},{j}")
                    centers.append(np.array(element.center) + i * np.array(self.design.a1) + j * np.array(self.design.a2))
                    normals.append(element.rings[0].normal)
        self.centers = np.array(centers) / self.unit
        self.normals = unit(np.array(normals))
        first = self.design.elements[0].name
        self.held = [k for k, name in enumerate(self.names) if name.startswith(f"{first}@0,")]
        self.pulled = [k for k, name in enumerate(self.names) if name.startswith(f"{first}@{cells - 1},")]
        self.width = (cells - 1) * self.design.a1[0] / self.unit
        self.links = self.linking(self.centers, self.normals)

    def pairs(self, function, centers, normals, *more):
        i, j = np.triu_indices(len(centers), 1)
        return function(centers[i], normals[i], 1.0, *more, centers[j], normals[j], 1.0, *more)

    def linking(self, centers, normals):
        return self.pairs(maille.geometry.linking_number, centers, normals)

    def stretch(self, x):
        return (x[self.pulled].mean() - x[self.held].mean()) / self.width

    def result(self, centers, normals):
        """Stretch, smallest gap, number of pairs whose linking number is not that of the start."""
        gap = self.pairs(maille.geometry.torus_gap, centers, normals, self.wire).min()
        return self.stretch(centers[:, 0]), gap, int((self.linking(centers, normals) != self.links).sum())

    def capsules(self, k):
        """The ends of ring k's capsules, relative to its centre."""
        n = self.normals[k]
        u = np.cross(n, [0.3, 0.5, 0.8])
        u /= np.linalg.norm(u)
        v = np.cross(n, u)
        at = np.arange(self.facets + 1) * 2 * math.pi / self.facets
        points = np.outer(np.cos(at), u) + np.outer(np.sin(at), v)
        return list(zip(points[:-1], points[1:]))


def words(numbers):
    return " ".join(repr(float(x)) for x in numbers)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def rotated(q, v):
    """Each vector rotated by its quaternion (w, x, y, z); single precision leaves these not quite unit ones."""
    q = unit(q)
    t = 2 * np.cross(q[:, 1:], v)
    return v + q[:, :1] * t + np.cross(q[:, 1:], t)


class Rapier:
    name, package, step_s = "rapier", "rapier3d", 1 / 60
    finer = FINER

    def __init__(self, piece, step_s, force):
        import rapier3d as rp

        self.piece, self.world, self.bodies = piece, rp.PhysicsWorld(), []
        self.world.set_num_threads(1)
        self.world.integration_parameters.dt = step_s
        for k, center in enumerate(piece.centers):
            builder = rp.RigidBody.dynamic().translation(tuple(center)).linear_damping(1.0).angular_damping(1.0)
            if k in piece.held:
                builder = builder.enabled_translations((False, False, False))
            body = self.world.add_body(builder.can_sleep(False))
            for a, b in piece.capsules(k):
                capsule = rp.Collider.capsule_from_endpoints(tuple(a), tuple(b), piece.wire).mass(1 / piece.facets).friction(0.0)
                self.world.add_collider(capsule, body)
            if k in piece.pulled:
                self.world.rigid_bodies[body].add_force((force, 0.0, 0.0))
            self.bodies.append(body)

    def step(self):
        self.world.step()

    def poses(self):
        bodies = [self.world.rigid_bodies[b] for b in self.bodies]
        q = np.array([(b.rotation.w, b.rotation.i, b.rotation.j, b.rotation.k) for b in bodies])
        centers = np.array([(b.translation.x, b.translation.y, b.translation.z) for b in bodies])
        return centers, rotated(q, self.piece.normals)


class Mujoco:
    name, package, step_s = "MuJoCo", "mujoco-core", 0.002
    finer = FINER

    def __init__(self, piece, step_s, force):
        import mujoco

        self.piece, self.mujoco = piece, mujoco
        bodies = []
        for k, center in enumerate(piece.centers):
            joint = f'<joint type="{"ball" if k in piece.held else "free"}" damping="1"/>'
            bodies.append(f'<body pos="{words(center)}">{joint}{self.ring(piece, k)}</body>')
        self.model = mujoco.MjModel.from_xml_string(
            f'<mujoco>{self.shapes(piece)}<option timestep="{step_s}" gravity="0 0 0"/><size memory="1G"/>'
            '<default><geom condim="1"/></default>'
            f'<worldbody>{"".join(bodies)}</worldbody></mujoco>')
        self.data = mujoco.MjData(self.model)
        for k in piece.pulled:
            self.data.xfrc_applied[k + 1, 0] = force  # body 0 is the world

    def shapes(self, piece):
        return ""

    def ring(self, piece, k):
        return "".join(
            f'<geom type="capsule" size="{piece.wire}" mass="{1 / piece.facets}" fromto="{words((*a, *b))}"/>'
            for a, b in piece.capsules(k))

    def step(self):
        self.mujoco.mj_step(self.model, self.data)

    def poses(self):
        return self.data.xpos[1:].copy(), rotated(self.data.xquat[1:], self.piece.normals)


class MujocoTorus(Mujoco):
    name = "MuJoCo torus"
    finer = (1.0,)  # it is slow

    def shapes(self, piece):
        size = f'<config key="radius1" value="1"/><config key="radius2" value="{piece.wire}"/>'
        return ('<extension><plugin plugin="mujoco.sdf.torus">'
                f'<instance name="ring">{size}</instance></plugin></extension>'
                '<asset><mesh name="ring"><plugin instance="ring"/></mesh></asset>')

    def ring(self, piece, k):
        axis = words(piece.normals[k])
        return f'<geom type="sdf" mesh="ring" mass="1" zaxis="{axis}"><plugin instance="ring"/></geom>'


class Bullet:
    name, package, step_s = "Bullet", "pybullet", 1 / 240
    finer = FINER

    def __init__(self, piece, step_s, force):
        import pybullet

        self.piece, self.bullet, self.force = piece, pybullet, force
        pybullet.resetSimulation() if pybullet.isConnected() else pybullet.connect(pybullet.DIRECT)
        pybullet.setTimeStep(step_s)
        self.bodies = []
        with tempfile.TemporaryDirectory() as folder:
            for k, center in enumerate(piece.centers):
                path = Path(folder) / f"{k}.urdf"
                path.write_text(self.urdf(piece, k))
                body = pybullet.loadURDF(str(path), basePosition=list(center))
                if k in piece.held:
                    pybullet.createConstraint(body, -1, -1, -1, pybullet.JOINT_POINT2POINT, [0] * 3, [0] * 3, list(center))
                decay = 1 - math.exp(-1)  # Bullet keeps (1 - damping)^dt of a velocity
                pybullet.changeDynamics(body, -1, lateralFriction=0, linearDamping=decay, angularDamping=decay)
                self.bodies.append(body)

    @staticmethod
    def urdf(piece, k):
        pieces = []
        for a, b in piece.capsules(k):
            d, middle = b - a, (a + b) / 2
            length = math.dist(a, b)
            turn = f"0 {math.acos(d[2] / length)} {math.atan2(d[1], d[0])}"
            place = words(middle)
            pieces.append(f'<collision><origin xyz="{place}" rpy="{turn}"/><geometry>'
                          f'<capsule radius="{piece.wire}" length="{length}"/></geometry></collision>')
        return ('<robot name="ring"><link name="ring"><inertial><mass value="1"/>'
                '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
                f'{"".join(pieces)}</link></robot>')

    def step(self):
        for k in self.piece.pulled:
            at, _ = self.bullet.getBasePositionAndOrientation(self.bodies[k])
            self.bullet.applyExternalForce(self.bodies[k], -1, [self.force, 0, 0], at, self.bullet.WORLD_FRAME)
        self.bullet.stepSimulation()

    def poses(self):
        found = [self.bullet.getBasePositionAndOrientation(b) for b in self.bodies]
        q = np.array([(w, x, y, z) for _, (x, y, z, w) in found])
        return np.array([at for at, _ in found]), rotated(q, self.piece.normals)


def run(engine, piece, step_s, force):
    """One run of an engine: stretch, gap, lost links, seconds, and how it ended if not at rest."""
    scene = engine(piece, step_s, force)
    before, spent = math.nan, 0.0
    for _ in range(40):
        begun = time.process_time()
        for _ in range(round(1 / step_s)):
            scene.step()
        spent += time.process_time() - begun
        stretch, gap, lost = piece.result(*scene.poses())
        if abs(stretch - before) < 1e-6:
            return stretch, gap, lost, spent, ""
        if spent > MOST_S:
            return stretch, gap, lost, spent, ", stopped"
        before = stretch
    return stretch, gap, lost, spent, ", still moving"


def simulated(piece):
    """What maille simulate makes of the piece: stretch, gap, lost links, seconds. The force is a ten-thousandth of its stiffness."""
    pulled = {piece.names[k]: (0.1, 0, 0) for k in piece.pulled}
    begun = time.process_time()
    held = [piece.names[k] for k in piece.held]
    sheet = maille.simulate(piece.design, (piece.cells, piece.cells), fix=held, force=pulled, steps=1)
    spent = time.process_time() - begun
    if sheet.end != "reached" or not sheet.links_ok:
        raise SystemExit(f"maille simulate ended {sheet.end}, links kept: {sheet.links_ok}")
    at = {name: k for k, name in enumerate(sheet.elements)}
    x = sheet.position[-1, [at[name] for name in piece.names], 0] / piece.unit
    return piece.stretch(x), sheet.smallest_gap / piece.unit, 0, spent


def limit():
    """The limit of the periodic sheet 1.1 along x: its status, and the values of a row; the time is the median of 21."""
    times = []
    for _ in range(21):
        begun = time.process_time()
        record = maille.characterize("1.1", directions=[0], l2=[0])
        times.append(time.process_time() - begun)
    columns = record.to_numpy()
    return columns["status"][0], (1 + columns["l1"][0], columns["min_gap"][0], 0, float(np.median(times)))


def pulls(engines, piece, every_step, known=None):
    """The table of a pull. Without a known stretch, that of maille simulate is compared with."""
    own = simulated(piece)
    known = own[0] if known is None else known
    rows = [["tool", "setting", "stretch", "error", "smallest gap / R", "links lost", "time", "/ `maille simulate`"]]

    def add(tool, setting, stretch, gap, lost, spent):
        error = f"{100 * (stretch / known - 1):+.3f} %" if lost == 0 else "wrong"
        rows.append([tool, setting, f"{stretch:.5f}", error, f"{gap:.5f}", str(lost), seconds(spent), ratio(spent / own[3])])
        print("  ".join(rows[-1]), file=sys.stderr, flush=True)

    if known is TAUT:
        status, values = limit()
        add("`maille characterize`", f"the periodic sheet, `{status}`", *values)
    add("`maille simulate`", "the piece", *own)
    for engine in engines:
        for share in engine.finer if every_step else (1.0,):
            for force in FORCES:
                *found, end = run(engine, piece, engine.step_s / share, force)
                add(engine.name, f"step 1/{share / engine.step_s:.0f}, force {force:g}" + end, *found)
    return rows


def gaps(count=2000):
    """The table of gaps: random rings of r = 0.1 R with centres less than 3 R apart, none overlapping."""
    import coal

    rng = np.random.default_rng(1)
    center = unit(rng.normal(size=(4 * count, 3))) * rng.uniform(0, 3, (4 * count, 1))
    one, two = unit(rng.normal(size=(4 * count, 3))), unit(rng.normal(size=(4 * count, 3)))
    zero, wire = np.zeros(3), 0.1

    def exact(one, two, center):
        return maille.geometry.torus_gap(zero, one, 1.0, wire, center, two, 1.0, wire)

    kept = np.flatnonzero(exact(one, two, center) > 1e-3)[:count]
    one, two, center = one[kept], two[kept], center[kept]
    wanted, times = exact(one, two, center), []
    for _ in range(21):
        begun = time.process_time()
        exact(one, two, center)
        times.append((time.process_time() - begun) / count)
    own = float(np.median(times))
    rows = [["tool", "ring", "median error / R", "largest error / R", "time of a pair", "/ `maille`"]]
    rows.append(["`maille.geometry.torus_gap`", "exact", "0", "0", seconds(own), "1"])
    for around, across in ((32, 12), (64, 24), (128, 48)):
        mesh = torus(coal, wire, around, across)
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        frames = [(coal.Transform3s(frame(a), zero), coal.Transform3s(frame(b), c)) for a, b, c in zip(one, two, center)]
        found, begun = np.empty(count), time.process_time()
        for k, (a, b) in enumerate(frames):
            result.clear()
            found[k] = coal.distance(mesh, a, mesh, b, request, result)
        spent = (time.process_time() - begun) / count
        error = np.abs(found - wanted)
        rows.append(["Coal", f"mesh of {around} × {across}", f"{np.median(error):.2g}", f"{error.max():.2g}",
                     seconds(spent), ratio(spent / own)])
        print("  ".join(rows[-1]), file=sys.stderr, flush=True)
    return rows


def torus(coal, wire, around, across):
    """The mesh of a torus about z, corners on its surface."""
    u, v = np.meshgrid(np.arange(around) * 2 * math.pi / around, np.arange(across) * 2 * math.pi / across, indexing="ij")
    r = 1 + wire * np.cos(v)
    points = np.stack([r * np.cos(u), r * np.sin(u), wire * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = (i * across + j).ravel(), ((i + 1) % around * across + j).ravel()
    c, d = ((i + 1) % around * across + (j + 1) % across).ravel(), (i * across + (j + 1) % across).ravel()
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(2 * around * across, around * across)
    mesh.addVertices(points)
    mesh.addTriangles(np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]))
    mesh.endModel()
    return mesh


def frame(normal):
    """A rotation that turns z to the normal."""
    u = unit(np.cross(normal, np.eye(3)[np.abs(normal).argmin()]))
    return np.stack([u, np.cross(normal, u), normal], axis=1)


def seconds(time_s):
    """Three digits with a unit."""
    for unit_s, name in ((1, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if time_s >= unit_s:
            return f"{time_s / unit_s:.3g} {name}"
    return f"{time_s / 1e-9:.3g} ns"


def ratio(value):
    return f"{value:,.0f}" if value >= 10 else f"{value:.2g}"


def markdown(rows):
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join([lines[0], "| --- | --- |" + " ---: |" * (len(rows[0]) - 2), *lines[1:]])


def cpu():
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.machine()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="rapier,MuJoCo,MuJoCo torus,Bullet,Coal")
    parser.add_argument("--facets", type=int, default=32, help="capsules of a ring [default: 32]")
    parser.add_argument("--write", type=Path, help="the page whose tables to make anew")
    asked = parser.parse_args()
    only = asked.only.split(",")
    engines = [engine for engine in (Rapier, Mujoco, MujocoTorus, Bullet) if engine.name in only]
    packages = {engine.name.removesuffix(" torus"): engine.package for engine in engines}
    packages |= {"Coal": "coal"} if "Coal" in only else {}
    versions = ", ".join(f"{name} {importlib.metadata.version(package)}" for name, package in packages.items())
    text = f"maille {maille.__version__}, {versions}; Python {platform.python_version()}, {os.cpu_count()} cores of {cpu()}.\n"
    if engines:
        text += "\n## A grid of rings\n\n" + markdown(pulls(engines, Piece("1.1", 3, asked.facets), True, TAUT)) + "\n"
        text += "\n## A dense weave\n\n" + markdown(pulls(engines, Piece("european-4-in-1", 4, asked.facets), False)) + "\n"
    if "Coal" in only:
        text += "\n## The gap between two rings\n\n" + markdown(gaps()) + "\n"
    if asked.write is None:
        print(text)
        return
    before, mark, _ = asked.write.read_text().partition(MARK)
    if not mark:
        raise SystemExit(f"{asked.write} has no line `{MARK}`")
    new = asked.write.with_name(asked.write.name + ".new")
    new.write_text(f"{before}{MARK}\n\n{text}")
    new.replace(asked.write)


if __name__ == "__main__":
    main()
