"""Meshes and fields for other packages, where they are installed: meshio, pyvista, matplotlib, scipy."""

from __future__ import annotations

import numpy as np

from ._viscera import HexMesh, SimulatedBody, SurfaceMesh, TetMesh, VolumeMesh

_VTK_TETRAHEDRON, _VTK_HEXAHEDRON = 10, 12


def _need(package: str, extra: str):
    """The package, or an error that says how to install it."""
    from importlib import import_module

    try:
        return import_module(package)
    except ImportError as error:
        message = f"this needs {package}, which is not installed: `pip install viscera[{extra}]`"
        raise ImportError(message) from error


def to_meshio(mesh: VolumeMesh | SimulatedBody, point_data: dict | None = None, cell_data: dict | None = None):
    """A `meshio.Mesh` of a mesh at rest, or of a body as it is now; regions become sets of points.

    `point_data` and `cell_data` are arrays by name, one row for each node or cell [in the caller's units].
    """
    meshio = _need("meshio", "mesh")
    shape = mesh.mesh if isinstance(mesh, SimulatedBody) else mesh
    points = mesh.positions if isinstance(mesh, SimulatedBody) else mesh.nodes
    kind = "tetra" if isinstance(shape, TetMesh) else "hexahedron"
    sets = {name: parts["nodes"] for name, parts in shape.regions.items()}
    fields = {name: [values] for name, values in (cell_data or {}).items()}
    return meshio.Mesh(
        np.array(points, dtype=float), [(kind, shape.cells.astype(int))], point_data=point_data or {}, cell_data=fields, point_sets=sets
    )


def from_meshio(mesh, scale: float = 1.0) -> TetMesh | HexMesh | SurfaceMesh:
    """The mesh of a `meshio.Mesh`: its tetrahedra, or else its hexahedra, or else its triangles; `scale` is its unit [m].

    Sets of points become regions. Nodes of no cell are left out by `checked`.
    """
    points = np.asarray(mesh.points, dtype=float) * scale
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    cells = {kind: mesh.get_cells_type(kind) for kind in ("tetra", "hexahedron", "triangle")}
    regions = {name: np.asarray(nodes) for name, nodes in (mesh.point_sets or {}).items()}
    if len(cells["tetra"]):
        return TetMesh(points, cells["tetra"], regions)
    if len(cells["hexahedron"]):
        return HexMesh(points, cells["hexahedron"], regions)
    if len(cells["triangle"]):
        return SurfaceMesh(points, cells["triangle"])
    raise ValueError("the mesh has neither tetrahedra nor hexahedra nor triangles of first order")


def to_pyvista(mesh: VolumeMesh | SimulatedBody, point_data: dict | None = None, cell_data: dict | None = None):
    """A `pyvista.UnstructuredGrid` of a mesh at rest, or of a body as it is now without the cells that are cut away."""
    pyvista = _need("pyvista", "mesh")
    shape = mesh.mesh if isinstance(mesh, SimulatedBody) else mesh
    left = ~mesh.removed if isinstance(mesh, SimulatedBody) else np.full(len(shape), True)
    points = mesh.positions if isinstance(mesh, SimulatedBody) else mesh.nodes
    cells = shape.cells[left].astype(np.int64)
    kind = _VTK_TETRAHEDRON if isinstance(shape, TetMesh) else _VTK_HEXAHEDRON
    grid = pyvista.UnstructuredGrid({kind: cells}, np.array(points, dtype=float))
    for name, values in (point_data or {}).items():
        grid.point_data[name] = values
    for name, values in (cell_data or {}).items():
        grid.cell_data[name] = np.asarray(values)[left]
    return grid


def from_pyvista(grid, scale: float = 1.0) -> TetMesh | HexMesh:
    """The mesh of a `pyvista.UnstructuredGrid`: its tetrahedra, or else its hexahedra; `scale` is its unit [m]."""
    points = np.asarray(grid.points, dtype=float) * scale
    cells = grid.cells_dict
    if _VTK_TETRAHEDRON in cells:
        return TetMesh(points, cells[_VTK_TETRAHEDRON])
    if _VTK_HEXAHEDRON in cells:
        return HexMesh(points, cells[_VTK_HEXAHEDRON])
    raise ValueError("the grid has neither tetrahedra nor hexahedra of first order")


