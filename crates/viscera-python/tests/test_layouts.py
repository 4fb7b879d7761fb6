"""What numpy can hold is read as numpy reads it: records, misaligned memory, broadcasts, types; and what is no whole number is refused."""

import itertools

import numpy as np
import pytest

import viscera

MESH = viscera.TetMesh.box_grid([2, 1, 1], [0.2, 0.1, 0.1])


def record(values):
    """A field of records whose size is no multiple of a number's: an integer, the row, and a byte."""
    rows = np.zeros(len(values), dtype=[("id", "i4"), ("x", values.dtype, values.shape[1:]), ("seen", "u1")])
    rows["x"] = values
    return rows["x"]


def misaligned(values):
    """The same numbers, one after the other, from an odd address on."""
    memory = np.zeros(values.nbytes + 1, dtype=np.uint8)
    memory[1:] = np.frombuffer(values.tobytes(), dtype=np.uint8)
    return memory[1:].view(values.dtype).reshape(values.shape)


def every_second(values):
    """Every second number of every axis of a larger array."""
    larger = np.full([2 * size for size in values.shape], 7, dtype=values.dtype)
    view = larger[tuple(slice(None, None, 2) for _ in values.shape)]
    view[...] = values
    return view


def backwards(values):
    return np.ascontiguousarray(values[::-1])[::-1]


LAYOUTS = [np.ascontiguousarray, np.asfortranarray, record, misaligned, every_second, backwards, np.ndarray.tolist]
layouts = pytest.mark.parametrize("layout", LAYOUTS, ids=lambda layout: layout.__name__)


def test_the_layouts_are_those_that_cannot_be_looked_at_in_steps_of_a_number():
    nodes = MESH.nodes.copy()
    assert record(nodes).strides[0] % 8 != 0
    assert not misaligned(nodes).flags.aligned and misaligned(nodes).flags.c_contiguous


@layouts
def test_nodes_of_every_layout_are_the_ones_that_were_given(layout):
    mesh = viscera.TetMesh(layout(MESH.nodes.copy()), MESH.cells)
    assert np.array_equal(mesh.nodes, MESH.nodes)
    surface = MESH.surface()
    assert viscera.SurfaceMesh(layout(surface.nodes), surface.triangles).area == surface.area


@layouts
@pytest.mark.parametrize("kind", ["i4", "i8", "u2", "u4", ">i4", ">u8", "f4", "f8", ">f8"])
def test_cells_of_every_layout_and_type_are_the_ones_that_were_given(layout, kind):
    mesh = viscera.TetMesh(MESH.nodes, layout(MESH.cells.astype(kind)))
    assert np.array_equal(mesh.cells, MESH.cells)


def test_a_field_of_other_records_is_read_from_its_own_bytes():
    """Stride 28 with the field at byte 4, as files of instruments have it."""
    rows = np.zeros(4, dtype=[("id", "i4"), ("x", "f8", 3)])
    rows["id"] = 2**31 - 1
    rows["x"] = [[0, 0, 0], [2, 0, 0], [0, 3, 0], [0, 0, 4]]
    assert rows["x"].strides == (28, 8)
    mesh = viscera.TetMesh(rows["x"], [[0, 1, 2, 3]])
    assert np.array_equal(mesh.nodes, rows["x"]) and mesh.volume == pytest.approx(4.0, rel=1e-15)


@layouts
@pytest.mark.parametrize("precision", ["single", "double"])
def test_forces_answers_and_states_do_not_depend_on_the_layout(layout, precision, beam):
    _, body = beam(precision, cells=(1, 1, 2))
    rng = np.random.default_rng(3)
    x = body.mesh.nodes + 1e-3 * rng.uniform(-1, 1, body.mesh.nodes.shape)
    dx = rng.uniform(-1, 1, x.shape)
    assert np.array_equal(body.forces_at(layout(x)), body.forces_at(x))
    assert np.array_equal(body.product_at(layout(x), layout(dx)), body.product_at(x, dx))
    assert body.energy_at(layout(x)) == body.energy_at(x)
    several = np.stack([dx, 2 * dx, -dx])
    assert np.array_equal(body.respond(layout(several)), body.respond(several))
    body.velocities = layout(dx)
    free = np.array(body.motions) == "free"
    assert np.array_equal(body.velocities[free], dx.astype(body.velocities.dtype)[free])


