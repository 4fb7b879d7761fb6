"""Standard errors of identified parameters: right in all units, infinite where nothing is known, conditioned on what a bound holds."""

import dataclasses

import numpy as np
import pytest

import viscera
from viscera.identify import Equilibrium, fit

MESH = viscera.TetMesh.box_grid([2, 2, 4], [0.1, 0.1, 0.2])


@dataclasses.dataclass
class Linear:
    """Measurements that are linear in the parameters: all there is to know about them is known."""

    matrix: np.ndarray
    measured: np.ndarray

    def residuals(self, p, gradients=True):
        return self.matrix @ list(p.values()) - self.measured, self.matrix if gradients else None


def textbook(matrix):
    """(AᵀA)⁻¹ with columns of length one, in twice the digits."""
    norms = np.linalg.norm(matrix, axis=0)
    columns = (matrix / norms).astype(np.longdouble)
    return np.linalg.inv((columns.T @ columns).astype(float)) / np.outer(norms, norms)


def drawn(scales, seed=0, rows=40):
    return np.random.default_rng(seed).normal(size=(rows, len(scales))) / np.asarray(scales)


@pytest.mark.parametrize("scales", [[1.0, 1.0], [1e9, 1e-6], [1e-12, 1e4]])
def test_standard_errors_follow_the_units_of_the_parameters(scales):
    """The same measurements in other units: a modulus in Pa beside a way in m, or a rate beside both."""
    matrix, noise = drawn(scales), np.random.default_rng(1).normal(0, 0.1, 40)
    truth = np.array([3.0, 5.0]) * scales
    result = fit([Linear(matrix, matrix @ truth + noise)], dict(zip("ab", truth * 1.5)))
    left = result.residuals
    wanted = textbook(matrix) * (left @ left) / 38
    assert np.allclose(result.covariance, wanted, rtol=1e-9, atol=0)
    assert np.allclose(list(result.standard_errors.values()), np.sqrt(np.diag(wanted)), rtol=1e-9, atol=0)
    assert np.all(np.abs(np.array(list(result.parameters.values())) - truth) < 4 * np.sqrt(np.diag(wanted)))


def test_known_deviations_count_and_the_scatter_does_not():
    """Residuals that are ten times too small for their deviations leave the errors what the deviations say."""
    matrix = drawn([1e4, 0.3])
    noise = np.random.default_rng(2).normal(0, 0.1, 40)
    experiment = Linear(matrix, matrix @ [2e4, 0.4] + noise)
    known, scattered = (fit([experiment], {"young": 1e4, "poisson": 0.1}, known_deviations=known) for known in (True, False))
    assert np.allclose(known.covariance, textbook(matrix), rtol=1e-9, atol=0)
    ratio = scattered.standard_errors["young"] / known.standard_errors["young"]
    assert ratio == pytest.approx(np.sqrt(known.residuals @ known.residuals / 38), rel=1e-9)


def test_what_only_two_parameters_say_together_is_known_of_neither_and_the_third_keeps_its_error():
    """Columns 0 and 1 are parallel: their sum is known, and neither of them."""
    matrix = drawn([1e4, 1.0, 1e-3])
    matrix[:, 1] = 3e4 * matrix[:, 0]
    noise = np.random.default_rng(3).normal(0, 0.1, 40)
    result = fit([Linear(matrix, matrix @ [1e4, 1.0, 2e-3] + noise)], {"a": 2e4, "b": 2.0, "c": 1e-3})
    assert np.isinf(result.standard_errors["a"]) and np.isinf(result.standard_errors["b"])
    alone = textbook(matrix[:, [0, 2]])[1, 1] * (result.residuals @ result.residuals) / 38
    assert result.standard_errors["c"] == pytest.approx(np.sqrt(alone), rel=1e-9)
    assert "a = " in str(result) and str(result).count("not identifiable") == 2


@pytest.mark.parametrize("effect", [0.0, 1e-14])
def test_a_parameter_without_effect_has_an_infinite_error(effect):
    """Rounding in a gradient is no knowledge."""
    matrix = drawn([1.0, 1.0])
    matrix[:, 1] *= effect
    result = fit([Linear(matrix, matrix @ [1.0, 1.0] + 0.01)], {"a": 2.0, "b": 1.0})
    assert np.isinf(result.standard_errors["b"]) and np.isfinite(result.standard_errors["a"])


