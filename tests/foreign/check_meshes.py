"""What other programs make of the exported meshes: `python check_meshes.py FOLDER`, which holds expected.json.

expected.json is a list of exports: the beginning of the files' names, the count of rings, elements, shapes and contacts,
the volume of the exact tori (2 pi^2 R r^2 each) with a relative tolerance, and the box, all in millimetres.
"""

import json
import sys
import xml.etree.ElementTree
from pathlib import Path

import lib3mf
import numpy as np
import trimesh
from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkMassProperties, vtkPolyDataConnectivityFilter, vtkTriangleFilter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader


def check(name, holds, found):
    if not holds:
        raise SystemExit(f"FAILED {name}: found {found}")


def check_box(name, box, wanted, scale=1.0):
    size = np.max(np.subtract(wanted[1], wanted[0])) * scale
    check(f"{name}: box", np.allclose(box, np.multiply(wanted, scale), atol=0.01 * size), np.asarray(box).tolist())


def check_volume(name, volume, wanted, tolerance):
    # The mesh is inscribed, so it lacks a little and never exceeds.
    check(f"{name}: volume (torus: {wanted})", wanted * (1 - tolerance) < volume < wanted * (1 + 1e-6), volume)


def check_trimesh(name, mesh, expected, scale=1.0):
    check(f"{name}: watertight", mesh.is_watertight, mesh)
    check(f"{name}: winding", mesh.is_winding_consistent, mesh)
    faces = np.arange(len(mesh.faces))
    bodies = trimesh.graph.connected_components(mesh.face_adjacency, nodes=faces, engine="networkx")
    check(f"{name}: bodies", len(bodies) == expected["rings"], len(bodies))
    check_volume(name, mesh.volume / scale**3, expected["volume"], expected["volume_tolerance"])


def baked(prefix, expected):
    for ending in ["stl", "obj", "ply"]:
        name = f"{prefix}.{ending}"
        mesh = trimesh.load_mesh(name)
        if isinstance(mesh, trimesh.Scene):
            mesh = mesh.to_mesh()
        check_trimesh(name, mesh, expected)
        check_box(name, mesh.bounds, [[0, 0, 0], np.subtract(*expected["box"][::-1])])


def glb(prefix, expected):
    name = f"{prefix}.glb"
    scene = trimesh.load_scene(name)
    nodes = scene.graph.nodes_geometry
    check(f"{name}: nodes with a mesh", len(nodes) == expected["rings"], len(nodes))
    check(f"{name}: meshes", len(scene.geometry) == expected["glb_meshes"], len(scene.geometry))
    # trimesh keeps the vertices of a file apart only if told so; bodies are counted after the nodes are placed.
    mesh = scene.to_mesh()
    mesh.merge_vertices()
    check_trimesh(name, mesh, expected, 0.001)
    # glTF is y up: (x, y, z) is our (x, z, -y).
    x, y, z = np.subtract(*expected["box"][::-1])
    check_box(name, mesh.bounds, [[0, 0, -y], [x, z, 0]], 0.001)


def transform(t):
    """lib3mf's transform, columns by rows, as a 4 x 4 matrix for column vectors."""
    m = np.eye(4)
    for column in range(4):
        for row in range(3):
            m[row, column] = t.Fields[column][row]
    return m


def concrete(model, thing):
    """lib3mf hands out a base class; the model knows what it is."""
    number = thing.GetResourceID()
    return model.GetMeshObjectByID(number) if thing.IsMeshObject() else model.GetComponentsObjectByID(number)


def three_mf(prefix, expected):
    for objects, items in [("element", expected["elements"]), ("ring", expected["rings"]), ("sheet", 1)]:
        name = f"{prefix}-{objects}.3mf"
        wrapper = lib3mf.get_wrapper()
        model = wrapper.CreateModel()
        reader = model.QueryReader("3mf")
        reader.SetStrictModeActive(True)
        reader.ReadFromFile(name)
        warnings = [reader.GetWarning(k) for k in range(reader.GetWarningCount())]
        check(f"{name}: warnings", not warnings, warnings)
        check(f"{name}: unit", model.GetUnit() == lib3mf.ModelUnit.MilliMeter, model.GetUnit())
        meshes = {}
        iterator = model.GetMeshObjects()
        while iterator.MoveNext():
            mesh = iterator.GetCurrentMeshObject()
            check(f"{name}: manifold and outward", mesh.IsManifoldAndOriented(), mesh.GetName())
            check(f"{name}: valid", mesh.IsValid(), mesh.GetName())
            vertices = np.array([list(v.Coordinates) for v in mesh.GetVertices()])
            faces = np.array([list(t.Indices) for t in mesh.GetTriangleIndices()])
            meshes[mesh.GetResourceID()] = trimesh.Trimesh(vertices, faces, process=False)
        check(f"{name}: meshes", len(meshes) == expected["shapes"], len(meshes))
        volume, count, found_items, corners = 0.0, 0, 0, []
        iterator = model.GetBuildItems()
        while iterator.MoveNext():
            item = iterator.GetCurrent()
            found_items += 1
            matrix = transform(item.GetObjectTransform()) if item.HasObjectTransform() else np.eye(4)
            stack = [(concrete(model, item.GetObjectResource()), matrix)]
            while stack:
                thing, matrix = stack.pop()
                if thing.IsMeshObject():
                    mesh = meshes[thing.GetResourceID()]
                    check(f"{name}: rigid", abs(np.linalg.det(matrix[:3, :3]) - 1) < 1e-5, matrix)
                    count += 1
                    volume += mesh.volume
                    points = trimesh.transform_points(mesh.vertices, matrix)
                    corners += [points.min(axis=0), points.max(axis=0)]
                    continue
                for k in range(thing.GetComponentCount()):
                    component = thing.GetComponent(k)
                    inner = transform(component.GetTransform()) if component.HasTransform() else np.eye(4)
                    stack.append((concrete(model, component.GetObjectResource()), matrix @ inner))
        check(f"{name}: items", found_items == items, found_items)
        check(f"{name}: rings", count == expected["rings"], count)
        check_volume(name, volume, expected["volume"], expected["volume_tolerance"])
        # Moved into the positive octant.
        size = np.subtract(expected["box"][1], expected["box"][0])
        check_box(name, [np.min(corners, axis=0), np.max(corners, axis=0)], [[0, 0, 0], size])


