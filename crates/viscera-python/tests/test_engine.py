"""The engine from Python: laws, models, worlds, equilibria, errors, scenes."""

import os
import pickle
import threading
from pathlib import Path

import numpy as np
import pytest

import viscera

SCENE = """
duration = "60 ms"
gravity = [0, -2, 0]
precision = "double"
[body.bar]
mesh = { generate = "box", size = [0.1, 0.1, 0.3], cells = [2, 2, 6] }
density = 1060
law = { kind = "stable-neo-hookean", young = "4 kPa", poisson = 0.4 }
model = { kind = "total-lagrangian" }
fix = "z-min"
damping = 2
"""


def test_every_law_has_the_gradient_of_its_energy_and_the_derivative_of_its_stress():
    """Central differences of step h: truncation h² and rounding 1e-16/h, 1e-9 and less of the stiffness."""
    rng = np.random.default_rng(1)
    lame = viscera.Lame.from_young_poisson(10e3, 0.4)
    stiff = viscera.Lame(3 * lame.lambda_, 3 * lame.mu)
    laws = [kind(lame) for kind in (viscera.LinearElastic, viscera.StVenantKirchhoff, viscera.NeoHookean, viscera.StableNeoHookean)]
    laws += [kind(lame, [1, 2, 0], stiff) for kind in (viscera.TransverseLinear, viscera.TransverseStVenantKirchhoff)]
    h = 1e-5
    for law in laws:
        gradient, direction = np.eye(3) + 0.2 * rng.uniform(-1, 1, (3, 3)), rng.uniform(-1, 1, (3, 3))
        ends = np.array([gradient + h * direction, gradient - h * direction])
        slope = np.subtract(*law.energy(ends)) / (2 * h)
        assert slope == pytest.approx(np.sum(law.stress(gradient)[0] * direction), rel=1e-7), law
        change = np.subtract(*law.stress(ends)) / (2 * h)
        assert np.allclose(change, law.tangent(gradient, direction)[0], atol=1e-8 * 10e3), law


@pytest.mark.parametrize("precision", ["single", "double"])
def test_every_model_gives_the_derivative_of_its_energy(precision):
    mesh = viscera.TetMesh.box_grid([2, 1, 1], [0.2, 0.1, 0.1])
    law, linear = (kind.from_young_poisson(10e3, 0.3) for kind in (viscera.StVenantKirchhoff, viscera.LinearElastic))
    models = [viscera.TotalLagrangian(law), viscera.TensorMass(law), viscera.NodallyIntegrated(law), viscera.Corotational(linear)]
    rng = np.random.default_rng(2)
    x = mesh.nodes + 0.01 * rng.uniform(-1, 1, mesh.nodes.shape)
    dx = rng.uniform(-1, 1, mesh.nodes.shape)
    for recipe in models:
        model = viscera.ForceModel(mesh, recipe, precision=precision)
        exact = viscera.ForceModel(mesh, recipe)
        h = 1e-6
        slope = (exact.energy(x + h * dx) - exact.energy(x - h * dx)) / (2 * h)
        tolerance = 1e-7 if precision == "double" else 1e-3
        assert np.sum(model.forces(x) * dx) == pytest.approx(slope, rel=tolerance), recipe


@pytest.mark.parametrize(
    ("make", "kind", "says"),
    [
        (lambda: viscera.Lame.from_young_poisson(5e3, 0.5), viscera.MaterialRefused, "0.5 makes lambda infinite: take 0.49"),
        (lambda: viscera.TetMesh.liver(-1.0, 0.1), viscera.GenerateRefused, "length"),
        (lambda: viscera.TetMesh.box_grid([1, 1, 1], [1, 1, 1]).nodes_in("nobody"), viscera.RegionRefused, "it has `x-max`"),
        (lambda: viscera.Curve([(1.0, 0.0), (0.5, 1.0)]), viscera.CurveRefused, "times must ascend"),
        (lambda: viscera.World(step=-1.0), viscera.WorldRefused, "step = -1 is out of range"),
        (lambda: viscera.read_mesh("nowhere.msh"), viscera.ReadFailed, "nowhere.msh"),
    ],
)
def test_what_is_refused_is_raised_with_the_engines_own_words(make, kind, says):
    with pytest.raises(kind) as error:
        make()
    assert says in str(error.value) and isinstance(error.value, viscera.Error)


