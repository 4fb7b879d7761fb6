"""Scene files both ways: from files to Python and back, from Python to files, and the command line on the same; each to the same bits."""

import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

import viscera
from test_engine import SCENE

SCENES = sorted(Path(os.environ["VISCERA_SCENES"]).glob("*.toml"))
PROGRAM = os.environ["VISCERA_PROGRAM"]


def places(world):
    return {name: body.positions for name, body in world.bodies.items()}


def assert_same(found, wanted):
    assert found.keys() == wanted.keys()
    for name in wanted:
        assert found[name].dtype == wanted[name].dtype and np.array_equal(found[name], wanted[name]), name


def points(file):
    """The points of a VTU whose arrays are appended raw, in their own type."""
    raw = file.read_bytes()
    head, data = raw.split(b'<AppendedData encoding="raw">', 1)
    header = np.dtype({b"UInt32": "<u4", b"UInt64": "<u8"}[re.search(rb'header_type="(\w+)"', head)[1]])
    element = re.search(rb"<Points>\s*<DataArray ([^>]*)>", head)[1]
    kind = np.dtype({b"Float32": "<f4", b"Float64": "<f8"}[re.search(rb'type="(\w+)"', element)[1]])
    begin = data.index(b"_") + 1 + int(re.search(rb'offset="(\d+)"', element)[1])
    size = int(np.frombuffer(data, header, 1, begin)[0])
    return np.frombuffer(data, kind, size // kind.itemsize, begin + header.itemsize).reshape(-1, 3)


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_shipped_scene_goes_through_python_and_runs_to_the_bits_of_the_command_line(path, tmp_path):
    """File → Scene → dict → Scene → text → Scene in Python, the file itself in the program: four steps, places and numbers to the last bit.

    Scenes take turns in the two precisions, and are built once on either side: making a liver is most of the time.
    """
    scene = viscera.Scene.load(path)
    described = viscera.Scene.from_dict(scene.check(), scene.folder)
    again = viscera.Scene.parse(described.to_toml(), scene.folder)
    assert again.check() == described.check() == scene.check()

    step, precision = scene.check()["step"], ["single", "double"][SCENES.index(path) % 2]
    changes = ["--precision", precision, "--time", repr(4 * step), "--set", f"output.interval={step!r}"]
    command = [PROGRAM, "run", str(path), "--out", str(tmp_path / "out"), "--quiet", "--pictures", "0", *changes]
    subprocess.run(command, cwd=tmp_path, check=True)

    again.set("duration", 4 * step)
    world, steps, _ = again.build(precision=precision)
    assert steps == 4
    world.steps(steps)
    for name, positions in places(world).items():
        frames = sorted((tmp_path / "out" / "frames").glob(f"{name}-*.vtu"))
        assert np.array_equal(points(frames[-1]), positions) and len(frames) == 5
    header, *_, last = (tmp_path / "out" / "observables.csv").read_text().splitlines()
    row = dict(zip(header.split(","), map(float, last.split(","))))
    assert row["time [s]"] == world.time
    for name, body in world.bodies.items():
        seen = body.observe()
        for column, value in {
            "kinetic energy [J]": seen.kinetic_energy,
            "elastic energy [J]": seen.elastic_energy,
            "volume [m^3]": seen.volume,
            "max displacement [m]": seen.max_displacement,
            "momentum x [kg m/s]": seen.momentum[0],
            "reaction z [N]": seen.reaction[2],
        }.items():
            assert row[f"{name}: {column}"] == value, column
    for name, tool in world.instruments.items():
        for axis, value in zip("xyz", tool.observe().force):
            assert row[f"{name}: force {axis} [N]"] == value


@pytest.mark.parametrize("precision", ["single", "double"])
def test_a_resection_runs_to_the_bits_of_the_command_line_past_its_first_cuts(precision, tmp_path):
    """A liver in coarse cells: the grasper holds, the cautery takes cells away, and what is left goes on to the last bit."""
    path = next(path for path in SCENES if path.stem == "liver-resection")
    changes = {"body.liver.mesh.edge": "30 mm", "duration": 1.6, "output.interval": 0.4}
    command = [PROGRAM, "run", str(path), "--out", str(tmp_path / "out"), "--quiet", "--pictures", "0", "--precision", precision]
    command += [part for key, value in changes.items() for part in ("--set", f"{key}={value}")]
    subprocess.run(command, cwd=tmp_path, check=True)
    scene = viscera.Scene.load(path)
    for key, value in changes.items():
        scene.set(key, value)
    world, steps, _ = scene.build(precision=precision)
    liver, removed = world.body("liver"), []
    for _ in range(steps):
        world.step()
        removed.append(int(liver.removed.sum()))
    assert removed[0] == 0 and len(set(removed)) > 2, "the cautery cuts more than once"
    assert steps - np.argmax(np.array(removed) > 0) > 20, "the run goes on after the first cut"
    frames = sorted((tmp_path / "out" / "frames").glob("liver-*.vtu"))
    assert np.array_equal(points(frames[-1]), liver.positions) and len(frames) == 5
    header, *_, last = (tmp_path / "out" / "observables.csv").read_text().splitlines()
    row = dict(zip(header.split(","), map(float, last.split(","))))
    seen = liver.observe()
    assert row["time [s]"] == world.time
    assert row["liver: elastic energy [J]"] == seen.elastic_energy and row["liver: volume [m^3]"] == seen.volume
    assert next(value for column, value in row.items() if column.startswith("liver: removed cells")) == removed[-1]


def random_world(rng):
    """A world of two blocks that are grown together, of any law, model, loads and tools that a scene has words for."""
    young, poisson = rng.uniform(3e3, 9e3), rng.uniform(0.1, 0.45)
    lame, along = viscera.Lame.from_young_poisson(young, poisson), viscera.Lame.from_young_poisson(rng.uniform(2, 4) * young, poisson)
    fibres = rng.uniform(-1, 1, 3).tolist()
    linear, stvk = viscera.LinearElastic(lame), viscera.StVenantKirchhoff(lame)
    fibred, fibred_linear = viscera.TransverseStVenantKirchhoff(lame, fibres, along), viscera.TransverseLinear(lame, fibres, along)
    models = [
        viscera.LinearTensorMass(linear),
        viscera.LinearTensorMass(fibred_linear),
        viscera.TensorMass(stvk),
        viscera.TensorMass(fibred, adaptive=1e-3),
        viscera.TotalLagrangian(fibred),
        viscera.TotalLagrangian(viscera.NeoHookean(lame)),
        viscera.TotalLagrangian(viscera.StableNeoHookean(lame)),
        viscera.NodallyIntegrated(viscera.StableNeoHookean(lame), stabilise=0.05),
        viscera.Corotational(linear, rotation="qr", tangent="exact"),
        viscera.StiffnessWarping(linear),
        viscera.MassSpring(linear),
        viscera.ShapeMemory(linear),
    ]
    mesh = viscera.TetMesh.box_grid([3, 2, 2], [0.12, 0.08, 0.08])
    other = mesh.with_nodes(mesh.nodes + [0.12, 0.0, 0.0])
    pull = [(0.0, [0, 0, 0]), (rng.uniform(0.01, 0.02), rng.uniform(-0.1, 0.1, 3).tolist())]
    loads = [
        viscera.Load.force("x-max", pull),
        viscera.Load.pressure("y-max", rng.uniform(0, 50)),
        viscera.Load.traction(viscera.Region.plane([0, 0.08, 0], [0, 1, 0]) & "surface", rng.uniform(-30, 30, 3).tolist()),
    ]
    world = viscera.World(
        gravity=rng.uniform(-3, 3, 3).tolist(),
        step=rng.uniform(1e-3, 4e-3),
        precision=str(rng.choice(["single", "double"])),
        integrator=viscera.Explicit(),
    )
    first = world.add(
        viscera.Body(
            mesh, rng.uniform(900, 1100), name="first", model=models[rng.integers(len(models))], fix="x-min",
            keep_volume=rng.choice([0.0, 5e3]), damping=rng.uniform(0, 5), load=loads[1 + rng.integers(2)],
            prescribe=(viscera.Region.nearest([0.06, 0.08, 0.0]), [(0.0, [0, 0, 0]), (0.02, [0, 0.004, 0])]),
        )
    )  # fmt: skip
    second = world.add(
        viscera.Body(
            other, 1000.0, name="second", model=models[rng.integers(len(models))], damping=2.0, load=loads[0], loose_pieces="drop",
            slide=(viscera.Region.cuboid([0.2, 0, 0], [0.3, 1, 0]), [0, 0, 1]),
        )
    )  # fmt: skip
    world.attach(first, "x-max", second)
    tip = [0.24, 0.08, 0.04]
    tools = {
        "probe": viscera.Probe([(0.0, [0.06, 0.1, 0.04]), (0.03, [0.06, 0.07, 0.04])], direction=[0.1, -1, 0.2], friction=0.3),
        "grasper": viscera.Grasper([(0.0, tip), (0.05, [0.26, 0.1, 0.04])], radius=0.03, close=0.005, roll=0.3, grip=2.0, jaws=(0.02, 2e-3, 1.0)),
        "cautery": viscera.Cautery([(0.0, [0.16, 0.08, 0.04]), (0.03, [0.16, 0.05, 0.04])], radius=0.015, on=0.01, off=0.02, trocar=[0.1, 0.3, 0]),
    }
    world.add_instrument(viscera.Probe([0.06, 0.0, 0.04]), "gone").remove()
    for name in rng.permutation(list(tools))[: rng.integers(4)]:
        world.add_instrument(tools[name], str(name))
    return world


@pytest.mark.parametrize("seed", range(12))
def test_a_world_that_python_described_is_written_to_run_to_the_same_bits(seed, tmp_path):
    """Laws with fibres, models, loads, motions, attachments and tools, drawn at random: 12 steps, to the last bit."""
    world = random_world(np.random.default_rng(seed))
    path = world.write_scene(tmp_path, duration=0.5, name="drawn")
    again, steps, _ = viscera.Scene.load(path).build()
    assert steps == np.ceil(0.5 / world.step_length * (1 - 1e-9)) and again.precision == world.precision
    assert list(again.instruments) == list(world.instruments)
    world.steps(12)
    again.steps(12)
    assert_same(places(again), places(world))
    for name, tool in world.instruments.items():
        assert again.instruments[name].observe().as_dict() == tool.observe().as_dict()


@pytest.mark.parametrize("scheme", [viscera.Implicit("newmark", gamma=0.6, beta=0.31), viscera.Implicit.accurate(), viscera.Explicit(1e-4), viscera.QuasiStatic(tolerance=1e-9), viscera.QuasiStatic(solver="direct")])
def test_an_integrator_is_written_to_run_to_the_same_bits(scheme, beam, tmp_path):
    world, body = beam(integrator=scheme)
    again, _, _ = viscera.Scene.load(world.write_scene(tmp_path, duration=0.1)).build()
    world.steps(6)
    again.steps(6)
    assert np.array_equal(again.body("beam").positions, body.positions)


@pytest.mark.parametrize("answers", [viscera.Precomputed, lambda law: viscera.Hybrid(law, dynamic=viscera.Region.cuboid([0, 0, 0.2], [1, 1, 1]))])
def test_a_body_that_answers_at_once_is_written_to_run_to_the_same_bits(answers, tmp_path):
    mesh = viscera.TetMesh.box_grid([2, 2, 4], [0.1, 0.1, 0.3])
    world = viscera.World(gravity=[0, -1, 0], step=0.002)
    model = answers(viscera.LinearElastic.from_young_poisson(10e3, 0.4))
    pull = viscera.Load.force("z-max", [(0.0, [0, 0, 0]), (0.02, [0, 0, 0.5])])
    body = world.add(viscera.Body(mesh, 1000.0, name="bar", model=model, fix="z-min", load=pull))
    again, _, _ = viscera.Scene.load(world.write_scene(tmp_path, duration=0.1)).build()
    world.steps(12)
    again.steps(12)
    assert np.array_equal(again.body("bar").positions, body.positions) and body.max_displacement > 1e-4


def test_a_shaft_is_led_through_a_point_and_let_go_and_a_scene_says_so(beam, tmp_path):
    world, _ = beam()
    tool = world.add_instrument(viscera.Probe([0, 1, 0]), "rod")
    assert tool.trocar is None
    tool.trocar = [0, 1, 0.3]
    assert tool.trocar == [0, 1, 0.3] and np.allclose(tool.direction, [0, 0, -1])
    again, _, _ = viscera.Scene.load(world.write_scene(tmp_path, duration=1.0)).build()
    assert again.instruments["rod"].trocar == [0, 1, 0.3]
    tool.lead([0.4, 1, 0])
    world.step()
    assert np.allclose(tool.direction, [0.8, 0, -0.6])
    tool.trocar = None
    tool.lead([0.4, 1, 0], direction=[1, 0, 0])
    world.step()
    assert np.allclose(tool.direction, [1, 0, 0])
    with pytest.raises(viscera.Error):
        tool.trocar = [0, float("nan"), 0]


def led(world):
    world.add_instrument(viscera.Probe(), "hand").lead([0, 1, 0])


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda world: world.step(), "at rest, whole"),
        (lambda world: world.body("beam").settle(), "at rest, whole"),
        (lambda world: world.body("beam").remove_cells([3]), "at rest, whole"),
        (lambda world: setattr(world.body("beam"), "velocities", world.body("beam").mesh.nodes), "at rest, whole"),
        (led, "tools on their paths"),
        (lambda world: world.add_instrument(viscera.Grasper([0, 1, 0]), "jaws"), "`jaws` closes by hand only"),
        (lambda world: world.add_instrument(viscera.Cautery([0, 1, 0]), "hook"), "`hook` is switched on by hand only"),
        (
            lambda world: world.add_instrument(viscera.Probe([0, 1, 0], direction=[(0.0, [1, 0, 0]), (1.0, [0, 1, 0])]), "rod"),
            "`rod` turns along time",
        ),
        (lambda world: world.add_instrument(viscera.Probe([0, 1, 0], roll=0.2), "rod"), "`rod` is round"),
    ],
)
def test_what_a_scene_has_no_words_for_is_refused_with_a_reason(change, says, beam, tmp_path):
    world, _ = beam()
    change(world)
    with pytest.raises(ValueError, match=says):
        world.write_scene(tmp_path, duration=1.0)
    assert not (tmp_path / "scene.toml").exists()


def test_settings_of_a_model_and_orders_that_a_scene_does_not_have_are_refused(tmp_path):
    law = viscera.StableNeoHookean.from_young_poisson(5e3, 0.4)
    mesh = viscera.HexMesh.box_grid([1, 1, 1], [0.1, 0.1, 0.1])
    world = viscera.World()
    world.add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(law, gauss=3), fix="x-min"))
    with pytest.raises(ValueError, match="no words for `gauss`"):
        world.write_scene(tmp_path, duration=1.0)
    world = viscera.World()
    blocks = [
        world.add(viscera.Body(mesh.with_nodes(mesh.nodes + [0.1 * k, 0, 0]), 1000.0, model=viscera.TotalLagrangian(law), name=f"{k}"))
        for k in range(3)
    ]
    world.attach(blocks[1], "x-max", blocks[2])
    world.attach(blocks[0], "x-max", blocks[1])
    with pytest.raises(ValueError, match="attach in the order in which bodies were added"):
        world.write_scene(tmp_path, duration=1.0)
    world, _, _ = viscera.Scene.parse(SCENE).build()
    with pytest.raises(ValueError, match="built from a scene"):
        world.write_scene(tmp_path, duration=1.0)
