# %% [markdown]
# # First cut
# A strip of tissue hangs under its weight, and a cautery cuts into it. Everything is SI.

# %%
import numpy as np

import viscera

mesh = viscera.TetMesh.box_grid([4, 16, 2], [0.04, 0.16, 0.02])  # m
liver = viscera.TISSUES["liver"]
print(liver.source)

# %% [markdown]
# A body is a mesh, a density, a force model of a law, and what holds it. It is held at its top.

# %%
world = viscera.World(gravity=[0, -9.81, 0], step=5e-3)
strip = world.add(
    viscera.Body(
        mesh,
        liver.density,
        name="strip",
        model=viscera.TotalLagrangian(liver.law(viscera.StableNeoHookean)),
        fix="y-max",
        damping=5.0,
        loose_pieces="drop",
    )
)
strip.settle()
before = strip.observe()
print(f"it hangs {1e3 * before.max_displacement:.1f} mm, and what holds it carries {before.reaction[1]:.4f} N")
assert np.isclose(before.reaction[1], liver.density * mesh.volume * 9.81, rtol=1e-8)

# %% [markdown]
# A cautery goes through half of it, at the height where the strip's middle hangs now.

# %%
middle = strip.positions[:, 1].mean()
cautery = viscera.Cautery([(0.0, [-0.02, middle, 0.01]), (0.2, [0.02, middle, 0.01])], radius=0.004, on=0.0, off=0.2)
world.add_instrument(cautery, "cautery")
world.steps(100)
after = strip.observe()
print(f"{after.removed_cells} of {len(mesh)} tetrahedra are gone; it hangs {1e3 * after.max_displacement:.1f} mm now")
assert after.removed_cells > 0
assert after.max_displacement > before.max_displacement

# %% [markdown]
# Arrays keep their shape: nodes and cells are never renumbered, and fields of what is gone are NaN.

# %%
stress = strip.von_mises_stress()
assert np.isnan(stress).sum() == after.removed_cells
print(f"the largest stress is {np.nanmax(stress) / 1e3:.1f} kPa, beside the cut")

# %% [markdown]
# With matplotlib (`pip install viscera[plot]`) it is drawn in one call.

# %%
try:
    viscera.plot(strip, "von-mises", title="cut", path="first-cut.png")
except ImportError as missing:
    print(missing)
