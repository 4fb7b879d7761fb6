use super::batch::Batch;
use super::deal::{deal, halves_share_no_node};
use super::element::{Deformed, Diagonal, Element, Measure, Measured, Record, Shared};
use super::fan::{Fan, LONGEST, fans};
use super::visitor::{BatchNodes, Keep, Largest, Scatter, ScatterAndMeasure, ScatterBlocks, Visitor, starts};
use super::{PatchPairs, PatchRows, Patches, PerPatch, clear, no_rows};
use crate::executor::Executor;
use crate::math::{
    Lanes, MAX_LANES, Mat3, Part, Real, Scalar, Simd, Vec3, baseline, dispatch, dispatch_level, large_pages,
};
use crate::mesh::TetMesh;
use crate::model::Sums;
use crate::model::lane_vector::nothing;
use crate::solver::Turn;

/// Tetrahedra in the order in which loops visit them: patch by patch, fan by fan, as many fans at once as there are lanes.
///
/// The numbers that a loop keeps of the tetrahedra stand in the rows of a table, one block of rows for each slot: the
/// tetrahedra that the lanes are at, at one time. Fans of a batch that are shorter than its longest are padded with copies of
/// their last cell, mirrored where that follows from the order of the nodes; a loop switches them off.
#[derive(Clone, Debug)]
pub(crate) struct TetFans {
    patches: Patches,
    /// Where the batches of each patch begin, and the end.
    batch_starts: Vec<usize>,
    batches: Vec<Batch>,
    /// Nodes of the batches by the numbers that their rows in the patch begin with, four times their own: axis, then ring, each for all
    /// lanes; of fans that close, the ring once around.
    nodes: Vec<u32>,
    /// Where the slots of each patch begin, and the end.
    slot_starts: Vec<usize>,
    /// The cell of each row, for padding the one that it copies.
    cells: Vec<u32>,
    /// The row of each cell.
    rows: Vec<u32>,
    lanes: usize,
}

/// A tetrahedron of a loop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tetrahedron {
    /// Row of its numbers.
    pub(crate) row: usize,
    /// Which cell it is.
    pub(crate) cell: usize,
    /// Its corners in the order of the fan: an even permutation of those of the cell, unless it is padding.
    pub(crate) corners: [u32; 4],
    /// Whether it only copies the cell.
    pub(crate) is_padding: bool,
}

impl TetFans {
    /// The tetrahedra of `mesh`, whose indices are good, in batches of `lanes` fans.
    pub(crate) fn new(mesh: &TetMesh, lanes: usize) -> Self {
        let (patches, parts) = Patches::new(&mesh.nodes, &mesh.cells);
        let mut order = Self {
            patches,
            batch_starts: vec![0],
            batches: Vec::new(),
            nodes: Vec::new(),
            slot_starts: vec![0],
            cells: Vec::new(),
            rows: vec![0; mesh.cells.len()],
            lanes,
        };
        for (patch, part) in parts.iter().enumerate() {
            let local = |node: &u32| order.patches.nodes(patch).partition_point(|other| other < node) as u32;
            let corners: Vec<[u32; 4]> =
                part.iter().map(|&cell| mesh.cells[cell as usize].each_ref().map(local)).collect();
            for batch in deal(fans(&corners), lanes) {
                order.add_batch(&batch, part);
            }
            order.batch_starts.push(order.batches.len());
            order.slot_starts.push(order.slots());
        }
        order.nodes = large_pages::moved(order.nodes);
        order
    }

    fn add_batch(&mut self, fans: &[Fan], part: &[u32]) {
        let length = fans.iter().map(|fan| fan.cells.len()).max().unwrap_or(0);
        let is_closed = fans.iter().all(|fan| fan.cells.len() == length && fan.is_closed());
        let is_apart = fans.len() == self.lanes && halves_share_no_node(fans);
        let batch =
            Batch { nodes: self.nodes.len(), slot: self.slots(), length, fans: fans.len(), is_closed, is_apart };
        self.batches.push(batch);
        let fan = |lane: usize| fans.get(lane).unwrap_or(&fans[0]);
        for end in 0..2 {
            self.nodes.extend((0..self.lanes).map(|lane| 4 * fan(lane).axis[end]));
        }
        for place in 0..batch.ring() {
            self.nodes.extend((0..self.lanes).map(|lane| 4 * ring_node(fan(lane), place)));
        }
        for slot in 0..length {
            for lane in 0..self.lanes {
                let cells = &fan(lane).cells;
                let cell = part[cells[slot.min(cells.len() - 1)] as usize];
                if lane < fans.len() && slot < cells.len() {
                    self.rows[cell as usize] = self.cells.len() as u32;
                }
                self.cells.push(cell);
            }
        }
    }

