"""The tasks as environments of Gymnasium: one, and many at once."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector.utils import batch_space, concatenate, create_empty_array

import viscera

from .episode import Episode, Settings
from .tasks import TASKS


def _spaces(task: type[Episode], settings: Settings) -> tuple[gymnasium.Space, gymnasium.Space]:
    """What is seen and done."""
    box = gymnasium.spaces.Box
    doing = box(-1.0, 1.0, (task.actions,), np.float32)
    if settings.observation == "state":
        return box(-10.0, 10.0, (9 + 3 * task.tracked + 4,), np.float32), doing
    width, height = settings.image
    pictures = {
        "points": box(-5.0, 5.0, (settings.points, 3), np.float32),
        "depth": box(0.0, 5.0, (height, width), np.float32),
    }
    numbers = {"tool": box(-10.0, 10.0, (10,), np.float32), "goal": box(-5.0, 5.0, (3,), np.float32)}
    return gymnasium.spaces.Dict({settings.observation: pictures[settings.observation], **numbers}), doing


def _task(name: str) -> type[Episode]:
    if name not in TASKS:
        raise ValueError(f"task = `{name}`: there are {', '.join(f'`{known}`' for known in TASKS)}")
    return TASKS[name]


def _render_mode(given: str | None) -> str | None:
    if given not in (None, "rgb_array"):
        raise ValueError(f"render_mode = `{given}`: there is `rgb_array`")
    return given


class TissueEnv(gymnasium.Env):
    """One task. Actions are velocities of the tip over `Settings.speed`, and the trigger from −1 (open, off) to 1 (closed, on)."""

    metadata = {"render_modes": ["rgb_array"], "render_fps": 25}

    def __init__(self, task: str = "Reach", *, render_mode: str | None = None, **settings: Any):
        self.settings, kind = Settings(**settings), _task(task)
        self.observation_space, self.action_space = _spaces(kind, self.settings)
        self.episode, self.render_mode = kind(self.settings), _render_mode(render_mode)

    def reset(self, *, seed: int | None = None, options: dict | None = None):
        super().reset(seed=seed)
        self.episode.reset(self.np_random)
        return self.episode.observe(), {}

    def step(self, action):
        self.episode.command(action)
        try:
            self.episode.world.step()
            failure = None
        except viscera.StepFailed as error:
            failure = str(error)
        reward, terminated, truncated, info = self.episode.outcome(failure)
        return self.episode.observe(), reward, terminated, truncated, info

    def render(self):
        """The depth picture, as grey levels of 8 bits of shape (height, width, 3); near is bright."""
        return self.episode.picture()


class TissueVectorEnv(gymnasium.vector.VectorEnv):
    """Many environments of one task, stepped and begun anew by threads. Environments that end begin anew in the next step."""

    metadata = {"autoreset_mode": gymnasium.vector.AutoresetMode.NEXT_STEP, "render_modes": ["rgb_array"], "render_fps": 25}

    def __init__(self, num_envs: int = 1, task: str = "Reach", *, threads: int = 0, render_mode: str | None = None, **settings: Any):
        self.threads = viscera.Threads(threads)
        self._pool = ThreadPoolExecutor(self.threads.count)
        self.settings, kind = Settings(**settings), _task(task)
        self.num_envs, self.render_mode = num_envs, _render_mode(render_mode)
        self.single_observation_space, self.single_action_space = _spaces(kind, self.settings)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.episodes = [kind(self.settings) for _ in range(num_envs)]
        self._generators: list[np.random.Generator] = []
        self._ended = np.zeros(num_envs, dtype=bool)

    def reset(self, *, seed: int | list[int | None] | None = None, options: dict | None = None):
        """Begins anew: all, or where ``options={"reset_mask": mask}`` says so (bool, one for each). A seed of an int gives each
        environment its own (seed, seed + 1, …); in a list, None goes on with the generator that the environment has."""
        mask = self._mask((options or {}).get("reset_mask"))
        self._seed(seed, mask)
        self._begin(np.flatnonzero(mask))
        self._ended[mask] = False
        return self._observe(), {}

    def _mask(self, given) -> np.ndarray:
        """Which environments begin anew."""
        if given is None:
            return np.ones(self.num_envs, dtype=bool)
        mask = np.asarray(given)
        if mask.dtype != bool or mask.shape != (self.num_envs,) or not mask.any():
            raise ValueError(
                f"reset_mask must be {self.num_envs} truth values, at least one of them true, and has shape {mask.shape} of {mask.dtype}"
            )
        if not (mask.all() or self._generators):
            raise ValueError("reset_mask leaves environments out that have not begun: reset all of them first")
        return mask

    def _seed(self, seed: int | list[int | None] | None, mask: np.ndarray) -> None:
        """Gives new generators to those that begin anew, where a seed says so or they have none."""
        if seed is None and not self._generators:
            seed = int(np.random.default_rng().integers(2**31))
        if isinstance(seed, int | np.integer):
            seed = [int(seed) + number for number in range(self.num_envs)]
        if seed is None:
            return
        if len(seed) != self.num_envs:
            raise ValueError(f"seed has {len(seed)} entries, and there are {self.num_envs} environments")
        if not self._generators:
            self._generators = [gymnasium.utils.seeding.np_random(each)[0] for each in seed]
        for number in np.flatnonzero(mask):
            if seed[number] is not None:
                self._generators[number] = gymnasium.utils.seeding.np_random(seed[number])[0]

    def _begin(self, numbers) -> None:
        """New episodes, on as many threads as step them: the engine lets others run while it builds, restores and steps."""
        list(self._pool.map(lambda number: self.episodes[number].reset(self._generators[number]), numbers))

    def close_extras(self, **kwargs: Any) -> None:
        self._pool.shutdown()

    def render(self):
        """The depth picture of each, as grey levels of 8 bits of shape (height, width, 3); near is bright."""
        return tuple(episode.picture() for episode in self.episodes)

    def step(self, actions):
        going = np.flatnonzero(~self._ended)
        rewards = np.zeros(self.num_envs)
        terminated, truncated = np.zeros(self.num_envs, dtype=bool), np.zeros(self.num_envs, dtype=bool)
        infos: dict[str, Any] = {}
        self._begin(np.flatnonzero(self._ended))
        for number in going:
            self.episodes[number].command(actions[number])
        failures = self.threads.step([self.episodes[number].world for number in going], 1)
        for number, failure in zip(going, failures):
            rewards[number], terminated[number], truncated[number], info = self.episodes[number].outcome(failure)
            infos = self._add_info(infos, info, number)
        self._ended = terminated | truncated
        return self._observe(), rewards, terminated, truncated, infos

    def _observe(self) -> Any:
        seen = create_empty_array(self.single_observation_space, n=self.num_envs)
        return concatenate(self.single_observation_space, [episode.observe() for episode in self.episodes], seen)
