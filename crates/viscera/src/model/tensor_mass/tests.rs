//! The tables themselves: against the reference, and after removals against tables assembled afresh.

use std::collections::HashMap;

use serde_json::Value;

use super::entity::{Edge, Entity, Tetrahedron, Triangle, Vertex};
use super::entity_loop::EntityLoop;
use super::shape::RestShape;
use super::tensors::TetTensors;
use crate::material::{Lame, LawFamily, StVenantKirchhoff, Tissue, TransverseStVenantKirchhoff};
use crate::math::{Mat3, Vec3};
use crate::mesh::{TetMesh, TetTopology};
use crate::model::Scratch;
use crate::model::sections::SectionScratch;
use crate::model::tet_loop::RestTet;

const TABLES: &str = include_str!("../../../tests/data/references/A08_tensor_mass_tables.json");

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn vector(value: &Value) -> Vec3<f64> {
    Vec3::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

fn vectors(value: &Value) -> Vec<Vec3<f64>> {
    value.as_array().unwrap().iter().map(vector).collect()
}

/// The tetrahedron of case A08, its tensors without and with fibres, and what the reference says about each.
fn case(data: &Value) -> (TetMesh, [(TetTensors, &Value); 2]) {
    let material = &data["material"];
    let lame = |lambda: &str, mu: &str| Lame::new(number(&material[lambda]), number(&material[mu])).unwrap();
    let (across, along) = (lame("lambda_Pa", "mu_Pa"), lame("lambdaL_Pa", "muL_Pa"));
    let fibred = TransverseStVenantKirchhoff::new(across, vector(&material["a0"]).to_array(), along).unwrap();
    let mesh = TetMesh::new(vectors(&data["tet"]["X_m"]), vec![[0, 1, 2, 3]]);
    let rest = RestTet::new(&mesh, 0).unwrap();
    let tensors = [StVenantKirchhoff::new(across).at_rest(), fibred.at_rest()].map(|s| TetTensors::new(&rest, &s));
    let reference = &data["reference"];
    let [isotropic, transverse] = tensors;
    (mesh, [(isotropic, &reference["isotropic"]), (transverse, &reference["transversely_isotropic"])])
}

/// Fails unless all entries agree to 1e-10 of the largest, the tolerance that the case states.
fn assert_entries(pairs: &[(f64, f64)], what: &str) {
    let scale = pairs.iter().map(|(_, expected)| expected.abs()).fold(0.0, f64::max);
    for (index, (actual, expected)) in pairs.iter().enumerate() {
        assert!((actual - expected).abs() <= 1e-10 * scale, "{what}, entry {index}: {actual} instead of {expected}");
    }
}

#[test]
fn gradients_and_volume_match_the_reference() {
    let data: Value = serde_json::from_str(TABLES).unwrap();
    let (mesh, _) = case(&data);
    let rest = RestTet::new(&mesh, 0).unwrap();
    assert_entries(&[(rest.volume, number(&data["tet"]["rest_volume_m3"]))], "volume");
    let expected = vectors(&data["tet"]["alpha_j"]);
    let pairs = rest.gradients().into_iter().zip(expected);
    let pairs: Vec<_> = pairs.flat_map(|(a, e)| (0..3).map(move |i| (a[i], e[i]))).collect();
    assert_entries(&pairs, "gradients");
}

#[test]
fn tables_b_c_d_match_the_reference() {
    let data: Value = serde_json::from_str(TABLES).unwrap();
    let (_, cases) = case(&data);
    for (tensors, expected) in &cases {
        let (mut b, mut c, mut d) = (Vec::new(), Vec::new(), Vec::new());
        for j in 0..4 {
            for k in 0..4 {
                for (row, column) in (0..9).map(|i| (i / 3, i % 3)) {
                    let value = number(&expected["B_jk"][j][k][row][column]);
                    b.push((tensors.b(j, k).columns[column][row], value));
                }
                for l in 0..4 {
                    c.extend((0..3).map(|i| (tensors.c(j, k, l)[i], number(&expected["C_jkl"][j][k][l][i]))));
                    d.extend((0..4).map(|m| (tensors.d(j, k, l, m), number(&expected["D_jklm"][j][k][l][m]))));
                }
            }
        }
        assert_eq!((b.len(), c.len(), d.len()), (144, 192, 256));
        assert_entries(&b, "B");
        assert_entries(&c, "C");
        assert_entries(&d, "D");
    }
}

/// Scaling u by s scales the parts of degree 2, 3, 4 by s², s³, s⁴, so three scales tell them apart.
#[test]
fn energy_and_forces_split_by_degree_as_in_the_reference() {
    let data: Value = serde_json::from_str(TABLES).unwrap();
    let (mesh, cases) = case(&data);
    let u = vectors(&data["tet"]["U_m"]);
    for (index, (_, expected)) in cases.iter().enumerate() {
        let material = &data["material"];
        let lame = |lambda: &str, mu: &str| Lame::new(number(&material[lambda]), number(&material[mu])).unwrap();
        let (across, along) = (lame("lambda_Pa", "mu_Pa"), lame("lambdaL_Pa", "muL_Pa"));
        let tissue = if index == 0 {
            Tissue::uniform(StVenantKirchhoff::new(across))
        } else {
            let a0 = vector(&material["a0"]).to_array();
            Tissue::uniform(TransverseStVenantKirchhoff::new(across, a0, along).unwrap())
        };
        let tables = Tables::new(&mesh, &tissue);
        let energy = |s: f64| tables.energy(&u, s);
        // e(s) = q s² + c s³ + r s⁴ at s = 1, −1, 2
        let (one, minus, two) = (energy(1.0), energy(-1.0), energy(2.0));
        let cubic = 0.5 * (one - minus);
        let even = 0.5 * (one + minus);
        let quartic = (two - 8.0 * cubic - 4.0 * even) / 12.0;
        let split = &expected["energy_split_J"];
        let pairs = [(even - quartic, "quadratic"), (cubic, "cubic"), (quartic, "quartic")]
            .map(|(e, key)| (e, number(&split[key])));
        assert_entries(&pairs, "energy by degree");

        let forces = |s: f64| tables.forces(&u, s);
        let (one, minus, two) = (forces(1.0), forces(-1.0), forces(2.0));
        for p in 0..4 {
            // f(s) = a s + b s² + c s³
            let second = (one[p] + minus[p]) * 0.5;
            let odd = (one[p] - minus[p]) * 0.5;
            let third = (two[p] - second * 4.0 - odd * 2.0) / 6.0;
            for (actual, key) in [(odd - third, "F1_N"), (second, "F2_N"), (third, "F3_N")] {
                let scale = vectors(&expected[key]).iter().map(|f| f.norm()).fold(0.0, f64::max);
                let error = (actual - vector(&expected[key][p])).norm();
                assert!(error <= 1e-10 * scale, "{key} on vertex {p}: off by {error:e} of {scale:e}");
            }
        }
    }
}

/// All tables of a mesh and what is needed to name their rows.
struct Tables {
    shape: RestShape,
    topology: TetTopology,
    vertices: EntityLoop<f64, Vertex, 1>,
    edges: EntityLoop<f64, Edge, 2>,
    triangles: EntityLoop<f64, Triangle, 3>,
    tetrahedra: EntityLoop<f64, Tetrahedron, 4>,
}

impl Tables {
    fn new(mesh: &TetMesh, tissue: &Tissue) -> Self {
        let shape = RestShape::new(mesh, tissue).unwrap();
        Self {
            topology: TetTopology::new(mesh),
            vertices: shape.assemble_vertices(),
            edges: shape.assemble_edges(),
            triangles: shape.assemble_triangles(),
            tetrahedra: shape.assemble_tetrahedra(),
            shape,
        }
    }

    fn energy(&self, u: &[Vec3<f64>], scale: f64) -> f64 {
        let at = |node: u32| u[node as usize] * scale;
        self.vertices.energy(at) + self.edges.energy(at) + self.triangles.energy(at) + self.tetrahedra.energy(at)
    }

    fn forces(&self, u: &[Vec3<f64>], scale: f64) -> Vec<Vec3<f64>> {
        let Self { vertices, edges, triangles, tetrahedra, .. } = self;
        let most = [vertices.sum_rows(), edges.sum_rows(), triangles.sum_rows(), tetrahedra.sum_rows()];
        let mut scratch = Scratch::new(u.len());
        scratch.nodal = u.iter().map(|&u| [u.x * scale, u.y * scale, u.z * scale, 1.0]).collect();
        let SectionScratch { nodal, mut sums, .. } = scratch.sections(most.into_iter().fold(0, usize::max));
        vertices.add_forces::<false>(nodal, &mut sums);
        edges.add_forces::<false>(nodal, &mut sums);
        triangles.add_forces::<false>(nodal, &mut sums);
        tetrahedra.add_forces::<false>(nodal, &mut sums);
        scratch.forces.into_iter().map(|[x, y, z, _]| Vec3::new(x, y, z)).collect()
    }

    fn remove(&mut self, cell: usize) {
        let tensors = self.shape.tensors(cell);
        self.shape.cell_vertices(cell).into_iter().for_each(|(row, at)| self.vertices.subtract(row, &tensors, at));
        self.shape.cell_edges(cell).into_iter().for_each(|(row, at)| self.edges.subtract(row, &tensors, at));
        self.shape.cell_triangles(cell).into_iter().for_each(|(row, at)| self.triangles.subtract(row, &tensors, at));
        self.tetrahedra.subtract(cell, &tensors, [0, 1, 2, 3]);
    }

    /// Every entry by what it is: its letter and its indices as `name` calls the nodes, in an order that the tensor's
    /// symmetries leave. An entity without cells is left out, after a check that it holds exact zeros.
    fn entries(&self, name: impl Fn(u32) -> u32, used: impl Fn(&[u32]) -> bool) -> HashMap<(char, Vec<u32>), Vec<f64>> {
        let mut entries = HashMap::new();
        let mut take = |nodes: &[u32], row: Vec<f64>, names: Vec<(char, Vec<u32>, std::ops::Range<usize>)>| {
            if !used(nodes) {
                assert!(row.iter().all(|&value| value == 0.0), "{nodes:?} has no cell left and holds {row:?}");
                return;
            }
            for (letter, indices, range) in names {
                entries.insert((letter, indices), row[range].to_vec());
            }
        };
        for (row, _) in self.shape.mesh.nodes.iter().enumerate() {
            let p = name(row as u32);
            let names = vec![('B', vec![p, p], 0..9), ('C', vec![p; 3], 9..12), ('D', vec![p; 4], 12..13)];
            take(&[row as u32], self.vertices.row(row).collect(), names);
        }
        for (row, &[from, to]) in self.topology.edges.iter().enumerate() {
            let (p, j) = (name(from), name(to));
            let mut values: Vec<f64> = self.edges.row(row).collect();
            // B_jp = B_pjᵀ: told from the smaller name to the larger
            let b_ends = if p < j {
                vec![p, j]
            } else {
                let b = Mat3::from_columns(
                    Vec3::new(values[0], values[1], values[2]),
                    Vec3::new(values[3], values[4], values[5]),
                    Vec3::new(values[6], values[7], values[8]),
                );
                let transposed = b.transpose().columns.into_iter().flat_map(Vec3::to_array);
                values.iter_mut().zip(transposed).for_each(|(value, entry)| *value = entry);
                vec![j, p]
            };
            let (low, high) = (p.min(j), p.max(j));
            let names = vec![
                ('B', b_ends, 0..9),
                ('C', vec![p, p, j], 9..12),
                ('C', vec![j, j, p], 12..15),
                ('C', vec![j, p, p], 15..18),
                ('C', vec![p, j, j], 18..21),
                ('D', vec![j, p, p, p], 21..22),
                ('D', vec![p, j, j, j], 22..23),
                ('D', vec![low, low, high, high], 23..24),
                ('D', vec![low, high, low, high], 24..25),
                ('D', vec![low, high, high, low], 25..26),
            ];
            take(&[from, to], values, names);
        }
        for (row, face) in self.topology.faces.iter().enumerate() {
            let corners = face.nodes.map(&name);
            let names = (0..3).flat_map(|i| {
                let p = corners[i];
                let (mut j, mut k) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
                if j > k {
                    std::mem::swap(&mut j, &mut k);
                }
                [
                    ('C', vec![p, j, k], 3 * i..3 * i + 3),
                    ('D', vec![j, k, p, p], 9 + 3 * i..10 + 3 * i),
                    ('D', vec![j, p, k, p], 10 + 3 * i..11 + 3 * i),
                    ('D', vec![p, j, k, p], 11 + 3 * i..12 + 3 * i),
                ]
            });
            take(&face.nodes, self.triangles.row(row).collect(), names.collect());
        }
        for (row, cell) in self.shape.mesh.cells.iter().enumerate() {
            let [a, b, c, d] = cell.map(&name);
            let orders = [[a, b, c], [a, c, b], [b, a, c], [b, c, a], [c, a, b], [c, b, a]];
            let names = orders.into_iter().enumerate().map(|(i, [j, k, l])| ('D', vec![j, k, l, d], i..i + 1));
            take(cell, self.tetrahedra.row(row).collect(), names.collect());
        }
        entries
    }
}

/// The fresh mesh numbers its nodes backwards, so every one of its edges runs the other way.
#[test]
fn tables_after_thousands_of_removals_equal_tables_assembled_afresh() {
    let mesh = TetMesh::box_grid([7, 7, 7], [0.12, 0.1, 0.09]);
    let tissue = Tissue::uniform(TransverseStVenantKirchhoff::example());
    let mut tables = Tables::new(&mesh, &tissue);
    let (cells, last) = (mesh.cells.len(), mesh.nodes.len() as u32 - 1);
    // a stride without common factor visits every cell once, in no geometric order
    let order: Vec<usize> = (0..cells).map(|i| i * 1013 % cells).collect();
    for (done, keep) in [(0, 1000), (cells - 1000, 60), (cells - 60, 3)] {
        order[done..cells - keep].iter().for_each(|&cell| tables.remove(cell));
        let left: Vec<[u32; 4]> = order[cells - keep..].iter().map(|&cell| mesh.cells[cell]).collect();
        let nodes = mesh.nodes.iter().rev().copied().collect();
        let fresh_mesh = TetMesh::new(nodes, left.iter().map(|cell| cell.map(|node| last - node)).collect());
        let fresh = Tables::new(&fresh_mesh, &tissue);
        let used = |entity: &[u32]| left.iter().any(|cell| entity.iter().all(|node| cell.contains(node)));
        let kept = tables.entries(|node| node, used);
        let expected = fresh.entries(|node| last - node, |_| true);
        let mut largest = HashMap::new();
        for ((letter, indices), values) in &expected {
            let distinct = indices.iter().collect::<std::collections::BTreeSet<_>>().len();
            let slot = largest.entry((*letter, distinct)).or_insert(0.0_f64);
            *slot = values.iter().fold(*slot, |max, value| max.max(value.abs()));
        }
        for (key, values) in &kept {
            let distinct = key.1.iter().collect::<std::collections::BTreeSet<_>>().len();
            let scale = largest[&(key.0, distinct)];
            for (actual, expected) in values.iter().zip(&expected[key]) {
                assert!(
                    (actual - expected).abs() <= 1e-12 * scale,
                    "{key:?} with {keep} left: {actual}, not {expected}"
                );
            }
        }
        // nodes without cells hold nothing on either side
        let told = expected.values().filter(|values| values.iter().any(|&value| value != 0.0)).count();
        assert!(kept.len() >= told, "{} entities are named, {told} have entries", kept.len());
    }
}

/// The numbers that one tetrahedron adds, and that its removal subtracts: 280, and 6 of its own.
#[test]
fn a_tetrahedron_touches_280_numbers_beside_its_own_six() {
    let touched = 4 * Vertex::COLUMNS + 6 * Edge::COLUMNS + 4 * Triangle::COLUMNS;
    assert_eq!((touched, Tetrahedron::COLUMNS), (280, 6));
}
