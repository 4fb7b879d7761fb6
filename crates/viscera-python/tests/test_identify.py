"""Parameters from measurements: gradients against finite differences, and values that come back from noisy data."""

import numpy as np
import pytest

import viscera
from viscera.identify import Equilibrium, Motion, fit

MESH = viscera.TetMesh.box_grid([2, 2, 4], [0.1, 0.1, 0.2])


def block(p, **more):
    law = viscera.NeoHookean.from_young_poisson(**p)
    return viscera.Body(MESH, 1000.0, model=viscera.TotalLagrangian(law), fix="z-min", **more)


def pulled(p):
    return block(p, load=viscera.Load.traction("z-max", [300.0, 0.0, 600.0]))


def check_gradient(experiment, p):
    """The Jacobian against central differences of whole solves; their own error is 1e-6 of the largest entry and less."""
    _, jacobian = experiment.residuals(p)
    for column, (name, value) in enumerate(p.items()):
        h = 1e-4 * value
        ends = [experiment.residuals({**p, name: value + sign * h}, gradients=False)[0] for sign in (1, -1)]
        slope = (ends[0] - ends[1]) / (2 * h)
        assert np.abs(jacobian[:, column] - slope).max() < 2e-6 * np.abs(slope).max(), name


def test_gradients_of_positions_at_rest_cost_one_solve_and_are_right():
    nodes = MESH.nodes_in("z-max")
    check_gradient(Equilibrium(pulled, gravity=[0, -1, 0], nodes=nodes, positions=MESH.nodes[nodes]), {"young": 8e3, "poisson": 0.4})


def test_gradients_of_a_measured_force_are_right():
    def pressed(p):
        return block(p, prescribe=("z-max", [0.0, 0.0, -0.02]))

    plate = MESH.nodes_in("z-max")
    check_gradient(Equilibrium(pressed, gravity=[0, 0, 0], force_on=plate, force=[0, 0, -10]), {"young": 8e3, "poisson": 0.4})


@pytest.mark.parametrize("measured", ["positions", "force"])
def test_gradients_by_density_load_and_way_are_right(measured):
    """What pulls, what hangs and where the plate is brought are parameters as well as what the tissue is."""

    def loaded(p):
        law = viscera.NeoHookean.from_young_poisson(p["young"], 0.4)
        pull = viscera.Load.traction("x-max", [p["pull"], 0.0, 0.0])
        plate = ("z-max", [0.0, p["across"], p["way"]])
        return viscera.Body(MESH, p["density"], model=viscera.TotalLagrangian(law), fix="z-min", prescribe=plate, load=pull)

    p = {"young": 8e3, "density": 1100.0, "pull": 150.0, "way": -0.015, "across": 0.01}
    plate, skin = MESH.nodes_in("z-max"), MESH.nodes_in("x-max")
    measurement = {"positions": {"nodes": skin, "positions": MESH.nodes[skin]}, "force": {"force_on": plate, "force": [0, 0, -10]}}
    check_gradient(Equilibrium(loaded, gravity=[0, -3, 0], **measurement[measured]), p)


def test_gradients_of_a_motion_are_handed_on_from_step_to_step():
    nodes = MESH.nodes_in("z-max")
    seen = {2: MESH.nodes[nodes], 4: MESH.nodes[nodes]}
    motion = Motion(lambda p: block(p, damping=3.0), step=0.02, nodes=nodes, seen=seen, gravity=[0, -5, 0])
    check_gradient(motion, {"young": 8e3, "poisson": 0.4})


def braked(p):
    return block({"young": p["young"], "poisson": 0.4}, damping=p["damping"])


@pytest.mark.parametrize("measured", ["positions", "forces"])
def test_gradients_of_a_motion_by_its_damping_and_of_the_force_that_holds_it_are_right(measured):
    """The body says what damps it; the force on its fixed end is that of the tissue there."""
    nodes, held = MESH.nodes_in("z-max"), MESH.nodes_in("z-min")
    steps = {"positions": {"nodes": nodes, "seen": {3: MESH.nodes[nodes]}}, "forces": {"force_on": held, "forces": {1: [0, 0, 0], 4: [0, 9, 0]}}}
    motion = Motion(braked, step=0.02, gravity=[0, -5, 0], **steps[measured])
    check_gradient(motion, {"young": 8e3, "damping": 3.0})


def test_modulus_and_damping_come_back_from_a_motion_and_the_force_that_holds_it():
    truth = {"young": 7e3, "damping": 4.0}
    nodes, held = MESH.nodes_in("z-max"), MESH.nodes_in("z-min")
    scheme = viscera.Implicit(newton="full", newton_tolerance=1e-11, linear_tolerance=1e-9)
    body = viscera.World(gravity=[0, -5, 0], step=0.02, integrator=scheme).add(braked(truth))
    seen, forces = {}, {}
    for number in range(1, 11):
        body.world.step()
        if number % 2:
            seen[number] = body.positions[nodes]
        else:
            forces[number] = (body.internal_forces - body.external_forces)[held].sum(axis=0)
    for measured in ({"nodes": nodes, "seen": seen}, {"force_on": held, "forces": forces}):
        result = fit([Motion(braked, step=0.02, gravity=[0, -5, 0], **measured)], {"young": 4e3, "damping": 1.0}, {"damping": (0.0, 50.0)})
        assert result.converged
        for name, value in truth.items():
            assert result.parameters[name] == pytest.approx(value, rel=1e-5)


