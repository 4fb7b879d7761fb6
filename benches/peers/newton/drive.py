"""The beam in Newton, on NVIDIA Warp's CPU device."""

from protocol import serve, stable_neo_hookean

import newton
import numpy as np
import warp as wp

wp.config.quiet = True
wp.set_device("cpu")

# Sweeps over the elements or nodes in a step of the iterative solvers.
ITERATIONS = 25

VARIANTS = {
    "semi-implicit": ("explicit", lambda model: newton.solvers.SolverSemiImplicit(model, enable_tri_contact=False)),
    "VBD": (f"implicit, {ITERATIONS} sweeps", lambda model: newton.solvers.SolverVBD(model, iterations=ITERATIONS)),
    "XPBD": (f"implicit, {ITERATIONS} sweeps", lambda model: newton.solvers.SolverXPBD(model, iterations=ITERATIONS)),
}

ABOUT = {
    "name": "newton",
    "version": newton.__version__,
    "variants": [
        {
            "name": name,
            "law": "stable neo-Hookean",
            "scheme": scheme,
            "precision": "f32",
            "reference": "stable-neo-hookean",
            "note": "",
        }
        for name, (scheme, _) in VARIANTS.items()
    ],
}


class Beam:
    def __init__(self, case, mesh, setup):
        builder = newton.ModelBuilder()
        lam, mu = stable_neo_hookean(case)
        builder.add_soft_mesh(
            pos=wp.vec3(),
            rot=wp.quat_identity(),
            scale=1.0,
            vel=wp.vec3(),
            vertices=[wp.vec3(*node) for node in mesh.nodes],
            indices=mesh.cells.ravel().tolist(),
            density=case["tissue"]["density"],
            k_mu=mu,
            k_lambda=lam,
            k_damp=0.0,
            particle_radius=1e-4,
            add_surface_mesh_edges=False,
        )
        for node in mesh.held():
            builder.particle_mass[node] = 0.0
        if setup.variant == "VBD":
            builder.color()
        self.model = builder.finalize(device="cpu")
        # No contact between the nodes: their default radius is as large as the beam is wide.
        self.model.particle_grid, self.model.particle_max_radius = None, 0.0
        self.model.set_gravity(tuple(setup.gravity))
        self.solver = VARIANTS[setup.variant][1](self.model)
        self.now, self.next = self.model.state(), self.model.state()
        self.control = self.model.control()
        self.step, self.slowing = setup.step, np.exp(-setup.damping * setup.step)

    def advance(self, steps):
        for _ in range(steps):
            self.now.clear_forces()
            self.solver.step(self.now, self.next, self.control, None, self.step)
            self.now, self.next = self.next, self.now
            if self.slowing < 1.0:
                velocities = self.now.particle_qd.numpy()  # the array itself, on this device
                velocities *= self.slowing

    def positions(self):
        return self.now.particle_q.numpy().astype(float)

    def place(self, positions):
        for state in self.now, self.next:
            state.particle_q.assign(positions.astype(np.float32))
            state.particle_qd.zero_()


serve(ABOUT, Beam)
