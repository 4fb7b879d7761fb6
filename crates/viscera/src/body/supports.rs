//! What holds a body, from the regions that a user gave.

use super::simulated::free_directions;
use super::{Body, BodyError, Guides, NodeMotion};
use crate::curve::Curve;
use crate::executor::Executor;
use crate::math::{Scalar, Vec3};
use crate::mesh::{Region, VolumeMesh};
use crate::model::precomputed::{Responses, Supports};
use crate::solver::{Filter, LinearSolver};

/// A region whose nodes move along a normal.
pub(super) type Guided = (Region, [f64; 3], Curve<f64>);

impl Body {
    /// Computes the responses of the body for the model [`Precomputed`](crate::model::Precomputed), off-line: on the threads of `executor`,
    /// with `progress` told how many handles are done, of how many. They may be kept as bytes and given to the model of an equal body.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use viscera::body::Body;
    /// use viscera::executor::Executor;
    /// use viscera::material::{LinearElastic, Tissue};
    /// use viscera::mesh::{Region, TetMesh};
    /// use viscera::model::Precomputed;
    /// use viscera::solver::Envelope;
    /// use viscera::world::{World, WorldConfig};
    ///
    /// let tissue = Tissue::uniform(LinearElastic::from_young_poisson(10e3, 0.4)?); // Pa
    /// let bar = || {
    ///     Body::new(TetMesh::box_grid([2, 2, 6], [0.1, 0.1, 0.3]), 1000.0)
    ///         .model(Precomputed::new(tissue.clone()))
    ///         .fix(Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0))
    /// };
    /// let responses = Arc::new(bar().precompute(&mut Envelope::default(), &Executor::serial(), &|_, _| ())?);
    /// let mut world = World::<f64>::new(WorldConfig { gravity: [0.0, -0.1, 0.0], ..WorldConfig::default() })?;
    /// let bar = world.add(bar().model(Precomputed::new(tissue.clone()).responses(responses)))?;
    /// world.step()?;
    /// // It rests at once: what fixes it carries its weight of 0.3 N.
    /// assert!((world.observe(bar).reaction.y - 0.3).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BodyError`] where the body makes no sense, nothing holds it, or its tissue is not linear.
    pub fn precompute(
        &self,
        solver: &mut dyn LinearSolver,
        executor: &Executor,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Responses, BodyError> {
        let body = || self.name.clone();
        let recipe = self.model.as_ref().ok_or_else(|| BodyError::NoModel { body: body() })?;
        let (guides, motions) = motions(&self.name, &self.mesh, &self.fixed, &self.prescribed, self.guided.clone())?;
        let filters = filters(&guides, &motions);
        let supports = Supports { mesh: &self.mesh, filters: &filters };
        let computed = Responses::compute(recipe.tissue(), &supports, solver, executor, progress);
        computed.map_err(|source| BodyError::Model { body: body(), source })
    }
}

/// How each node moves, and along which guides. Where regions overlap, fixed ones count before prescribed ones, and these before guides.
pub(super) fn motions(
    body: &str,
    mesh: &VolumeMesh,
    fixed: &[Region],
    prescribed: &[(Region, Curve<Vec3<f64>>)],
    guided: Vec<Guided>,
) -> Result<(Guides, Vec<NodeMotion>), BodyError> {
    let (guides, guide_at_nodes) = Guides::new(body, guided, mesh)?;
    let motion = |guide: Option<u32>| guide.map_or(NodeMotion::Free, NodeMotion::Guided);
    let mut motions: Vec<_> = guide_at_nodes.into_iter().map(motion).collect();
    let mut mark = |region: &Region, motion, purpose| {
        let error = |source| BodyError::Region { body: body.into(), purpose, source: Box::new(source) };
        let nodes = region.nodes(mesh).map_err(error)?;
        nodes.into_iter().for_each(|node| motions[node as usize] = motion);
        Ok(())
    };
    for (number, (region, _)) in prescribed.iter().enumerate() {
        mark(region, NodeMotion::Prescribed(number as u32), "a prescribed motion")?;
    }
    for region in fixed {
        mark(region, NodeMotion::Fixed, "a fixed region")?;
    }
    Ok((guides, motions))
}

/// The directions in which forces move each node.
pub(super) fn filters<T: Scalar>(guides: &Guides, motions: &[NodeMotion]) -> Vec<Filter<T>> {
    motions.iter().map(|&motion| free_directions(guides, motion)).collect()
}
