//! What is stored on vertices, edges, triangles and tetrahedra, and the force that each adds to its nodes.
//!
//! Stored per vertex / edge / face / tetrahedron: tensors 1/1/0/0, vectors 1/4/3/0, scalars 1/5/9/6. The tables sum the
//! tensors of all tetrahedra that touch the entity. Forces are those of the table of RR-4028 with its misprints
//! corrected; common inner products are taken out of it.
//!
//! Source: Picinbono, Delingette, Ayache, INRIA RR-4028 (2000), table 1 and appendix B, corrected.

use super::tensors::TetTensors;
use crate::math::{Mat3, Real, Vec3};

/// The most numbers stored for an entity: those of an edge.
pub(crate) const MAX_COLUMNS: usize = 26;

/// A node's displacement and its weight of the non-linear part: 1, or 0 where an adaptive model is linear.
#[derive(Clone, Copy)]
pub(crate) struct Corner<R> {
    pub(crate) u: Vec3<R>,
    pub(crate) weight: R,
}

/// One kind of entity, with `NODES` corners.
pub(crate) trait Entity<const NODES: usize>: Send + Sync {
    /// Numbers stored for one.
    const COLUMNS: usize;
    /// What the tetrahedron adds (the first [`Entity::COLUMNS`] numbers), where the entity's corners are its local corners `at`.
    fn stored(tensors: &TetTensors, at: [usize; NODES]) -> [f64; MAX_COLUMNS];
    /// Linear part of the forces, if the entity has one.
    #[inline(always)]
    fn linear<R: Real>(_c: &[R], _corners: &[Corner<R>; NODES]) -> Option<[Vec3<R>; NODES]> {
        None
    }
    /// Non-linear part of the forces, not yet weighted, if the entity has one.
    #[inline(always)]
    fn nonlinear<R: Real>(_c: &[R], _corners: &[Corner<R>; NODES]) -> Option<[Vec3<R>; NODES]> {
        None
    }
}

#[inline(always)]
fn vector<R: Real>(c: &[R], first: usize) -> Vec3<R> {
    Vec3::new(c[first], c[first + 1], c[first + 2])
}

#[inline(always)]
fn tensor<R: Real>(c: &[R], first: usize) -> Mat3<R> {
    Mat3::from_columns(vector(c, first), vector(c, first + 3), vector(c, first + 6))
}

/// The numbers of an entity in the order in which they are stored, zeros behind them. The compiler knows how many there are of each: over
/// slices of any length a removal took twice as long.
#[inline(always)]
fn numbers<const TENSORS: usize, const VECTORS: usize, const SCALARS: usize>(
    tensors: [Mat3<f64>; TENSORS],
    vectors: [Vec3<f64>; VECTORS],
    scalars: [f64; SCALARS],
) -> [f64; MAX_COLUMNS] {
    let mut numbers = [0.0; MAX_COLUMNS];
    let mut put = |first: usize, vector: Vec3<f64>| numbers[first..first + 3].copy_from_slice(&vector.to_array());
    for (i, tensor) in tensors.into_iter().enumerate() {
        for (j, column) in tensor.columns.into_iter().enumerate() {
            put(9 * i + 3 * j, column);
        }
    }
    for (i, vector) in vectors.into_iter().enumerate() {
        put(9 * TENSORS + 3 * i, vector);
    }
    for (i, scalar) in scalars.into_iter().enumerate() {
        numbers[9 * TENSORS + 3 * VECTORS + i] = scalar;
    }
    numbers
}

/// B_pp, C_ppp, D_pppp.
#[derive(Debug)]
pub(crate) struct Vertex;

impl Entity<1> for Vertex {
    const COLUMNS: usize = 13;

    #[inline(always)]
    fn stored(t: &TetTensors, [p]: [usize; 1]) -> [f64; MAX_COLUMNS] {
        numbers([t.b(p, p)], [t.c(p, p, p)], [t.d(p, p, p, p)])
    }

    #[inline(always)]
    fn linear<R: Real>(c: &[R], [p]: &[Corner<R>; 1]) -> Option<[Vec3<R>; 1]> {
        let force = tensor(c, 0) * p.u;
        Some([force + force])
    }

    // [2 u uᵀ + (u·u) I] C_ppp + 4 D_pppp (u·u) u
    #[inline(always)]
    fn nonlinear<R: Real>(c: &[R], [p]: &[Corner<R>; 1]) -> Option<[Vec3<R>; 1]> {
        let (u, c_ppp, d_pppp) = (p.u, vector(c, 9), c[12]);
        let uu = u.squared_norm();
        let along_u = u.dot(c_ppp).double() + d_pppp * u.x.like(4.0) * uu;
        Some([c_ppp.mul_add(uu, u * along_u)])
    }
}

/// B_pp alone: what a linear model stores on a vertex.
#[derive(Debug)]
pub(crate) struct LinearVertex;

