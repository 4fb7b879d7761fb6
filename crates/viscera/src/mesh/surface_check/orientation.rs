use super::super::{Point, SurfaceMesh, TriangleTree};
use super::{EdgeUses, SurfaceReport};

/// Turns facets so that neighbours agree, then every component outwards, cavities inwards.
pub(super) fn orient(surface: &mut SurfaceMesh, origins: &[u32], uses: &EdgeUses, report: &mut SurfaceReport) {
    let mut components = Vec::new();
    let mut seen = vec![false; surface.triangles.len()];
    for seed in 0..surface.triangles.len() {
        if !seen[seed] {
            let (component, turned) = agree(surface, uses, seed, &mut seen, report);
            // Whichever the seed was, the fewer facets are the flipped ones.
            let majority_turned = 2 * turned.len() > component.len();
            if majority_turned {
                component.iter().for_each(|&triangle| surface.triangles[triangle as usize].swap(1, 2));
            }
            for &triangle in &component {
                if turned.binary_search(&triangle).is_ok() != majority_turned {
                    report.flipped.push(origins[triangle as usize]);
                }
            }
            components.push(component);
        }
    }
    report.flipped.sort_unstable();
    report.components = components.len();
    if uses.values().all(|triangles| triangles.len() == 2) && report.one_sided.is_none() {
        turn_outwards(surface, &components, report);
    }
}

/// The triangles connected to a seed, turned to agree with it; and, ascending, those that had to be turned.
fn agree(
    surface: &mut SurfaceMesh,
    uses: &EdgeUses,
    seed: usize,
    seen: &mut [bool],
    report: &mut SurfaceReport,
) -> (Vec<u32>, Vec<u32>) {
    let (mut component, mut turned) = (Vec::new(), Vec::new());
    let mut waiting = vec![seed as u32];
    seen[seed] = true;
    while let Some(triangle) = waiting.pop() {
        component.push(triangle);
        let [a, b, c] = surface.triangles[triangle as usize];
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let sharing = &uses[&[from.min(to), from.max(to)]];
            // Across an edge of more than two triangles nobody knows which ones belong together.
            let &[first, second] = &sharing[..] else { continue };
            let other = if first == triangle { second } else { first };
            let corners = surface.triangles[other as usize];
            let same_way = (0..3).any(|i| corners[i] == from && corners[(i + 1) % 3] == to);
            if !seen[other as usize] {
                seen[other as usize] = true;
                waiting.push(other);
                if same_way {
                    surface.triangles[other as usize].swap(1, 2);
                    turned.push(other);
                }
            } else if same_way {
                let middle = (surface.nodes[from as usize] + surface.nodes[to as usize]) * 0.5;
                report.one_sided.get_or_insert(middle);
            }
        }
    }
    turned.sort_unstable();
    (component, turned)
}

/// Gives every component positive volume, or negative volume where it lies inside an odd number of others.
fn turn_outwards(surface: &mut SurfaceMesh, components: &[Vec<u32>], report: &mut SurfaceReport) {
    let alone = |surface: &SurfaceMesh, component: &[u32]| SurfaceMesh {
        nodes: surface.nodes.clone(),
        triangles: component.iter().map(|&triangle| surface.triangles[triangle as usize]).collect(),
    };
    let signs: Vec<_> =
        components.iter().map(|component| alone(surface, component).enclosed_volume().signum()).collect();
    let trees: Vec<_> = if components.len() > 1 {
        components.iter().map(|component| TriangleTree::new(&alone(surface, component))).collect()
    } else {
        Vec::new()
    };
    for (number, component) in components.iter().enumerate() {
        let [a, b, c] = surface.triangles[component[0] as usize].map(|node| surface.nodes[node as usize]);
        let place: Point = (a + b + c) / 3.0;
        let around = |other: usize| other != number && trees[other].winding_number(place).abs() > 0.5;
        let cavity = (0..trees.len()).filter(|&other| around(other)).count() % 2 == 1;
        report.cavities += usize::from(cavity);
        if (signs[number] < 0.0) != cavity {
            report.inside_out += 1;
            component.iter().for_each(|&triangle| surface.triangles[triangle as usize].swap(1, 2));
        }
    }
}
