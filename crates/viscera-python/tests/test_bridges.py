"""Meshes and fields for other packages."""

import matplotlib
import meshio
import numpy as np
import pytest
import pyvista

import viscera


def test_a_mesh_goes_through_meshio_and_back(tmp_path, beam):
    mesh = viscera.TetMesh.box_grid([2, 1, 1], [0.2, 0.1, 0.1])
    back = viscera.from_meshio(viscera.to_meshio(mesh))
    assert np.array_equal(back.nodes, mesh.nodes) and np.array_equal(back.cells, mesh.cells)
    assert np.array_equal(back.nodes_in("x-max"), mesh.nodes_in("x-max"))
    _, body = beam()
    body.settle()
    file = tmp_path / "beam.vtu"
    stress = body.von_mises_stress()
    viscera.to_meshio(body, cell_data={"von Mises [Pa]": stress}).write(file)
    read = meshio.read(file)
    assert np.array_equal(read.points, body.positions)
    assert np.array_equal(read.cell_data["von Mises [Pa]"][0], stress)
    assert isinstance(viscera.from_meshio(meshio.Mesh(mesh.nodes, [("triangle", mesh.surface().triangles)])), viscera.SurfaceMesh)


def test_a_body_goes_to_pyvista_without_what_is_cut_away(beam):
    _, body = beam()
    body.remove_cells([0, 1])
    grid = viscera.to_pyvista(body, cell_data={"J": body.volume_ratio()})
    assert grid.n_cells == body.cell_count and not np.isnan(grid.cell_data["J"]).any()
    again = viscera.from_pyvista(grid)
    assert np.array_equal(again.cells, body.mesh.cells[~body.removed])


KINDS = pytest.mark.parametrize("kind", [viscera.TetMesh, viscera.HexMesh], ids=["tetrahedra", "hexahedra"])


def partitioned(kind):
    """A box with one more region, of cells and their corners."""
    box = kind.box_grid([3, 1, 2], [0.3, 0.1, 0.2])
    half = np.flatnonzero(box.nodes[box.cells].mean(axis=1)[:, 0] < 0.15)
    part = {"nodes": np.unique(box.cells[half]), "cells": half}
    return kind(box.nodes, box.cells, {**{name: parts for name, parts in box.regions.items()}, "part": part})


def assert_same(found, wanted):
    """The same nodes, cells, and nodes and cells of regions."""
    assert type(found) is type(wanted)
    assert np.array_equal(found.nodes, wanted.nodes) and np.array_equal(found.cells, wanted.cells)
    assert found.regions.keys() == wanted.regions.keys()
    for name, parts in wanted.regions.items():
        for what in ("nodes", "cells"):
            assert np.array_equal(found.regions[name][what], parts[what]), (name, what)


@KINDS
def test_cells_of_both_kinds_and_their_regions_come_back_from_other_packages(kind, tmp_path):
    mesh = partitioned(kind)
    assert_same(viscera.from_meshio(viscera.to_meshio(mesh)), mesh)
    assert_same(viscera.from_pyvista(viscera.to_pyvista(mesh)), mesh)
    viscera.to_pyvista(mesh).save(tmp_path / "box.vtu")
    assert_same(viscera.from_pyvista(pyvista.read(tmp_path / "box.vtu")), mesh)
    doubled = viscera.from_meshio(viscera.to_meshio(mesh), 2.0)
    assert doubled.volume == pytest.approx(8 * mesh.volume, rel=1e-12)


@KINDS
def test_cells_that_are_cut_away_are_left_out_with_their_fields_and_numbers(kind):
    mesh = partitioned(kind)
    law = viscera.NeoHookean.from_young_poisson(10e3, 0.3)
    body = viscera.World().add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(law)))
    part = mesh.regions["part"]["cells"]
    body.remove_cells([int(part[0]), len(mesh) - 1])
    left = np.flatnonzero(~body.removed)
    numbers = {"number": np.arange(len(mesh)), "J": body.volume_ratio()}
    written, grid = viscera.to_meshio(body, cell_data=numbers), viscera.to_pyvista(body, cell_data=numbers)
    assert written.cell_data["number"][0].tolist() == np.asarray(grid.cell_data["number"]).tolist() == left.tolist()
    assert not np.isnan(written.cell_data["J"][0]).any()
    for back in (viscera.from_meshio(written), viscera.from_pyvista(grid)):
        assert np.array_equal(back.cells, mesh.cells[left]) and np.array_equal(back.nodes, body.positions)
        assert left[back.regions["part"]["cells"]].tolist() == part[1:].tolist()
    for take in (viscera.to_meshio, viscera.to_pyvista):
        with pytest.raises(ValueError, match=f"`short` has 2 values, and the mesh has {len(mesh)} cells"):
            take(body, cell_data={"short": [1.0, 2.0]})