def test_regions_join_and_intersect_with_names_on_either_side():
    mesh = viscera.TetMesh.box_grid([2, 2, 2], [1, 1, 1])
    ends = set(mesh.nodes_in("x-min")) | set(mesh.nodes_in("x-max"))
    edge = set(mesh.nodes_in("x-min")) & set(mesh.nodes_in("y-max"))
    named = viscera.Region.named
    for both in (named("x-min") | "x-max", "x-min" | named("x-max"), named("x-min") | named("x-max")):
        assert set(mesh.nodes_in(both)) == ends
    for both in (named("x-min") & "y-max", "x-min" & named("y-max")):
        assert set(mesh.nodes_in(both)) == edge


def test_a_scene_that_is_wrong_shows_its_line():
    with pytest.raises(viscera.SceneError) as error:
        viscera.Scene.parse(SCENE.replace("young", "youngs")).check()
    assert (error.value.line, error.value.column) == (8, 38)
    assert "did you mean `young`?" in str(error.value)


def test_a_load_beyond_the_law_says_how_far_it_went(beam):
    world = viscera.World(gravity=[0, -2.0, 0])
    law = viscera.StVenantKirchhoff.from_young_poisson(10e3, 0.3)
    mesh = viscera.TetMesh.box_grid([2, 2, 8], [0.1, 0.1, 0.4])
    body = world.add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(law), fix="z-min"))
    with pytest.raises(viscera.StaticFailed, match="stable-neo-hookean"):
        body.settle()


@pytest.mark.parametrize("solver", ["iterative", "direct"])
def test_steps_of_a_quasi_static_world_keep_their_residuals(solver):
    world = viscera.World(gravity=[0, -0.5, 0], integrator=viscera.QuasiStatic(solver=solver))
    law = viscera.NeoHookean.from_young_poisson(10e3, 0.4)
    mesh = viscera.TetMesh.box_grid([2, 2, 8], [0.1, 0.1, 0.4])
    body = world.add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(law), fix="z-min"))
    assert body.static_report is None
    world.step()
    share, residuals = body.static_report.steps[-1]
    assert share == 1.0 and len(residuals) > 3 and residuals[-1] <= 1e-10 < residuals[0]
    assert body.static_report.iterations == sum(len(step[1]) - 1 for step in body.static_report.steps)


def test_the_answer_to_small_forces_is_the_slope_of_the_equilibrium(beam):
    """Two equilibria with forces of ±h on the tip against one linear solve: the difference is of second order in h."""
    _, body = beam()
    body.settle()
    tip = int(np.argmax(body.mesh.nodes @ [1, 1, 10]))
    forces = np.zeros_like(body.positions)
    forces[tip, 0] = 1.0
    answer = body.respond(forces)
    ends = []
    for h in (1e-4, -1e-4):
        world = viscera.World(gravity=[0, -0.5, 0])
        law = viscera.NeoHookean.from_young_poisson(young=10e3, poisson=0.4)
        load = viscera.Load.force(viscera.Region.nodes([tip]), [h, 0, 0])
        other = world.add(viscera.Body(body.mesh, 1000.0, model=viscera.TotalLagrangian(law), fix="z-min", load=load))
        other.settle()
        ends.append(other.positions)
    slope = (ends[0] - ends[1]) / 2e-4
    assert np.abs(answer - slope).max() < 1e-5 * np.abs(slope).max()


def test_a_snapshot_goes_on_with_the_same_bits_also_as_bytes(beam):
    world, body = beam("single")
    world.steps(5)
    body.remove_cells([0, 1, 2])
    kept = world.snapshot()
    as_bytes = kept.to_bytes()
    world.steps(20)
    wanted = body.positions
    world.restore(kept)
    world.steps(20)
    assert np.array_equal(body.positions, wanted)
    other, same = beam("single")
    other.restore(other.read_snapshot(as_bytes))
    other.steps(20)
    assert np.array_equal(same.positions, wanted)
    foreign, _ = beam("single", cells=(1, 1, 1))
    with pytest.raises(viscera.SnapshotRefused):
        foreign.read_snapshot(as_bytes)