def test_as_many_parameters_as_measurements_leave_no_scatter_to_judge_by():
    matrix = drawn([1.0, 1.0], rows=2)
    experiment = Linear(matrix, matrix @ [1.0, 2.0])
    assert all(map(np.isinf, fit([experiment], {"a": 2.0, "b": 1.0}).standard_errors.values()))
    known = fit([experiment], {"a": 2.0, "b": 1.0}, known_deviations=True)
    assert np.allclose(known.covariance, textbook(matrix), rtol=1e-8)
    fewer = fit([Linear(matrix[:1], matrix[:1] @ [1.0, 2.0])], {"a": 2.0, "b": 1.0}, known_deviations=True)
    assert all(map(np.isinf, fewer.standard_errors.values()))


def test_errors_beside_a_bound_are_those_of_a_fit_that_knows_the_parameter():
    matrix = drawn([1.0, 1.0, 1.0])
    matrix[:, 1] += matrix[:, 0]
    noise = np.random.default_rng(4).normal(0, 0.1, 40)
    experiment = Linear(matrix, matrix @ [1.0, 5.0, 2.0] + noise)
    bounded = fit([experiment], {"a": 1.0, "b": 1.0, "c": 1.0}, {"b": (0.0, 3.0)})
    known = fit([Linear(matrix[:, [0, 2]], experiment.measured - 3.0 * matrix[:, 1])], {"a": 1.0, "c": 1.0})
    assert bounded.at_bound == ["b"] and bounded.parameters["b"] == 3.0
    assert np.isnan(bounded.standard_errors["b"]) and not bounded.covariance[1].any()
    for name in "ac":
        assert bounded.parameters[name] == pytest.approx(known.parameters[name], rel=1e-7)
        assert bounded.standard_errors[name] == pytest.approx(known.standard_errors[name], rel=1e-7)
    loose, tight = (fit([experiment], {"a": 1.0, "b": 1.0, "c": 1.0}, bounds, known_deviations=True) for bounds in ({}, {"b": (0.0, 3.0)}))
    assert loose.standard_errors["a"] > 1.2 * tight.standard_errors["a"]
    assert "b = 3 held by its bound" in str(bounded)


def hanging(p):
    law = viscera.NeoHookean.from_young_poisson(p["young"], p.get("poisson", 0.4))
    return viscera.Body(MESH, p["density"], model=viscera.TotalLagrangian(law), fix="z-min")


def test_weight_alone_tells_the_ratio_of_density_and_modulus_and_neither_of_them():
    """Both twice as large hang the same."""
    body = viscera.World(gravity=[0, -2, 0]).add(hanging({"young": 8e3, "density": 1000.0}))
    body.settle()
    nodes = MESH.nodes_in("z-max")
    places = body.positions[nodes] + np.random.default_rng(5).normal(0, 1e-4, (len(nodes), 3))
    experiment = Equilibrium(hanging, gravity=[0, -2, 0], nodes=nodes, positions=places, deviation=1e-4)
    both = fit([experiment], {"young": 7e3, "density": 1100.0}, known_deviations=True)
    assert all(map(np.isinf, both.standard_errors.values()))
    ratio = both.parameters["young"] / both.parameters["density"]
    assert ratio == pytest.approx(8.0, rel=0.05)


def test_known_deviations_claim_what_repeated_measurements_scatter():
    """Noise of 0.1 mm is known: over eight measurements the modulus scatters as each of them claims, to the digits eight of them give."""
    truth = {"young": 8e3, "density": 1000.0}
    body = viscera.World(gravity=[0, -2, 0]).add(hanging(truth))
    body.settle()
    nodes = MESH.nodes_in("z-max")
    found, claimed = [], []
    for seed in range(8):
        places = body.positions[nodes] + np.random.default_rng(seed).normal(0, 1e-4, (len(nodes), 3))
        model = lambda p: hanging({"density": 1000.0, **p})
        experiment = Equilibrium(model, gravity=[0, -2, 0], nodes=nodes, positions=places, deviation=1e-4)
        result = fit([experiment], {"young": 7e3}, known_deviations=True)
        found.append(result.parameters["young"])
        claimed.append(result.standard_errors["young"])
    assert np.std(claimed) < 0.05 * np.mean(claimed)
    assert 0.4 < np.std(found, ddof=1) / np.mean(claimed) < 1.7
    assert abs(np.mean(found) - 8e3) < 4 * np.mean(claimed) / np.sqrt(8)
