# %% [markdown]
# # A tool in your hand
# The environments of `viscera.gym` move a tool; so can you. A grasper takes the rim of a sheet and lifts it.

# %%
import numpy as np

import viscera

mesh = viscera.TetMesh.box_grid([10, 1, 10], [0.1, 0.005, 0.1])
law = viscera.StableNeoHookean.from_young_poisson(young=5e3, poisson=0.45)
world = viscera.World(gravity=[0, 0, 0], step=0.01, precision="single")
sheet = world.add(viscera.Body(mesh, 1060.0, model=viscera.TotalLagrangian(law), fix="x-min", damping=10.0))
grasper = world.add_instrument(viscera.Grasper(radius=0.012), "grasper")

# %%
rim = np.array([0.1, 0.0025, 0.05])
grasper.lead(rim.tolist(), trigger=0.0)
world.step()
grasper.lead(rim.tolist(), trigger=1.0)
world.step()
print(f"the grasper holds {grasper.held_nodes} nodes")
assert grasper.held_nodes > 0

# %% [markdown]
# Led by a target for each step: 10 cm/s upwards, and then still.

# %%
for step in range(1, 61):
    height = min(0.001 * step, 0.03)
    grasper.lead((rim + [0.0, height, 0.0]).tolist(), trigger=1.0)
    world.step()
lifted = sheet.positions[mesh.nodes_in(viscera.Region.nearest(rim.tolist()))[0], 1] - mesh.nodes[:, 1].max()
print(f"the rim is lifted by {1e3 * lifted:.1f} mm, with {np.linalg.norm(grasper.force):.3f} N")
assert 0.02 < lifted < 0.035
assert grasper.force[1] > 0