def test_a_surface_goes_to_other_packages_and_back(tmp_path):
    skin = partitioned(viscera.TetMesh).surface()
    heights = skin.nodes[:, 2]
    written = viscera.to_meshio(skin, point_data={"height [m]": heights})
    poly = viscera.to_pyvista(skin, point_data={"height [m]": heights}, cell_data={"number": np.arange(len(skin))})
    assert poly.n_cells == len(skin) and np.array_equal(poly.point_data["height [m]"], heights)
    assert poly.volume == pytest.approx(0.006, rel=1e-6) and poly.area == pytest.approx(skin.area, rel=1e-6)
    for back in (viscera.from_meshio(written), viscera.from_pyvista(poly), viscera.from_pyvista(poly.cast_to_unstructured_grid())):
        assert isinstance(back, viscera.SurfaceMesh)
        assert np.array_equal(back.nodes, skin.nodes) and np.array_equal(back.triangles, skin.triangles)
    written.write(tmp_path / "skin.stl")
    assert viscera.read_mesh(tmp_path / "skin.stl")[0].repaired()[0].enclosed_volume == pytest.approx(0.006, rel=1e-5)


def test_polygons_of_pyvista_are_cut_into_triangles_and_its_solids_filled():
    box = viscera.from_pyvista(pyvista.Box((0, 100, 0, 200, 0, 300)).clean(), 1e-3)
    assert len(box) == 12 and box.repaired()[0].enclosed_volume == pytest.approx(0.006, rel=1e-9)
    ball = viscera.from_pyvista(pyvista.Sphere(radius=0.05))
    assert viscera.TetMesh.from_surface(ball, 0.015).volume == pytest.approx(ball.enclosed_volume, rel=0.05)
    with pytest.raises(ValueError, match="no polygons"):
        viscera.from_pyvista(pyvista.PolyData(np.eye(3)))


def test_what_is_no_mesh_is_refused_by_its_type():
    for take in (viscera.to_meshio, viscera.to_pyvista, viscera.plot):
        with pytest.raises(TypeError, match="of type World"):
            take(viscera.World())


def test_fields_of_a_body_are_refused_for_a_mesh_and_arrays_are_drawn():
    matplotlib.use("Agg")
    mesh = partitioned(viscera.TetMesh)
    for shape in (mesh, mesh.surface()):
        for field in ("displacement", "von-mises", "volume"):
            with pytest.raises(ValueError, match=f"`{field}` is one of a body in a world, and this is a mesh at rest"):
                viscera.plot(shape, field)
        with pytest.raises(ValueError, match="`colour`: there are"):
            viscera.plot(shape, "colour")
        with pytest.raises(ValueError, match=r"and has shape \(3,\)"):
            viscera.plot(shape, np.zeros(3))
        for values in (None, shape.nodes[:, 0], np.arange(len(shape))):
            axes = viscera.plot(shape, values)
            assert len(axes.collections[0].get_facecolor()) == len(mesh.surface())
            matplotlib.pyplot.close(axes.figure)


def test_a_body_is_drawn_in_one_call(tmp_path, beam):
    matplotlib.use("Agg")
    _, body = beam()
    body.settle()
    for field in (None, "displacement", "von-mises", "volume", np.arange(len(body.mesh))):
        axes = viscera.plot(body, field, path=tmp_path / "beam.png")
        # One triangle of the picture for each of the surface's.
        assert len(axes.collections[0].get_facecolor()) == len(body.surface()[0])
        matplotlib.pyplot.close(axes.figure)
    assert (tmp_path / "beam.png").read_bytes()[:4] == b"\x89PNG"
    with pytest.raises(ValueError, match="there are"):
        viscera.plot(body, "colour")


def test_presets_say_where_their_moduli_come_from():
    for name, preset in viscera.TISSUES.items():
        law = preset.law(viscera.StableNeoHookean)
        lame = viscera.Lame(law.parameters["lambda"], law.parameters["mu"])
        assert lame.young == pytest.approx(preset.young, rel=1e-12), name
        assert any(letter.isdigit() for letter in preset.source)


def test_presets_are_those_of_scenes_and_have_the_modulus_that_they_state_along_their_fibres():
    assert {"liver", "kidney", "spleen", "brain", "fat", "muscle", "skin", "gallbladder-wall", "artery"} <= set(viscera.TISSUES)
    muscle = viscera.TISSUES["muscle"]
    low, high = muscle.measured["along"].range
    assert low <= muscle.along <= high and muscle.measured["young"].weakness
    values = muscle.law_along([0.0, 2.0, 0.0]).parameters
    matrix = viscera.Lame(values["lambda"], values["mu"])
    assert matrix.young + 2.0 * values["fibre-stiffness"] == pytest.approx(muscle.along, rel=1e-12)
    with pytest.raises(ValueError, match="liver has no fibres"):
        viscera.TISSUES["liver"].law_along([1.0, 0.0, 0.0])
