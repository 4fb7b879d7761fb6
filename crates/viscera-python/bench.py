"""Speed of the Python side, to be run against a wheel that was built in release: `python bench.py`.

Prints environment steps per second and core for each task (3 000 tetrahedra, 10 ms of action), the time of a reset, and what a step from
Python costs above the engine's own time.
"""

import time

import numpy as np

import viscera


def environments(cells=3000, seconds=2.0):
    import gymnasium

    import viscera.gym

    for task in viscera.gym.TASKS:
        env = gymnasium.make_vec(f"viscera/{task}-v0", num_envs=4, threads=1, cells=cells, horizon=10**9)
        begin = time.perf_counter()
        env.reset(seed=0)
        reset = (time.perf_counter() - begin) / 4
        rng = np.random.default_rng(0)
        steps, begin = 0, time.perf_counter()
        while time.perf_counter() - begin < seconds:
            env.step(rng.uniform(-1, 1, env.action_space.shape).astype(np.float32))
            steps += 4
        rate = steps / (time.perf_counter() - begin)
        episode = env.unwrapped.episodes[0]
        report = episode.world.step()
        print(
            f"{task:14} {len(episode.body.mesh):5} tetrahedra  {rate:8.0f} steps/s on one core  "
            f"{report.substeps:3} sub-steps in each  reset {1e3 * reset:.1f} ms"
        )


def overhead(count=3000):
    """A step from Python against one of many in a go: medians of seven rounds each."""
    mesh = viscera.TetMesh.box_grid([5, 5, 10], [0.1, 0.1, 0.2])
    law = viscera.StableNeoHookean.from_young_poisson(5e3, 0.4)
    world = viscera.World(step=2e-4, precision="single")
    world.add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(law), fix="z-min"))
    each, together = [], []
    for _ in range(7):
        begin = time.perf_counter()
        for _ in range(count):
            world.step()
        each.append(time.perf_counter() - begin)
        begin = time.perf_counter()
        world.steps(count)
        together.append(time.perf_counter() - begin)
    own = np.median(together) / count
    extra = np.median(each) / count - own
    print(f"{len(mesh)} tetrahedra: a step takes {1e6 * own:.1f} us, and from Python {1e6 * extra:.2f} us more")


if __name__ == "__main__":
    overhead()
    environments()
