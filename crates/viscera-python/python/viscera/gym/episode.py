"""One body of tissue, one tool, one goal: what every task has in common."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

import viscera


@dataclass(frozen=True)
class Settings:
    """What can be chosen about a task. All SI."""

    #: Tetrahedra of the organ, about.
    cells: int = 3000
    #: Time of one action [s].
    control_step: float = 0.01
    #: Actions of an episode.
    horizon: int = 200
    #: How fast the tip moves at an action of 1 [m/s].
    speed: float = 0.2
    #: "state" (numbers), "points" (points of the surface, seen from nowhere in particular) or "depth" (a picture of distances). With points and
    #: pictures come, as a dict, the numbers of the tool and of the goal, which neither of them shows.
    observation: str = "state"
    #: How many points a cloud has.
    points: int = 128
    #: Width and height of depth pictures.
    image: tuple[int, int] = (64, 64)
    #: Young's modulus is drawn from this range [Pa], evenly in its logarithm.
    young: tuple[float, float] = (3e3, 9e3)
    #: The body's sides vary by up to this share, each for itself.
    shape: float = 0.08
    #: Whether material and shape are drawn anew for each episode; else they stay at the middle of their ranges, and a reset is quick.
    randomise: bool = True
    #: Force of the tool that does harm [N]; what goes beyond it, over time, is `damage`.
    force_limit: float = 2.0

    def __post_init__(self):
        if self.observation not in ("state", "points", "depth"):
            raise ValueError(f"observation = `{self.observation}`: there are `state`, `points`, `depth`")
        if not (self.control_step > 0 and self.horizon > 0 and self.cells > 0 and 0 < self.young[0] <= self.young[1]):
            raise ValueError("control_step, horizon, cells and young must be positive, and young ascend")
        if not 0 <= self.shape < 0.5:
            raise ValueError(f"shape = {self.shape} must lie between 0 and 0.5")


class Episode:
    """A world that is played by one agent. Tasks say what body it is (`mesh`, `held`), what tool, where it starts and what is good."""

    #: Edge of the space in which the tip moves, over which lengths are divided in observations [m].
    extent = 0.3
    #: Numbers in an action: three of velocity, and the trigger where the tool has one.
    actions = 4
    #: Points of the body that the state shows.
    tracked = 8
    #: Where the tool is before an episode begins, above all tissue [m].
    home = (0.0, 0.25, 0.0)
    #: Where it points, from handle to tip.
    direction = (0.0, -1.0, 0.0)

    def __init__(self, settings: Settings):
        self.settings = settings
        self._start: viscera.Snapshot | None = None

    # What a task says.

    def mesh(self) -> viscera.TetMesh:
        """The body at rest, at the middle of its shapes."""
        raise NotImplementedError

    def held(self) -> viscera.Region:
        """What does not move."""
        raise NotImplementedError

    def tool(self):
        """The instrument."""
        raise NotImplementedError

    def place(self, rng: np.random.Generator) -> np.ndarray:
        """Draws the goal, and gives where the tip starts [m]."""
        raise NotImplementedError

    def goal(self) -> np.ndarray:
        """What of the goal an agent is told: three numbers [m]."""
        raise NotImplementedError

    def judge(self) -> tuple[float, bool]:
        """Reward of the last step, and whether the task is done."""
        raise NotImplementedError

    # What all tasks share.

    def reset(self, rng: np.random.Generator) -> None:
        """Begins anew: the same generator's state gives the same episode, to the bit."""
        settings = self.settings
        low, high = np.log(settings.young)
        share, sides = rng.uniform(), rng.uniform(-1, 1, size=3)
        if settings.randomise:
            young = float(np.exp(low + share * (high - low)))
            self._build(young, 1 + settings.shape * sides)
        elif self._start is None:
            self._build(float(np.exp(0.5 * (low + high))), np.ones(3))
            self._start = self.world.snapshot()
        else:
            self.world.restore(self._start)
        self.positions = self.body.positions
        self.steps, self.damage, self.trigger = 0, 0.0, 0.0
        self.tip = np.asarray(self.place(rng), dtype=float)
        self.force: np.ndarray = np.zeros(3)
        # The tool comes from above, where it touches nothing, and the tissue rests meanwhile.
        self.instrument.lead(self.tip.tolist(), direction=self.direction)
        self.world.step()

    def _build(self, young: float, sides: np.ndarray) -> None:
        mesh = self.mesh()
        mesh = mesh.with_nodes(mesh.nodes * sides)
        tissue = viscera.StableNeoHookean.from_young_poisson(young, 0.45)
        # The shape of an organ in a picture has gravity in it already: none is added.
        self.world = viscera.World(gravity=[0.0, 0.0, 0.0], step=self.settings.control_step, precision="single")
        description = viscera.Body(
            mesh, 1060.0, model=viscera.TotalLagrangian(tissue), fix=self.held(), damping=10.0, loose_pieces="drop", name="tissue"
        )
        self.body = self.world.add(description)
        self.sides, self.young, self.rest = sides, young, mesh.nodes
        self.surface = mesh.surface().triangles
        self.skin = np.unique(self.surface)
        self.seen = _spread(mesh.nodes, self.skin, max(self.settings.points, self.tracked))
        self.instrument = self.world.add_instrument(self.tool(), "tool")

    def command(self, action: np.ndarray) -> None:
        """Moves the tool's target; what it really does, the next step shows."""
        action = np.clip(np.asarray(action, dtype=float), -1, 1)
        reach = self.settings.speed * self.settings.control_step
        self.tip = np.clip(self.tip + reach * action[:3], -self.extent, self.extent)
        if self.actions == 4:
            self.trigger = float(0.5 * (action[3] + 1))
        self.instrument.lead(self.tip.tolist(), direction=self.direction, trigger=self.trigger)

    def outcome(self, failure: str | None):
        """After a step: reward, terminated, truncated, info."""
        self.steps += 1
        self.positions = self.body.positions
        self.force = np.asarray(self.instrument.force)
        strength = float(np.linalg.norm(self.force))
        beyond = max(strength - self.settings.force_limit, 0.0) * self.settings.control_step
        self.damage += beyond
        reward, done = self.judge()
        info = {"force": strength, "damage": self.damage, "young": self.young, "success": bool(done), "failure": failure or ""}
        # A step that the engine refused ends the episode: the world is as it was before it.
        return float(reward - beyond), bool(done or failure is not None), self.steps >= self.settings.horizon, info

    def observe(self) -> Any:
        """What the agent sees: one array of numbers, or a dict of the picture or points under their name, `tool` and `goal`.

        `tool` is where the tip was sent and where it is [over `extent`], its force [over `Settings.force_limit`], and the trigger.
        """
        kind = self.settings.observation
        goal = self._scaled(self.goal())
        force = np.clip(self.force / self.settings.force_limit, -10, 10)
        tip = self._scaled(np.concatenate([self.tip, self.instrument.tip]))
        if kind == "state":
            tracked = self._scaled(self.positions[self.seen[: self.tracked]].ravel())
            return np.concatenate([tip, goal, tracked, force, [self.trigger]]).astype(np.float32)
        seen = self._depth() if kind == "depth" else self._scaled(self.positions[self.seen[: self.settings.points]])
        return {kind: seen, "tool": np.concatenate([tip, force, [self.trigger]]).astype(np.float32), "goal": goal}

    def _scaled(self, places) -> np.ndarray:
        return np.clip(np.asarray(places) / self.extent, -5, 5).astype(np.float32)

    def _depth(self) -> np.ndarray:
        eye = np.array([0.6, 1.6, 1.8]) * self.extent
        triangles, _ = self.body.surface()
        picture = viscera.depth_image(self.positions, triangles, eye=eye.tolist(), target=[0.0, 0.0, 0.0], size=self.settings.image)
        return np.minimum(picture / self.extent, 5.0).astype(np.float32)


def _spread(nodes: np.ndarray, among: np.ndarray, count: int) -> np.ndarray:
    """Nodes far from one another: the first, then again and again the one that is farthest from all so far."""
    chosen = [int(among[0])]
    distance = np.linalg.norm(nodes[among] - nodes[chosen[0]], axis=1)
    while len(chosen) < count:
        chosen.append(int(among[np.argmax(distance)]))
        distance = np.minimum(distance, np.linalg.norm(nodes[among] - nodes[chosen[-1]], axis=1))
    return np.array(chosen)
