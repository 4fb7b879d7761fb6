"""Run by `test.sh` where the wheel was installed and nothing else: it needs numpy alone, and says what an extra is missing."""

import importlib.metadata

import numpy as np

import viscera
import viscera.identify

there = {distribution.metadata["Name"].lower() for distribution in importlib.metadata.distributions()}
assert there <= {"viscera", "numpy", "pip", "setuptools"}, there

mesh = viscera.TetMesh.box_grid([2, 2, 4], [0.1, 0.1, 0.2])
law = viscera.NeoHookean.from_young_poisson(young=10e3, poisson=0.45)
world = viscera.World(gravity=[0, -1, 0])
body = world.add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(law), fix="z-min"))
body.settle()
assert np.allclose(body.observe().reaction, [0, 2.0, 0], atol=1e-8)
world.steps(10)
assert len(viscera.sweep(viscera.Scene.parse("duration = 0.1"), {"gravity": [[0, 0, 0], [0, -1, 0]]})) == 2

for call, extra in (
    (lambda: viscera.to_meshio(mesh), "mesh"),
    (lambda: viscera.to_pyvista(mesh), "mesh"),
    (lambda: viscera.plot(mesh), "plot"),
    (lambda: viscera.stiffness(body, mesh.nodes), "sparse"),
):
    try:
        call()
    except ImportError as error:
        assert f"pip install viscera[{extra}]" in str(error), error
    else:
        raise AssertionError(f"viscera[{extra}] is not installed, and was found")
