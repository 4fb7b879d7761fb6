//! Which fans make a batch: such that share no node, while there are any.
//!
//! A force that is added to a node has to wait for the one before. And batches whose halves share no node are added up at once, to the same bits
//! as half by half.

use super::PATCH_NODES;
use super::fan::Fan;

/// Deals fans, the longest first, into batches of `lanes`, the last one perhaps of fewer. Those that close stand together.
pub(super) fn deal(fans: Vec<Fan>, lanes: usize) -> Vec<Vec<Fan>> {
    let mut batches = Vec::new();
    let mut longer: Vec<Fan> = Vec::new();
    for same in fans.chunk_by(|a, b| a.cells.len() == b.cells.len()) {
        if longer.len() + same.len() < lanes {
            longer.extend_from_slice(same);
            continue;
        }
        let (closed, mut left): (Vec<_>, Vec<_>) = same.iter().cloned().partition(Fan::is_closed);
        left.extend(closed);
        if !longer.is_empty() {
            let wanted = lanes - longer.len();
            let batch = take_apart(&longer, &mut left, lanes);
            batches.push(batch.unwrap_or_else(|| longer.iter().cloned().chain(left.drain(..wanted)).collect()));
        }
        let (closed, open): (Vec<_>, Vec<_>) = left.into_iter().partition(Fan::is_closed);
        let mut left = deal_same(closed, lanes, &mut batches);
        left.extend(open);
        longer = deal_same(left, lanes, &mut batches);
    }
    if !longer.is_empty() {
        batches.push(longer);
    }
    batches
}

/// Deals whole batches, and gives back what is too little for one. Where halves that share no node are used up, fans are put far apart.
fn deal_same(mut fans: Vec<Fan>, lanes: usize, batches: &mut Vec<Vec<Fan>>) -> Vec<Fan> {
    while let Some(batch) = take_apart(&[], &mut fans, lanes) {
        batches.push(batch);
    }
    let count = fans.len() / lanes;
    let left = fans.split_off(count * lanes);
    batches.extend((0..count).map(|batch| (0..lanes).map(|lane| fans[lane * count + batch].clone()).collect()));
    left
}

/// Takes a batch whose halves share no node, with those that are `given` first.
fn take_apart(given: &[Fan], fans: &mut Vec<Fan>, lanes: usize) -> Option<Vec<Fan>> {
    let (first, second) = given.split_at(given.len().min(lanes / 2));
    let mut halves = [Nodes::of(first), Nodes::of(second)];
    let mut is_taken = vec![false; fans.len()];
    let mut batch = Vec::with_capacity(lanes);
    for (half, given) in [first, second].into_iter().enumerate() {
        batch.extend_from_slice(given);
        let other = halves[1 - half].clone();
        fill_up(&mut batch, fans, (&mut halves[half], &other), &mut is_taken, (half + 1) * (lanes / 2));
    }
    (batch.len() == lanes && halves_share_no_node(&batch)).then(|| {
        let mut taken = is_taken.into_iter();
        fans.retain(|_| taken.next() == Some(false));
        batch
    })
}

/// Fills up half a batch with fans that share no node with the other half; with such first that share none with this one either.
fn fill_up(
    batch: &mut Vec<Fan>,
    fans: &[Fan],
    (half, other): (&mut Nodes, &Nodes),
    is_taken: &mut [bool],
    count: usize,
) {
    for may_touch in [false, true] {
        for (fan, is_taken) in fans.iter().zip(is_taken.iter_mut()) {
            let touches = |nodes: &Nodes| fan.nodes().any(|node| nodes.contains(node));
            if batch.len() < count && !*is_taken && !touches(other) && (may_touch || !touches(half)) {
                half.add(fan);
                batch.push(fan.clone());
                *is_taken = true;
            }
        }
    }
}

/// Whether no node of the first half of `fans` is one of the second.
pub(super) fn halves_share_no_node(fans: &[Fan]) -> bool {
    let (first, second) = fans.split_at(fans.len() / 2);
    let met = Nodes::of(first);
    second.iter().flat_map(Fan::nodes).all(|node| !met.contains(node))
}

/// Some of the nodes of a patch.
#[derive(Clone)]
struct Nodes([bool; PATCH_NODES]);

impl Nodes {
    fn of(fans: &[Fan]) -> Self {
        let mut nodes = Self([false; PATCH_NODES]);
        fans.iter().for_each(|fan| nodes.add(fan));
        nodes
    }

    fn add(&mut self, fan: &Fan) {
        fan.nodes().for_each(|node| self.0[node as usize] = true);
    }

    fn contains(&self, node: u32) -> bool {
        self.0[node as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::super::fan::fans;
    use super::*;
    use crate::mesh::TetMesh;

    /// Every fan is in one batch; batches are as long as their longest fan, so all but the last hold as many as there are lanes, and lengths fall.
    #[test]
    fn each_fan_is_dealt_once_and_lengths_fall() {
        let mesh = TetMesh::cylinder(0.01, 0.05, 4, 6).unwrap();
        for lanes in [8, 16] {
            let all = fans(&mesh.cells);
            let batches = deal(all.clone(), lanes);
            let mut dealt: Vec<u32> = batches.iter().flatten().flat_map(|fan| fan.cells.clone()).collect();
            dealt.sort_unstable();
            assert_eq!(dealt, (0..mesh.cells.len() as u32).collect::<Vec<_>>());
            assert!(batches[..batches.len() - 1].iter().all(|batch| batch.len() == lanes));
            let longest: Vec<usize> =
                batches.iter().map(|batch| batch.iter().map(|fan| fan.cells.len()).max().unwrap()).collect();
            assert!(longest.is_sorted_by(|a, b| a >= b), "{longest:?}");
            assert_eq!(batches.len(), all.len().div_ceil(lanes));
        }
    }

    /// In a box all batches can be had whose fans share no node; in a cylinder most have halves that do not.
    #[test]
    fn halves_of_batches_share_no_node() {
        let apart = |mesh: &TetMesh| {
            let batches = deal(fans(&mesh.cells), 16);
            let apart = batches.iter().filter(|batch| batch.len() == 16 && halves_share_no_node(batch)).count();
            (apart, batches.len())
        };
        assert_eq!(apart(&TetMesh::box_grid([8, 8, 4], [1.0; 3])), (16, 16));
        let (apart, all) = apart(&TetMesh::cylinder(0.01, 0.05, 4, 6).unwrap());
        assert!(2 * apart > all, "{apart} of {all}");
    }
}
