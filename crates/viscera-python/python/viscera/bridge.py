"""Meshes and fields for other packages, where they are installed: meshio, pyvista, matplotlib, scipy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ._viscera import HexMesh, SimulatedBody, SurfaceMesh, TetMesh, VolumeMesh

_VTK_TRIANGLE, _VTK_TETRAHEDRON, _VTK_HEXAHEDRON = 5, 10, 12
#: What the names of fields begin with that are a region in pyvista, which has no sets of its own.
_REGION = "region: "


def _need(package: str, extra: str):
    """The package, or an error that says how to install it."""
    from importlib import import_module

    try:
        return import_module(package)
    except ImportError as error:
        message = f"this needs {package}, which is not installed: `pip install viscera[{extra}]`"
        raise ImportError(message) from error


@dataclass
class _Shape:
    """What other packages are told of a mesh, a surface or a body."""

    points: np.ndarray
    #: Corners of the cells that are left.
    cells: np.ndarray
    #: "tetra", "hexahedron" or "triangle".
    kind: str
    #: Which cells of the mesh these are.
    left: np.ndarray
    #: For each region its nodes, and its cells among those that are left.
    regions: dict[str, tuple[np.ndarray, np.ndarray]]


def _shape(mesh: VolumeMesh | SurfaceMesh | SimulatedBody) -> _Shape:
    if isinstance(mesh, SurfaceMesh):
        return _Shape(np.array(mesh.nodes), mesh.triangles.astype(np.int64), "triangle", np.full(len(mesh), True), {})
    body = mesh if isinstance(mesh, SimulatedBody) else None
    rest = body.mesh if body else mesh
    if not isinstance(rest, VolumeMesh):
        raise TypeError(f"a mesh, a surface or a body of a world is needed, and this is of type {type(mesh).__name__}")
    left = ~body.removed if body else np.full(len(rest), True)
    number = np.cumsum(left) - 1
    regions = {}
    for name, parts in rest.regions.items():
        cells = parts["cells"]
        regions[name] = (parts["nodes"], number[cells[left[cells]]])
    points = np.array(body.positions if body else rest.nodes, dtype=float)
    kind = "tetra" if isinstance(rest, TetMesh) else "hexahedron"
    return _Shape(points, rest.cells[left].astype(np.int64), kind, left, regions)


def _of_cells(shape: _Shape, name: str, values: Any) -> np.ndarray:
    """One value for each cell that is left, from one for each cell of the mesh."""
    values = np.asarray(values)
    if len(values) != len(shape.left):
        raise ValueError(f"cell_data `{name}` has {len(values)} values, and the mesh has {len(shape.left)} cells")
    return values[shape.left]


def to_meshio(mesh: VolumeMesh | SurfaceMesh | SimulatedBody, point_data: dict | None = None, cell_data: dict | None = None):
    """A `meshio.Mesh` of a mesh at rest, of a surface, or of a body as it is now without the cells that are cut away.

    Regions become sets of points and of cells. `point_data` and `cell_data` are arrays by name, one row for each node or each cell of the
    mesh, cut or not [in the caller's units].
    """
    meshio = _need("meshio", "mesh")
    shape = _shape(mesh)
    fields = {name: [_of_cells(shape, name, values)] for name, values in (cell_data or {}).items()}
    points = {name: nodes for name, (nodes, _) in shape.regions.items()}
    cells = {name: [cells] for name, (_, cells) in shape.regions.items() if len(cells)}
    return meshio.Mesh(
        shape.points, [(shape.kind, shape.cells)], point_data=point_data or {}, cell_data=fields, point_sets=points, cell_sets=cells
    )


def from_meshio(mesh, scale: float = 1.0) -> TetMesh | HexMesh | SurfaceMesh:
    """The mesh of a `meshio.Mesh`: its tetrahedra, or else its hexahedra, or else its triangles; `scale` is its unit [m].

    Sets of points and of cells become regions. Nodes of no cell are left out by `checked`.
    """
    points = np.asarray(mesh.points, dtype=float) * scale
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    cells = {kind: mesh.get_cells_type(kind) for kind in ("tetra", "hexahedron", "triangle")}
    kind = next((kind for kind, corners in cells.items() if len(corners)), None)
    if kind is None:
        raise ValueError("the mesh has neither tetrahedra nor hexahedra nor triangles of first order")
    nodes = {name: np.asarray(numbers) for name, numbers in (mesh.point_sets or {}).items()}
    numbers = {name: sets[kind] for name, sets in (mesh.cell_sets_dict if mesh.cell_sets else {}).items() if kind in sets}
    return _made(kind, points, cells[kind], nodes, numbers)


def _made(kind: str, points, corners, nodes: dict, cells: dict) -> TetMesh | HexMesh | SurfaceMesh:
    """A mesh of this kind, with regions of these nodes and cells by name."""
    if kind == "triangle":
        return SurfaceMesh(points, corners)
    regions = {}
    for name in [*nodes, *(name for name in cells if name not in nodes)]:
        numbers = np.asarray(cells.get(name, []), dtype=np.int64)
        # Where only cells are named, the region's nodes are their corners.
        regions[name] = {"nodes": nodes.get(name, np.unique(np.asarray(corners)[numbers])), "cells": numbers}
    return (TetMesh if kind == "tetra" else HexMesh)(points, corners, regions)


def to_pyvista(mesh: VolumeMesh | SurfaceMesh | SimulatedBody, point_data: dict | None = None, cell_data: dict | None = None):
    """A `pyvista.UnstructuredGrid` of a mesh at rest, or of a body as it is now without the cells that are cut away; a `pyvista.PolyData`
    of a surface.

    Regions become fields of truth values whose names begin with "region: ", of points and of cells. `point_data` and `cell_data` are as for
    `to_meshio`.
    """
    pyvista = _need("pyvista", "mesh")
    shape = _shape(mesh)
    if shape.kind == "triangle":
        grid = pyvista.PolyData(shape.points, np.insert(shape.cells, 0, 3, axis=1).ravel())
    else:
        grid = pyvista.UnstructuredGrid({_VTK_TETRAHEDRON if shape.kind == "tetra" else _VTK_HEXAHEDRON: shape.cells}, shape.points)
    for name, (nodes, cells) in shape.regions.items():
        grid.point_data[_REGION + name] = np.isin(np.arange(len(shape.points)), nodes)
        if len(cells):
            grid.cell_data[_REGION + name] = np.isin(np.arange(len(shape.cells)), cells)
    for name, values in (point_data or {}).items():
        grid.point_data[name] = values
    for name, values in (cell_data or {}).items():
        grid.cell_data[name] = _of_cells(shape, name, values)
    return grid


def from_pyvista(grid, scale: float = 1.0) -> TetMesh | HexMesh | SurfaceMesh:
    """The mesh of a `pyvista.UnstructuredGrid`: its tetrahedra, or else its hexahedra, or else its triangles; or the surface of a
    `pyvista.PolyData`, polygons cut into triangles. `scale` is its unit [m]. Fields whose names begin with "region: " become regions.
    """
    points = np.asarray(grid.points, dtype=float) * scale
    if hasattr(grid, "triangulate") and not hasattr(grid, "cells_dict"):
        corners = np.asarray(grid.triangulate().faces).reshape(-1, 4)[:, 1:]
        if not len(corners):
            raise ValueError("the surface has no polygons")
        return SurfaceMesh(points, corners)
    cells = grid.cells_dict
    known = {"tetra": _VTK_TETRAHEDRON, "hexahedron": _VTK_HEXAHEDRON, "triangle": _VTK_TRIANGLE}
    kind = next((kind for kind, number in known.items() if number in cells), None)
    if kind is None:
        raise ValueError("the grid has neither tetrahedra nor hexahedra nor triangles of first order")
    of_kind = np.asarray(grid.celltypes) == known[kind]
    nodes, numbers = (
        {
            name.removeprefix(_REGION): np.flatnonzero(np.asarray(data[name])[among])
            for name in data.keys()
            if name.startswith(_REGION)
        }
        for data, among in ((grid.point_data, slice(None)), (grid.cell_data, of_kind))
    )
    return _made(kind, points, cells[known[kind]], nodes, numbers)


def stiffness(model, x):
    """K(x) [N/m] of a `ForceModel` or a `SimulatedBody` at positions `x` [m, shape (n, 3)], as a CSR matrix of scipy's of size 3n."""
    sparse = _need("scipy.sparse", "sparse")
    rows, columns, blocks = model.blocks(x)
    size = 3 * len(x)
    row = (3 * rows[:, None, None].astype(np.int64) + np.arange(3)[None, :, None]) + np.zeros((1, 1, 3), dtype=np.int64)
    column = (3 * columns[:, None, None].astype(np.int64) + np.arange(3)[None, None, :]) + np.zeros((1, 3, 1), dtype=np.int64)
    return sparse.coo_matrix((blocks.ravel(), (row.ravel(), column.ravel())), shape=(size, size)).tocsr()


def plot(
    body: SimulatedBody | VolumeMesh | SurfaceMesh,
    field=None,
    *,
    title: str | None = None,
    label: str | None = None,
    axes=None,
    path=None,
):
    """Draws the surface of a body (or mesh) with matplotlib, coloured by `field`, and gives the axes.

    `field`: None (plain), an array with one value for each node or cell, or of a body "displacement" [mm], "von-mises" [kPa], "volume" [%].
    With `path` the picture is written there as well.
    """
    _need("matplotlib", "plot")
    from matplotlib import cm, colormaps, colors, pyplot
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    corners: np.ndarray
    if isinstance(body, SimulatedBody):
        points, corners, triangles = np.asarray(body.positions, dtype=float), body.mesh.cells, body.surface()[0]
    elif isinstance(body, SurfaceMesh):
        points, corners, triangles = body.nodes, body.triangles, body.triangles
    elif isinstance(body, VolumeMesh):
        points, corners, triangles = body.nodes, body.cells, body.surface().triangles
    else:
        raise TypeError(f"a body of a world, a mesh or a surface is drawn, and this is of type {type(body).__name__}")
    values, unit = _field(body, corners, len(points), field)
    if axes is None:
        axes = pyplot.figure(figsize=(7, 6)).add_subplot(projection="3d")
    faces_at = points[triangles]
    normals = np.cross(faces_at[:, 1] - faces_at[:, 0], faces_at[:, 2] - faces_at[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True) + np.finfo(float).tiny
    light = 0.35 + 0.65 * np.clip(normals @ (np.array([-0.4, 0.7, 0.6]) / np.linalg.norm([0.4, 0.7, 0.6])), 0, 1)
    if values is None:
        faces = np.array(colors.to_rgb("#c9675f"))[None, :] * light[:, None]
    else:
        on_faces = values[triangles].mean(axis=1)
        scale = colors.Normalize(float(values.min()), float(values.max()))
        faces = colormaps["viridis"](scale(on_faces))[:, :3] * (0.6 + 0.4 * light[:, None])
        axes.figure.colorbar(cm.ScalarMappable(scale, "viridis"), ax=axes, shrink=0.6, label=label or unit)
    # y points up: matplotlib's third axis does.
    axes.add_collection3d(Poly3DCollection(faces_at[:, :, [0, 2, 1]], facecolors=np.clip(faces, 0, 1), edgecolors="none"))
    low, high = points.min(axis=0), points.max(axis=0)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(high[2], low[2])
    axes.set_zlim(low[1], high[1])
    axes.set_box_aspect(np.maximum(high - low, 1e-3 * np.linalg.norm(high - low))[[0, 2, 1]])
    axes.set(xlabel="x [m]", ylabel="z [m]", zlabel="y [m]", title=title or "")
    if path is not None:
        axes.figure.savefig(path, dpi=120, bbox_inches="tight")
    return axes


_FIELDS = ("displacement", "von-mises", "volume")


def _field(body, corners: np.ndarray, nodes: int, field):
    """Values at the nodes, and what they are."""
    if field is None:
        return None, ""
    if isinstance(field, str):
        if field not in _FIELDS:
            raise ValueError(f"field = `{field}`: there are `displacement`, `von-mises`, `volume`, and arrays")
        if not isinstance(body, SimulatedBody):
            raise ValueError(f"field = `{field}` is one of a body in a world, and this is a mesh at rest: give the body, or an array")
        if field == "displacement":
            return 1e3 * np.linalg.norm(body.positions - body.mesh.nodes, axis=1), "displacement [mm]"
        if field == "von-mises":
            return _at_nodes(corners, nodes, body.von_mises_stress() / 1e3), "von Mises stress [kPa]"
        return _at_nodes(corners, nodes, 100 * (body.volume_ratio() - 1)), "change of volume [%]"
    values = np.asarray(field, dtype=float)
    if values.shape == (nodes,):
        return values, ""
    if values.shape == (len(corners),):
        return _at_nodes(corners, nodes, values), ""
    raise ValueError(f"field must have one value for each of {nodes} nodes or {len(corners)} cells, and has shape {values.shape}")


def _at_nodes(corners: np.ndarray, nodes: int, values):
    """Means over the cells around each node; cells that are cut away (NaN) do not count."""
    sums, counts = np.zeros(nodes), np.zeros(nodes)
    there = ~np.isnan(values)
    for corner in corners[there].T:
        np.add.at(sums, corner, values[there])
        np.add.at(counts, corner, 1)
    return sums / np.maximum(counts, 1)