    /// How many blocks of rows there are.
    pub(crate) fn slots(&self) -> usize {
        self.cells.len() / self.lanes
    }

    /// Rows that a table of the tetrahedra has: whole blocks.
    pub(crate) fn row_count(&self) -> usize {
        self.cells.len()
    }

    /// The row of a cell.
    pub(crate) fn row(&self, cell: u32) -> usize {
        self.rows[cell as usize] as usize
    }

    /// Rows that a loop sums in: forces take one for each copy of a node, blocks two, products two more for the direction and the masses.
    pub(crate) fn sum_rows(&self) -> usize {
        3 * self.patches.rows()
    }

    /// Size of the numbers that a loop reads [bytes].
    pub(crate) fn bytes(&self) -> usize {
        self.patches.bytes() + size_of_val(self.nodes.as_slice())
    }

    /// All tetrahedra, row by row.
    pub(crate) fn tetrahedra(&self) -> impl Iterator<Item = Tetrahedron> + '_ {
        let batches = self.batch_starts.windows(2).enumerate().flat_map(move |(patch, ends)| {
            self.batches[ends[0]..ends[1]].iter().map(move |batch| (self.patches.nodes(patch), batch))
        });
        batches.flat_map(move |(nodes, batch)| {
            let node = move |place: usize, lane: usize| {
                nodes[self.nodes[batch.nodes + place * self.lanes + lane] as usize / 4]
            };
            (0..batch.length * self.lanes).map(move |number| {
                let (slot, lane) = (number / self.lanes, number % self.lanes);
                let row = batch.slot * self.lanes + number;
                let cell = self.cells[row];
                let corners = batch.corners(slot).map(|place| node(place, lane));
                Tetrahedron { row, cell: cell as usize, corners, is_padding: self.row(cell) != row }
            })
        })
    }

    /// Adds to `out` the forces that `element` makes of the edges of each tetrahedron in the `fields`.
    pub(crate) fn add<T: Scalar, E: Element<T, FIELDS>, const FIELDS: usize>(
        &self,
        fields: [&[Vec3<T>]; FIELDS],
        element: &E,
        sums: Sums<'_, T>,
        out: &mut [Vec3<T>],
    ) {
        let Sums { executor, rows } = sums;
        self.sum(fields, element, Sums { executor, rows: &mut *rows }).add_up(executor, rows, out);
    }

    /// Sums the forces of each patch on copies of its nodes, in the first rows.
    pub(crate) fn sum<T: Scalar, E: Element<T, FIELDS>, const FIELDS: usize>(
        &self,
        fields: [&[Vec3<T>]; FIELDS],
        element: &E,
        Sums { executor, rows }: Sums<'_, T>,
    ) -> &Patches {
        let data = self.patches.per_patch(&mut rows[..self.patches.rows()], 1);
        let work = |patch: usize, rows: PerPatch<'_, [T; 4]>, places: &mut [PatchRows<T>; FIELDS]| {
            let ([sums], _) = rows.values.as_chunks_mut() else { return };
            clear(&mut sums[..self.patches.nodes(patch).len()]);
            self.patches.gather(patch, &fields, places);
            self.scatter(patch, places.each_ref(), element, sums);
        };
        executor.each_with(&no_rows, self.patches.count(), data, &work);
        &self.patches
    }

    /// The same, and the largest number that `element` measures, 0 if there is none above.
    pub(crate) fn sum_and_find_largest<T: Scalar>(
        &self,
        x: &[Vec3<T>],
        element: &impl Measured<T>,
        Sums { executor, rows }: Sums<'_, T>,
    ) -> (&Patches, T) {
        let data = self.patches.per_patch(&mut rows[..self.patches.rows()], 1);
        let work = |patch: usize, rows: PerPatch<'_, [T; 4]>, places: &mut [PatchRows<T>; 1]| {
            let ([sums], _) = rows.values.as_chunks_mut() else { return T::ZERO };
            clear(&mut sums[..self.patches.nodes(patch).len()]);
            self.patches.gather(patch, &[x], places);
            dispatch!(dispatch_level(), simd => self.scatter_and_measure(simd, patch, &places[0], element, sums))
        };
        let largest = executor.fold_with(&no_rows, self.patches.count(), data, &work, &Real::max);
        (&self.patches, largest.unwrap_or(T::ZERO))
    }

    #[inline(always)]
    fn scatter_and_measure<T: Scalar, S: Simd>(
        &self,
        simd: S,
        patch: usize,
        places: &PatchRows<T>,
        element: &impl Measured<T>,
        sums: &mut PatchRows<T>,
    ) -> T {
        let zero = T::Lanes::<S>::splat(simd, T::ZERO);
        let (invariants, forces) = ([[zero; 3]; LONGEST], [[nothing(); 3]; LONGEST]);
        let mut scatter = ScatterAndMeasure { element, sums, batch: (0, 0), invariants, forces, largest: zero };
        self.walk(simd, patch, [places], &mut scatter);
        largest_lane(simd, scatter.largest)
    }

    /// The same for a product at `x`, along the direction that `turn` is on its way to, with masses; gives the curvature along it as well.
    pub(crate) fn sum_product<T: Scalar, E: Element<T, FIELDS>, const FIELDS: usize>(
        &self,
        x: &[Vec3<T>],
        (turn, masses): (&Turn<'_, T>, &[T]),
        element: &E,
        Sums { executor, rows }: Sums<'_, T>,
    ) -> (&Patches, f64) {
        let count = self.patches.rows();
        let (sums, rest) = rows.split_at_mut(count);
        let (directions, inertia) = rest.split_at_mut(count);
        let per_patch = |rows| self.patches.per_patch(rows, 1);
        let inertia = self.patches.per_patch(&mut inertia.as_flattened_mut()[..count], 1);
        let data = ((per_patch(sums), per_patch(directions)), inertia);
        let memory = || (FIELDS > 1).then(no_rows::<T, 1>);
        let work = |patch: usize,
                    ((sums, directions), inertia): ProductRows<'_, T>,
                    places: &mut Option<[PatchRows<T>; 1]>| {
            let (([sums], _), ([direction], _)) = (sums.values.as_chunks_mut(), directions.values.as_chunks_mut())
            else {
                return 0.0;
            };
            self.patches.turn(patch, turn, masses, ([sums, direction], inertia.values));
            if let Some(places) = places {
                self.patches.gather(patch, &[x], places);
            }
            let (direction, places) = (&*direction, places.as_ref());
            let fields = std::array::from_fn(|field| match places {
                Some(places) if field + 1 < FIELDS => &places[0],
                _ => direction,
            });
            self.scatter(patch, fields, element, sums);
            self.patches.curvature(patch, direction, sums)
        };
        let curvature = executor.fold_with(&memory, self.patches.count(), data, &work, &|a, b| a + b);
        (&self.patches, curvature.unwrap_or(0.0))
    }

    /// Adds up forces in a patch. Out of line, so that the kernel exists once.
    #[inline(never)]
    fn scatter<T: Scalar, E: Element<T, FIELDS>, const FIELDS: usize>(
        &self,
        patch: usize,
        fields: [&PatchRows<T>; FIELDS],
        element: &E,
        sums: &mut PatchRows<T>,
    ) {
        if E::IS_WIDE {
            dispatch!(dispatch_level(), simd => self.scatter_with(simd, patch, fields, element, sums));
        } else {
            self.scatter_with(baseline(), patch, fields, element, sums);
        }
    }

    #[inline(always)]
    fn scatter_with<T: Scalar, S: Simd, const FIELDS: usize>(
        &self,
        simd: S,
        patch: usize,
        fields: [&PatchRows<T>; FIELDS],
        element: &impl Element<T, FIELDS>,
        sums: &mut PatchRows<T>,
    ) {
        let mut scatter = Scatter { element, sums, forces: [[nothing(); 3]; LONGEST] };
        self.walk(simd, patch, fields, &mut scatter);
    }

    /// Sums the blocks on the diagonal that `element` makes of the edges of each tetrahedron at `x` on copies of the nodes.
    pub(crate) fn sum_diagonal<T: Scalar, E: Diagonal<T>>(
        &self,
        x: &[Vec3<T>],
        element: &E,
        Sums { executor, rows }: Sums<'_, T>,
    ) -> &Patches {
        let data = self.patches.per_patch(&mut rows[..2 * self.patches.rows()], 2);
        let work = |patch: usize, rows: PerPatch<'_, [T; 4]>, places: &mut [PatchRows<T>; 1]| {
            let ([sums], _) = rows.values.as_chunks_mut() else { return };
            clear(&mut sums[..2 * self.patches.nodes(patch).len()]);
            if E::IS_OF_EDGES {
                self.patches.gather(patch, &[x], places);
            }
            if E::IS_WIDE {
                dispatch!(dispatch_level(), simd => self.scatter_blocks(simd, patch, &places[0], element, sums));
            } else {
                self.scatter_blocks(baseline(), patch, &places[0], element, sums);
            }
        };
        executor.each_with(&no_rows, self.patches.count(), data, &work);
        &self.patches
    }

    #[inline(always)]
    fn scatter_blocks<T: Scalar, S: Simd>(
        &self,
        simd: S,
        patch: usize,
        places: &PatchRows<T>,
        element: &impl Diagonal<T>,
        sums: &mut PatchPairs<T>,
    ) {
        let mut scatter = ScatterBlocks { element, sums, blocks: [[nothing(); 8]; LONGEST] };
        self.walk(simd, patch, [places], &mut scatter);
    }

    /// Fills the blocks of rows of `table` with what `record` keeps of each tetrahedron at `x`, and sums its forces on copies of the nodes.
    pub(crate) fn record_and_sum<T: Scalar>(
        &self,
        x: &[Vec3<T>],
        record: &impl Record<T>,
        Sums { executor, rows }: Sums<'_, T>,
        table: &mut [T],
    ) -> &Patches {
        let block = record.columns() * T::LANES;
        let table = PerPatch { values: table, starts: &self.slot_starts, width: block };
        let data = (table, self.patches.per_patch(&mut rows[..self.patches.rows()], 1));
        let work = |patch: usize, (table, rows): RecordRows<'_, T>, places: &mut [PatchRows<T>; 1]| {
            let ([sums], _) = rows.values.as_chunks_mut() else { return };
            clear(&mut sums[..self.patches.nodes(patch).len()]);
            self.patches.gather(patch, &[x], places);
            let values = (table.values, block);
            dispatch!(dispatch_level(), simd => self.scatter_and_keep(simd, patch, &places[0], (record, values), sums));
        };
        executor.each_with(&no_rows, self.patches.count(), data, &work);
        &self.patches
    }

    #[inline(always)]
    fn scatter_and_keep<T: Scalar, S: Simd>(
        &self,
        simd: S,
        patch: usize,
        places: &PatchRows<T>,
        (record, (values, block)): (&impl Record<T>, (&mut [T], usize)),
        sums: &mut PatchRows<T>,
    ) {
        let zero = Mat3::diagonal(T::Lanes::<S>::splat(simd, T::ZERO));
        let (first, batch) = (self.slot_starts[patch], (0, 0));
        let deformed = [Deformed { edges: zero, f: zero, r: zero }; LONGEST];
        let mut keep =
            Keep { record, values, first, block, sums, batch, places: deformed, forces: [[nothing(); 3]; LONGEST] };
        self.walk(simd, patch, [places], &mut keep);
    }

    /// The largest of what `measure` says of each tetrahedron at `x`, and 0 if there is none above.
    pub(crate) fn largest<T: Scalar>(&self, x: &[Vec3<T>], measure: &impl Measure<T>, executor: &Executor) -> T {
        let work = |patch: usize, (): (), places: &mut [PatchRows<T>; 1]| {
            self.patches.gather(patch, &[x], places);
            dispatch!(dispatch_level(), simd => self.largest_of(simd, patch, &places[0], measure))
        };
        executor.fold_with(&no_rows, self.patches.count(), (), &work, &Real::max).unwrap_or(T::ZERO)
    }

    #[inline(always)]
    fn largest_of<T: Scalar, S: Simd>(
        &self,
        simd: S,
        patch: usize,
        places: &PatchRows<T>,
        measure: &impl Measure<T>,
    ) -> T {
        let mut largest = Largest { measure, value: T::Lanes::<S>::splat(simd, T::ZERO) };
        self.walk(simd, patch, [places], &mut largest);
        largest_lane(simd, largest.value)
    }

    /// Leads `visitor` along the fans of a patch.
    ///
    /// All nodes of a batch are read, then its tetrahedra visited, then sums written: tetrahedra do not wait for one another, and each part
    /// has the registers for itself (forces a tenth faster where there are sixteen, measured).
    #[inline(always)]
    fn walk<T: Scalar, S: Simd, V: Visitor<T, S, FIELDS>, const FIELDS: usize>(
        &self,
        simd: S,
        patch: usize,
        fields: [&PatchRows<T>; FIELDS],
        visitor: &mut V,
    ) {
        let zero = Vec3::splat(T::Lanes::<S>::splat(simd, T::ZERO));
        let mut ring = [[zero; FIELDS]; LONGEST + 1];
        let mut faces = [zero; LONGEST + 1];
        for batch in &self.batches[self.batch_starts[patch]..self.batch_starts[patch + 1]] {
            let nodes = &self.nodes[batch.nodes..batch.nodes + (2 + batch.ring()) * T::LANES];
            let (origin, nodes) = nodes.split_at(T::LANES);
            let (end, nodes) = nodes.split_at(T::LANES);
            let (ring_nodes, last) = nodes.split_at(batch.length * T::LANES);
            let last = if batch.is_closed { &ring_nodes[..T::LANES] } else { last };
            let batch_nodes = BatchNodes {
                origin,
                end,
                ring: ring_nodes,
                last,
                is_closed: batch.is_closed,
                fans: batch.fans,
                is_apart: batch.is_apart,
            };
            for part in Part::all::<T>(simd).take_while(|part| part.start::<T, T::Lanes<S>>() < batch.fans) {
                let at_origin = gather(part, fields, origin);
                let axis = minus(gather(part, fields, end), &at_origin);
                let axis_square = if V::IS_SHARING { axis[0].squared_norm() } else { zero.x };
                for ((place, face), nodes) in ring.iter_mut().zip(&mut faces).zip(nodes.chunks_exact(T::LANES)) {
                    *place = minus(gather(part, fields, nodes), &at_origin);
                    if V::IS_SHARING {
                        *face = axis[0].cross(place[0]);
                    }
                }
                let length = batch.length.min(LONGEST);
                if batch.is_closed {
                    (ring[length], faces[length]) = (ring[0], faces[0]);
                }
                for place in 0..length {
                    let edges = std::array::from_fn(|field| {
                        Mat3::from_columns(axis[field], ring[place][field], ring[place + 1][field])
                    });
                    let shared = Shared { axis_square, from: faces[place], to: faces[place + 1] };
                    visitor.tetrahedron(part, batch.slot + place, place, &edges, &shared);
                }
                visitor.end(part, &batch_nodes);
            }
        }
    }
}

