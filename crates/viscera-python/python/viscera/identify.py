"""Parameters of tissue from measured positions and forces.

Gauss–Newton (Levenberg–Marquardt) with exact gradients: one load costs its equilibrium and one factorisation, a motion one linear
solve with as many right-hand sides as there are parameters in each of its steps. At an equilibrium f(x, p) = f_ext,

    K dx/dp = −∂f/∂p + ∂f_ext/∂p,

and a step of backward Euler has (1/dt² + γ/dt) M + K in place of K, and what the step before hands on at its right. ∂f/∂p at fixed
positions is a central difference of the forces, which are smooth in the parameters and cost no solve.

    body = lambda p: viscera.Body(mesh, 1000, model=viscera.TotalLagrangian(
        viscera.NeoHookean.from_young_poisson(**p)), fix="z-min")
    hanging = viscera.identify.Equilibrium(body, gravity=[0, 0, -9.81], nodes=skin, positions=measured)
    result = viscera.identify.fit([hanging], start={"young": 5e3, "poisson": 0.3}, bounds={"poisson": (0.0, 0.49)})
    print(result)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ._viscera import Body, Error, Implicit, World

#: Share of a parameter by which it is varied for ∂f/∂p: rounding (1e-16/h) and truncation (h²) meet near it.
_VARIATION = 1e-5
#: What gradients are off by, as a share of the largest.
_GRADIENT_ERROR = 1e-9

Parameters = Mapping[str, float]
BodyOf = Callable[[Parameters], Body]


def _ends(body: BodyOf, p: Parameters, name: str, of: Callable[[Body], np.ndarray]) -> np.ndarray:
    """Central difference of what is computed of the body, by one of its parameters."""
    step = _VARIATION * max(abs(p[name]), _VARIATION)
    ends = [of(body({**p, name: p[name] + sign * step})) for sign in (1.0, -1.0)]
    return (ends[0] - ends[1]) / (2 * step)


def _varied_forces(body: BodyOf, p: Parameters, x) -> np.ndarray:
    """∂f_int/∂p at positions x [N per unit of the parameter]; shape (parameters, n, 3)."""
    return np.array([_ends(body, p, name, lambda made: _simulate(made).forces_at(x)) for name in p])


def _varied_residuals(body: BodyOf, p: Parameters, x, gravity) -> np.ndarray:
    """The same of f_int − f_ext, gravity and loads included."""

    def residual(made: Body) -> np.ndarray:
        simulated = _simulate(made, gravity=gravity)
        simulated.positions = x
        return simulated.forces_at(x) - simulated.external_forces

    return np.array([_ends(body, p, name, residual) for name in p])


def _varied_ways(body: BodyOf, p: Parameters, gravity, driven) -> np.ndarray:
    """A displacement for each parameter that moves what is driven as the parameter does, and the rest somehow; shape (parameters, n, 3).

    One linear solve puts what is driven into its place. Where the parameter moves nothing of it, nothing is moved.
    """

    def placed(made: Body) -> np.ndarray:
        simulated = _simulate(made, gravity=gravity)
        simulated.settle(small_strain=True)
        return simulated.positions

    ways = np.array([_ends(body, p, name, placed) for name in p])
    moves = np.abs(ways[:, driven]).max(axis=(1, 2), initial=0.0) > 1e-9 * np.abs(ways).max(axis=(1, 2), initial=0.0)
    return ways * moves[:, None, None]


def _simulate(body: Body, **world):
    """The body alone in a world, in double precision."""
    return World(precision="double", **world).add(body)


@dataclass
class Equilibrium:
    """A body at rest under a load, of which positions, or the force on a region, or both were measured.

    ``body``: makes the body from a dict of parameters: of its tissue, its density, its loads, the ways of what is prescribed (of which, where
    pressures act as well, gradients leave out how these turn). ``nodes``, ``positions``: which nodes were seen where [m, shape (k, 3)]; NaN
    for coordinates that were not. ``points``: instead of nodes, weights of shape (k, n) (a row sums to 1) for places between
    nodes. ``force_on``: nodes of a region on which ``force`` [N, shape (3,)] was measured: what holds the region, so +weight for what
    stands on it. ``deviation`` [m] and ``force_deviation`` [N]: standard deviations of one number; where they are not known, leave
    them, and the scatter of the residuals takes their place.
    """

    body: BodyOf
    gravity: Sequence[float] = (0.0, -9.81, 0.0)
    nodes: ArrayLike | None = None
    points: np.ndarray | None = None
    positions: np.ndarray | None = None
    force_on: ArrayLike | None = None
    force: ArrayLike | None = None
    deviation: float = 1.0
    force_deviation: float = 1.0
    solver: str = "direct"
    _start: np.ndarray | None = field(default=None, repr=False)

    def __post_init__(self):
        if self.positions is None and self.force is None:
            raise ValueError("nothing was measured: give `positions` of `nodes` or `points`, or a `force` on `force_on`")
        if self.positions is not None and (self.nodes is None) == (self.points is None):
            raise ValueError("say where the positions are: give either `nodes` or `points`")
        if not (self.deviation > 0 and self.force_deviation > 0):
            raise ValueError("standard deviations must be positive")

    def _seen(self, vectors):
        """The measured places among vectors at the nodes."""
        return vectors[np.asarray(self.nodes)] if self.points is None else np.asarray(self.points) @ vectors

    def residuals(self, p: Parameters, gradients: bool = True):
        """Computed less measured, over the standard deviations, and their derivatives by the parameters; shapes (m,), (m, k)."""
        body = _simulate(self.body(p), gravity=self.gravity)
        # From the last equilibrium, unless a plate has to go its way again: the tissue before it would be crushed.
        if self._start is not None and not {"prescribed", "guided"} & set(body.motions):
            body.positions = self._start
        body.settle(solver=self.solver)
        x = body.positions
        self._start = x
        slopes = moved = np.zeros((0, *x.shape))
        if gradients:
            driven = np.isin(body.motions, ("prescribed", "guided"))
            slopes = _varied_residuals(self.body, p, x, self.gravity)
            ways = _varied_ways(self.body, p, self.gravity, driven) if driven.any() else np.zeros_like(slopes)
            pulled = slopes + np.array([body.product_at(x, way) if way.any() else way for way in ways])
            moved = ways + body.respond(-pulled, solver=self.solver)
        rows, columns = [], []
        if self.positions is not None:
            known = np.isfinite(self.positions)
            rows.append((self._seen(x) - self.positions)[known] / self.deviation)
            if gradients:
                columns.append(np.array([self._seen(u)[known] for u in moved]).T / self.deviation)
        if self.force is not None:
            held = np.asarray(self.force_on)
            reaction = (body.internal_forces - body.external_forces)[held].sum(axis=0)
            rows.append((reaction - np.asarray(self.force)) / self.force_deviation)
            if gradients:
                by_parameter = [(df + body.product_at(x, u))[held].sum(axis=0) for df, u in zip(slopes, moved)]
                columns.append(np.array(by_parameter).T / self.force_deviation)
        return np.concatenate(rows), np.concatenate(columns) if gradients else None


@dataclass
class Motion:
    """A body in motion, of which positions, or the force on what holds it, or both were measured at some of its steps.

    ``body``: makes the body from a dict of parameters: of its law, and of its ``damping``. It starts at rest, or at ``start`` with ``velocity``
    (shape (n, 3)), and moves by backward Euler steps of ``step`` [s], solved in full. ``seen``: for a step's number, from 1, the positions of
    ``nodes`` [m, shape (k, 3), NaN for coordinates that were not seen]. ``forces``: for a step's number the force [N, shape (3,)] on ``force_on``,
    nodes that are fixed. ``deviation`` [m] and ``force_deviation`` [N] are as for `Equilibrium`.
    """

    body: BodyOf
    step: float
    nodes: ArrayLike | None = None
    seen: Mapping[int, np.ndarray] = field(default_factory=dict)
    gravity: Sequence[float] = (0.0, -9.81, 0.0)
    deviation: float = 1.0
    start: np.ndarray | None = None
    velocity: np.ndarray | None = None
    force_on: ArrayLike | None = None
    forces: Mapping[int, ArrayLike] = field(default_factory=dict)
    force_deviation: float = 1.0
    solver: str = "direct"

    def __post_init__(self):
        if not (self.seen or self.forces):
            raise ValueError("nothing was measured: give positions (`seen`) or `forces` for at least one step")
        if self.seen and self.nodes is None:
            raise ValueError("say where the positions are: give `nodes`")
        if self.forces and self.force_on is None:
            raise ValueError("say where the forces are: give `force_on`, nodes that are fixed")
        if not (self.deviation > 0 and self.force_deviation > 0):
            raise ValueError("standard deviations must be positive")
        if first := [number for number in (*self.seen, *self.forces) if number < 1]:
            raise ValueError(f"step {first[0]} was not made: steps are numbered from 1")

    def _check(self, made: Body, p: Parameters, gradients: bool) -> None:
        """Refuses what the gradients leave out."""
        if made.stiffness_damping:
            raise ValueError(
                f"stiffness_damping = {made.stiffness_damping} s: its forces turn with the stiffness, whose derivative a motion's gradients do not "
                "have; describe the body with `damping`"
            )
        if not gradients:
            return

        def given(body: Body) -> np.ndarray:
            simulated = _simulate(body, gravity=self.gravity)
            return np.concatenate([simulated.masses, simulated.external_forces.ravel()])

        for name in p:
            if _ends(self.body, p, name, given).any():
                raise ValueError(
                    f"`{name}` changes the masses of the body or its loads: a motion identifies parameters of the law and of `damping`; an "
                    "`Equilibrium` identifies loads and densities"
                )

    def residuals(self, p: Parameters, gradients: bool = True):
        """Computed less measured, over the standard deviations, and their derivatives by the parameters; shapes (m,), (m, k)."""
        scheme = Implicit(newton="full", newton_tolerance=1e-11, linear_tolerance=1e-9)
        made = self.body(p)
        self._check(made, p, gradients)
        body = _simulate(made, gravity=self.gravity, step=self.step, integrator=scheme)
        held = np.asarray(self.force_on if self.force_on is not None else [], dtype=np.int64)
        if not all(body.motions[node] == "fixed" for node in held):
            raise ValueError("`force_on` holds nodes that are not fixed: the force on others is also their inertia")
        if self.start is not None:
            body.positions = self.start
        if self.velocity is not None:
            body.velocities = self.velocity
        nodes, masses = np.asarray(self.nodes if self.nodes is not None else [], dtype=np.int64), body.masses[:, None]
        still = np.zeros((len(p), *body.mesh.nodes.shape))
        moved, speed, before = still, still, body.positions
        inertia = 1 / self.step**2 + made.damping / self.step
        braking = np.array([_ends(self.body, p, name, lambda body: np.array(body.damping)) for name in p]) if gradients else still
        rows, columns = [], []
        for number in range(1, max((*self.seen, *self.forces)) + 1):
            body.world.step()
            x = body.positions
            if gradients:
                slopes = _varied_forces(self.body, p, x)
                handed_on = masses * (inertia * moved + speed / self.step)
                braked = braking[:, None, None] * (masses * (x - before) / self.step)
                after = body.respond(handed_on - slopes - braked, inertia=inertia, solver=self.solver)
                moved, speed = after, (after - moved) / self.step
            if number in self.seen:
                measured = np.asarray(self.seen[number], dtype=float)
                known = np.isfinite(measured)
                rows.append((x[nodes] - measured)[known] / self.deviation)
                if gradients:
                    columns.append(np.array([u[nodes][known] for u in moved]).T / self.deviation)
            if number in self.forces:
                reaction = (body.internal_forces - body.external_forces)[held].sum(axis=0)
                rows.append((reaction - np.asarray(self.forces[number], dtype=float)) / self.force_deviation)
                if gradients:
                    by_parameter = [(df + body.product_at(x, u))[held].sum(axis=0) for df, u in zip(slopes, moved)]
                    columns.append(np.array(by_parameter).T / self.force_deviation)
            before = x
        return np.concatenate(rows), np.concatenate(columns) if gradients else None


@dataclass
class Fit:
    """What was found."""

    #: Values by name.
    parameters: dict[str, float]
    #: Standard errors by name, in the units of the parameters: the roots of the covariance's diagonal. Infinite for what the measurements say
    #: nothing about, alone or together with others; NaN for what a bound holds.
    standard_errors: dict[str, float]
    #: Covariance s² (JᵀJ)⁻¹ in the order of `parameters`, with s² the scatter of the residuals, or 1 where deviations were given. What a bound
    #: holds is taken as known: its rows are 0. Between parameters of infinite error and others it is NaN.
    covariance: np.ndarray
    #: Residuals over their deviations at the end.
    residuals: np.ndarray
    #: ½ Σ r² after each iteration, and at the start.
    costs: list[float]
    #: Whether the last step was below the tolerance.
    converged: bool
    #: Parameters that ended at one of their bounds.
    at_bound: list[str]

    def __str__(self):
        def error(name):
            found = self.standard_errors[name]
            return "held by its bound" if np.isnan(found) else "not identifiable" if np.isinf(found) else f"± {found:.2g}"

        lines = [f"{name} = {value:.6g} {error(name)}" for name, value in self.parameters.items()]
        return "\n".join([*lines, f"{len(self.costs) - 1} iterations, {'converged' if self.converged else 'not converged'}"])


def _without_effect(norms: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Which parameters change the residuals, if they change by their own size, by less than gradients are off."""
    effect = norms * size
    return (norms == 0) | ((size > 0) & (effect <= _GRADIENT_ERROR * effect.max(initial=0.0)))


