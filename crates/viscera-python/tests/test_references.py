"""The reference cases through Python: numbers of other programs and closed forms, at least one for each topic."""

import numpy as np
import pytest

import viscera


def relative(found, wanted):
    found, wanted = np.asarray(found, dtype=float), np.asarray(wanted, dtype=float)
    return np.abs(found - wanted).max() / np.abs(wanted).max()


def stvk(material):
    return viscera.StVenantKirchhoff(viscera.Lame(material["lambda_Pa"], material["mu_Pa"]))


def test_a_patch_of_tetrahedra_has_the_closed_form_stress_and_energy(reference, reference_mesh):
    """A03: one finite deformation gradient everywhere; every cell has its strain and stresses, and the body its energy."""
    case = reference("A03_patch_stvk_tet4")
    mesh = reference_mesh("A03_patch_stvk_tet4.msh")
    world = viscera.World(gravity=[0, 0, 0])
    body = world.add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(stvk(case["material"]))))
    strain = np.array(case["reference"]["E_green"])
    # Any F with that Green strain will do for E and S: the symmetric root of 2E + 1.
    values, vectors = np.linalg.eigh(2 * strain + np.eye(3))
    body.positions = mesh.nodes @ (vectors @ np.diag(np.sqrt(values)) @ vectors.T)
    assert relative(body.green_strain()[7], strain) < 1e-10
    assert relative(body.second_piola_stress()[7], case["reference"]["S_PK2_Pa"]) < 1e-10
    energy = body.energy_at(body.positions)
    density = np.einsum("ij,ij", strain, np.array(case["reference"]["S_PK2_Pa"])) / 2
    assert relative(energy, density * mesh.volume) < 1e-10


def test_single_elements_have_the_forces_and_stiffness_of_the_complex_step(reference):
    """A07: a distorted tetrahedron and a distorted hexahedron, energy, forces and tangent."""
    case = reference("A07_single_elements")
    for name, kind, corners in (("tet4", viscera.TetMesh, 4), ("hex8", viscera.HexMesh, 8)):
        element = case["reference"][name]
        mesh = kind(element["X_m"], [list(range(corners))])
        x = np.array(element["X_m"]) + np.array(element["u_m"])
        wanted = element["stvk" if name == "tet4" else "stvk_gauss2"]
        model = viscera.ForceModel(mesh, viscera.TotalLagrangian(stvk(case["material"])))
        assert relative(model.energy(x), wanted["energy_J"]) < 1e-10
        assert relative(model.forces(x), np.reshape(wanted["internal_force_N"], (-1, 3))) < 1e-10
        assert relative(viscera.stiffness(model, x).toarray(), wanted["tangent_stiffness_N_per_m"]) < 1e-10


@pytest.mark.parametrize(
    ("name", "mesh", "model"),
    [
        ("B01_beam_s_tet_nu03_g05", "beam_s_tet4.msh", "total-lagrangian"),
        ("B01_beam_s_tet_nu03_g05", "beam_s_tet4.msh", "tensor-mass"),
        ("B03_beam_s_hex_nu03_g05", "beam_s_hex8.msh", "total-lagrangian"),
        ("B07_beam_s_tet_corot_g05", "beam_s_tet4.msh", "corotational"),
    ],
)
def test_beams_hang_where_scikit_fem_and_calculix_have_them(reference, reference_mesh, name, mesh, model):
    """B: large static deflection, to the digits of the reference."""
    case = reference(name)
    mesh = reference_mesh(mesh)
    law = viscera.LinearElastic if model == "corotational" else viscera.StVenantKirchhoff
    law = law(viscera.Lame(case["material"]["lambda_Pa"], case["material"]["mu_Pa"]))
    recipe = {
        "total-lagrangian": viscera.TotalLagrangian,
        "tensor-mass": viscera.TensorMass,
        "corotational": lambda law: viscera.Corotational(law, tangent="exact"),
    }[model](law)
    world = viscera.World(gravity=[0, -0.5, 0])
    beam = world.add(viscera.Body(mesh, 1000.0, model=recipe, fix=viscera.Region.plane([0, 0, 0], [0, 0, 1])))
    beam.settle(solver="direct")
    tip = case["reference"]["tip_centre_node_0based"]
    moved = beam.positions[tip] - mesh.nodes[tip]
    assert relative(moved, case["reference"]["tip_centre_displacement_m"]) < 1e-7
    assert np.allclose(beam.observe().reaction, [0, 2.0, 0], atol=1e-8 * 2.0)


