"""The tasks as environments of Gymnasium: one, and many at once."""

from __future__ import annotations

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


class TissueEnv(gymnasium.Env):
    """One task. Actions are velocities of the tip over `Settings.speed`, and the trigger from −1 (open, off) to 1 (closed, on)."""

    metadata = {"render_modes": ["depth"], "render_fps": 25}

    def __init__(self, task: str = "Reach", *, render_mode: str | None = None, **settings: Any):
        self.settings, kind = Settings(**settings), _task(task)
        self.observation_space, self.action_space = _spaces(kind, self.settings)
        self.episode, self.render_mode = kind(self.settings), render_mode

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
        """The depth picture, as grey levels of 8 bits; near is bright."""
        depth = self.episode._depth()
        near, far = float(depth.min()), float(depth[depth < 5].max(initial=depth.min()))
        grey = np.where(depth < 5, 255 - 200 * (depth - near) / max(far - near, 1e-6), 0).clip(0, 255)
        return np.repeat(grey.astype(np.uint8)[:, :, None], 3, axis=2)


class TissueVectorEnv(gymnasium.vector.VectorEnv):
    """Many environments of one task, stepped by threads of the engine. Environments that end begin anew in the next step."""

    metadata = {"autoreset_mode": gymnasium.vector.AutoresetMode.NEXT_STEP}

    def __init__(self, num_envs: int = 1, task: str = "Reach", *, threads: int = 0, render_mode: str | None = None, **settings: Any):
        self.settings, kind = Settings(**settings), _task(task)
        self.num_envs, self.render_mode = num_envs, render_mode
        self.single_observation_space, self.single_action_space = _spaces(kind, self.settings)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.episodes = [kind(self.settings) for _ in range(num_envs)]
        self.threads = viscera.Threads(threads)
        self._generators: list[np.random.Generator] = []
        self._ended = np.zeros(num_envs, dtype=bool)

    def reset(self, *, seed: int | list[int | None] | None = None, options: dict | None = None):
        if seed is not None or not self._generators:
            first = seed if seed is not None else int(np.random.default_rng().integers(2**31))
            seeds = first if isinstance(first, list) else [first + number for number in range(self.num_envs)]
            self._generators = [gymnasium.utils.seeding.np_random(each)[0] for each in seeds]
        for episode, rng in zip(self.episodes, self._generators):
            episode.reset(rng)
        self._ended[:] = False
        return self._observe(), {}

    def step(self, actions):
        going = np.flatnonzero(~self._ended)
        rewards = np.zeros(self.num_envs)
        terminated, truncated = np.zeros(self.num_envs, dtype=bool), np.zeros(self.num_envs, dtype=bool)
        infos: dict[str, Any] = {}
        for number in np.flatnonzero(self._ended):
            self.episodes[number].reset(self._generators[number])
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
