//! How the nodes of a mesh are numbered, and whether that costs time.

use viscera::mesh::VolumeMesh;
use viscera_io::grouped;

/// Nodes of a mesh that fits the fastest caches, where their order hardly counts.
const FEW: usize = 1000;
/// Numbers so many times as far apart as they could be are in no order.
const TANGLED: f64 = 4.0;

/// That the nodes of a mesh are in no order, and what their numbers would be apart in one; nothing where they are in some.
pub(crate) fn remark(mesh: &VolumeMesh) -> Option<String> {
    let span = mesh.node_span();
    if mesh.nodes().len() <= FEW {
        return None;
    }
    let ordered = mesh.reordered().ok()?.mesh.node_span();
    let told = |span: f64| grouped(span.round() as usize);
    (span > TANGLED * ordered).then(|| {
        format!("numbers of a cell's nodes lie {} apart in the mean, where {} would do", told(span), told(ordered))
    })
}
