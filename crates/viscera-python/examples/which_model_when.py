# %% [markdown]
# # Which model when
# One beam, held at one end, under loads from small to large; and nearly incompressible.

# %%
import time

import numpy as np

import viscera

mesh = viscera.TetMesh.box_grid([4, 4, 16], [0.1, 0.1, 0.4])
tip = mesh.nodes_in(viscera.Region.nearest([0.05, 0.05, 0.4]))[0]


def sag(model, gravity):
    """How far the tip sinks [m], and how far the beam's volume is off."""
    body = viscera.World(gravity=[0, -gravity, 0]).add(viscera.Body(mesh, 1000.0, model=model, fix="z-min"))
    body.settle()
    return mesh.nodes[tip, 1] - body.positions[tip, 1], body.observe().volume_variation


# %% [markdown]
# Small loads: all agree, and the linear models are cheapest. Large ones: linear elasticity grows in volume; St Venant–Kirchhoff and
# corotational tetrahedra follow the turn; neo-Hookean laws bear what St Venant–Kirchhoff does not.

# %%
young, poisson = 10e3, 0.3
linear = viscera.LinearElastic.from_young_poisson(young, poisson)
stvk = viscera.StVenantKirchhoff.from_young_poisson(young, poisson)
stable = viscera.StableNeoHookean.from_young_poisson(young, poisson)
models = {
    "total-lagrangian, linear": viscera.TotalLagrangian(linear),
    "corotational": viscera.Corotational(linear, tangent="exact"),
    "tensor-mass, St Venant-Kirchhoff": viscera.TensorMass(stvk),
    "total-lagrangian, St Venant-Kirchhoff": viscera.TotalLagrangian(stvk),
    "total-lagrangian, stable neo-Hookean": viscera.TotalLagrangian(stable),
}
table = {}
print(f"{'model':40} {'0.005 m/s²':>12} {'0.5 m/s²':>12} {'volume at 0.5':>14}")
for name, model in models.items():
    small, _ = sag(model, 0.005)
    large, volume = sag(model, 0.5)
    table[name] = (small, large, volume)
    print(f"{name:40} {1e3 * small:9.3f} mm {1e3 * large:9.2f} mm {100 * volume:12.2f} %")
smalls = np.array([row[0] for row in table.values()])
assert np.ptp(smalls) < 0.01 * smalls.mean()
assert table["total-lagrangian, linear"][1] > 1.05 * table["total-lagrangian, St Venant-Kirchhoff"][1]
assert abs(table["total-lagrangian, linear"][2]) > 5 * abs(table["corotational"][2])
# Tensor-mass is another text of the same law.
assert np.isclose(table["tensor-mass, St Venant-Kirchhoff"][1], table["total-lagrangian, St Venant-Kirchhoff"][1], rtol=1e-6)

# %% [markdown]
# Nearly incompressible tissue: plain tetrahedra lock, nodally integrated ones do not.

# %%
nearly = viscera.StableNeoHookean.from_young_poisson(young, 0.499)
locked, _ = sag(viscera.TotalLagrangian(nearly), 0.05)
free, _ = sag(viscera.NodallyIntegrated(nearly), 0.05)
print(f"ν = 0.499: plain tetrahedra sink {1e3 * locked:.2f} mm, nodally integrated ones {1e3 * free:.2f} mm")
assert free > 1.3 * locked

# %% [markdown]
# Forces alone, for a solver of your own: the same for every model.

# %%
x = mesh.nodes + 0.001 * np.random.default_rng(0).standard_normal(mesh.nodes.shape)
for name, recipe in models.items():
    alone = viscera.ForceModel(mesh, recipe, precision="single")
    begin = time.perf_counter()
    for _ in range(20):
        alone.forces(x)
    each = (time.perf_counter() - begin) / 20 / len(mesh)
    print(f"{name:40} {1e9 * each:6.1f} ns for each tetrahedron, arrays in and out included")