def test_a_thin_beam_of_hexahedra_bends_as_in_the_reference(reference):
    """C01: 40 x 4 x 2 cells, linear statics, ν = 0.3."""
    case = reference("C01_nesme_beam_40x4x2")["reference"]["per_nu"][1]
    material = reference("C01_nesme_beam_40x4x2")["material"]
    mesh = viscera.HexMesh.box_grid([40, 4, 2], [40.0, 4.0, 2.0])
    law = viscera.LinearElastic.from_young_poisson(material["E_Pa"], case["nu"])
    world = viscera.World(gravity=[0, 0, -0.001])
    body = viscera.Body(mesh, material["density_kg_m3"], model=viscera.TotalLagrangian(law), fix="x-min")
    beam = world.add(body)
    beam.settle(small_strain=True)
    centre = mesh.nodes_in(viscera.Region.nearest([40.0, 2.0, 1.0]))[0]
    sag = beam.positions[centre, 2] - mesh.nodes[centre, 2]
    assert relative(sag, case["hex8"]["centreline_uz_m"][-1]) < 1e-7


def test_a_glued_cube_locks_as_much_as_the_reference_says(reference):
    """D01: 8³ hexahedra, ν = 0.499, the force of the plate at 5 %."""
    case = reference("D01_truth_cube")
    wanted = next(
        row for row in case["locking_on_8x8x8"] if (row["element"], row["model"], row["strain"]) == ("hex8", "linear", 0.05)
    )
    law = viscera.LinearElastic.from_young_poisson(case["material"]["E_Pa"], case["material"]["nu"])
    mesh = viscera.HexMesh.box_grid([8, 8, 8], [0.08, 0.08, 0.08])
    world = viscera.World(gravity=[0, 0, 0])
    pressed = ("z-max", [0.0, 0.0, -0.05 * 0.08])
    body = viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(law), fix="z-min", prescribe=pressed)
    cube = world.add(body)
    cube.settle(small_strain=True)
    plate = mesh.nodes_in("z-max")
    assert relative(cube.internal_forces[plate].sum(axis=0)[2], wanted["plate_force_z_N"]) < 1e-6


def test_the_beam_swings_at_the_frequencies_of_its_stiffness(reference, reference_mesh):
    """E01: the lowest frequencies from the stiffness that Python assembles, and the masses that the world has lumped."""
    from scipy.sparse import diags
    from scipy.sparse.linalg import eigsh

    case = reference("E01_modes_beam_s")
    mesh = reference_mesh("beam_s_tet4.msh")
    law = viscera.LinearElastic.from_young_poisson(case["material"]["E_Pa"], case["material"]["nu"])
    world = viscera.World(gravity=[0, 0, 0])
    beam = world.add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(law), fix=viscera.Region.plane([0, 0, 0], [0, 0, 1])))
    free = np.repeat(np.array(beam.motions) == "free", 3)
    matrix = viscera.stiffness(beam, mesh.nodes)[free][:, free]
    masses = diags(np.repeat(beam.masses, 3)[free])
    squares = eigsh(matrix.tocsc(), k=6, M=masses.tocsc(), sigma=0, return_eigenvectors=False)
    found = np.sqrt(np.sort(squares)) / (2 * np.pi)
    assert relative(found, case["reference"]["tet4_lumped"]["first_12_frequencies_Hz"][:6]) < 1e-7


def test_a_flying_beam_keeps_its_momenta(reference, reference_mesh):
    """E02: turning freely, 0.05 s on: centre of mass and momenta are exact."""
    case = reference("E02_free_flight")
    start, wanted = case["initial"], case["reference"][0]
    mesh = reference_mesh("beam_s_tet4.msh")
    law = viscera.StVenantKirchhoff.from_young_poisson(case["material"]["E_Pa"], case["material"]["nu"])
    world = viscera.World(gravity=[0, 0, 0], step=1e-3)
    beam = world.add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(law)))
    beam.velocities = np.array(start["v0_m_s"]) + np.cross(start["omega_rad_s"], mesh.nodes - np.array(start["c_m"]))
    world.steps(50)
    seen = beam.observe()
    assert relative(seen.momentum, wanted["exact_linear_momentum"]) < 1e-10
    assert relative(seen.angular_momentum, wanted["exact_angular_momentum_about_origin"]) < 1e-9
    centre = beam.masses @ beam.positions / beam.masses.sum()
    assert relative(centre, wanted["exact_centre_of_mass_m"]) < 1e-10


