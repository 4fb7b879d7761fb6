"""What agents see, what is drawn for them, what harm counts, and how many environments begin anew."""

import gymnasium
import numpy as np
import pytest

import viscera.gym
from gymnasium.utils.env_checker import check_env

SMALL = {"cells": 400, "horizon": 30}
TASKS = list(viscera.gym.TASKS)


def make(task="Reach", **settings):
    return gymnasium.make(f"viscera/{task}-v0", **{**SMALL, **settings}).unwrapped


def same(found, wanted):
    if isinstance(wanted, dict):
        return found.keys() == wanted.keys() and all(np.array_equal(found[key], wanted[key]) for key in wanted)
    return np.array_equal(found, wanted)


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("observation", ["points", "depth"])
def test_pictures_and_points_come_with_the_tool_and_the_goal_of_the_state(task, observation):
    """The same seed and actions, seen both ways: the numbers are those of the state, so that a goal drawn at random can be known."""
    pictured, numbered = make(task, observation=observation), make(task)
    rng, goals = np.random.default_rng(0), []
    for seed in range(3):
        seen, state = pictured.reset(seed=seed)[0], numbered.reset(seed=seed)[0]
        for _ in range(4):
            assert seen in pictured.observation_space
            assert np.array_equal(seen["tool"], np.concatenate([state[:6], state[-4:]]))
            assert np.array_equal(seen["goal"], state[6:9])
            action = rng.uniform(-1, 1, numbered.action_space.shape).astype(np.float32)
            seen, state = pictured.step(action)[0], numbered.step(action)[0]
        goals.append(seen["goal"].tolist())
        assert np.allclose(seen["goal"] * pictured.episode.extent, pictured.episode.goal(), atol=1e-7)
        assert np.allclose(seen["tool"][3:6] * pictured.episode.extent, pictured.episode.instrument.tip, atol=1e-7)
    assert goals[0] != goals[1] != goals[2]


@pytest.mark.parametrize("observation", ["state", "points", "depth"])
def test_vectors_have_the_dicts_of_single_environments_to_the_bit(observation):
    vector = gymnasium.make_vec("viscera/GraspAndLift-v0", num_envs=2, threads=2, observation=observation, **SMALL)
    singles = [make("GraspAndLift", observation=observation) for _ in range(2)]
    seen, alone = vector.reset(seed=3)[0], [env.reset(seed=3 + number)[0] for number, env in enumerate(singles)]
    rng = np.random.default_rng(1)
    for _ in range(5):
        assert seen in vector.observation_space
        for number, wanted in enumerate(alone):
            row = {key: values[number] for key, values in seen.items()} if isinstance(seen, dict) else seen[number]
            assert same(row, wanted)
        actions = rng.uniform(-1, 1, vector.action_space.shape).astype(np.float32)
        seen, alone = vector.step(actions)[0], [env.step(action)[0] for env, action in zip(singles, actions)]
    vector.close()


RANGES = {
    "young": (2e3, 8e3),
    "poisson": (0.3, 0.48),
    "density": (950.0, 1100.0),
    "damping": (2.0, 20.0),
    "edges": (0.03, 0.04, 0.05),
}


@pytest.mark.parametrize("task", TASKS)
def test_everything_that_has_a_range_is_drawn_from_it_and_the_body_is_made_of_it(task):
    env = make(task, **RANGES)
    drawn = []
    for _ in range(6):
        env.reset(seed=None if drawn else 5)
        found, body = env.episode.drawn, env.episode.body
        drawn.append(found)
        for name in ("young", "poisson", "density", "damping"):
            low, high = RANGES[name]
            assert low <= getattr(found, name) <= high
        assert found.edge in RANGES["edges"] and np.all(np.abs(found.sides - 1) <= env.settings.shape)
        assert body.masses.sum() == pytest.approx(found.density * body.mesh.volume, rel=1e-5)
        speed = np.sqrt(viscera.Lame.from_young_poisson(found.young, found.poisson).mu / found.density)
        assert body.stable_step < 0.05 / speed
    for name in ("young", "poisson", "density", "damping"):
        assert len({getattr(each, name) for each in drawn}) == 6, name
    assert len({each.edge for each in drawn}) > 1
    again = make(task, **RANGES)
    for number, each in enumerate(drawn):
        again.reset(seed=None if number else 5)
        assert str(again.episode.drawn) == str(each)