def read_vtk(name):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(name)
    reader.Update()
    check(f"{name}: read", reader.GetErrorCode() == 0, reader.GetErrorCode())
    return reader.GetOutput()


def vtk(prefix, expected):
    name = f"{prefix}.vtp"
    data = read_vtk(name)
    arrays = {data.GetCellData().GetArrayName(k) for k in range(data.GetCellData().GetNumberOfArrays())}
    check(f"{name}: arrays", {"ring", "element", "kind", "cell_1", "cell_2"} <= arrays, arrays)
    check(f"{name}: elements", data.GetCellData().GetArray("element").GetRange() == (0, expected["elements"] - 1), data)
    check(f"{name}: normals", data.GetPointData().GetArray("Normals").GetNumberOfComponents() == 3, data)
    edges = vtkFeatureEdges()
    edges.SetInputData(data)
    edges.BoundaryEdgesOn()
    edges.NonManifoldEdgesOn()
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.Update()
    check(f"{name}: open edges", edges.GetOutput().GetNumberOfCells() == 0, edges.GetOutput().GetNumberOfCells())
    triangles = vtkTriangleFilter()
    triangles.SetInputData(data)
    triangles.Update()
    mass = vtkMassProperties()
    mass.SetInputData(triangles.GetOutput())
    mass.Update()
    check_volume(name, mass.GetVolume(), expected["volume"], expected["volume_tolerance"])
    bodies = vtkPolyDataConnectivityFilter()
    bodies.SetInputData(data)
    bodies.SetExtractionModeToAllRegions()
    bodies.Update()
    check(f"{name}: bodies", bodies.GetNumberOfExtractedRegions() == expected["rings"], bodies.GetNumberOfExtractedRegions())
    b = data.GetBounds()
    check_box(name, [b[0::2], b[1::2]], expected["box"])

    name = f"{prefix}-poses.vtp"
    data = read_vtk(name)
    check(f"{name}: points", data.GetNumberOfPoints() == expected["rings"], data.GetNumberOfPoints())
    check(f"{name}: vertices", data.GetNumberOfVerts() == expected["rings"], data.GetNumberOfVerts())
    big, small = (data.GetPointData().GetArray(k) for k in "Rr")
    volume = sum(2 * np.pi**2 * big.GetValue(k) * small.GetValue(k) ** 2 for k in range(expected["rings"]))
    check(f"{name}: radii", abs(volume / expected["volume"] - 1) < 1e-5, volume)
    lengths = [np.linalg.norm(data.GetPointData().GetArray("normal").GetTuple(k)) for k in range(expected["rings"])]
    check(f"{name}: normals", np.allclose(lengths, 1, atol=1e-6), lengths)

    if expected["contacts"]:
        name = f"{prefix}-contacts.vtp"
        data = read_vtk(name)
        check(f"{name}: points", data.GetNumberOfPoints() == expected["contacts"], data.GetNumberOfPoints())
        force = data.GetPointData().GetArray("force")
        total = sum(np.linalg.norm(force.GetTuple(k)) for k in range(expected["contacts"]))
        check(f"{name}: forces", abs(total - expected["force"]) < 1e-5 * total, total)


def series(folder):
    for path in sorted(folder.glob("*.pvd")):
        files = [entry.get("file") for entry in xml.etree.ElementTree.parse(path).iter("DataSet")]
        check(f"{path}: files", files and all((folder / file).is_file() for file in files), files)


def main():
    folder = Path(sys.argv[1])
    for expected in json.loads((folder / "expected.json").read_text()):
        prefix = str(folder / expected["name"])
        for reader in [baked, glb, three_mf, vtk]:
            reader(prefix, expected)
        print(f"{expected['name']}: {expected['rings']} rings are watertight, outward, of the right volume and place")
    series(folder)


main()