def test_a_cylinder_bends_and_keeps_its_volume_as_in_the_reference(reference, reference_mesh):
    """F01: a lateral force on the central top vertex."""
    case = reference("F01_cylinder_bending")
    mesh, wanted = reference_mesh("F01_cylinder_bending.msh"), case["reference"][0]
    node = case["loads"]["node_0based"]
    force = viscera.Load.force(viscera.Region.nodes([node]), [wanted["force_x_N"], 0.0, 0.0])
    world = viscera.World(gravity=[0, 0, 0])
    law = stvk(case["material"])
    hold = viscera.Region.plane([0, 0, 0], [0, 0, 1])
    body = world.add(viscera.Body(mesh, 1000.0, model=viscera.TensorMass(law), fix=hold, load=force))
    body.settle()
    moved = body.positions[node] - mesh.nodes[node]
    assert relative(moved, wanted["stvk"]["tip_displacement_m"]) < 1e-7
    assert abs(body.observe().volume_variation - wanted["stvk"]["volume_variation"]) < 1e-6


def test_laws_have_the_stresses_of_the_closed_forms(reference):
    """G05: neo-Hookean, isochoric: P at the stretches of the reference."""
    case = reference("G05_compressible_single_element")
    law = viscera.NeoHookean(viscera.Lame(case["material"]["lambda_Pa"], case["material"]["mu_Pa"]))
    rows = [row for row in case["reference"] if row["law"] == "neo_hookean_isochoric" and row["mode"] == "confined"]
    assert rows
    for row in rows:
        gradient = np.diag([row["value"], 1.0, 1.0])
        assert relative(law.stress(gradient)[0], row["P_Pa"]) < 1e-8


def test_a_sphere_is_pressed_into_a_block_with_the_force_of_the_exact_active_set(reference, reference_mesh):
    """H02: the compliance of the upper face from one answer for each of its nodes; nodes that pull are let go, those inside are taken hold of."""
    case = reference("H02_block_indentation")
    mesh, contact = reference_mesh("H02_block_indentation.msh"), case["contact"]
    law = viscera.LinearElastic.from_young_poisson(case["material"]["E_Pa"], case["material"]["nu"])
    world = viscera.World(gravity=[0, 0, 0])
    hold = viscera.Region.plane([0, 0, 0], [0, 0, 1])
    block = world.add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(law), fix=hold))
    nodes = np.array(case["reference"]["top_node_ids_0based"])
    forces = np.zeros((len(nodes), len(mesh.nodes), 3))
    forces[np.arange(len(nodes)), nodes, 2] = 1.0
    compliance = block.respond(forces)[:, nodes, 2].T
    assert relative(compliance, compliance.T) < 1e-10
    away = np.linalg.norm(mesh.nodes[nodes, :2] - contact["axis_xy_m"], axis=1)
    radius = contact["sphere_radius_m"]
    sphere = radius - np.sqrt(radius**2 - away**2)
    for row in case["reference"]["table"]:
        gap, active = sphere - row["depth_m"], np.zeros(len(nodes), dtype=bool)
        active[gap < 0] = True
        for _ in range(50):
            pressure = np.zeros(len(nodes))
            pressure[active] = np.linalg.solve(compliance[np.ix_(active, active)], gap[active])
            inside = compliance @ pressure > gap + 1e-12 * row["depth_m"]
            follows = (active & (pressure < 0)) | (~active & inside)
            if np.array_equal(follows, active):
                break
            active = follows
        assert nodes[active].tolist() == sorted(row["active_node_ids_0based"])
        assert relative(-pressure.sum(), row["force_N"]) < 1e-6
        assert relative(-pressure[active], row["nodal_normal_force_N"]) < 1e-6
