"""Learns to reach with a short PPO run of stable-baselines3: minutes on one core. `pip install viscera[gym] stable-baselines3`.

Prints the share of episodes that succeed before and after. Not run by the tests: stable-baselines3 brings PyTorch.
"""

import sys

import gymnasium
import numpy as np
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecEnv

import viscera.gym  # noqa: F401  (registers the environments)


class Adapter(VecEnv):
    """A vector environment of Gymnasium as stable-baselines3 wants it: one that ended begins anew in the same step."""

    def __init__(self, env):
        super().__init__(env.num_envs, env.single_observation_space, env.single_action_space)
        self.env, self.actions = env.unwrapped, None

    def reset(self):
        return self.env.reset(seed=int(np.random.default_rng().integers(2**31)))[0]

    def step_async(self, actions):
        self.actions = actions

    def step_wait(self):
        seen, rewards, terminated, truncated, infos = self.env.step(self.actions)
        ended = terminated | truncated
        details = [
            {key: values[number] for key, values in infos.items() if not key.startswith("_")} for number in range(self.num_envs)
        ]
        for number in np.flatnonzero(ended):
            details[number] |= {"terminal_observation": seen[number].copy(), "TimeLimit.truncated": bool(truncated[number] and not terminated[number])}
            self.env.episodes[number].reset(self.env._generators[number])
            seen[number] = self.env.episodes[number].observe()
        self.env._ended[:] = False
        return seen, rewards.astype(np.float32), ended, details

    def close(self):
        self.env.close()

    def get_attr(self, name, indices=None):
        return [getattr(self.env, name)] * self.num_envs

    def set_attr(self, name, value, indices=None):
        setattr(self.env, name, value)

    def env_method(self, name, *args, indices=None, **kwargs):
        return [getattr(self.env, name)(*args, **kwargs)] * self.num_envs

    def env_is_wrapped(self, wrapper, indices=None):
        return [False] * self.num_envs


def successes(policy, episodes=50):
    """The share of episodes that a policy brings to their goal."""
    env = gymnasium.make("viscera/Reach-v0", cells=600, horizon=120)
    done = 0
    for number in range(episodes):
        seen, _ = env.reset(seed=10_000 + number)
        ended = False
        while not ended:
            seen, _, terminated, truncated, info = env.step(policy(seen))
            ended = terminated or truncated
        done += info["success"]
    return done / episodes


def main(steps: int) -> None:
    env = Adapter(gymnasium.make_vec("viscera/Reach-v0", num_envs=16, cells=600, horizon=120))
    model = PPO("MlpPolicy", env, n_steps=128, batch_size=512, learning_rate=1e-3, gamma=0.97, ent_coef=0.0, verbose=0, seed=1, device="cpu")
    act = lambda seen: model.predict(seen, deterministic=True)[0]
    before = successes(act)
    model.learn(steps)
    after = successes(act)
    print(f"reached before learning: {before:.0%}; after {steps} steps: {after:.0%}")
    if after < before + 0.3:
        sys.exit("it did not learn")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 150_000)
