"""The tasks: reach, grasp and lift, retract, cut to a line."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

import viscera

from .episode import Episode


@lru_cache(maxsize=8)
def _liver(cells: int) -> viscera.TetMesh:
    """A liver of 24 cm of about so many tetrahedra."""
    edge = 0.03
    for _ in range(12):
        mesh = viscera.TetMesh.liver(0.24, edge)
        if abs(len(mesh) / cells - 1) < 0.05:
            break
        edge *= (len(mesh) / cells) ** (1 / 3)
    return mesh


@lru_cache(maxsize=8)
def _liver_of_edge(edge: float) -> viscera.TetMesh:
    return viscera.TetMesh.liver(0.24, edge)


@lru_cache(maxsize=8)
def _sheet(along: int, side: float, thickness: float) -> viscera.TetMesh:
    """A square sheet around the origin in the plane y = 0, one cell thick and so many along each side."""
    mesh = viscera.TetMesh.box_grid([along, 1, along], [side, thickness, side])
    return mesh.with_nodes(mesh.nodes - np.array([side / 2, thickness / 2, side / 2]))


def _along(cells: int, side: float, edge: float | None) -> int:
    """How many cells a sheet has along a side."""
    return max(2, round((cells / 6) ** 0.5 if edge is None else side / edge))


class _OnLiver(Episode):
    """A liver that is held at its back."""

    def mesh(self, edge):
        return _liver(self.settings.cells) if edge is None else _liver_of_edge(edge)

    #: Middle of what is held [m].
    back = (0.0, 0.01, -0.025)

    def held(self):
        return viscera.Region.sphere(list(self.back), 0.035)

    def _top(self, rng) -> int:
        """A node of the upper side, away from what is held."""
        nodes = self.rest[self.skin]
        upper = nodes[:, 1] > np.quantile(nodes[:, 1], 0.6)
        away = np.linalg.norm(nodes - np.array(self.back), axis=1) > 0.055
        return int(rng.choice(self.skin[upper & away]))


class Reach(_OnLiver):
    """Bring the tip of a probe to a place just above the liver without pressing into it.

    Reward: what the way to the goal shortens [over 10 cm], and 1 when the tip is within 5 mm of it.
    """

    actions = 3

    def tool(self):
        return viscera.Probe(self.home, shaft=(2.5e-3, 0.3))

    def place(self, rng):
        self._goal = self.rest[self._top(rng)] + np.array([0.0, 0.008, 0.0])
        start = np.array([rng.uniform(-0.1, 0.1), rng.uniform(0.10, 0.14), rng.uniform(-0.05, 0.05)])
        self._before = float(np.linalg.norm(start - self._goal))
        return start

    def goal(self):
        return self._goal

    def judge(self):
        left = float(np.linalg.norm(np.asarray(self.instrument.tip) - self._goal))
        gain, self._before = self._before - left, left
        done = left < 0.005
        return 10 * gain + (1.0 if done else 0.0), done


class GraspAndLift(_OnLiver):
    """Take hold of a place of the liver's upper side and lift it by 2 cm.

    Reward: what the tip comes nearer to the place [over 10 cm] while it is not held, what the place is lifted [over 1 cm] while it is, and 1
    when it is lifted by 2 cm.
    """

    def tool(self):
        return viscera.Grasper(self.home, radius=0.012)

    def place(self, rng):
        self._node = self._top(rng)
        self._height = float(self.positions[self._node, 1])
        self._lifted = 0.0
        start = self.rest[self._node] + np.array([rng.uniform(-0.03, 0.03), rng.uniform(0.03, 0.06), rng.uniform(-0.03, 0.03)])
        self._before = float(np.linalg.norm(start - self.rest[self._node]))
        return start

    def goal(self):
        return self.positions[self._node].astype(float)

    def judge(self):
        left = float(np.linalg.norm(np.asarray(self.instrument.tip) - self.positions[self._node]))
        lifted = float(self.positions[self._node, 1]) - self._height
        held = self.instrument.held_nodes > 0
        gain = 100 * (lifted - self._lifted) if held else 10 * (self._before - left)
        self._before, self._lifted = left, lifted
        done = held and lifted > 0.02
        return gain + (1.0 if done else 0.0), done


class Retract(Episode):
    """Take a flap of tissue at its free edge and draw it back until what lies under it can be seen from above.

    The flap is 12 cm square and grown to its bed along one edge. Reward: what the seen share of the target grows, a tenth of what the tip comes
    nearer to the free edge while it holds nothing [over 10 cm], and 1 when nine tenths are seen.
    """

    extent = 0.15

    def mesh(self, edge):
        return _sheet(_along(self.settings.cells, 0.12, edge), 0.12, 0.006)

    def held(self):
        return viscera.Region.half_space([-0.046, 0.0, 0.0], [-1.0, 0.0, 0.0])

    def tool(self):
        return viscera.Grasper(self.home, radius=0.012)

    def place(self, rng):
        centre = np.array([rng.uniform(0.0, 0.02), rng.uniform(-0.02, 0.02)])
        grid = np.linspace(-0.015, 0.015, 5)
        offsets = np.array([(x, z) for x in grid for z in grid if x * x + z * z <= 0.016**2])
        self._target, self._centre = centre + offsets, centre
        # A place is hidden if a node of the flap is nearer to it, seen from above, than the cells are wide.
        along = _along(self.settings.cells, 0.12, self.drawn.edge)
        self._near = 0.75 * 0.12 / along * float(self.drawn.sides.max())
        edge = self.rest[:, 0] > self.rest[:, 0].max() - 1e-9
        self._edge = np.flatnonzero(edge)
        self._share = self._seen_share()
        start = np.array([0.06 + rng.uniform(0.0, 0.02), rng.uniform(0.03, 0.05), rng.uniform(-0.03, 0.03)])
        self._before = self._distance(start)
        return start

    def _seen_share(self) -> float:
        flap = self.positions[:, [0, 2]]
        squares = ((self._target[:, None, :] - flap[None, :, :]) ** 2).sum(axis=2).min(axis=1)
        return float(np.mean(squares > self._near**2))

    def _distance(self, tip) -> float:
        return float(np.linalg.norm(self.positions[self._edge] - tip, axis=1).min())

    def goal(self):
        return np.array([self._centre[0], 0.0, self._centre[1]])

    def judge(self):
        share, left = self._seen_share(), self._distance(np.asarray(self.instrument.tip))
        gain = share - self._share
        if self.instrument.held_nodes == 0:
            gain += self._before - left
        self._share, self._before = share, left
        done = share >= 0.9
        return gain + (1.0 if done else 0.0), done


class CutToLine(Episode):
    """Cut a stretched sheet along a line with a cautery, and nothing else.

    Reward: what the removed share of the line's cells grows, less twice that of the others, and 1 when nine tenths of the line are cut.
    Cells beside the line that are removed count in `damage` by their share of all.
    """

    extent = 0.12

    def mesh(self, edge):
        return _sheet(_along(self.settings.cells, 0.1, edge), 0.1, 0.005)

    def held(self):
        return viscera.Region.half_space([-0.04, 0.0, 0.0], [-1.0, 0.0, 0.0]) | viscera.Region.half_space(
            [0.04, 0.0, 0.0], [1.0, 0.0, 0.0]
        )

    def tool(self):
        return viscera.Cautery(self.home, radius=0.002)

    def place(self, rng):
        corners = self.rest[self.body.mesh.cells][:, :, 0]
        self._x = float(rng.uniform(-0.015, 0.015))
        # The line runs through some cells, and those that the hot tip cannot touch when it keeps to it are to be spared.
        low, high = corners.min(axis=1), corners.max(axis=1)
        self._line = (low <= self._x) & (self._x <= high)
        self._spared = (low > self._x + 0.004) | (high < self._x - 0.004)
        self._cut, self._else = 0.0, 0.0
        return np.array([self._x + rng.uniform(-0.01, 0.01), 0.02, -0.06])

    def goal(self):
        return np.array([self._x, 0.0, 0.0])

    def judge(self):
        removed = self.body.removed
        cut, elsewhere = float(removed[self._line].mean()), float(removed[self._spared].mean())
        gain = cut - self._cut - 2 * (elsewhere - self._else)
        self.damage += elsewhere - self._else
        self._cut, self._else = cut, elsewhere
        done = cut >= 0.9
        return gain + (1.0 if done else 0.0), done


TASKS: dict[str, type[Episode]] = {"Reach": Reach, "GraspAndLift": GraspAndLift, "Retract": Retract, "CutToLine": CutToLine}
