use super::lattice::Lattice;
use super::skin::{Cut, Skin};

/// A cut closer to an end of a long edge than this part of the edge moves the end onto the skin.
///
/// With the two thresholds below the dihedral angles of Labelle & Shewchuk 2007 are met: at least 10.7°, at most 164.8°.
/// They balance the three worst cases, and were found again by letting signs and cuts be anything (the test below this
/// module): larger ones flatten cells whose nodes are warped, smaller ones leave slivers between cuts. The pair 0.24999,
/// 0.41189, also in use elsewhere, allows 9.3°.
pub(super) const TOO_CLOSE_LONG: f64 = 0.2851;
/// The same for a short edge.
pub(super) const TOO_CLOSE_SHORT: f64 = 0.3989;

/// Moves every lattice node with a cut too close to it onto the nearest such cut, and forgets the cuts of its edges.
///
/// Node by node in the order of their numbers: a cut that an earlier node has taken no longer moves a later one.
pub(super) fn onto_skin(lattice: &Lattice, skin: &mut Skin, cuts: &mut Vec<Cut>) {
    let (starts, cuts_at) = cuts_of_nodes(cuts, skin.value.len());
    let mut taken = vec![false; cuts.len()];
    for node in 0..skin.value.len() {
        let around = &cuts_at[starts[node] as usize..starts[node + 1] as usize];
        let mut nearest: Option<(f64, u32)> = None;
        for &cut in around.iter().filter(|&&cut| !taken[cut as usize]) {
            let Cut { ends, fraction, .. } = cuts[cut as usize];
            let from_here = if ends[0] as usize == node { fraction } else { 1.0 - fraction };
            let long = lattice.is_long(ends[0], ends[1]);
            let (limit, length) = if long { (TOO_CLOSE_LONG, 1.0) } else { (TOO_CLOSE_SHORT, 0.75f64.sqrt()) };
            let distance = from_here * length;
            if from_here < limit && nearest.is_none_or(|(nearest, _)| distance < nearest) {
                nearest = Some((distance, cut));
            }
        }
        if let Some((_, cut)) = nearest {
            skin.place[node] = cuts[cut as usize].place;
            skin.value[node] = 0.0;
            around.iter().for_each(|&cut| taken[cut as usize] = true);
        }
    }
    let mut taken = taken.into_iter();
    cuts.retain(|_| taken.next() == Some(false));
}

/// The cuts on the edges of node `n` are `cuts[starts[n]..starts[n + 1]]`.
fn cuts_of_nodes(cuts: &[Cut], nodes: usize) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; nodes + 1];
    for &node in cuts.iter().flat_map(|cut| &cut.ends) {
        starts[node as usize + 1] += 1;
    }
    for node in 0..nodes {
        starts[node + 1] += starts[node];
    }
    let mut cursor = starts.clone();
    let mut cuts_at = vec![0u32; 2 * cuts.len()];
    for (index, cut) in cuts.iter().enumerate() {
        for &node in &cut.ends {
            cuts_at[cursor[node as usize] as usize] = index as u32;
            cursor[node as usize] += 1;
        }
    }
    (starts, cuts_at)
}
