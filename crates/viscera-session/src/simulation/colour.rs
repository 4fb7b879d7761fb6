//! What vertices are coloured by.

use viscera::body::{NodeMotion, SimulatedBody};
use viscera::math::Scalar;

/// What vertices are coloured by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Colouring {
    #[default]
    None,
    Displacement,
    VonMises,
    VolumeChange,
    AdaptiveMode,
}

impl Colouring {
    pub(crate) const ALL: [Self; 5] =
        [Self::None, Self::Displacement, Self::VonMises, Self::VolumeChange, Self::AdaptiveMode];

    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|colouring| colouring.name() == name)
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Displacement => "displacement",
            Self::VonMises => "von-mises",
            Self::VolumeChange => "volume-change",
            Self::AdaptiveMode => "adaptive-mode",
        }
    }

    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::None => "Tissue",
            Self::Displacement => "Displacement",
            Self::VonMises => "Von Mises stress",
            Self::VolumeChange => "Volume change",
            Self::AdaptiveMode => "Linear / non-linear",
        }
    }

    pub(crate) fn unit(self) -> &'static str {
        match self {
            Self::Displacement => "m",
            Self::VonMises => "Pa",
            Self::None | Self::VolumeChange | Self::AdaptiveMode => "",
        }
    }

    pub(crate) fn summary(self) -> &'static str {
        match self {
            Self::None => "the tissue itself",
            Self::Displacement => "distance from the place at rest",
            Self::VonMises => "√(3/2 dev σ : dev σ), how hard the shape is strained; mean of the cells at each node",
            Self::VolumeChange => "(V − V0)/V0 of the cells at each node",
            Self::AdaptiveMode => "1 where the full law acts, 0 where its linear part is enough",
        }
    }

    /// The ends of the scale that these numbers, and nothing before them, would have.
    pub(crate) fn range(self, scalars: impl Iterator<Item = f32>) -> (f64, f64) {
        let largest = scalars.map(|scalar| f64::from(scalar.abs())).fold(0.0, f64::max);
        match self {
            Self::None | Self::AdaptiveMode => (0.0, 1.0),
            Self::Displacement | Self::VonMises => (0.0, largest),
            Self::VolumeChange => (-largest, largest),
        }
    }
}

/// The numbers of a colouring at these nodes; none where it has none.
pub(super) fn nodal_scalars<T: Scalar>(body: &SimulatedBody<T>, by: Colouring, nodes: &[u32]) -> Option<Vec<f32>> {
    let displacement = |node: usize| body.positions()[node].cast::<f64>() - body.mesh().nodes()[node];
    Some(match by {
        Colouring::None => return None,
        Colouring::Displacement => nodes.iter().map(|&node| displacement(node as usize).norm() as f32).collect(),
        Colouring::VonMises => mean_of_cells(body, nodes, |cell| body.von_mises_stress(cell)),
        Colouring::VolumeChange => mean_of_cells(body, nodes, |cell| body.volume_ratio(cell) - 1.0),
        Colouring::AdaptiveMode => {
            let model = &body.state().models[0];
            let nonlinear = |node: u32| model.is_nonlinear_at(displacement(node as usize).cast());
            nodes.iter().map(|&node| f32::from(u8::from(nonlinear(node)))).collect()
        }
    })
}

/// The mean of what the cells at each node have, those that are left.
fn mean_of_cells<T: Scalar>(body: &SimulatedBody<T>, nodes: &[u32], of_cell: impl Fn(usize) -> f64) -> Vec<f32> {
    let state = body.state();
    let mut sums = vec![(0.0, 0_u32); state.positions.len()];
    for cell in (0..body.mesh().cell_count()).filter(|&cell| !state.removed[cell]) {
        let value = of_cell(cell);
        for &node in body.mesh().cell(cell) {
            let (sum, count) = &mut sums[node as usize];
            *sum += value;
            *count += 1;
        }
    }
    let mean = |&node: &u32| match sums[node as usize] {
        (sum, count) if count > 0 && state.motions[node as usize] != NodeMotion::Retired => {
            (sum / f64::from(count)) as f32
        }
        _ => 0.0,
    };
    nodes.iter().map(mean).collect()
}