@layouts
def test_laws_densities_and_tissues_do_not_depend_on_the_layout(layout):
    rng = np.random.default_rng(4)
    gradients = np.eye(3) + 0.2 * rng.uniform(-1, 1, (5, 3, 3))
    directions = rng.uniform(-1, 1, (5, 3, 3))
    law = viscera.NeoHookean.from_young_poisson(5e3, 0.4)
    for ask in (law.energy, law.stress, lambda f: law.tangent(f, layout(directions))):
        assert np.array_equal(ask(layout(gradients)), ask(gradients))
    values = np.column_stack([np.linspace(2e3, 4e3, len(MESH)), np.linspace(1e3, 3e3, len(MESH))])
    tissue = viscera.Tissue.from_values("neo-hookean", layout(values))
    assert [tissue.values(cell).tolist() for cell in range(len(MESH))] == values.tolist()
    densities = np.linspace(900.0, 1100.0, len(MESH))
    model = viscera.TotalLagrangian(tissue)
    masses = [viscera.World().add(viscera.Body(MESH, given, model=model)).masses for given in (densities, layout(densities))]
    assert np.array_equal(*masses)


@layouts
def test_a_depth_picture_does_not_depend_on_the_layout(layout):
    surface = MESH.surface()
    view = dict(eye=[0.4, 0.3, 0.5], target=[0.1, 0.05, 0.05], size=(24, 16))
    wanted = viscera.depth_image(surface.nodes, surface.triangles, **view)
    assert np.isfinite(wanted).any()
    assert np.array_equal(viscera.depth_image(layout(surface.nodes), layout(surface.triangles), **view), wanted)


def test_broadcast_densities_are_the_same_number_for_each_cell():
    law = viscera.NeoHookean.from_young_poisson(5e3, 0.4)
    same = np.broadcast_to(np.array(1000.0), len(MESH))
    assert same.strides == (0,)
    body = viscera.World().add(viscera.Body(MESH, same, model=viscera.TotalLagrangian(law)))
    assert body.masses.sum() == pytest.approx(1000 * MESH.volume, rel=1e-12)


@pytest.mark.parametrize("shape", [(), (3,), (4, 2), (4, 4), (2, 4, 3), (0, 3, 3)])
def test_vectors_of_another_shape_are_refused_with_the_shape_that_is_wanted(shape, beam):
    _, body = beam(cells=(1, 1, 1))
    for ask in (body.forces_at, lambda x: viscera.TetMesh(x, MESH.cells), body.energy_at):
        with pytest.raises(ValueError, match=r"must have shape"):
            ask(np.zeros(shape))


@pytest.mark.parametrize(
    ("value", "says"),
    [(3.9, r"cells holds 3.9 at \[1, 2\]"), (np.nan, r"cells holds NaN at \[1, 2\]"), (1e300, r"cells holds 1e300 at \[1, 2\]")],
)
@pytest.mark.parametrize("form", [np.asarray, np.ndarray.tolist, lambda cells: cells.astype(object)], ids=["array", "list", "object"])
def test_cells_that_are_no_whole_numbers_are_refused_and_the_first_is_named(value, says, form):
    cells = np.array([[0, 1, 2, 3], [1, 2, 3, 4], [2, 3, 4, 5]], dtype=float)
    cells[1, 2], cells[2, 0] = value, 0.5
    with pytest.raises(ValueError, match=says):
        viscera.TetMesh(MESH.nodes, form(cells))


def test_every_input_of_numbers_of_nodes_refuses_fractions_masks_and_texts():
    halves = MESH.surface().triangles + 0.5
    asks = {
        "triangles": [
            lambda given: viscera.SurfaceMesh(MESH.nodes, given),
            lambda given: viscera.depth_image(MESH.nodes, given, eye=[1, 1, 1], target=[0, 0, 0]),
        ],
        "nodes": [
            lambda given: viscera.TetMesh(MESH.nodes, MESH.cells, {"part": given}),
            lambda given: viscera.TetMesh(MESH.nodes, MESH.cells, {"part": {"nodes": given}}),
        ],
        "cells": [
            lambda given: viscera.TetMesh(MESH.nodes, given),
            lambda given: viscera.HexMesh(MESH.nodes, given),
            lambda given: viscera.TetMesh(MESH.nodes, MESH.cells, {"part": {"cells": given}}),
        ],
        "faces": [lambda given: viscera.TetMesh(MESH.nodes, MESH.cells, {"part": {"faces": given}})],
    }
    for what, ask in itertools.chain.from_iterable(([what, ask] for ask in asked) for what, asked in asks.items()):
        with pytest.raises(ValueError, match=rf"{what} holds 0.5 at \[0, "):
            ask(halves - halves[0, 0] + 0.5)
        with pytest.raises(TypeError, match=rf"{what} is a mask .* numpy.flatnonzero"):
            ask(halves > 1)
        with pytest.raises(TypeError, match=rf"{what} must hold whole numbers, and holds <U"):
            ask(halves.astype(str))


def test_whole_numbers_as_floats_and_no_numbers_at_all_are_taken():
    mesh = viscera.TetMesh(MESH.nodes, MESH.cells.astype(float), {"ends": [0.0, 3.0], "nothing": []})
    assert mesh.regions["ends"]["nodes"].tolist() == [0, 3] and mesh.regions["nothing"]["nodes"].size == 0
