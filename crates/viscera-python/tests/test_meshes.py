"""Meshes made, filled, written and read: volumes against closed forms, and what a filling loses."""

import numpy as np
import pytest

import viscera


def sphere(radius, rings=24):
    """A ball's skin of triangles between circles of latitude."""
    around = 2 * rings
    polar, turn = np.meshgrid(np.pi * np.arange(1, rings) / rings, 2 * np.pi * np.arange(around) / around, indexing="ij")
    circles = np.stack([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], axis=-1).reshape(-1, 3)
    nodes = radius * np.vstack([[0, 0, 1], circles, [0, 0, -1]])
    at = lambda ring, number: 1 + ring * around + number % around
    last, triangles = len(nodes) - 1, []
    for number in range(around):
        triangles += [[0, at(0, number), at(0, number + 1)], [last, at(rings - 2, number + 1), at(rings - 2, number)]]
        for ring in range(rings - 2):
            a, b, c, d = at(ring, number), at(ring + 1, number), at(ring + 1, number + 1), at(ring, number + 1)
            triangles += [[a, b, c], [a, c, d]]
    return viscera.SurfaceMesh(nodes, triangles)


@pytest.mark.parametrize("edge", [0.02, 0.012])
def test_a_ball_is_filled_to_its_volume_but_for_what_the_report_says(edge):
    ball = sphere(0.05)
    mesh, report = viscera.TetMesh.filled(ball, edge)
    assert report.surface_volume == pytest.approx(ball.enclosed_volume, rel=1e-12)
    assert ball.enclosed_volume == pytest.approx(4 / 3 * np.pi * 0.05**3, rel=0.01)
    assert (report.edge, report.cells) == (edge, len(mesh))
    assert report.volume == pytest.approx(mesh.volume, rel=1e-12)
    assert report.volume_lost == pytest.approx(1 - mesh.volume / ball.enclosed_volume, rel=1e-9)
    # A chord of one edge cuts off edge²/(8 radius) of the radius at most, three times that share of the volume.
    assert 0 < report.volume_lost < 3 * edge**2 / (8 * 0.05**2)
    assert (report.pieces, report.components, report.cavities, report.thin_area) == (1, 1, 0, 0.0)
    assert report.sufficient_edge == edge and report.as_dict()["cells"] == len(mesh)
    assert f"{len(mesh)} tetrahedra" in report.text
    assert viscera.TetMesh.from_surface(ball, edge) == mesh


def test_a_finer_edge_loses_less():
    losses = [viscera.TetMesh.filled(sphere(0.05), edge)[1].volume_lost for edge in (0.02, 0.012)]
    assert losses[1] < 0.5 * losses[0]


def test_a_plate_thinner_than_its_cells_says_which_edge_would_do():
    plate = viscera.TetMesh.box_grid([10, 1, 10], [0.1, 0.012, 0.1]).surface()
    _, report = viscera.TetMesh.filled(plate, 0.01)
    assert report.thin_area > 0.5 and report.sufficient_edge == pytest.approx(0.012 / 1.5, rel=1e-6)
    assert "an edge of 8.000 mm would do" in report.text


def test_an_open_surface_is_refused_with_its_hole():
    ball = sphere(0.05)
    with pytest.raises(viscera.SurfaceRefused, match="1 hole"):
        viscera.TetMesh.filled(viscera.SurfaceMesh(ball.nodes, ball.triangles[1:]), 0.02)
    with pytest.raises(viscera.SurfaceRefused, match="choose a smaller edge"):
        viscera.TetMesh.from_surface(ball, 0.2)


def test_cylinders_and_tubes_have_the_volumes_of_their_closed_forms():
    """Of a regular polygon with so many corners: (n/2) r² sin(2π/n) of the circle's area."""
    cylinder = viscera.TetMesh.cylinder(0.03, 0.1, 8, 10)
    assert cylinder.volume == pytest.approx(np.pi * 0.03**2 * 0.1, rel=0.01)
    around = 24
    tube = viscera.TetMesh.tube(0.02, 0.03, 0.1, around, 2, 8)
    wanted = 0.5 * around * np.sin(2 * np.pi / around) * (0.03**2 - 0.02**2) * 0.1
    assert tube.volume == pytest.approx(wanted, rel=1e-9)
    for mesh, regions in ((cylinder, {"bottom", "top", "side"}), (tube, {"bottom", "top", "inner", "outer"})):
        assert set(mesh.regions) == regions and mesh.quality().min() > 0
        assert np.allclose(mesh.nodes[mesh.nodes_in("top"), 2], 0.1) and np.allclose(mesh.nodes[mesh.nodes_in("bottom"), 2], 0.0)
    radii = {name: np.linalg.norm(tube.nodes[tube.nodes_in(name), :2], axis=1) for name in ("inner", "outer")}
    assert np.allclose(radii["inner"], 0.02) and np.allclose(radii["outer"], 0.03)


