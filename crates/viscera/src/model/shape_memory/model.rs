use super::ShapeMemory;
use super::memory::{Hold, Neighbours};
use super::neighbourhoods::Neighbourhoods;
use crate::executor::{Executor, NODE_BLOCK, NodeBlocks, node_blocks};
use crate::math::rotation::{polar, polar_along};
use crate::math::{Dual, Mat3, Real, Scalar, Sym3, Vec3};
use crate::model::{BlockSink, ForceModel, Scratch, Sums};

/// Rows in which a node's hold is kept while its neighbours read it, and as many for the derivative.
const ROWS: usize = 5;

/// A node's hold, and the centroid of its neighbours counted from the node [m].
#[derive(Clone, Copy)]
pub(super) struct Held<R> {
    pub(super) hold: Hold<R>,
    pub(super) centre: Vec3<R>,
}

impl<T: Scalar> Neighbourhoods<T> {
    /// What the node's neighbours make of it, `at` being the place of each from the node; none for one without neighbours.
    pub(super) fn held<R: Real>(
        &self,
        node: usize,
        at: impl Fn(usize) -> Vec3<R>,
        lift: impl Fn(T) -> R,
        rotate: impl Fn(&Mat3<R>) -> Mat3<R>,
    ) -> Option<Held<R>> {
        let own = &self.nodes[node];
        if own.share == T::ZERO {
            return None;
        }
        let zero = Vec3::splat(lift(T::ZERO));
        let sum = self.entries(node).fold(zero, |sum, entry| sum + at(entry));
        let centre = sum * lift(own.share);
        let unit = lift(own.unit);
        let mut covariance = Mat3::from_columns(zero, zero, zero);
        let mut spread = Sym3::diagonal(zero.x);
        for entry in self.entries(node) {
            let y = (at(entry) - centre) * unit;
            covariance += y.outer(lifted(self.arms[entry], &lift) * unit);
            spread = spread + Sym3::square(y);
        }
        let now = Neighbours { covariance, spread, offset: -centre, rotation: rotate(&covariance) };
        Some(Held { hold: Hold::new(&now, &own.remembered(&lift)), centre })
    }

    /// The same at places `x`.
    fn held_at(&self, node: usize, x: &[Vec3<T>]) -> Option<Held<T>> {
        let at = |entry: usize| x[self.neighbour(entry)] - x[node];
        self.held(node, at, |value| value, |covariance| polar(covariance))
    }

    /// The same, moving along `dx`.
    fn held_along(&self, node: usize, x: &[Vec3<T>], dx: impl Fn(usize) -> Vec3<T>) -> Option<Held<Dual<T>>> {
        let at = |entry: usize| {
            let other = self.neighbour(entry);
            dual(x[other] - x[node], dx(other) - dx(node))
        };
        self.held(node, at, Dual::constant, rotation_along)
    }

    pub(super) fn neighbour(&self, entry: usize) -> usize {
        self.rest.neighbours[entry] as usize
    }

    /// The force on the node of `entry` from the node of whose neighbours it is one; y is its place from that node.
    fn share_of<R: Real>(&self, entry: usize, held: &Held<R>, at: Vec3<R>, share: T, lift: impl Fn(T) -> R) -> Vec3<R> {
        let arm = lifted(self.arms[entry], &lift);
        held.hold.turn(arm, at - held.centre) - held.hold.force * lift(share)
    }