def _covariance(jacobian: np.ndarray, residuals: np.ndarray, free: np.ndarray, size: np.ndarray, known_deviations: bool) -> np.ndarray:
    """Covariance of the parameters: of the `free` ones where those that a bound holds are known.

    Columns are brought to length one first, so that it does not depend on units. What changes the residuals by less than the gradients'
    own error is not identifiable: its variance is infinite.
    """
    count = len(free)
    covariance = np.zeros((count, count))
    norms = np.linalg.norm(jacobian, axis=0)
    blind = free & _without_effect(norms, size)
    seen = np.flatnonzero(free & ~blind)
    rank = 0
    if seen.size:
        _, values, directions = np.linalg.svd(jacobian[:, seen] / norms[seen], full_matrices=False)
        values, directions = np.pad(values, (0, max(0, seen.size - values.size))), _completed(directions, seen.size)
        null = values <= 10 * _GRADIENT_ERROR * values[0]
        rank = int(np.sum(~null))
        loose = np.abs(directions[null]).max(axis=0, initial=0.0) > 1e-5
        blind[seen[loose]] = True
        spread = directions[~null] / values[~null, None]
        covariance[np.ix_(seen, seen)] = spread.T @ spread / np.outer(norms[seen], norms[seen])
    freedom = len(residuals) - rank
    if known_deviations:
        variance = 1.0
    elif freedom > 0:
        variance = float(residuals @ residuals) / freedom
    else:
        # As many parameters as measurements: nothing is left that would scatter.
        variance, blind = 1.0, free.copy()
    covariance *= variance
    covariance[blind] = np.nan
    covariance[:, blind] = np.nan
    covariance[blind, blind] = np.inf
    return covariance


