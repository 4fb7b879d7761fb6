"""Volumes kept exactly, rigid parts, muscles, actuators and fields from Python."""

import numpy as np
import pytest

import viscera

LAW = viscera.LinearElastic.from_young_poisson(10e3, 0.4)
MESH = viscera.TetMesh.box_grid([2, 2, 6], [0.1, 0.1, 0.3])


def between(low, high):
    return viscera.Region.cuboid([-1, -1, low - 1e-6], [1, 1, high + 1e-6])


def test_a_pressed_body_keeps_its_volume_in_every_step():
    """A plate presses a bar to 80 % of its height; without the constraint a twentieth of the volume goes."""
    lost = {}
    for exact in (None, ("whole", viscera.Region.all())):
        world = viscera.World(gravity=[0, 0, 0], step=0.01)
        body = world.add(
            viscera.Body(
                MESH, 1000.0, model=viscera.ShapeMemory(LAW), damping=5.0, fix=between(0, 0), keep_volume_exactly=exact,
                prescribe=(between(0.3, 0.3), [(0.0, [0, 0, 0]), (0.5, [0, 0, -0.06])]),
            )
        )  # fmt: skip
        for _ in range(60):
            world.step()
            for kept in body.kept_volumes:
                assert abs(kept.error) <= 1e-12 and kept.name == "whole" and kept.wanted == pytest.approx(0.003)
        lost[exact is not None] = abs(body.observe().volume_variation)
    assert body.kept_volumes[0].pressure > 0 and body.kept_volumes[0].as_dict().keys() == {"name", "wanted", "error", "pressure"}
    assert lost[True] < 1e-12 and lost[False] > 0.05


def test_a_rigid_part_keeps_its_distances_and_the_rest_does_not():
    world = viscera.World(gravity=[0, -2, 0], step=0.01)
    end = between(0.2, 0.3)
    body = world.add(viscera.Body(MESH, 1000.0, model=viscera.MassSpring(LAW), fix="z-min", rigid=[end]))
    world.steps(40)
    rest, now = MESH.nodes, body.positions
    rigid = rest[:, 2] > 0.19
    distances = lambda x: np.linalg.norm(x[:, None] - x[None], axis=2)
    assert np.abs(distances(now[rigid]) - distances(rest[rigid])).max() < 1e-12
    assert np.abs(distances(now) - distances(rest)).max() > 1e-4


def test_active_tissue_shortens_to_where_its_stresses_balance():
    """E = 10 kPa with fibres of 4 kPa that are slack at 0.7 and pull with 1 kPa: a stretch of (10 + 2.8 - 1)/14, whoever steps it."""
    law = viscera.LinearElastic.from_young_poisson(10e3, 0.0)
    fibres = viscera.Actuator.along("all", [0, 0, 1], young=4e3, length=[(0.0, 1.0), (1.0, 0.7)], stress=[(0.0, 0.0), (1.0, 1e3)])
    for integrator in (viscera.Explicit(), viscera.Implicit()):
        world = viscera.World(gravity=[0, 0, 0], step=0.02, integrator=integrator)
        model = viscera.Corotational(law)
        body = world.add(viscera.Body(MESH, 1000.0, model=model, damping=30.0, fix="z-min", actuator=fibres))
        world.steps(150)
        assert body.positions[:, 2].max() / 0.3 == pytest.approx(11.8 / 14, abs=1e-4)


def test_an_actuator_and_a_field_pull_with_what_they_say():
    tendon = viscera.Actuator.between("z-min", "z-max", force=2.0)
    weight = viscera.Load.body_force("all", [0, -9810.0, 0])
    pull = viscera.Load.attraction("all", centre=[0.05, 0.05, 10.15], radius=1.0, per_volume=100.0)
    world = viscera.World(gravity=[0, 0, 0], step=0.01)
    body = world.add(
        viscera.Body(MESH, 1000.0, model=viscera.MassSpring(LAW), fix="all", actuator=[tendon], load=[weight, pull])
    )
    world.step()
    forces = body.external_forces
    assert forces[:, 1].sum() == pytest.approx(-9810 * 0.003, rel=1e-9)
    # A hundredth of 100 N/m³ on 3 litres ten metres off; the tendon adds nothing to the sum.
    assert forces[:, 2].sum() == pytest.approx(0.003, rel=1e-3)
    assert forces[MESH.nodes[:, 2] > 0.29, 2].sum() == pytest.approx(-2.0, rel=1e-3)


def test_a_muscle_pulls_as_activated():
    """A sheet of squares cut in two that is held pulls across every line with 3/2 S c a per metre."""
    plate = viscera.TetMesh.box_grid([8, 4, 1], [0.2, 0.1, 0.01])
    top = viscera.Region.plane([0, 0, 0.01], [0, 0, 1])
    muscle = viscera.Muscle(top, stiffness=40.0, contraction=0.3, activation=[(0.0, 0.0), (1.0, 1.0)])
    world = viscera.World(gravity=[0, 0, 0], step=0.01)
    body = world.add(viscera.Body(plate, 1000.0, model=viscera.Corotational(LAW), muscle=muscle, fix="all"))
    for time in (0.5, 1.0):
        world.steps(50)
        across = body.external_forces[plate.nodes[:, 0] < 0.06, 0].sum()
        assert across == pytest.approx(1.5 * 40 * 0.3 * time * 0.1, rel=1e-12)


@pytest.mark.parametrize(
    ("constraint", "says"),
    [
        ({"muscle": viscera.Muscle("z-max", stiffness=-1.0, contraction=0.3, activation=1.0)}, "muscle stiffness"),
        ({"muscle": viscera.Muscle("z-max", stiffness=1.0, contraction=1.0, activation=1.0)}, "muscle contraction"),
        ({"rigid": ["z-min"]}, "rigid"),
        ({"rigid": [between(0.2, 0.3), between(0.1, 0.2)]}, "rigid"),
    ],
)
def test_what_cannot_be_kept_is_refused(constraint, says):
    world = viscera.World()
    with pytest.raises(viscera.Error, match=says):
        world.add(viscera.Body(MESH, 1000.0, model=viscera.ShapeMemory(LAW), fix="z-min", **constraint))


def test_implicit_steps_refuse_constraints():
    world = viscera.World(integrator=viscera.Implicit())
    with pytest.raises(viscera.Error, match="volumes kept exactly"):
        world.add(viscera.Body(MESH, 1000.0, model=viscera.Corotational(LAW), keep_volume_exactly=("whole", "all")))


def test_constraints_are_written_to_run_to_the_same_bits(tmp_path):
    muscle = viscera.Muscle("y-max", stiffness=40.0, contraction=0.3, activation=[(0.0, 0.0), (0.1, 1.0)])
    world = viscera.World(step=0.005)
    body = viscera.Body(
        MESH, 1000.0, name="bar", model=viscera.ShapeMemory(LAW), fix="z-min", rigid=between(0.25, 0.3), muscle=muscle,
        keep_volume_exactly=[("whole", "all"), ("half", between(0, 0.15))],
    )  # fmt: skip
    body = world.add(body)
    again, _, _ = viscera.Scene.load(world.write_scene(tmp_path, duration=0.1)).build()
    world.steps(12)
    again.steps(12)
    assert np.array_equal(again.body("bar").positions, body.positions) and body.max_displacement > 1e-4
    assert [kept.as_dict() for kept in again.body("bar").kept_volumes] == [kept.as_dict() for kept in body.kept_volumes]