    /// Lets every node add up its own force and its shares in those of its neighbours, of the holds in `rows`.
    fn gather<const WIDTH: usize>(
        &self,
        executor: &Executor,
        rows: &[[[T; 4]; WIDTH]],
        out: &mut [Vec3<T>],
        own: &(impl Fn(&[[T; 4]; WIDTH]) -> Vec3<T> + Sync),
        share: &(impl Fn(usize, usize, usize) -> Vec3<T> + Sync),
    ) {
        assert_eq!(self.nodes.len(), out.len(), "arrays must be those of the model's mesh");
        executor.each(node_blocks(out.len()), NodeBlocks(out), &|block, NodeBlocks(out)| {
            for (place, out) in out.iter_mut().enumerate() {
                let node = block * NODE_BLOCK + place;
                if self.nodes[node].share == T::ZERO {
                    continue;
                }
                *out += own(&rows[node]);
                for entry in self.entries(node) {
                    *out += share(node, self.neighbour(entry), self.rest.back[entry] as usize);
                }
            }
        });
    }
}

fn lifted<T: Scalar, R>(v: Vec3<T>, lift: &impl Fn(T) -> R) -> Vec3<R> {
    Vec3 { x: lift(v.x), y: lift(v.y), z: lift(v.z) }
}

fn dual<T: Scalar>(value: Vec3<T>, derivative: Vec3<T>) -> Vec3<Dual<T>> {
    let [x, y, z] = [0, 1, 2].map(|axis| Dual::new(value[axis], derivative[axis]));
    Vec3 { x, y, z }
}

fn value<T: Scalar>(v: Vec3<Dual<T>>) -> Vec3<T> {
    Vec3 { x: v.x.value, y: v.y.value, z: v.z.value }
}

fn derivative<T: Scalar>(v: Vec3<Dual<T>>) -> Vec3<T> {
    Vec3 { x: v.x.derivative, y: v.y.derivative, z: v.z.derivative }
}

fn rotation_along<T: Scalar>(covariance: &Mat3<Dual<T>>) -> Mat3<Dual<T>> {
    let now = Mat3 { columns: covariance.columns.map(value) };
    let rotation = polar(&now);
    let change = polar_along(&now, &rotation, &Mat3 { columns: covariance.columns.map(derivative) });
    Mat3::with_derivative(&rotation, &change)
}

impl<R: Copy> Held<R> {
    /// The numbers, row by row.
    fn rows(&self) -> [[R; 4]; ROWS] {
        let Self { hold, centre } = self;
        let (force, spin, [a, b, c]) = (hold.force, hold.spin, hold.rotation.columns);
        let with = |v: Vec3<R>, last| [v.x, v.y, v.z, last];
        [with(force, hold.mix), with(spin, hold.grip), with(a, centre.x), with(b, centre.y), with(c, centre.z)]
    }

    fn from_rows([force, spin, a, b, c]: &[[R; 4]; ROWS]) -> Self {
        let vector = |&[x, y, z, _]: &[R; 4]| Vec3 { x, y, z };
        let rotation = Mat3 { columns: [vector(a), vector(b), vector(c)] };
        let hold = Hold { force: vector(force), spin: vector(spin), rotation, mix: force[3], grip: spin[3] };
        Self { hold, centre: Vec3 { x: a[3], y: b[3], z: c[3] } }
    }
}

/// The values of a dual hold, then its derivatives.
fn split<T: Scalar>(held: &Held<Dual<T>>) -> [[T; 4]; 2 * ROWS] {
    let rows = held.rows();
    std::array::from_fn(|row| match rows.get(row) {
        Some(row) => row.map(|number| number.value),
        None => rows[row - ROWS].map(|number| number.derivative),
    })
}

fn joined<T: Scalar>(rows: &[[T; 4]; 2 * ROWS]) -> Held<Dual<T>> {
    let dual = |row: usize| std::array::from_fn(|place| Dual::new(rows[row][place], rows[ROWS + row][place]));
    Held::from_rows(&std::array::from_fn(dual))
}

