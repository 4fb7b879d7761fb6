use super::super::TetMesh;
use super::GenerateError;

/// Half the breadth and half the depth of the trunk, over its height.
const BREADTH: f64 = 0.36;
const DEPTH: f64 = 0.25;
/// How high the rim of the diaphragm lies, and how much higher its middle, over the height.
const RIM: f64 = 0.5;
const DOME: f64 = 0.16;
/// The spine: the part of the wall that lies farther back than this share of the depth.
const SPINE: f64 = 0.8;
/// The belly: the part that lies farther to the front than this share of the depth.
const BELLY: f64 = 0.5;

impl TetMesh {
    /// A trunk of the given `height` [m] in tetrahedra of about `edge` [m]: an upright elliptic cylinder, a stand-in for the
    /// anatomy, with the dome of the diaphragm across it.
    ///
    /// Frame: z up from the pelvis, x to the left, y to the front, the origin in the middle of the base. Regions: the cells
    /// "abdomen" and "thorax" below and above the diaphragm; the sheet of nodes "diaphragm" between them; the nodes "pelvis" (the
    /// base), "spine" (the back wall), "belly" (the front wall of the abdomen), and "ribs-1", "ribs-2", … upwards: arcs around
    /// the front of the thorax, the lowest at the rim of the diaphragm.
    ///
    /// # Errors
    /// [`GenerateError::Length`] for a height or edge that is not positive, [`GenerateError::Divisions`] for an edge so long that
    /// there are fewer than six layers.
    pub fn trunk(height: f64, edge: f64) -> Result<Self, GenerateError> {
        GenerateError::check_length("height", height)?;
        GenerateError::check_length("edge", edge)?;
        let rings = ((BREADTH + DEPTH) / 2.0 * height / edge).round().max(2.0) as usize;
        let half = (0.5 * height / edge).round() as usize;
        GenerateError::check_divisions("layers", 2 * half, 6)?;

        let mut mesh = Self::cylinder(1.0, 1.0, rings, 2 * half)?;
        mesh.regions.clear();
        let per_layer = mesh.nodes.len() / (2 * half + 1);
        for node in 0..mesh.nodes.len() {
            let place = mesh.nodes[node];
            let (radius, layer) = (place.x.hypot(place.y), node / per_layer);
            let inside = 1.0 - radius * radius;
            // The layers below and above give way to the dome in proportion.
            let raised = DOME * inside * (1.0 - (place.z - RIM).abs() / RIM);
            let on_wall = node % per_layer + 6 * rings >= per_layer;
            let mut name = |name: &str| mesh.regions.entry(name.to_owned()).or_default().nodes.push(node as u32);
            if layer == half {
                name("diaphragm");
            }
            if layer == 0 {
                name("pelvis");
            }
            if on_wall && place.y < -SPINE {
                name("spine");
            } else if on_wall && layer >= half && layer < 2 * half && (layer - half).is_multiple_of(2) {
                name(&format!("ribs-{}", (layer - half) / 2 + 1));
            } else if on_wall && place.y > BELLY && layer > 0 && layer < half {
                name("belly");
            }
            let node = &mut mesh.nodes[node];
            (node.x, node.y, node.z) =
                (place.x * BREADTH * height, place.y * DEPTH * height, (place.z + raised) * height);
        }
        for (cell, corners) in mesh.cells.iter().enumerate() {
            let below = corners.iter().all(|&node| node as usize / per_layer <= half);
            let part = mesh.regions.entry(if below { "abdomen" } else { "thorax" }.to_owned()).or_default();
            part.cells.push(cell as u32);
            part.nodes.extend(corners);
        }
        mesh.regions.values_mut().for_each(|region| region.normalize());
        Ok(mesh)
    }
}
