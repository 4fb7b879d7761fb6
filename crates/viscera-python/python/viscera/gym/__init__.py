"""Environments for robot learning, after Gymnasium (extra ``viscera[gym]``).

Importing this registers ``viscera/Reach-v0``, ``viscera/GraspAndLift-v0``, ``viscera/Retract-v0`` and ``viscera/CutToLine-v0``;
``gymnasium.make`` and ``gymnasium.make_vec`` take the fields of :class:`Settings` as keyword arguments. A vector environment steps its worlds in
threads of the engine; its rows are, to the bit, those of single environments with the seeds that it hands out (seed, seed + 1, …).

Observations are arrays of numbers ("state"), or dicts of "points" or "depth" with the numbers of the "tool" and of the "goal". Young's modulus,
Poisson's ratio, density, damping, sides and the mesh's edge can be drawn anew in each episode, from the ranges in :class:`Settings`; what was
drawn is ``env.unwrapped.episode.drawn``.
"""

import gymnasium

from .environment import TissueEnv, TissueVectorEnv
from .episode import Drawn, Settings
from .tasks import TASKS, CutToLine, GraspAndLift, Reach, Retract

__all__ = ["TASKS", "CutToLine", "Drawn", "GraspAndLift", "Reach", "Retract", "Settings", "TissueEnv", "TissueVectorEnv"]

for _name in TASKS:
    _id = f"viscera/{_name}-v0"
    if _id not in gymnasium.registry:
        gymnasium.register(
            _id,
            entry_point="viscera.gym:TissueEnv",
            vector_entry_point="viscera.gym:TissueVectorEnv",
            kwargs={"task": _name},
            disable_env_checker=True,
        )
