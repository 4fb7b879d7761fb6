# %% [markdown]
# # Sweep
# How far does a strip of liver hang, for every stiffness and every thickness?

# %%
import viscera

SCENE = """
title = "A strip of tissue that hangs"
duration = "0.2 s"
[body.strip]
mesh = { generate = "box", size = ["4 cm", "16 cm", "2 cm"], cells = [2, 8, 1] }
density = 1060
law = { kind = "stable-neo-hookean", young = "6 kPa", poisson = 0.45 }
model = { kind = "total-lagrangian" }
fix = "y-max"
damping = 5
"""

# %% [markdown]
# Values by dotted key, in all combinations. Without a `client` cases run on the threads of this machine; with a `dask.distributed.Client` on
# its workers: `viscera.sweep(scene, values, client=Client("tcp://…"))`. A worker may die; the table is the same.

# %%
values: dict[str, list] = {
    "body.strip.law.young": ["4 kPa", "6 kPa", "8 kPa"],
    "body.strip.mesh.size": [["4 cm", "16 cm", "1 cm"], ["4 cm", "16 cm", "2 cm"]],
}
table = viscera.sweep(viscera.Scene.parse(SCENE), values)
for row in table.rows:
    print(row["body.strip.law.young"], row["body.strip.mesh.size"], f"{1e3 * row['strip: max displacement [m]']:.2f} mm")
assert len(table) == 6 and table["error"] == [None] * 6
sags = table["strip: max displacement [m]"]
assert sags[0] > sags[2] > sags[4]

# %% [markdown]
# What is measured can be chosen; and the table goes to pandas, Arrow, Parquet or CSV.

# %%
energies = viscera.sweep(
    viscera.Scene.parse(SCENE),
    {"body.strip.law.poisson": [0.3, 0.45]},
    measure=lambda world: {"elastic [J]": world.body("strip").observe().elastic_energy},
)
energies.to_csv("energies.csv")
print(open("energies.csv").read())
