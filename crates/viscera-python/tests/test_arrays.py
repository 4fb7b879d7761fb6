"""Arrays in and out: shapes, types, strides, lifetimes."""

import gc

import numpy as np
import pytest

import viscera


@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.int64, ">f8"])
@pytest.mark.parametrize("layout", ["c", "fortran", "reversed", "strided", "list"])
def test_nodes_are_taken_in_every_type_and_layout(dtype, layout):
    nodes = np.array([[0, 0, 0], [2, 0, 0], [0, 3, 0], [0, 0, 4]], dtype=dtype)
    forms = {
        "c": nodes,
        "fortran": np.asfortranarray(nodes),
        "reversed": np.ascontiguousarray(nodes[::-1])[::-1],
        "strided": np.repeat(np.repeat(nodes, 2, axis=0), 3, axis=1)[::2, ::3],
        "list": nodes.tolist(),
    }
    mesh = viscera.TetMesh(forms[layout], np.array([[0, 1, 2, 3]], dtype=np.uint16))
    assert mesh.nodes.tolist() == nodes.astype(float).tolist()
    assert mesh.volume == pytest.approx(4.0, rel=1e-15)


@pytest.mark.parametrize(
    ("nodes", "cells", "says"),
    [
        (np.zeros((4, 2)), [[0, 1, 2, 3]], "nodes must have shape (n, 3)"),
        (np.zeros(12), [[0, 1, 2, 3]], "nodes must have shape (n, 3)"),
        (np.eye(4, 3), [[0, 1, 2]], "cells must have shape (n, 4)"),
        (np.eye(4, 3), [[0, 1, 2, -1]], "-1"),
        (np.eye(4, 3), [[0, 1, 2, 9]], "node 9"),
        (np.full((4, 3), np.nan), [[0, 1, 2, 3]], "node 0"),
    ],
)
def test_arrays_of_a_wrong_shape_or_content_are_refused_with_words(nodes, cells, says):
    with pytest.raises((ValueError, viscera.Error)) as error:
        viscera.TetMesh(nodes, cells)
    assert says in str(error.value)


def test_constant_arrays_are_shared_closed_and_outlive_their_mesh():
    mesh = viscera.TetMesh.box_grid([2, 2, 2], [1, 1, 1])
    nodes, cells = mesh.nodes, mesh.cells
    assert mesh.nodes is nodes and mesh.cells is cells
    assert (nodes.dtype, nodes.shape, cells.dtype, cells.shape) == (np.float64, (27, 3), np.uint32, (48, 4))
    with pytest.raises(ValueError, match="read-only"):
        nodes[0] = 1
    total = nodes.sum()
    del mesh
    gc.collect()
    assert nodes.sum() == total


@pytest.mark.parametrize(("precision", "dtype"), [("double", np.float64), ("single", np.float32)])
def test_state_comes_in_the_precision_of_the_world(beam, precision, dtype):
    _, body = beam(precision)
    for array in (body.positions, body.velocities, body.internal_forces, body.external_forces, body.live_positions):
        assert (array.dtype, array.shape) == (dtype, (len(body.mesh.nodes), 3))


def test_positions_are_copies_and_live_positions_follow(beam):
    world, body = beam()
    copy, live = body.positions, body.live_positions
    world.steps(5)
    assert np.array_equal(copy, body.mesh.nodes)
    assert np.array_equal(live, body.positions) and not np.array_equal(live, copy)
    before = world.snapshot()
    moment = body.positions
    world.steps(5)
    world.restore(before)
    assert np.array_equal(live, moment)
    with pytest.raises(ValueError, match="read-only"):
        live[0] = 0


def test_live_positions_outlive_the_world_and_keep_their_shape_in_a_cut(beam):
    world, body = beam()
    live = body.live_positions
    body.remove_cells(list(range(48)))
    world.step()
    assert live.shape == (len(body.mesh.nodes), 3)
    last = body.positions
    del world, body
    gc.collect()
    assert np.array_equal(live, last)


def test_fields_of_removed_cells_are_nan_and_the_others_stay(beam):
    world, body = beam()
    world.steps(3)
    before = body.von_mises_stress()
    assert body.remove_cells([5, 7, 7]) == 2
    after = body.von_mises_stress()
    gone = np.isnan(after)
    assert np.flatnonzero(gone).tolist() == [5, 7] and np.flatnonzero(body.removed).tolist() == [5, 7]
    assert np.array_equal(after[~gone], before[~gone])
    assert body.surface()[1].any()


def test_positions_that_are_set_are_the_ones_that_are_read_where_nodes_are_free(beam):
    _, body = beam()
    places = body.mesh.nodes * 1.1 + 0.01
    body.positions = np.asfortranarray(places)
    free = np.array(body.motions) == "free"
    assert np.array_equal(body.positions[free], places[free])
    assert np.array_equal(body.positions[~free], body.mesh.nodes[~free])
    with pytest.raises(ValueError, match="one row for each node"):
        body.positions = places[:-1]


def test_strains_and_stresses_of_a_homogeneous_stretch_are_those_of_the_law(beam):
    """F = diag(1.2, 1, 0.9): E, S = F⁻¹P, σ = P Fᵀ/J and the von Mises stress follow by hand."""
    _, body = beam()
    world = viscera.World()
    law = viscera.StVenantKirchhoff.from_young_poisson(young=10e3, poisson=0.3)
    body = world.add(viscera.Body(body.mesh, 1000.0, model=viscera.TotalLagrangian(law)))
    gradient = np.diag([1.2, 1.0, 0.9])
    body.positions = body.mesh.nodes @ gradient
    strain = (gradient @ gradient - np.eye(3)) / 2
    lame = law.parameters
    second = lame["lambda"] * np.trace(strain) * np.eye(3) + 2 * lame["mu"] * strain
    cauchy = gradient @ second @ gradient / np.linalg.det(gradient)
    deviator = cauchy - np.trace(cauchy) / 3 * np.eye(3)
    assert np.allclose(body.green_strain(), strain, atol=1e-13)
    assert np.allclose(body.second_piola_stress(), second, rtol=1e-11, atol=1e-8)
    assert np.allclose(body.cauchy_stress(), cauchy, rtol=1e-11, atol=1e-8)
    assert np.allclose(body.von_mises_stress(), np.sqrt(1.5 * np.sum(deviator**2)), rtol=1e-11)
    assert np.allclose(body.volume_ratio(), 1.08, rtol=1e-12)