def stiffness(model, x):
    """K(x) [N/m] of a `ForceModel` or a `SimulatedBody` at positions `x` [m, shape (n, 3)], as a CSR matrix of scipy's of size 3n."""
    sparse = _need("scipy.sparse", "sparse")
    rows, columns, blocks = model.blocks(x)
    size = 3 * len(x)
    row = (3 * rows[:, None, None].astype(np.int64) + np.arange(3)[None, :, None]) + np.zeros((1, 1, 3), dtype=np.int64)
    column = (3 * columns[:, None, None].astype(np.int64) + np.arange(3)[None, None, :]) + np.zeros((1, 3, 1), dtype=np.int64)
    return sparse.coo_matrix((blocks.ravel(), (row.ravel(), column.ravel())), shape=(size, size)).tocsr()


def plot(body: SimulatedBody | VolumeMesh, field=None, *, title: str | None = None, label: str | None = None, axes=None, path=None):
    """Draws the surface of a body (or mesh) with matplotlib, coloured by `field`, and gives the axes.

    `field`: None (plain), "displacement" [mm], "von-mises" [kPa], "volume" [%], or an array with one value for each node or cell.
    With `path` the picture is written there as well.
    """
    _need("matplotlib", "plot")
    from matplotlib import cm, colormaps, colors, pyplot
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    shape: VolumeMesh
    if isinstance(body, SimulatedBody):
        shape, points, triangles = body.mesh, np.asarray(body.positions, dtype=float), body.surface()[0]
    else:
        shape, points, triangles = body, body.nodes, body.surface().triangles
    values, unit = _field(body, shape, field)
    if axes is None:
        axes = pyplot.figure(figsize=(7, 6)).add_subplot(projection="3d")
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
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
    axes.add_collection3d(Poly3DCollection(corners[:, :, [0, 2, 1]], facecolors=np.clip(faces, 0, 1), edgecolors="none"))
    low, high = points.min(axis=0), points.max(axis=0)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(high[2], low[2])
    axes.set_zlim(low[1], high[1])
    axes.set_box_aspect(np.maximum(high - low, 1e-3 * np.linalg.norm(high - low))[[0, 2, 1]])
    axes.set(xlabel="x [m]", ylabel="z [m]", zlabel="y [m]", title=title or "")
    if path is not None:
        axes.figure.savefig(path, dpi=120, bbox_inches="tight")
    return axes


def _field(body, shape, field):
    """Values at the nodes, and what they are."""
    if field is None:
        return None, ""
    if isinstance(field, str):
        if field == "displacement":
            return 1e3 * np.linalg.norm(body.positions - shape.nodes, axis=1), "displacement [mm]"
        if field == "von-mises":
            return _at_nodes(shape, body.von_mises_stress() / 1e3), "von Mises stress [kPa]"
        if field == "volume":
            return _at_nodes(shape, 100 * (body.volume_ratio() - 1)), "change of volume [%]"
        raise ValueError(f"field = `{field}`: there are `displacement`, `von-mises`, `volume`, and arrays")
    values = np.asarray(field, dtype=float)
    if len(values) == len(shape.nodes):
        return values, ""
    if len(values) == len(shape):
        return _at_nodes(shape, values), ""
    raise ValueError(f"field has {len(values)} values, and there are {len(shape.nodes)} nodes and {len(shape)} cells")


def _at_nodes(shape, values):
    """Means over the cells around each node; cells that are cut away (NaN) do not count."""
    sums, counts = np.zeros(len(shape.nodes)), np.zeros(len(shape.nodes))
    there = ~np.isnan(values)
    for corner in shape.cells[there].T:
        np.add.at(sums, corner, values[there])
        np.add.at(counts, corner, 1)
    return sums / np.maximum(counts, 1)
