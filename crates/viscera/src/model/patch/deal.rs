//! Which fans make a batch: such that share no node, while there are any.
//!
//! A force that is added to a node has to wait for the one before. And batches whose halves share no node are added up at once, to the same bits
//! as half by half.

use std::collections::HashSet;

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
        let (mut closed, open): (Vec<_>, Vec<_>) = left.into_iter().partition(Fan::is_closed);
        deal_same(&mut closed, lanes, &mut batches);
        closed.extend(open);
        deal_same(&mut closed, lanes, &mut batches);
        longer = closed;
    }
    if !longer.is_empty() {
        batches.push(longer);
    }
    batches
}

/// Deals whole batches, and leaves what is too little for one. Where halves that share no node are used up, fans are put far apart.
fn deal_same(fans: &mut Vec<Fan>, lanes: usize, batches: &mut Vec<Vec<Fan>>) {
    while let Some(batch) = take_apart(&[], fans, lanes) {
        batches.push(batch);
    }
    let count = fans.len() / lanes;
    let left = fans.split_off(count * lanes);
    batches.extend((0..count).map(|batch| (0..lanes).map(|lane| fans[lane * count + batch].clone()).collect()));
    *fans = left;
}

/// Takes a batch whose halves share no node, with those that are `given` first.
fn take_apart(given: &[Fan], fans: &mut Vec<Fan>, lanes: usize) -> Option<Vec<Fan>> {
    let (first, second) = given.split_at(given.len().min(lanes / 2));
    let (mut first, mut second, mut left) = (first.to_vec(), second.to_vec(), fans.clone());
    fill_up(&mut first, &second, &mut left, lanes / 2);
    fill_up(&mut second, &first, &mut left, lanes / 2);
    first.extend(second);
    let batch = (first.len() == lanes && halves_share_no_node(&first)).then_some(first)?;
    *fans = left;
    Some(batch)
}

/// Fills up half a batch with fans that share no node with the other half; with such first that share none with this one either.
fn fill_up(half: &mut Vec<Fan>, other: &[Fan], fans: &mut Vec<Fan>, count: usize) {
    let others = nodes(other);
    let mut met = &others | &nodes(half);
    for may_touch in [false, true] {
        let mut next = 0;
        while half.len() < count && next < fans.len() {
            let avoided = if may_touch { &others } else { &met };
            if fans[next].nodes().any(|node| avoided.contains(&node)) {
                next += 1;
            } else {
                let fan = fans.remove(next);
                met.extend(fan.nodes());
                half.push(fan);
            }
        }
    }
}

fn nodes(fans: &[Fan]) -> HashSet<u32> {
    fans.iter().flat_map(Fan::nodes).collect()
}

/// Whether no node of the first half of `fans` is one of the second.
pub(super) fn halves_share_no_node(fans: &[Fan]) -> bool {
    let (first, second) = fans.split_at(fans.len() / 2);
    let met = nodes(first);
    second.iter().flat_map(Fan::nodes).all(|node| !met.contains(&node))
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