def test_a_finer_edge_gives_more_cells_and_the_middle_is_taken_without_randomisation():
    counts = []
    for edge in (0.05, 0.04, 0.03):
        env = make(edges=(edge,))
        env.reset(seed=0)
        counts.append(len(env.episode.body.mesh))
    assert counts[0] < counts[1] < counts[2]
    env = make(randomise=False, **RANGES)
    env.reset(seed=0)
    middle = env.episode.drawn
    assert (middle.young, middle.poisson, middle.density, middle.damping) == pytest.approx((4e3, 0.39, 1025.0, 11.0))
    assert middle.edge == 0.04 and middle.sides.tolist() == [1.0, 1.0, 1.0]


def test_ranges_of_one_value_take_nothing_from_the_generator():
    """Seeds keep their episodes whatever could be drawn beside what is."""
    plain, pinned = make(), make(poisson=(0.4, 0.4), density=(900.0, 900.0), damping=(3.0, 3.0))
    for env in (plain, pinned):
        env.reset(seed=8)
    assert plain.episode.goal().tolist() == pinned.episode.goal().tolist()
    assert plain.episode.drawn.young == pinned.episode.drawn.young


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"poisson": (0.4, 0.3)}, "must ascend"),
        ({"poisson": (0.4, 0.5)}, "below 0.5"),
        ({"density": (0.0, 1.0)}, "density be positive"),
        ({"damping": (-1.0, 1.0)}, "damping not negative"),
        ({"edges": (0.03, 0.0)}, "must be positive"),
        ({"render_mode": "human"}, "there is `rgb_array`"),
    ],
)
def test_settings_that_make_no_sense_are_refused(settings, says):
    with pytest.raises(ValueError, match=says):
        viscera.gym.TissueEnv("Reach", **settings)
    with pytest.raises(ValueError, match=says):
        viscera.gym.TissueVectorEnv(2, "Reach", **settings)


def test_pressing_beyond_the_limit_is_felt_counted_over_time_and_paid_for():
    """A probe is driven 6 cm into a liver: `damage` is the integral of the force beyond the limit, and is taken from the reward."""
    limit = 0.02
    env, careless = (make(force_limit=force, horizon=100, randomise=False) for force in (limit, 1e9))
    for each in (env, careless):
        each.reset(seed=2)
    damage, beyond, forces = 0.0, [], []
    for _ in range(100):
        target = env.episode.goal() - [0.0, 0.07, 0.0]
        way = np.clip((target - env.episode.tip) / (env.settings.speed * env.settings.control_step), -1, 1).astype(np.float32)
        _, reward, terminated, _, info = env.step(way)
        _, unpunished, _, _, free = careless.step(way)
        assert info["force"] == pytest.approx(np.linalg.norm(env.episode.instrument.force), rel=1e-12)
        assert info["force"] == free["force"] and free["damage"] == 0
        excess = max(info["force"] - limit, 0.0) * env.settings.control_step
        damage += excess
        assert info["damage"] == pytest.approx(damage, rel=1e-12, abs=1e-15)
        assert reward == pytest.approx(unpunished - excess, rel=1e-12, abs=1e-15)
        beyond.append(excess > 0)
        forces.append(info["force"])
    assert not beyond[0] and sum(beyond) > 5 and max(forces) > 2 * limit


