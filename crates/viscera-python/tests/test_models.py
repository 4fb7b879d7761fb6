"""All ten force models, the fields of bodies, and integrators, from Python."""

import numpy as np
import pytest

import viscera

LINEAR = viscera.LinearElastic.from_young_poisson(10e3, 0.3)
STVK = viscera.StVenantKirchhoff.from_young_poisson(10e3, 0.3)
TETS = viscera.TetMesh.box_grid([2, 1, 1], [0.2, 0.1, 0.1])
HEXES = viscera.HexMesh.box_grid([2, 1, 1], [0.2, 0.1, 0.1])

#: Every model, and whether its product is the derivative of its forces; stiffness warping leaves out of it how the rotations change.
MODELS = {
    "linear-tensor-mass": (lambda: viscera.LinearTensorMass(LINEAR), True),
    "tensor-mass": (lambda: viscera.TensorMass(STVK), True),
    "total-lagrangian": (lambda: viscera.TotalLagrangian(STVK), True),
    "nodally-integrated": (lambda: viscera.NodallyIntegrated(STVK), True),
    "corotational": (lambda: viscera.Corotational(LINEAR, tangent="exact"), True),
    "stiffness-warping": (lambda: viscera.StiffnessWarping(LINEAR), False),
    "mass-spring": (lambda: viscera.MassSpring(LINEAR), True),
    "shape-memory": (lambda: viscera.ShapeMemory(LINEAR), True),
    "precomputed": (lambda: viscera.Precomputed(LINEAR), True),
    "hybrid": (lambda: viscera.Hybrid(STVK), True),
}


def test_the_ten_models_are_the_ones_that_there_are():
    classes = {cls for cls in vars(viscera).values() if isinstance(cls, type) and issubclass(cls, viscera.Model)} - {viscera.Model}
    made = {name: make() for name, (make, _) in MODELS.items()}
    assert {type(model) for model in made.values()} == classes and len(classes) == 10
    assert all(model.kind == name for name, model in made.items())


def deformed(mesh, seed=2):
    """Places a little beside those at rest, and a direction."""
    rng = np.random.default_rng(seed)
    return mesh.nodes + 2e-3 * rng.uniform(-1, 1, mesh.nodes.shape), rng.uniform(-1, 1, mesh.nodes.shape)


@pytest.mark.parametrize("name", list(MODELS))
def test_products_are_those_of_the_stiffness_and_of_finite_differences(name):
    """K(x) dx by the model, by the assembled blocks, and by central differences of the forces."""
    make, exact = MODELS[name]
    model = viscera.ForceModel(TETS, make())
    x, dx = deformed(TETS)
    product = model.product(x, dx)
    scale = np.abs(product).max()
    assert scale > 0
    blocks = (viscera.stiffness(model, x) @ dx.ravel()).reshape(-1, 3)
    assert np.abs(blocks - product).max() < 1e-11 * scale
    h = 1e-6
    slope = (model.forces(x + h * dx) - model.forces(x - h * dx)) / (2 * h)
    if exact:
        assert np.abs(slope - product).max() < 1e-6 * scale
    at_rest = TETS.nodes
    slope = (model.forces(at_rest + h * dx) - model.forces(at_rest - h * dx)) / (2 * h)
    product = model.product(at_rest, dx)
    assert np.abs(slope - product).max() < 1e-6 * np.abs(product).max()


@pytest.mark.parametrize("name", list(MODELS))
def test_single_precision_gives_the_products_of_double(name):
    x, dx = deformed(TETS)
    single, double = (viscera.ForceModel(TETS, MODELS[name][0](), precision=precision) for precision in ("single", "double"))
    wanted = double.product(x, dx)
    found = single.product(x, dx)
    assert found.dtype == np.float32 and np.abs(found - wanted).max() < 1e-3 * np.abs(wanted).max()


@pytest.mark.parametrize("precision", ["single", "double"])
def test_a_force_that_keeps_volume_is_added_with_its_energy_and_stiffness(precision):
    """W_v = κ/2 Σ (V − V0)²/V0 grows with κ, and its forces and products are its derivatives."""
    x, dx = deformed(TETS)
    recipe = viscera.TotalLagrangian(STVK)
    plain, kept, twice = (viscera.ForceModel(TETS, recipe, keep_volume=kappa, precision=precision) for kappa in (0.0, 2e4, 4e4))
    added = [model.energy(x) - plain.energy(x) for model in (kept, twice)]
    tolerance = 1e-9 if precision == "double" else 1e-2
    assert added[0] > 0 and added[1] == pytest.approx(2 * added[0], rel=tolerance)
    if precision == "double":
        h = 1e-6
        slope = (kept.energy(x + h * dx) - kept.energy(x - h * dx)) / (2 * h)
        assert np.sum(kept.forces(x) * dx) == pytest.approx(slope, rel=1e-6)
        slope = (kept.forces(x + h * dx) - kept.forces(x - h * dx)) / (2 * h)
        assert np.abs(kept.product(x, dx) - slope).max() < 1e-6 * np.abs(slope).max()
    assert np.abs(kept.forces(x) - plain.forces(x)).max() > 1e-2 * np.abs(plain.forces(x)).max()
    with pytest.raises(ValueError, match="works on tetrahedra"):
        viscera.ForceModel(HEXES, recipe, keep_volume=1.0)