impl<T: Scalar> ForceModel<T> for Neighbourhoods<T> {
    fn name(&self) -> &'static str {
        ShapeMemory::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        let (Sums { executor, rows }, _) = scratch.sums(ROWS * x.len());
        let (rows, _) = rows.as_chunks_mut::<ROWS>();
        executor.each(node_blocks(x.len()), NodeBlocks(rows), &|block, NodeBlocks(rows)| {
            for (place, row) in rows.iter_mut().enumerate() {
                if let Some(held) = self.held_at(block * NODE_BLOCK + place, x) {
                    *row = held.rows();
                }
            }
        });
        let own = |row: &[[T; 4]; ROWS]| Held::from_rows(row).hold.force;
        let share = |node: usize, other: usize, back: usize| {
            let held = Held::from_rows(&rows[other]);
            self.share_of(back, &held, x[node] - x[other], self.nodes[other].share, |value| value)
        };
        self.gather(executor, rows, out, &own, &share);
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        let (Sums { executor, rows }, _) = scratch.sums(2 * ROWS * x.len());
        let (rows, _) = rows.as_chunks_mut::<{ 2 * ROWS }>();
        executor.each(node_blocks(x.len()), NodeBlocks(rows), &|block, NodeBlocks(rows)| {
            for (place, row) in rows.iter_mut().enumerate() {
                if let Some(held) = self.held_along(block * NODE_BLOCK + place, x, |node| dx[node]) {
                    *row = split(&held);
                }
            }
        });
        let own = |row: &[[T; 4]; 2 * ROWS]| derivative(joined(row).hold.force);
        let share = |node: usize, other: usize, back: usize| {
            let at = dual(x[node] - x[other], dx[node] - dx[other]);
            derivative(self.share_of(back, &joined(&rows[other]), at, self.nodes[other].share, Dual::constant))
        };
        self.gather(executor, rows, out, &own, &share);
    }

    fn add_blocks(&self, x: &[Vec3<T>], _scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        let axes = Mat3::IDENTITY.columns;
        for node in 0..x.len() {
            for column in std::iter::once(node).chain(self.entries(node).map(|entry| self.neighbour(entry))) {
                let step = |axis: Vec3<T>| move |moved: usize| if moved == column { axis } else { Vec3::ZERO };
                let [Some(a), Some(b), Some(c)] = axes.map(|axis| self.held_along(node, x, step(axis))) else {
                    continue;
                };
                let held = [a, b, c];
                let mut add = |row: usize, columns: [Vec3<T>; 3]| {
                    if row == column || !sink.keeps_diagonal_only() {
                        sink.add(row as u32, column as u32, Mat3 { columns });
                    }
                };
                add(node, held.map(|held| derivative(held.hold.force)));
                for entry in self.entries(node) {
                    let other = self.neighbour(entry);
                    let forces = [0, 1, 2].map(|axis| {
                        let step = step(axes[axis]);
                        let at = dual(x[other] - x[node], step(other) - step(node));
                        derivative(self.share_of(entry, &held[axis], at, self.nodes[node].share, Dual::constant))
                    });
                    add(other, forces);
                }
            }
        }
    }
    fn has_potential(&self) -> bool {
        false
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        let place = |node: usize| x[node].cast::<f64>();
        let of = |node: usize| {
            let at = |entry: usize| place(self.neighbour(entry)) - place(node);
            let held = self.held(node, at, T::to_f64, polar)?;
            let astray = |entry: usize| {
                let arm = self.arms[entry].cast::<f64>();
                (at(entry) - held.centre - held.hold.rotation * arm).squared_norm()
            };
            let around: f64 = self.entries(node).map(astray).sum();
            let own = held.hold.force.squared_norm() / self.nodes[node].stiffness.to_f64();
            Some(0.5 * (own + held.hold.grip * around))
        };
        (0..x.len()).filter_map(of).sum()
    }

    fn remove(&mut self, cells: &[u32]) {
        Neighbourhoods::remove(self, cells);
    }

    fn rings(&self) -> usize {
        2
    }

    fn sum_rows(&self) -> usize {
        2 * ROWS * self.nodes.len()
    }

    fn bytes(&self) -> usize {
        Neighbourhoods::bytes(self)
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}