impl Entity<1> for LinearVertex {
    const COLUMNS: usize = 9;

    #[inline(always)]
    fn stored(t: &TetTensors, [p]: [usize; 1]) -> [f64; MAX_COLUMNS] {
        numbers([t.b(p, p)], [], [])
    }

    #[inline(always)]
    fn linear<R: Real>(c: &[R], corners: &[Corner<R>; 1]) -> Option<[Vec3<R>; 1]> {
        Vertex::linear(c, corners)
    }
}

/// B_pj alone: what a linear model stores on an edge.
#[derive(Debug)]
pub(crate) struct LinearEdge;

impl Entity<2> for LinearEdge {
    const COLUMNS: usize = 9;

    #[inline(always)]
    fn stored(t: &TetTensors, [p, j]: [usize; 2]) -> [f64; MAX_COLUMNS] {
        numbers([t.b(p, j)], [], [])
    }

    #[inline(always)]
    fn linear<R: Real>(c: &[R], corners: &[Corner<R>; 2]) -> Option<[Vec3<R>; 2]> {
        Edge::linear(c, corners)
    }
}

/// With the edge from p to j: B_pj; C_ppj, C_jjp, C_jpp, C_pjj; D_jppp, D_jjjp, D_jjpp, D_jpjp, D_pjjp.
#[derive(Debug)]
pub(crate) struct Edge;

impl Entity<2> for Edge {
    const COLUMNS: usize = 26;

    #[inline(always)]
    fn stored(t: &TetTensors, [p, j]: [usize; 2]) -> [f64; MAX_COLUMNS] {
        numbers(
            [t.b(p, j)],
            [t.c(p, p, j), t.c(j, j, p), t.c(j, p, p), t.c(p, j, j)],
            [t.d(j, p, p, p), t.d(j, j, j, p), t.d(j, j, p, p), t.d(j, p, j, p), t.d(p, j, j, p)],
        )
    }

    // 2 B_pj u_j on p; B_jp = B_pjᵀ on j
    #[inline(always)]
    fn linear<R: Real>(c: &[R], [p, j]: &[Corner<R>; 2]) -> Option<[Vec3<R>; 2]> {
        let b = tensor(c, 0);
        let (on_p, on_j) = (b * j.u, b.transpose_mul(p.u));
        Some([on_p + on_p, on_j + on_j])
    }

    // On p:  2 [u_j u_pᵀ + (u_j·u_p) I] C_ppj + 2 u_p u_jᵀ C_jpp + 2 u_j u_jᵀ C_jjp + (u_j·u_j) C_pjj
    //        + 4 { D_jppp [2 (u_p·u_j) u_p + (u_p·u_p) u_j] + D_jjpp (u_j·u_j) u_p + (D_jpjp + D_pjjp)(u_j·u_p) u_j
    //              + D_jjjp (u_j·u_j) u_j };  on j the same with p and j exchanged.
    #[inline(always)]
    fn nonlinear<R: Real>(c: &[R], [p, j]: &[Corner<R>; 2]) -> Option<[Vec3<R>; 2]> {
        let (up, uj) = (p.u, j.u);
        let (c_ppj, c_jjp, c_jpp, c_pjj) = (vector(c, 9), vector(c, 12), vector(c, 15), vector(c, 18));
        let (d_jppp, d_jjjp, d_jjpp, mixed) = (c[21], c[22], c[23], c[24] + c[25]);
        let (pp, pj, jj) = (up.squared_norm(), up.dot(uj), uj.squared_norm());
        let four = pp.like(4.0);
        let on_p_along_p = uj.dot(c_jpp).double() + four * (d_jppp.double() * pj + d_jjpp * jj);
        let on_j_along_j = up.dot(c_pjj).double() + four * (d_jjjp.double() * pj + d_jjpp * pp);
        // The part along the other corner is the same number on both sides.
        let crossed = (up.dot(c_ppj) + uj.dot(c_jjp)).double() + four * (d_jppp * pp + mixed * pj + d_jjjp * jj);
        let twice_pj = pj.double();
        Some([
            c_ppj.mul_add(twice_pj, c_pjj.mul_add(jj, up.mul_add(on_p_along_p, uj * crossed))),
            c_jjp.mul_add(twice_pj, c_jpp.mul_add(pp, uj.mul_add(on_j_along_j, up * crossed))),
        ])
    }
}

/// With the corners a, b, c: C_abc, C_bca, C_cab; then for each corner p with the others j, k: D_jkpp, D_jpkp, D_pjkp.
#[derive(Debug)]
pub(crate) struct Triangle;

impl Entity<3> for Triangle {
    const COLUMNS: usize = 18;