/// Sums, direction and masses of a product on the copies of the nodes.
type ProductRows<'a, T> = ((PerPatch<'a, [T; 4]>, PerPatch<'a, [T; 4]>), PerPatch<'a, T>);

/// What is kept of tetrahedra, and sums on the copies of the nodes.
type RecordRows<'a, T> = (PerPatch<'a, T>, PerPatch<'a, [T; 4]>);

#[inline(always)]
fn largest_lane<T: Scalar, S: Simd>(simd: S, value: T::Lanes<S>) -> T {
    let mut lanes = [T::ZERO; MAX_LANES];
    value.store(Part::first(simd), &mut lanes);
    lanes.into_iter().fold(T::ZERO, Real::max)
}

/// A node of a fan's ring; beyond the end the last two in turn, so that the padding is the last cell over and over.
fn ring_node(fan: &Fan, place: usize) -> u32 {
    let last = fan.ring.len() - 1;
    let beyond = place.saturating_sub(last);
    fan.ring[place.min(last) - beyond % 2]
}

#[inline(always)]
fn gather<T: Scalar, S: Simd, const FIELDS: usize>(
    part: Part<S>,
    fields: [&PatchRows<T>; FIELDS],
    nodes: &[u32],
) -> [Vec3<T::Lanes<S>>; FIELDS] {
    let start = starts::<T, S, T::Lanes<S>>(part, nodes);
    let mut places = [Vec3::splat(T::Lanes::<S>::splat(part.simd, T::ZERO)); FIELDS];
    for field in 0..FIELDS {
        let [x, y, z, _] = T::Lanes::<S>::gather_from(part.simd, fields[field].as_flattened(), start);
        places[field] = Vec3::new(x, y, z);
    }
    places
}

#[inline(always)]
fn minus<R: Real, const FIELDS: usize>(mut places: [Vec3<R>; FIELDS], origin: &[Vec3<R>; FIELDS]) -> [Vec3<R>; FIELDS] {
    for field in 0..FIELDS {
        places[field] -= origin[field];
    }
    places
}
