# %% [markdown]
# # Identification
# What are E and ν of a block, given where points of its skin were seen before and after it was pulled?

# %%
import csv
import os

import numpy as np

import viscera
from viscera.identify import Equilibrium, fit

mesh = viscera.TetMesh.box_grid([3, 3, 6], [0.1, 0.1, 0.2])
skin = np.unique(mesh.surface().triangles)


def block(parameters):
    law = viscera.NeoHookean.from_young_poisson(**parameters)
    pull = viscera.Load.traction("z-max", [250.0, 0.0, 500.0])
    return viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(law), fix="z-min", load=pull)


# %% [markdown]
# Measurements are made here: the truth, and noise of 0.3 mm.

# %%
truth = {"young": 6500.0, "poisson": 0.42}
body = viscera.World(gravity=[0, -9.81, 0]).add(block(truth))
body.settle()
measured = body.positions[skin] + np.random.default_rng(5).normal(0, 3e-4, (len(skin), 3))

# %% [markdown]
# Two loads would be two experiments in the list. Each iteration costs one equilibrium and one more linear solve for each load.

# %%
experiment = Equilibrium(block, gravity=[0, -9.81, 0], nodes=skin, positions=measured)
result = fit([experiment], start={"young": 3e3, "poisson": 0.2}, bounds={"poisson": (0.0, 0.49), "young": (100, 1e5)})
print(result)
for name, value in truth.items():
    assert abs(result.parameters[name] - value) < 4 * result.standard_errors[name]

# %% [markdown]
# ## The truth cube
# Silicone with beads inside, pressed between plates (Kerdok et al., Medical Image Analysis 7, 2003). Where the plate goes a given way, places say
# nothing about Young's modulus; the force of the plate does. It was not published: the 6.2 N at 5 % are computed, by mixed quadratic elements
# (dolfinx, reference case D01, 6.193 N) of a neo-Hookean cube of the published 14.9 kPa. What comes back is that modulus, to what a mesh of
# 5³ cubes is too stiff or too soft.

# %%
side, cells = 0.08, 5
cube = viscera.TetMesh.box_grid([cells, cells, cells], [side] * 3)
plate = cube.nodes_in("z-max")


def pressed(young=14.9e3, poisson=0.499, way=0.05 * side):
    law = viscera.NeoHookean.from_young_poisson(young=young, poisson=poisson)
    down = ("z-max", [0.0, 0.0, -way])
    return viscera.Body(cube, 1000.0, model=viscera.NodallyIntegrated(law), fix="z-min", prescribe=down)


weighed = Equilibrium(lambda p: pressed(**p), gravity=[0, 0, 0], force_on=plate, force=[0.0, 0.0, -6.2])
modulus = fit([weighed], start={"young": 5e3})
print("truth cube, from the force of the plate:", modulus, sep="\n")
assert abs(modulus.parameters["young"] - 14.9e3) < 0.12 * 14.9e3

# %% [markdown]
# What the beads tell is Poisson's ratio, and how far the plate really went. Their places state no licence and are not part of viscera: give the
# path of `bead-positions.csv` in `VISCERA_TRUTH_CUBE`.


# %%
def read_beads(path, state=1):
    """Nominal places of the beads and how far they moved [m], both (343, 3); the file's axes are x, -y, -z of ours, in mm."""
    with open(path, newline="") as file:
        rows = [row for row in csv.reader(file) if row and row[0].strip().isdigit()]
    numbers = np.array([[float(value) for value in row[:15]] for row in rows])
    i, j, k = numbers[:, :3].T
    nominal = np.column_stack([i, 8 - j, k]) * 0.01
    seen = numbers[:, 3:].reshape(-1, 4, 3) * [1e-3, -1e-3, -1e-3]
    return nominal, seen[:, state] - seen[:, 0]


def between_nodes(mesh, places):
    """Weights of shape (k, n): each place between the corners of the tetrahedron around it."""
    corners = mesh.nodes[mesh.cells]
    inverse = np.linalg.inv(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2))
    weights = np.zeros((len(places), len(mesh.nodes)))
    for row, place in zip(weights, places):
        share = np.einsum("cij,cj->ci", inverse, place - corners[:, 0])
        share = np.column_stack([1 - share.sum(axis=1), share])
        cell = np.argmax(share.min(axis=1))
        row[mesh.cells[cell]] = share[cell]
    return weights


path = os.environ.get("VISCERA_TRUTH_CUBE")
if path is None:
    print("VISCERA_TRUTH_CUBE is not set: the beads are left out")
else:
    nominal, moved = read_beads(path)
    seen = Equilibrium(lambda p: pressed(**p), gravity=[0, 0, 0], points=between_nodes(cube, nominal), positions=nominal + moved)
    beads = fit([seen], start={"poisson": 0.48, "way": 0.04 * side}, bounds={"poisson": (0.3, 0.499)})
    left = beads.residuals.reshape(-1, 3)
    drift, apart = left.mean(axis=0), np.linalg.norm(left - left.mean(axis=0), axis=1)
    print("truth cube, from its beads:", beads, sep="\n")
    print(f"all drift by {np.round(1e3 * drift, 2)} mm, and are seen {100 * apart.mean() / side:.2f} % of the edge from there")
