"""Learns to reach with a short PPO run of stable-baselines3: minutes on one core. `pip install viscera[gym] stable-baselines3`.

Prints the share of 50 episodes that reach their goal, and their mean return, before and after. Not run by the tests: stable-baselines3 brings
PyTorch. With stable-baselines3 2.9.2, PyTorch 2.15.0 and 150 000 steps it went from 0 % and a return of -0.01 to 92 % and 2.04, in 64 s of one
core.
"""

import sys
import time

import gymnasium
import numpy as np
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecEnv

import viscera.gym  # noqa: F401  (registers the environments)


class Adapter(VecEnv):
    """A vector environment of Gymnasium as stable-baselines3 wants it: one that ended begins anew in the same step."""

    def __init__(self, env):
        self.env, self.actions = env.unwrapped, None
        super().__init__(env.num_envs, env.single_observation_space, env.single_action_space)

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
        return [getattr(self.env, name)] * self.env.num_envs

    def set_attr(self, name, value, indices=None):
        setattr(self.env, name, value)

    def env_method(self, name, *args, indices=None, **kwargs):
        return [getattr(self.env, name)(*args, **kwargs)] * self.num_envs

    def env_is_wrapped(self, wrapper, indices=None):
        return [False] * self.num_envs


def judged(policy, episodes=50):
    """The share of episodes that a policy brings to their goal, and its mean return."""
    env = gymnasium.make("viscera/Reach-v0", cells=600, horizon=120)
    done, total = 0, 0.0
    for number in range(episodes):
        seen, _ = env.reset(seed=10_000 + number)
        ended = False
        while not ended:
            seen, reward, terminated, truncated, info = env.step(policy(seen))
            total += float(reward)
            ended = terminated or truncated
        done += info["success"]
    return done / episodes, total / episodes


def main(steps: int) -> None:
    env = Adapter(gymnasium.make_vec("viscera/Reach-v0", num_envs=16, cells=600, horizon=120))
    model = PPO("MlpPolicy", env, n_steps=128, batch_size=512, learning_rate=1e-3, gamma=0.97, ent_coef=0.0, verbose=0, seed=1, device="cpu")
    act = lambda seen: model.predict(seen, deterministic=True)[0]
    before, poor = judged(act)
    begin = time.process_time()
    model.learn(steps)
    spent = time.process_time() - begin
    after, good = judged(act)
    print(f"before: {before:.0%} reached, return {poor:.2f}; after {steps} steps and {spent:.0f} s of a core: {after:.0%} reached, return {good:.2f}")
    if after < before + 0.3:
        sys.exit("it did not learn")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 150_000)