def test_pictures_are_rendered_in_the_mode_that_is_named_for_them():
    env = gymnasium.make("viscera/Reach-v0", render_mode="rgb_array", **SMALL)
    check_env(env.unwrapped)
    env.reset(seed=1)
    picture = env.render()
    assert picture.shape == (64, 64, 3) and picture.dtype == np.uint8
    depth = env.unwrapped.episode._depth()
    seen = depth < 5
    assert np.all(picture[~seen] == 0) and picture[seen].min() >= 55 and picture[seen].max() == 255
    assert np.all(picture[depth == depth.min()] == 255)
    vector = gymnasium.make_vec("viscera/Reach-v0", num_envs=2, render_mode="rgb_array", **SMALL)
    vector.reset(seed=1)
    pictures = vector.render()
    assert np.array_equal(pictures[0], picture) and len(pictures) == 2 and not np.array_equal(*pictures)
    vector.close()


@pytest.mark.parametrize("randomise", [True, False])
def test_resets_on_many_threads_have_the_bits_of_resets_on_one(randomise):
    vectors = [
        gymnasium.make_vec("viscera/CutToLine-v0", num_envs=5, threads=threads, randomise=randomise, **SMALL) for threads in (1, 4)
    ]
    actions = np.random.default_rng(0).uniform(-1, 1, (5, 4)).astype(np.float32)
    for seed in (4, None, None, 4):
        one, many = (vector.reset(seed=seed)[0] for vector in vectors)
        assert np.array_equal(one, many)
        one, many = (vector.step(actions)[0] for vector in vectors)
        assert np.array_equal(one, many)
    for vector in vectors:
        vector.close()


def test_a_mask_begins_those_anew_that_it_names_and_leaves_the_others_alone():
    vector = gymnasium.make_vec("viscera/Reach-v0", num_envs=3, threads=2, **SMALL)
    alone = [make() for _ in range(3)]
    vector.reset(seed=6)
    for number, env in enumerate(alone):
        env.reset(seed=6 + number)
    actions = np.full((3, 3), 0.5, dtype=np.float32)
    vector.step(actions)
    wanted = [env.step(action)[0] for env, action in zip(alone, actions)]
    worlds = [episode.world for episode in vector.unwrapped.episodes]
    mask = np.array([True, False, True])
    seen, _ = vector.reset(seed=[None, 3, 40], options={"reset_mask": mask})
    # The first goes on with its generator, the last has a new one.
    wanted[0], wanted[2] = alone[0].reset()[0], alone[2].reset(seed=40)[0]
    assert np.array_equal(seen, np.stack(wanted))
    assert [episode.world is world for episode, world in zip(vector.unwrapped.episodes, worlds)] == [False, True, False]
    assert [episode.steps for episode in vector.unwrapped.episodes] == [0, 1, 0]
    seen = vector.step(actions)[0]
    assert np.array_equal(seen, np.stack([env.step(action)[0] for env, action in zip(alone, actions)]))
    vector.close()


def test_an_environment_that_ended_and_was_begun_anew_by_a_mask_goes_on_in_the_next_step():
    vector = gymnasium.make_vec("viscera/Reach-v0", num_envs=2, threads=1, cells=400, horizon=2)
    vector.reset(seed=0)
    actions = np.zeros((2, 3), dtype=np.float32)
    vector.step(actions)
    _, _, _, truncated, _ = vector.step(actions)
    assert truncated.all()
    vector.reset(options={"reset_mask": np.array([True, False])})
    vector.step(actions)
    assert [episode.steps for episode in vector.unwrapped.episodes] == [1, 0]
    vector.close()


@pytest.mark.parametrize("mask", [[True], [0, 1], [False, False], np.ones((2, 2), dtype=bool)])
def test_masks_that_name_nobody_or_too_many_are_refused(mask):
    vector = gymnasium.make_vec("viscera/Reach-v0", num_envs=2, threads=1, **SMALL)
    with pytest.raises(ValueError, match="have not begun"):
        vector.reset(options={"reset_mask": np.array([True, False])})
    vector.reset(seed=0)
    with pytest.raises(ValueError, match="reset_mask must be 2 truth values"):
        vector.reset(options={"reset_mask": mask})
    with pytest.raises(ValueError, match="seed has 3 entries"):
        vector.reset(seed=[1, 2, 3])
    vector.close()
