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
# Beads in a cube of silicone (Kerdok et al., Medical Image Analysis 7, 2003), pressed between plates. The data states no licence, so it is not
# here: give the path of `bead-positions.csv` in `VISCERA_TRUTH_CUBE`. Bead positions do not depend on Young's modulus, which only the
# force shows; what they tell is ν. Force of the plate at 5 %: 6.2 N by a converged neo-Hookean solution of E = 14.9 kPa.

# %%
side, cells = 0.08, 5
cube = viscera.TetMesh.box_grid([cells, cells, cells], [side] * 3)
plate = cube.nodes_in("z-max")


def pressed(parameters):
    law = viscera.NeoHookean.from_young_poisson(young=parameters["young"], poisson=0.499)
    down = ("z-max", [0.0, 0.0, -0.05 * side])
    return viscera.Body(cube, 1000.0, model=viscera.NodallyIntegrated(law), fix="z-min", prescribe=down)


weighed = Equilibrium(pressed, gravity=[0, 0, 0], force_on=plate, force=[0.0, 0.0, -6.2])
modulus = fit([weighed], start={"young": 5e3})
print("truth cube, from the force of the plate:", modulus, sep="\n")
assert abs(modulus.parameters["young"] - 14.9e3) < 0.12 * 14.9e3

# %%
path = os.environ.get("VISCERA_TRUTH_CUBE")
if path is None:
    print("VISCERA_TRUTH_CUBE is not set: the beads are left out")
else:
    with open(path, newline="") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    print(f"{len(rows)} rows of beads are there; columns: {rows[0]}")
