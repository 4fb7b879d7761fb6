"""The beam in MuJoCo, as a flex of tetrahedra."""

from protocol import serve

import mujoco
import numpy as np

# Iterations of the solver of the discrete integrator in a step.
ITERATIONS = 25

VARIANTS = {
    "flex, Euler": ("Euler", "explicit"),
    "flex, discrete": ("discrete", f"implicit, {ITERATIONS} iterations of CG"),
}

ABOUT = {
    "name": "mujoco",
    "version": mujoco.__version__,
    "variants": [
        {
            "name": name,
            "law": "St Venant-Kirchhoff",
            "scheme": scheme,
            "precision": "f64",
            "reference": "st-venant-kirchhoff",
            "note": "",
        }
        for name, (_, scheme) in VARIANTS.items()
    ],
}


def numbers(array):
    return " ".join(map(repr, array.ravel().tolist()))


def text(case, mesh, setup):
    tissue = case["tissue"]
    return f"""
    <mujoco>
      <option timestep="{setup.step}" gravity="{numbers(np.array(setup.gravity))}" integrator="{VARIANTS[setup.variant][0]}"
              solver="CG" iterations="{ITERATIONS}" tolerance="0">
        <flag contact="disable" autoreset="disable"/>
      </option>
      <worldbody>
        <flexcomp name="beam" type="direct" dim="3" radius="1e-4" mass="1"
                  point="{numbers(mesh.nodes)}" element="{numbers(mesh.cells)}">
          <elasticity young="{tissue['young']}" poisson="{tissue['poisson']}" damping="0"/>
          <contact selfcollide="none"/>
          <pin id="{numbers(mesh.held())}"/>
        </flexcomp>
      </worldbody>
    </mujoco>"""


class Beam:
    def __init__(self, case, mesh, setup):
        self.model = mujoco.MjModel.from_xml_string(text(case, mesh, setup))
        self.nodes = mesh.nodes
        # A node that moves is a body with three slides, in the order of the nodes.
        self.free = np.setdiff1d(np.arange(len(mesh.nodes)), mesh.held())
        masses = mesh.masses(case["tissue"]["density"])
        self.model.body_mass[self.model.flex_vertbodyid[self.free]] = masses[self.free]
        self.data = mujoco.MjData(self.model)
        mujoco.mj_setConst(self.model, self.data)
        self.model.dof_damping[:] = setup.damping * np.repeat(masses[self.free], 3)
        mujoco.mj_forward(self.model, self.data)

    def advance(self, steps):
        mujoco.mj_step(self.model, self.data, steps)

    def positions(self):
        positions = self.nodes.copy()
        positions[self.free] += self.data.qpos.reshape(-1, 3)
        return positions

    def place(self, positions):
        self.data.qpos[:] = (positions - self.nodes)[self.free].ravel()
        self.data.qvel[:] = 0.0
        mujoco.mj_forward(self.model, self.data)


serve(ABOUT, Beam)
