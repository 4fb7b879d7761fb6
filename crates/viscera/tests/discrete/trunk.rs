use viscera::mesh::{Region, TetMesh, VolumeMesh};

/// The ellipse's prism, cut in two by the dome: regions fill it and leave nothing out.
#[test]
fn a_trunk_is_an_abdomen_and_a_thorax_with_the_diaphragm_between_them() {
    let mesh = TetMesh::trunk(0.4, 0.03).unwrap();
    let volume = |name: &str| mesh.regions[name].cells.iter().map(|&cell| mesh.cell_volume(cell as usize)).sum::<f64>();
    let (abdomen, thorax) = (volume("abdomen"), volume("thorax"));
    assert!((0..mesh.cells.len()).all(|cell| mesh.cell_volume(cell) > 0.0));
    // π a b h less what the polygon cuts off; the dome of 0.16 h ⟨1 − ρ²⟩ = 0.08 h of it belongs to the abdomen.
    let prism = std::f64::consts::PI * (0.36 * 0.4) * (0.25 * 0.4) * 0.4;
    assert!(((abdomen + thorax) / prism - 1.0).abs() < 0.03, "{abdomen} m³ and {thorax} m³ of {prism} m³");
    assert!((abdomen / (abdomen + thorax) - 0.58).abs() < 0.01);
    let mesh = VolumeMesh::from(mesh);
    let nodes = |name: &str| Region::Named(name.into()).nodes(&mesh).unwrap();
    let top = nodes("diaphragm").into_iter().map(|node| mesh.nodes()[node as usize].z).fold(0.0, f64::max);
    assert!((top - (0.5 + 0.16) * 0.4).abs() < 1e-12, "the dome reaches {top} m");
    for ribs in ["ribs-1", "ribs-2", "ribs-3"] {
        let own = nodes(ribs);
        assert!(own.len() > 6 && own.iter().all(|node| !nodes("spine").contains(node)), "{ribs}: {own:?}");
    }
}
