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
    #: Poisson's ratio is drawn from this range, evenly; so are the density [kg/m³] and the damping rate of the body [1/s].
    poisson: tuple[float, float] = (0.45, 0.45)
    density: tuple[float, float] = (1060.0, 1060.0)
    damping: tuple[float, float] = (10.0, 10.0)
    #: Edges of the tetrahedra [m], of which one is drawn; where none are given, the mesh is the one of `cells`.
    edges: tuple[float, ...] = ()
    #: The body's sides vary by up to this share, each for itself.
    shape: float = 0.08
    #: Whether material, shape and mesh are drawn anew for each episode; else they stay at the middle of their ranges, and a reset is quick.
    randomise: bool = True
    #: Force of the tool that does harm [N]; what goes beyond it, over time, is `damage`.
    force_limit: float = 2.0

    def __post_init__(self):
        if self.observation not in ("state", "points", "depth"):
            raise ValueError(f"observation = `{self.observation}`: there are `state`, `points`, `depth`")
        if not (self.control_step > 0 and self.horizon > 0 and self.cells > 0 and 0 < self.young[0] <= self.young[1]):
            raise ValueError("control_step, horizon, cells and young must be positive, and young ascend")
        for name in ("poisson", "density", "damping"):
            low, high = getattr(self, name)
            if not low <= high:
                raise ValueError(f"{name} = ({low}, {high}) must ascend; for one value give it twice")
        if not (-1 < self.poisson[0] and self.poisson[1] < 0.5 and self.density[0] > 0 and self.damping[0] >= 0):
            raise ValueError("poisson must lie above -1 and below 0.5, density be positive, and damping not negative")
        if not all(edge > 0 for edge in self.edges):
            raise ValueError(f"edges = {self.edges} must be positive [m]")
        if not 0 <= self.shape < 0.5:
            raise ValueError(f"shape = {self.shape} must lie between 0 and 0.5")


@dataclass(frozen=True)
class Drawn:
    """What was drawn for an episode."""

    #: Young's modulus [Pa].
    young: float
    #: Poisson's ratio.
    poisson: float
    #: Density [kg/m³].
    density: float
    #: Rate of the body's damping [1/s].
    damping: float
    #: Edge of the tetrahedra [m], None where their number was asked for.
    edge: float | None
    #: Factors of the body's sides; shape (3,).
    sides: np.ndarray


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

    def mesh(self, edge: float | None) -> viscera.TetMesh:
        """The body at rest, at the middle of its shapes: of tetrahedra of about `edge` [m], or of `Settings.cells` of them."""
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
        drawn = self._draw(rng)
        if settings.randomise:
            self._build(drawn)
        elif self._start is None:
            self._build(self._middle())
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

    def _draw(self, rng: np.random.Generator) -> Drawn:
        """Material, shape and mesh of an episode. A range of one value takes nothing from the generator."""
        settings = self.settings
        low, high = np.log(settings.young)
        share, sides = rng.uniform(), rng.uniform(-1, 1, size=3)

        def among(span: tuple[float, float]) -> float:
            return span[0] if span[0] == span[1] else float(rng.uniform(*span))

        poisson, density, damping = among(settings.poisson), among(settings.density), among(settings.damping)
        edges = settings.edges
        edge = edges[int(rng.integers(len(edges)))] if len(edges) > 1 else next(iter(edges), None)
        return Drawn(
            young=float(np.exp(low + share * (high - low))),
            poisson=poisson,
            density=density,
            damping=damping,
            edge=edge,
            sides=1 + settings.shape * sides,
        )

    def _middle(self) -> Drawn:
        """The middle of all ranges."""
        settings = self.settings
        return Drawn(
            young=float(np.exp(0.5 * np.sum(np.log(settings.young)))),
            poisson=0.5 * sum(settings.poisson),
            density=0.5 * sum(settings.density),
            damping=0.5 * sum(settings.damping),
            edge=sorted(settings.edges)[len(settings.edges) // 2] if settings.edges else None,
            sides=np.ones(3),
        )

    def _build(self, drawn: Drawn) -> None:
        mesh = self.mesh(drawn.edge)
        mesh = mesh.with_nodes(mesh.nodes * drawn.sides)
        tissue = viscera.StableNeoHookean.from_young_poisson(drawn.young, drawn.poisson)
        # The shape of an organ in a picture has gravity in it already: none is added.
        self.world = viscera.World(gravity=[0.0, 0.0, 0.0], step=self.settings.control_step, precision="single")
        description = viscera.Body(
            mesh,
            drawn.density,
            model=viscera.TotalLagrangian(tissue),
            fix=self.held(),
            damping=drawn.damping,
            loose_pieces="drop",
            name="tissue",
        )
        self.body = self.world.add(description)
        self.drawn, self.rest = drawn, mesh.nodes
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
        info = {"force": strength, "damage": self.damage, "young": self.drawn.young, "success": bool(done), "failure": failure or ""}
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

    def picture(self) -> np.ndarray:
        """The depth picture as grey levels of 8 bits, near is bright; shape (height, width, 3)."""
        depth = self._depth()
        near, far = float(depth.min()), float(depth[depth < 5].max(initial=depth.min()))
        grey = np.where(depth < 5, 255 - 200 * (depth - near) / max(far - near, 1e-6), 0).clip(0, 255)
        return np.repeat(grey.astype(np.uint8)[:, :, None], 3, axis=2)

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