def test_a_trunk_has_the_parts_that_breathe():
    trunk = viscera.TetMesh.trunk(0.5, 0.05)
    (_, low, _), (_, high, _) = trunk.bounds
    extents = np.subtract(trunk.bounds[1], trunk.bounds[0])
    assert extents.max() == pytest.approx(0.5, rel=0.1) and high > low
    assert trunk.quality().min() > 0
    for part in ("abdomen", "thorax", "diaphragm", "ribs"):
        assert any(part in name for name in trunk.regions), part


@pytest.mark.parametrize("kind", ["tetrahedra", "hexahedra"])
@pytest.mark.parametrize("ending", ["msh", "vtu"])
def test_a_mesh_that_is_written_is_read_as_it_was(kind, ending, tmp_path):
    """MSH keeps regions, VTU does not; nodes and cells stay to the bit."""
    mesh = (viscera.TetMesh if kind == "tetrahedra" else viscera.HexMesh).box_grid([2, 1, 3], [0.1, 0.07, 0.3])
    path = tmp_path / f"box.{ending}"
    mesh.write(path)
    back, notices = viscera.read_mesh(path)
    assert type(back) is type(mesh)
    assert np.array_equal(back.nodes, mesh.nodes) and np.array_equal(back.cells, mesh.cells)
    if ending == "msh":
        assert back.regions.keys() == mesh.regions.keys()
        assert all(np.array_equal(back.nodes_in(name), mesh.nodes_in(name)) for name in mesh.regions)
    in_millimetres, _ = viscera.read_mesh(path, 1e-3)
    assert in_millimetres.volume == pytest.approx(1e-9 * mesh.volume, rel=1e-9)


BOX = viscera.TetMesh.box_grid([1, 1, 1], [0.1, 0.2, 0.3])


def write_stl(path, surface):
    lines = ["solid box"]
    for corners in surface.nodes[surface.triangles]:
        places = "\n".join(f"vertex {x!r} {y!r} {z!r}" for x, y, z in corners.tolist())
        lines.append(f"facet normal 0 0 0\nouter loop\n{places}\nendloop\nendfacet")
    path.write_text("\n".join([*lines, "endsolid box\n"]))


def write_obj(path, surface):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in surface.nodes.tolist()]
    lines += ["f {} {} {}".format(*(triangle + 1)) for triangle in surface.triangles]
    path.write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize(("ending", "write"), [("stl", write_stl), ("obj", write_obj)])
def test_a_skin_that_other_programs_wrote_is_read_and_filled(ending, write, tmp_path):
    path = tmp_path / f"box.{ending}"
    write(path, BOX.surface())
    skin, _ = viscera.read_mesh(path)
    assert isinstance(skin, viscera.SurfaceMesh)
    closed, _ = skin.repaired()
    assert closed.enclosed_volume == pytest.approx(0.006, rel=1e-6) and closed.area == pytest.approx(0.22, rel=1e-6)
    mesh, report = viscera.TetMesh.filled(skin, 0.04)
    assert mesh.volume == pytest.approx(0.006 * (1 - report.volume_lost), rel=1e-6)


def test_a_volume_that_vtk_wrote_is_read(tmp_path):
    """The legacy format, in text."""
    nodes, cells = BOX.nodes.tolist(), BOX.cells.tolist()
    lines = ["# vtk DataFile Version 3.0", "box", "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(nodes)} double"]
    lines += [" ".join(map(repr, node)) for node in nodes]
    lines += [f"CELLS {len(cells)} {5 * len(cells)}", *(" ".join(map(str, [4, *cell])) for cell in cells)]
    lines += [f"CELL_TYPES {len(cells)}", *["10"] * len(cells)]
    path = tmp_path / "box.vtk"
    path.write_text("\n".join(lines) + "\n")
    mesh, _ = viscera.read_mesh(path)
    assert np.array_equal(mesh.nodes, BOX.nodes) and np.array_equal(mesh.cells, BOX.cells)


def test_a_reordered_mesh_has_the_same_nodes_and_cells_under_other_numbers():
    plain = viscera.TetMesh.box_grid([4, 4, 8], [0.1, 0.1, 0.2])
    order = np.random.default_rng(7).permutation(len(plain.nodes))
    number = np.argsort(order).astype(np.uint32)
    tangled = viscera.TetMesh(plain.nodes[order], number[plain.cells], {"foot": number[plain.regions["z-min"]["nodes"]]})
    mesh, nodes, cells = tangled.reordered()
    assert np.array_equal(mesh.nodes, tangled.nodes[nodes])
    assert np.array_equal(nodes[mesh.cells], tangled.cells[cells])
    assert np.array_equal(np.sort(nodes[mesh.regions["foot"]["nodes"]]), tangled.regions["foot"]["nodes"])
    assert np.ptp(mesh.cells, axis=1).mean() < 0.3 * np.ptp(tangled.cells, axis=1).mean()