def _completed(directions: np.ndarray, count: int) -> np.ndarray:
    """All directions: those that fewer measurements than parameters leave out span the rest."""
    if len(directions) == count:
        return directions
    _, _, all_directions = np.linalg.svd(directions)
    return np.vstack([directions, all_directions[len(directions) :]])


def fit(
    experiments: Sequence[Equilibrium | Motion],
    start: Parameters,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    *,
    known_deviations: bool = False,
    tolerance: float = 1e-8,
    iterations: int = 50,
) -> Fit:
    """The parameters that fit all experiments best in the least squares of their residuals.

    ``start``: the parameters to begin with. ``bounds``: (least, most) by name. ``known_deviations``: whether the experiments' deviations are
    those of the measurement, so that uncertainties follow from them and not from the scatter. ``tolerance``: relative change of the
    parameters at which to stop. Values at which a body has no equilibrium are stepped back from.
    """
    names = list(start)
    bounds = dict(bounds or {})
    if unknown := set(bounds) - set(names):
        raise ValueError(f"bounds are given for {sorted(unknown)}, which are no parameters; there are {names}")
    low = np.array([bounds.get(name, (-np.inf, np.inf))[0] for name in names], dtype=float)
    high = np.array([bounds.get(name, (-np.inf, np.inf))[1] for name in names], dtype=float)
    theta = np.array([start[name] for name in names], dtype=float)
    begun = np.abs(theta)
    if np.any(theta < low) or np.any(theta > high):
        raise ValueError("the start lies outside of the bounds")

    def evaluate(values, gradients):
        parts = [experiment.residuals(dict(zip(names, values.tolist())), gradients) for experiment in experiments]
        residuals = np.concatenate([part[0] for part in parts])
        return residuals, np.concatenate([part[1] for part in parts]) if gradients else None

    residuals, jacobian = evaluate(theta, True)
    costs, damping, converged = [0.5 * float(residuals @ residuals)], 1e-4, False
    while len(costs) <= iterations and not converged:
        gradient = jacobian.T @ residuals
        # What lies at a bound and is drawn beyond it takes no part in the step.
        free = ~(((theta <= low) & (gradient > 0)) | ((theta >= high) & (gradient < 0)))
        norms = np.linalg.norm(jacobian, axis=0)
        active = np.flatnonzero(free & ~_without_effect(norms, np.maximum(np.abs(theta), begun)))
        if not active.size:
            converged = True
            break
        # Columns of length one: parameters of 10 kPa and of 1 mm weigh the same.
        columns = jacobian[:, active] / norms[active]
        hessian = columns.T @ columns
        while True:
            step = np.zeros_like(theta)
            matrix = hessian + damping * np.eye(active.size)
            step[active] = -np.linalg.solve(matrix, gradient[active] / norms[active]) / norms[active]
            trial = np.clip(theta + step, low, high)
            change = np.max(np.abs(trial - theta) / np.maximum(np.abs(theta), np.finfo(float).tiny))
            try:
                tried, _ = evaluate(trial, False)
                cost = 0.5 * float(tried @ tried)
            except Error:
                cost = np.inf
            if cost <= costs[-1]:
                damping = max(damping / 9, 1e-12)
                theta, converged = trial, bool(change < tolerance)
                residuals, jacobian = evaluate(theta, True)
                costs.append(cost)
                break
            if change < tolerance or damping > 1e12:
                converged = bool(change < tolerance)
                iterations = 0
                break
            damping *= 11
    gradient = jacobian.T @ residuals
    held = ((theta <= low) & (gradient > 0)) | ((theta >= high) & (gradient < 0))
    covariance = _covariance(jacobian, residuals, ~held, np.maximum(np.abs(theta), begun), known_deviations)
    errors = np.where(held, np.nan, np.sqrt(np.diag(covariance)))
    return Fit(
        parameters=dict(zip(names, theta.tolist())),
        standard_errors=dict(zip(names, errors.tolist())),
        covariance=covariance,
        residuals=residuals,
        costs=costs,
        converged=converged,
        at_bound=[name for name, value, least, most in zip(names, theta, low, high) if value <= least or value >= most],
    )