def test_worlds_on_many_threads_have_the_bits_of_one():
    worlds, wanted = [], []
    scene = viscera.Scene.parse(SCENE)
    for young in (2e3, 4e3, 6e3, 8e3):
        scene.set("body.bar.law.young", young)
        worlds.append(scene.build()[0])
        alone = scene.build()[0]
        alone.steps(8)
        wanted.append(alone.body("bar").positions)
    failures = viscera.Threads(3).step(worlds, 8)
    assert failures == [None] * 4
    for world, positions in zip(worlds, wanted):
        assert np.array_equal(world.body("bar").positions, positions)
    with pytest.raises(RuntimeError, match="borrowed"):
        viscera.Threads(1).step([worlds[0], worlds[0]], 1)


def test_threads_of_python_step_worlds_of_their_own_at_once():
    scene = viscera.Scene.parse(SCENE)
    alone = scene.build()[0]
    alone.steps(200)
    worlds = [scene.build()[0] for _ in range(4)]
    threads = [threading.Thread(target=world.steps, args=(200,)) for world in worlds]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    for world in worlds:
        assert np.array_equal(world.body("bar").positions, alone.body("bar").positions)


def test_ten_thousand_steps_and_readings_leave_memory_as_it_was(beam):
    """A leak of one array of positions (1 kB) in each step would show as 10 MB."""
    world, body = beam("single", cells=(1, 1, 2), step=1e-4)

    def pages():
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    def play(steps):
        for _ in range(steps):
            world.step()
            body.positions, body.internal_forces, body.live_positions, body.surface(), body.observe(), body.mesh.nodes

    play(1000)
    before = pages()
    play(10_000)
    assert pages() - before < 4e6


def test_scenes_meshes_and_laws_survive_being_pickled():
    mesh = viscera.TetMesh.box_grid([1, 2, 1], [1, 1, 1])
    assert pickle.loads(pickle.dumps(mesh)) == mesh
    law = viscera.NeoHookean.from_young_poisson(5e3, 0.4)
    assert pickle.loads(pickle.dumps(law)) == law
    scene = viscera.Scene.parse(SCENE)
    assert pickle.loads(pickle.dumps(scene)).check() == scene.check()


def test_a_tissue_of_one_law_for_each_cell_bends_where_it_is_soft(beam):
    mesh = viscera.TetMesh.box_grid([2, 2, 4], [0.1, 0.1, 0.4])
    centres = mesh.nodes[mesh.cells].mean(axis=1)
    values = np.where(centres[:, :1] < 0.05, 1.0, 4.0) * np.array([[4e3, 2e3]])
    tissue = viscera.Tissue.from_values("neo-hookean", values)
    load = viscera.Load.traction("z-max", [0, 0, -200.0])
    world = viscera.World(gravity=[0, 0, 0])
    body = world.add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(tissue), fix="z-min", load=load))
    body.settle()
    top = mesh.nodes_in("z-max")
    soft, stiff = mesh.nodes[top, 0] < 0.01, mesh.nodes[top, 0] > 0.09
    sunk = (body.positions - mesh.nodes)[top, 2]
    assert sunk[soft].mean() < sunk[stiff].mean() < 0
    with pytest.raises(viscera.Error, match="laws are given for"):
        wrong = viscera.Tissue.from_values("neo-hookean", values[:-1])
        world.add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(wrong)))


def test_the_stub_names_what_the_module_has():
    """The typed stub and the compiled module list the same classes and methods."""
    import ast

    from viscera import _viscera

    stub = ast.parse((Path(viscera.__file__).parent / "_viscera.pyi").read_text())
    classes = {node.name: node for node in stub.body if isinstance(node, ast.ClassDef)}
    functions = {node.name for node in stub.body if isinstance(node, ast.FunctionDef)}
    public = {name for name in dir(_viscera) if not name.startswith("_")}
    assert set(classes) | functions == public
    for name, node in classes.items():
        named = {item.name for item in node.body if isinstance(item, ast.FunctionDef) and not item.name.startswith("_")}
        made = getattr(_viscera, name)
        has = {item for item in vars(made) if not item.startswith("_")}
        assert named == has, name
        assert made.__doc__, f"{name} has no docstring"
        assert all(getattr(made, item).__doc__ for item in has), f"{name} has something without a docstring"