@pytest.mark.parametrize("mesh", [TETS, HEXES], ids=["tetrahedra", "hexahedra"])
@pytest.mark.parametrize("precision", ["single", "double"])
def test_fields_of_a_homogeneous_deformation_are_those_of_the_law_in_every_cell(mesh, precision):
    """One F everywhere: F itself, P(F) of the law, S = F⁻¹P, and √(⅔ dev E : dev E)."""
    gradient = np.array([[1.15, 0.1, 0.0], [0.0, 0.95, -0.05], [0.02, 0.0, 1.05]])
    law = viscera.NeoHookean.from_young_poisson(10e3, 0.3)
    body = viscera.World(gravity=[0, 0, 0], precision=precision).add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(law)))
    body.positions = mesh.nodes @ gradient.T
    digits = 1e-11 if precision == "double" else 2e-5
    first = law.stress(gradient)[0]
    strain = (gradient.T @ gradient - np.eye(3)) / 2
    deviator = strain - np.trace(strain) / 3 * np.eye(3)
    for found, wanted in (
        (body.deformation_gradient(), gradient),
        (body.green_strain(), strain),
        (body.first_piola_stress(), first),
        (body.second_piola_stress(), np.linalg.solve(gradient, first)),
        (body.cauchy_stress(), first @ gradient.T / np.linalg.det(gradient)),
        (body.equivalent_strain(), np.sqrt(2 / 3 * np.sum(deviator**2))),
        (body.volume_ratio(), np.linalg.det(gradient)),
    ):
        assert len(found) == len(mesh)
        assert np.abs(found - wanted).max() < digits * max(1.0, 10 * np.abs(wanted).max())
    body.remove_cells([0])
    for field in (body.deformation_gradient(), body.first_piola_stress(), body.equivalent_strain()):
        assert np.isnan(field[0]).all() and np.isfinite(field[1:]).all()


def test_small_uniaxial_tension_has_its_elongation_as_equivalent_strain():
    """E = e diag(1, −ν, −ν): the equivalent strain is ⅔ (1 + ν) e."""
    e, poisson = 1e-6, 0.5
    body = viscera.World().add(viscera.Body(TETS, 1000.0, model=viscera.TotalLagrangian(STVK)))
    body.positions = TETS.nodes * [1 + e, 1 - poisson * e, 1 - poisson * e]
    assert np.allclose(body.equivalent_strain(), e, rtol=1e-5)


def test_an_attachment_carries_the_weight_that_hangs_from_it():
    """A block grown under another, damped to rest: what holds it is its weight, up."""
    half = viscera.TetMesh.box_grid([2, 2, 2], [0.1, 0.1, 0.1])
    lower = half.with_nodes(half.nodes - [0.0, 0.1, 0.0])
    world = viscera.World(gravity=[0, -1.0, 0], step=0.01)
    model = viscera.TotalLagrangian(viscera.StableNeoHookean.from_young_poisson(10e3, 0.3))
    above = world.add(viscera.Body(half, 1000.0, name="above", model=model, fix="y-max", damping=30.0))
    below = world.add(viscera.Body(lower, 1000.0, name="below", model=model, damping=30.0))
    attachment = world.attach(below, "y-max", above)
    world.steps(400)
    assert np.allclose(attachment.force, [0.0, 1.0, 0.0], atol=0.02)
    assert np.allclose(above.observe().reaction, [0.0, 2.0, 0.0], atol=0.03)


@pytest.mark.parametrize("scheme", ["backward-euler", "newmark", "bdf2"])
def test_implicit_schemes_swing_as_the_fine_explicit_one_does(scheme, beam):
    """First order loses some of the swing in 40 steps; the others keep the place to a few per cent."""
    explicit, reference = beam(cells=(1, 1, 4), step=0.01)
    explicit.steps(40)
    world, body = beam(cells=(1, 1, 4), step=0.01, integrator=viscera.Implicit.accurate(scheme))
    report = world.steps(40)
    assert report.implicit.converged
    wanted = reference.positions - reference.mesh.nodes
    found = body.positions - body.mesh.nodes
    allowed = 0.3 if scheme == "backward-euler" else 0.06
    assert np.abs(found - wanted).max() < allowed * np.abs(wanted).max()


def test_energy_momentum_keeps_the_energy_that_backward_euler_loses():
    """A beam let go swings by itself: kinetic, elastic and gravity energy add up to what they were."""
    changes = {}
    for scheme in ("energy-momentum", "backward-euler"):
        law = viscera.StVenantKirchhoff.from_young_poisson(10e3, 0.3)
        mesh = viscera.TetMesh.box_grid([1, 1, 4], [0.1, 0.1, 0.4])
        world = viscera.World(gravity=[0, -0.5, 0], step=0.02, integrator=viscera.Implicit.accurate(scheme))
        body = world.add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(law), fix="z-min"))

        def energies():
            seen = body.observe()
            return np.array([seen.kinetic_energy, seen.elastic_energy, seen.gravity_energy])

        before, largest = energies().sum(), 0.0
        for _ in range(40):
            world.step()
            largest = max(largest, energies()[0])
        changes[scheme] = abs(energies().sum() - before) / largest
    assert changes["energy-momentum"] < 1e-3 < 0.05 < changes["backward-euler"]
