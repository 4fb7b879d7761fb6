"""Arrays that look into the engine's memory: nothing is copied, nothing dangles, and nothing moves while someone looks."""

import gc
import threading
import weakref

import numpy as np
import pytest

import viscera

VIEWS = [("view_positions", "positions"), ("view_velocities", "velocities")]


def address(array):
    return array.__array_interface__["data"][0]


@pytest.mark.parametrize(("precision", "dtype"), [("double", np.float64), ("single", np.float32)])
@pytest.mark.parametrize(("view", "copy"), VIEWS)
def test_a_view_is_the_engines_memory_and_cannot_be_written_to(beam, precision, dtype, view, copy):
    world, body = beam(precision)
    world.steps(3)
    array = getattr(body, view)()
    assert (array.dtype, array.shape) == (dtype, (len(body.mesh.nodes), 3))
    assert array.strides == (3 * array.itemsize, array.itemsize) and array.flags.c_contiguous
    assert not array.flags.owndata and not array.flags.writeable
    assert address(array) == address(getattr(body, view)()) != address(getattr(body, copy))
    assert np.array_equal(array, getattr(body, copy)) and np.ptp(array) > 0
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 0
    with pytest.raises(ValueError, match="WRITEABLE"):
        array.flags.writeable = True


def changes(world, body, other, kept):
    """Everything that would change the state of a world."""
    places, speeds, rest = body.positions, body.velocities, body.mesh.nodes
    return {
        "step": world.step,
        "steps": lambda: world.steps(2),
        "restore": lambda: world.restore(kept),
        "add": lambda: world.add(other),
        "cut": lambda: body.remove_cells([0, 1]),
        "settle": body.settle,
        "threads": lambda: viscera.Threads(1).step([world], 1),
        "positions": lambda: setattr(body, "positions", rest),
        "velocities": lambda: setattr(body, "velocities", 0 * speeds),
        "attach": lambda: world.attach(body, "z-max", body),
        "unchanged": lambda: (places, speeds),
    }


def test_the_world_stands_still_while_someone_looks_and_goes_on_to_the_same_bits(beam):
    world, body = beam()
    undisturbed, same = beam()
    world.steps(2)
    kept, tool = world.snapshot(), world.add_instrument(viscera.Probe([0, 1, 0]))
    undisturbed.add_instrument(viscera.Probe([0, 1, 0]))
    law = viscera.NeoHookean.from_young_poisson(5e3, 0.3)
    other = viscera.Body(body.mesh, 1000.0, model=viscera.TotalLagrangian(law))
    before = (body.positions, body.velocities)
    view = body.view_positions()
    part = view[3:9, ::2]
    del view
    assert world.views == 1, "a slice looks as well"
    for name, change in changes(world, body, other, kept).items():
        if name != "unchanged":
            with pytest.raises(BufferError, match="stands still as long as arrays look into it, and 1 of them"):
                change()
    with pytest.raises(BufferError):
        tool.remove()
    # What only computes is let through, and so is a hand that says where it goes.
    tool.lead([0, 1, 0])
    tool.release()
    body.observe(), body.internal_forces, body.respond(0 * body.positions), body.live_positions, world.snapshot()
    assert np.array_equal(body.positions, before[0]) and np.array_equal(body.velocities, before[1])
    assert (len(world.bodies), body.cell_count, world.step_count) == (1, len(body.mesh), 2)
    assert np.array_equal(part, before[0][3:9, ::2])
    del part
    assert world.views == 0
    world.steps(5)
    undisturbed.steps(7)
    assert np.array_equal(body.positions, same.positions)


@pytest.mark.parametrize("view", ["view_positions", "view_velocities"])
def test_a_view_keeps_its_world_alive_and_outlives_every_name_of_it(beam, view):
    """Memory of 30 other worlds goes through the allocator meanwhile: what had been freed would be written over."""
    world, body = beam(cells=(4, 4, 16))
    world.steps(2)
    array = getattr(body, view)()
    wanted = array.copy()
    del world, body
    gc.collect()
    for _ in range(30):
        beam(cells=(4, 4, 16))
    assert np.array_equal(array, wanted)
    alive = weakref.ref(array)
    del array
    gc.collect()
    assert alive() is None


def test_a_cut_waits_for_views_and_leaves_their_shape_to_the_next(beam):
    world, body = beam()
    before = body.view_positions()
    shape, place = before.shape, address(before)
    with pytest.raises(BufferError):
        body.remove_cells(list(range(40)))
    del before
    assert body.remove_cells(list(range(40))) == 40
    after = body.view_positions()
    assert after.shape == shape and np.array_equal(after, body.positions)
    assert address(after) == place


@pytest.mark.parametrize("seed", range(6))
def test_any_order_of_looking_letting_go_and_changing_counts_right(beam, seed):
    """Random walks: a world changes if and only if nothing looks, and what is seen is what a copy says."""
    rng = np.random.default_rng(seed)
    world, body = beam("single" if seed % 2 else "double", cells=(1, 1, 2), step=1e-3)
    kept, held = world.snapshot(), []
    law = viscera.NeoHookean.from_young_poisson(5e3, 0.3)
    other = viscera.Body(body.mesh, 1000.0, model=viscera.TotalLagrangian(law))
    for _ in range(150):
        match rng.integers(4):
            case 0:
                view, copy = VIEWS[rng.integers(2)]
                array = getattr(body, view)()
                held.append((array, getattr(body, copy)))
            case 1 if held:
                array, copy = held[rng.integers(len(held))]
                rows = slice(rng.integers(3), None, rng.choice([1, 2, -1]))
                held.append((array[rows], copy[rows]))
            case 2 if held:
                held.pop(rng.integers(len(held)))
                array = None
            case _:
                allowed = world.views == 0
                name = rng.choice(["step", "steps", "restore", "positions", "velocities", "threads"])
                change = changes(world, body, other, kept)[name]
                if allowed:
                    change()
                else:
                    with pytest.raises(BufferError):
                        change()
        array = None
        assert (world.views == 0) == (not held)
        assert all(np.array_equal(*pair) for pair in held)


def test_a_world_that_another_thread_steps_is_refused_and_not_waited_for(beam):
    """Reading, looking and stepping raise RuntimeError meanwhile, and the world of the thread ends with the bits of one alone."""
    world, body = beam(step=1e-3)
    alone, same = beam(step=1e-3)
    failures, seen = [], set()
    calls = {
        "read": lambda: body.positions,
        "look": body.view_positions,
        "observe": body.observe,
        "step": world.snapshot,
        "names": lambda: world.bodies,
    }

    def play():
        try:
            world.steps(1500)
        except BaseException as error:
            failures.append(error)

    thread = threading.Thread(target=play)
    thread.start()
    while thread.is_alive():
        for name, call in calls.items():
            try:
                call()
            except RuntimeError as error:
                assert "borrowed" in str(error)
                seen.add(name)
            except BufferError:
                pass
    thread.join()
    if failures:
        # The array of `look` was there first.
        assert isinstance(failures[0], BufferError) and world.step_count == 0
        world.steps(1500)
    else:
        assert seen == set(calls)
    alone.steps(1500)
    assert np.array_equal(body.positions, same.positions)


def test_two_thousand_views_and_steps_in_turn_leave_no_trace(beam):
    world, body = beam(cells=(1, 1, 2), step=1e-4)
    total = 0.0
    for _ in range(2000):
        total += body.view_positions().sum() - body.positions.sum()
        world.step()
    assert total == 0 and world.views == 0