    #[inline(always)]
    fn stored(t: &TetTensors, [a, b, c]: [usize; 3]) -> [f64; MAX_COLUMNS] {
        let doubled = |p: usize, j: usize, k: usize| [t.d(j, k, p, p), t.d(j, p, k, p), t.d(p, j, k, p)];
        let ([a0, a1, a2], [b0, b1, b2], [c0, c1, c2]) = (doubled(a, b, c), doubled(b, c, a), doubled(c, a, b));
        let scalars = [a0, a1, a2, b0, b1, b2, c0, c1, c2];
        numbers([], [t.c(a, b, c), t.c(b, c, a), t.c(c, a, b)], scalars)
    }

    // On p:  2 [u_k u_jᵀ C_jkp + u_j u_kᵀ C_kjp + (u_j·u_k) C_pjk]
    //        + 4 { (D_pjkp + D_jpkp)[(u_k·u_p) u_j + (u_j·u_p) u_k] + 2 D_jkpp (u_j·u_k) u_p
    //              + (D_kjjp + D_jkjp)(u_j·u_k) u_j + D_jjkp (u_j·u_j) u_k
    //              + (D_jkkp + D_kjkp)(u_j·u_k) u_k + D_kkjp (u_k·u_k) u_j }
    // By the symmetries of D, each doubled corner p comes with two numbers: D_jkpp and D_pjkp + D_jpkp.
    #[inline(always)]
    fn nonlinear<R: Real>(c: &[R], corners: &[Corner<R>; 3]) -> Option<[Vec3<R>; 3]> {
        let u = [corners[0].u, corners[1].u, corners[2].u];
        let vectors = [vector(c, 0), vector(c, 3), vector(c, 6)];
        let apart = [c[9], c[12], c[15]];
        let mixed = [c[10] + c[11], c[13] + c[14], c[16] + c[17]];
        let own = [u[0].squared_norm(), u[1].squared_norm(), u[2].squared_norm()];
        // across[p] = u_j·u_k, the product of the two others
        let across = [u[1].dot(u[2]), u[2].dot(u[0]), u[0].dot(u[1])];
        let along = [u[0].dot(vectors[0]), u[1].dot(vectors[1]), u[2].dot(vectors[2])];
        let (two, four) = (own[0].like(2.0), own[0].like(4.0));
        let mut forces = u;
        for p in 0..3 {
            let (j, k) = ((p + 1) % 3, (p + 2) % 3);
            let on_j = along[k].double() + four * (mixed[p] * across[j] + mixed[j] * across[p] + apart[k] * own[k]);
            let on_k = along[j].double() + four * (mixed[p] * across[k] + mixed[k] * across[p] + apart[j] * own[j]);
            let on_p = four.double() * apart[p] * across[p];
            forces[p] = vectors[p].mul_add(two * across[p], u[j].mul_add(on_j, u[k].mul_add(on_k, u[p] * on_p)));
        }
        Some(forces)
    }
}

/// The six D with four different indices: D_jklm for m = 3 and jkl = 012, 021, 102, 120, 201, 210.
#[derive(Debug)]
pub(crate) struct Tetrahedron;

impl Entity<4> for Tetrahedron {
    const COLUMNS: usize = 6;

    #[inline(always)]
    fn stored(t: &TetTensors, [a, b, c, d]: [usize; 4]) -> [f64; MAX_COLUMNS] {
        let permutations = [(a, b, c), (a, c, b), (b, a, c), (b, c, a), (c, a, b), (c, b, a)];
        numbers([], [], permutations.map(|(j, k, l)| t.d(j, k, l, d)))
    }

    // On p:  4 { (D_jklp + D_kjlp)(u_j·u_k) u_l + (D_jlkp + D_ljkp)(u_j·u_l) u_k + (D_kljp + D_lkjp)(u_k·u_l) u_j }
    // D_jklp + D_kjlp depends only on the pairing {j,k | l,p}: three numbers for the whole tetrahedron.
    #[inline(always)]
    fn nonlinear<R: Real>(c: &[R], corners: &[Corner<R>; 4]) -> Option<[Vec3<R>; 4]> {
        let u = [corners[0].u, corners[1].u, corners[2].u, corners[3].u];
        let four = c[0].like(4.0);
        let pair_01_23 = four * (c[0] + c[2]);
        let pair_02_13 = four * (c[1] + c[4]);
        let pair_12_03 = four * (c[3] + c[5]);
        let (s01, s23) = (pair_01_23 * u[0].dot(u[1]), pair_01_23 * u[2].dot(u[3]));
        let (s02, s13) = (pair_02_13 * u[0].dot(u[2]), pair_02_13 * u[1].dot(u[3]));
        let (s12, s03) = (pair_12_03 * u[1].dot(u[2]), pair_12_03 * u[0].dot(u[3]));
        Some([
            u[1].mul_add(s23, u[2].mul_add(s13, u[3] * s12)),
            u[0].mul_add(s23, u[2].mul_add(s03, u[3] * s02)),
            u[0].mul_add(s13, u[1].mul_add(s03, u[3] * s01)),
            u[0].mul_add(s12, u[1].mul_add(s02, u[2] * s01)),
        ])
    }
}
