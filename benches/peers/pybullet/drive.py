"""The beam in PyBullet, as a deformable body."""

from protocol import serve, stable_neo_hookean

import os
import tempfile

import numpy as np
import pybullet as bullet

# There is no damping by mass. This of the tissue [s] brings the beam to rest in a few seconds; ten times as much, which
# also resists rotation, holds it up for minutes.
VISCOSITY = 0.02

ABOUT = {
    "name": "pybullet",
    "version": "3.2.7",
    "variants": [
        {
            "name": "deformable",
            "law": "stable neo-Hookean",
            "scheme": "explicit",
            "precision": "f64",
            "reference": "stable-neo-hookean",
            "note": "nodes of equal mass; brought to rest by its viscosity",
        }
    ],
}


def vtk(mesh):
    """The mesh as a legacy VTK file."""
    lines = ["# vtk DataFile Version 2.0", "beam", "ASCII", "DATASET UNSTRUCTURED_GRID"]
    lines.append(f"POINTS {len(mesh.nodes)} double")
    lines += (f"{x} {y} {z}" for x, y, z in mesh.nodes)
    lines.append(f"CELLS {len(mesh.cells)} {5 * len(mesh.cells)}")
    lines += (f"4 {a} {b} {c} {d}" for a, b, c, d in mesh.cells)
    lines.append(f"CELL_TYPES {len(mesh.cells)}")
    lines += ["10"] * len(mesh.cells)
    return "\n".join(lines) + "\n"


class Beam:
    def __init__(self, case, mesh, setup):
        if bullet.isConnected():
            bullet.disconnect()
        bullet.connect(bullet.DIRECT)
        bullet.resetSimulation(bullet.RESET_USE_DEFORMABLE_WORLD)
        bullet.setPhysicsEngineParameter(fixedTimeStep=setup.step, numSubSteps=0)
        bullet.setGravity(*setup.gravity)
        lam, mu = stable_neo_hookean(case)
        mass = case["tissue"]["density"] * np.prod(case["beam"]["size"])
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "beam.vtk")
            with open(path, "w") as file:
                file.write(vtk(mesh))
            self.body = bullet.loadSoftBody(
                path,
                mass=mass,
                useNeoHookean=1,
                NeoHookeanMu=mu,
                NeoHookeanLambda=lam,
                NeoHookeanDamping=VISCOSITY if setup.damping else 0.0,
                collisionMargin=1e-4,
            )
        bullet.changeDynamics(self.body, -1, activationState=bullet.ACTIVATION_STATE_DISABLE_SLEEPING)
        for node in mesh.held():
            bullet.createSoftBodyAnchor(self.body, int(node), -1, -1)

    def advance(self, steps):
        for _ in range(steps):
            bullet.stepSimulation()

    def positions(self):
        count, positions = bullet.getMeshData(self.body, -1, flags=bullet.MESH_DATA_SIMULATION_MESH)
        return np.array(positions)

    def place(self, positions):
        bullet.resetMeshData(self.body, positions.tolist())


serve(ABOUT, Beam)
