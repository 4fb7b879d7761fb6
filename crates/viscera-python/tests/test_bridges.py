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
