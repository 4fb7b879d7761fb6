"""Environments: Gymnasium's own checker, seeds to the bit, threads that change nothing, and goals that can be reached."""

import gymnasium
import numpy as np
import pytest

import viscera.gym
from gymnasium.utils.env_checker import check_env

SMALL = {"cells": 400, "horizon": 30}


@pytest.mark.parametrize("task", list(viscera.gym.TASKS))
@pytest.mark.parametrize("observation", ["state", "points", "depth"])
def test_every_task_passes_gymnasiums_checker(task, observation):
    env = gymnasium.make(f"viscera/{task}-v0", observation=observation, **SMALL)
    check_env(env.unwrapped, skip_render_check=True)


@pytest.mark.parametrize("task", list(viscera.gym.TASKS))
def test_the_rows_of_a_vector_are_single_environments_to_the_bit(task):
    """Three environments over 45 steps on two threads, so that each begins anew on the way."""
    vector = gymnasium.make_vec(f"viscera/{task}-v0", num_envs=3, threads=2, **SMALL)
    singles = [gymnasium.make(f"viscera/{task}-v0", **SMALL).unwrapped for _ in range(3)]
    seen, _ = vector.reset(seed=11)
    alone = [env.reset(seed=11 + number)[0] for number, env in enumerate(singles)]
    ended = [False] * 3
    rng = np.random.default_rng(0)
    for _ in range(45):
        assert np.array_equal(seen, np.stack(alone))
        actions = rng.uniform(-1, 1, vector.action_space.shape).astype(np.float32)
        seen, rewards, terminated, truncated, _ = vector.step(actions)
        for number, env in enumerate(singles):
            if ended[number]:
                alone[number], ended[number] = env.reset()[0], False
                assert rewards[number] == 0
            else:
                alone[number], reward, ends, cut, _ = env.step(actions[number])
                assert (reward, ends, cut) == (rewards[number], terminated[number], truncated[number])
                ended[number] = ends or cut


def test_a_reset_without_randomisation_restores_and_repeats():
    env = gymnasium.make("viscera/GraspAndLift-v0", randomise=False, **SMALL).unwrapped
    first, _ = env.reset(seed=4)
    world = env.episode.world
    for _ in range(10):
        env.step(env.action_space.sample())
    again, _ = env.reset(seed=4)
    assert env.episode.world is world
    assert np.array_equal(first, again)


def test_material_and_shape_are_drawn_anew_for_each_episode():
    env = gymnasium.make("viscera/Reach-v0", **SMALL).unwrapped
    drawn = []
    for _ in range(4):
        env.reset(seed=None if drawn else 1)
        drawn.append((env.episode.drawn.young, *env.episode.drawn.sides))
    assert len(set(drawn)) == 4
    assert all(3e3 <= young <= 9e3 for young, *_ in drawn)


def play(env, policy, seed=0):
    """An episode by a policy of the episode itself; its return, and what was said at the end."""
    env.reset(seed=seed)
    total, info = 0.0, {}
    for _ in range(env.settings.horizon):
        _, reward, terminated, truncated, info = env.step(policy(env.episode))
        total += reward
        if terminated or truncated:
            break
    return total, info


def towards(episode, place, trigger=-1.0):
    way = (np.asarray(place) - episode.tip) / (episode.settings.speed * episode.settings.control_step)
    way /= max(1.0, np.abs(way).max())
    return np.append(way, trigger)[: episode.actions].astype(np.float32)


def reach(episode):
    return towards(episode, episode.goal())


def lift(episode):
    if episode.instrument.held_nodes == 0:
        near = np.linalg.norm(episode.tip - episode.goal()) < 0.004
        return towards(episode, episode.goal(), 1.0 if near else -1.0)
    return np.array([0, 1, 0, 1], dtype=np.float32)


def retract(episode):
    edge = episode.positions[episode._edge]
    place = edge[np.argmin(np.linalg.norm(edge - episode.tip, axis=1))]
    if episode.instrument.held_nodes == 0:
        near = np.linalg.norm(episode.tip - place) < 0.004
        return towards(episode, place, 1.0 if near else -1.0)
    back = np.array([-0.05, 0.11, 0.0])
    return towards(episode, back, 1.0)


def cut(episode):
    along = np.array([episode._x, 0.0, episode.tip[2] + 0.05])
    if episode.tip[1] > 0.003 and episode.tip[2] < -0.055:
        return towards(episode, [episode._x, 0.0, -0.06])
    return towards(episode, along, 1.0)


@pytest.mark.parametrize(("task", "policy"), [("Reach", reach), ("GraspAndLift", lift), ("CutToLine", cut), ("Retract", retract)])
def test_each_task_can_be_done_and_doing_it_pays(task, policy):
    env = gymnasium.make(f"viscera/{task}-v0", cells=600, horizon=300).unwrapped
    best, info = play(env, policy)
    assert info["success"], info
    rng = np.random.default_rng(0)
    idle, _ = play(env, lambda episode: rng.uniform(-1, 1, episode.actions).astype(np.float32))
    assert best > idle


def test_a_depth_picture_shows_a_square_at_its_distance():
    """A square of side 2 at distance 4, seen with an opening of 90°, is a quarter as wide as the picture."""
    corners = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    view = dict(eye=[0, 0, 4], target=[0, 0, 0], field_of_view=np.pi / 2, size=(80, 80))
    picture = viscera.depth_image(corners, [[0, 1, 2], [0, 2, 3]], **view)
    assert picture.shape == (80, 80) and picture.dtype == np.float32
    seen = np.isfinite(picture)
    # The picture is 8 wide at that distance: 20 of 80 pixels.
    assert seen.sum() == 400 and seen[30:50, 30:50].all()
    assert np.allclose(picture[seen], 4.0, rtol=1e-6)
    # What is behind is hidden.
    behind = corners + [[x, y, z - 3] for x, y, z in corners]
    both = viscera.depth_image(behind, [[4, 5, 6], [4, 6, 7], [0, 1, 2], [0, 2, 3]], **view)
    assert np.allclose(both[seen], 4.0, rtol=1e-6)