def test_what_the_gradients_of_a_motion_leave_out_is_refused_with_a_reason():
    nodes = MESH.nodes_in("z-max")
    measured = {"step": 0.02, "nodes": nodes, "seen": {1: MESH.nodes[nodes]}}
    with pytest.raises(ValueError, match="stiffness_damping = 0.01 s: its forces turn with the stiffness"):
        fit([Motion(lambda p: block({**p, "poisson": 0.4}, stiffness_damping=0.01), **measured)], {"young": 8e3})

    def heavy(p):
        law = viscera.NeoHookean.from_young_poisson(8e3, 0.4)
        return viscera.Body(MESH, p["density"], model=viscera.TotalLagrangian(law), fix="z-min")

    def loaded(p):
        return block({"young": 8e3, "poisson": 0.4}, load=viscera.Load.traction("z-max", [p["pull"], 0.0, 0.0]))

    for body, p in ((heavy, {"density": 1000.0}), (loaded, {"pull": 10.0})):
        with pytest.raises(ValueError, match=f"`{next(iter(p))}` changes the masses of the body or its loads"):
            fit([Motion(body, **measured)], p)
    with pytest.raises(ValueError, match="nodes that are not fixed"):
        fit([Motion(braked, step=0.02, force_on=nodes, forces={1: [0, 0, 0]})], {"young": 8e3, "damping": 1.0})
    for wrong, says in (
        ({"seen": {1: MESH.nodes}}, "give `nodes`"),
        ({"forces": {1: [0, 0, 0]}}, "give `force_on`"),
        ({}, "nothing was measured"),
        ({"nodes": nodes, "seen": {0: MESH.nodes[nodes]}}, "numbered from 1"),
        ({**measured, "deviation": 0.0}, "must be positive"),
    ):
        with pytest.raises(ValueError, match=says):
            Motion(braked, **{"step": 0.02, **wrong})


def test_young_and_poisson_come_back_from_noisy_points_of_the_skin():
    """Noise of 0.2 mm: the true values lie within four standard errors, and the errors are those of repeated measurements."""
    truth = {"young": 7e3, "poisson": 0.38}
    body = viscera.World(gravity=[0, -1, 0]).add(pulled(truth))
    body.settle()
    skin = np.unique(MESH.surface().triangles)
    found, claimed = [], []
    for seed in range(6):
        noise = np.random.default_rng(seed).normal(0, 2e-4, (len(skin), 3))
        measured = Equilibrium(pulled, gravity=[0, -1, 0], nodes=skin, positions=body.positions[skin] + noise)
        result = fit([measured], {"young": 4e3, "poisson": 0.2}, {"poisson": (0.0, 0.49), "young": (500.0, 5e4)})
        assert result.converged and not result.at_bound
        for name, value in truth.items():
            assert abs(result.parameters[name] - value) < 4 * result.standard_errors[name]
        found.append(list(result.parameters.values()))
        claimed.append(list(result.standard_errors.values()))
    # The scatter of six fits knows its own deviation to a third.
    ratio = np.std(found, axis=0, ddof=1) / np.mean(claimed, axis=0)
    assert np.all((0.3 < ratio) & (ratio < 2.0)), ratio


def test_a_parameter_that_is_drawn_beyond_its_bound_stays_there_and_says_so():
    truth = {"young": 7e3, "poisson": 0.45}
    body = viscera.World(gravity=[0, -1, 0]).add(pulled(truth))
    body.settle()
    nodes = MESH.nodes_in("z-max")
    measured = Equilibrium(pulled, gravity=[0, -1, 0], nodes=nodes, positions=body.positions[nodes])
    result = fit([measured], {"young": 4e3, "poisson": 0.2}, {"poisson": (0.0, 0.3)})
    assert result.at_bound == ["poisson"] and result.parameters["poisson"] == 0.3


def test_a_modulus_comes_back_from_a_force_where_places_are_given():
    """Placed on both ends, the modulus shows in the force alone, and in proportion: two iterations."""

    def pressed(p):
        return block({**p, "poisson": 0.4}, prescribe=("z-max", [0.0, 0.0, -0.02]))

    plate = MESH.nodes_in("z-max")
    body = viscera.World(gravity=[0, 0, 0]).add(pressed({"young": 6e3}))
    body.settle()
    force = (body.internal_forces - body.external_forces)[plate].sum(axis=0)
    result = fit([Equilibrium(pressed, gravity=[0, 0, 0], force_on=plate, force=force)], {"young": 2e3})
    assert result.parameters["young"] == pytest.approx(6e3, rel=1e-7)


def test_experiments_without_measurements_are_refused():
    with pytest.raises(ValueError, match="nothing was measured"):
        Equilibrium(pulled)
    with pytest.raises(ValueError, match="which are no parameters"):
        fit([], {"young": 1.0}, {"yung": (0, 1)})
