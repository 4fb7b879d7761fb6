use super::{World, WorldError};
use crate::body::{NodeMotion, SimulatedBody};
use crate::math::Scalar;

/// The largest number of steps up to which time is exact.
const MOST_STEPS: f64 = (1_u64 << f64::MANTISSA_DIGITS) as f64;

impl<T: Scalar> World<T> {
    /// Goes on from where `other` is: this world was built anew with another law, model, integrator, step or precision, and takes over
    /// places, velocities, cuts, instruments with what they hold and who leads them, and the time, to the nearest step.
    ///
    /// ```
    /// use viscera::body::Body;
    /// use viscera::material::{StVenantKirchhoff, Tissue};
    /// use viscera::mesh::TetMesh;
    /// use viscera::model::TensorMass;
    /// use viscera::world::{World, WorldConfig};
    ///
    /// let world = |young: f64| -> Result<World<f64>, Box<dyn std::error::Error>> {
    ///     let tissue = Tissue::uniform(StVenantKirchhoff::from_young_poisson(young, 0.4)?); // Pa
    ///     let mut world = World::new(WorldConfig::default())?;
    ///     world.add(Body::new(TetMesh::box_grid([1, 1, 1], [0.1; 3]), 1000.0).model(TensorMass::new(tissue)))?;
    ///     Ok(world)
    /// };
    /// let mut soft = world(5e3)?;
    /// soft.step()?;
    /// let mut stiff = world(10e3)?;
    /// stiff.continue_from(&soft)?;
    /// assert_eq!(stiff.time(), soft.time());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`WorldError::ForeignSnapshot`] for a world with other instruments or another number of bodies; [`WorldError::OtherMesh`] where a
    /// body has another mesh. Nothing is changed.
    pub fn continue_from<U: Scalar>(&mut self, other: &World<U>) -> Result<(), WorldError> {
        let there = |(own, of): (&Option<_>, &Option<_>)| own.is_some() == of.is_some();
        if self.bodies.len() != other.bodies.len()
            || self.instruments.len() != other.instruments.len()
            || !self.instruments.iter().zip(&other.instruments).all(there)
        {
            return Err(WorldError::ForeignSnapshot);
        }
        let differs = |(body, of): &(&SimulatedBody<T>, &SimulatedBody<U>)| !body.has_mesh_of(of);
        if let Some((body, _)) = self.bodies.iter().zip(&other.bodies).find(differs) {
            return Err(WorldError::OtherMesh { body: body.name().into() });
        }
        // A step so short that the past has no number in it begins to count anew from the largest that is exact.
        self.steps = (other.time() / self.config.step).round().min(MOST_STEPS) as u64;
        for (body, of) in self.bodies.iter_mut().zip(&other.bodies) {
            body.continue_from(of);
        }
        self.tools.clone_from(&other.tools);
        self.reserve_for_tools();
        Ok(())
    }
}

impl<T: Scalar> SimulatedBody<T> {
    fn has_mesh_of<U: Scalar>(&self, other: &SimulatedBody<U>) -> bool {
        // Named regions may differ: they have done their work.
        let (mesh, of) = (&self.mesh, &other.mesh);
        let cells = mesh.cell_count();
        mesh.nodes() == of.nodes()
            && cells == of.cell_count()
            && (0..cells).all(|cell| mesh.cell(cell) == of.cell(cell))
    }

    fn continue_from<U: Scalar>(&mut self, other: &SimulatedBody<U>) {
        // Cut by cut, so that tables from which cells are subtracted keep the roundings of that order.
        for cells in other.state.removals.cuts() {
            self.remove_cells(&mut cells.to_vec());
        }
        let (state, of) = (&mut self.state, &other.state);
        for node in 0..state.positions.len() {
            state.positions[node] = of.positions[node].cast::<f64>().cast();
            state.velocities[node] = of.velocities[node].cast::<f64>().cast();
            if let held @ NodeMotion::Held(_) = of.motions[node]
                && state.motions[node] == NodeMotion::Free
            {
                state.motions[node] = held;
                state.grips[node] = of.grips[node].cast::<f64>().cast();
            }
        }
        let cast = |values: &[U]| values.iter().map(|value| T::from_f64(value.to_f64())).collect();
        (state.heat, state.seared) = (cast(&of.heat), cast(&of.seared));
        state.tractions.clone_from(&of.tractions);
        if state.volumes.len() == of.volumes.len() {
            state.volumes.clone_from(&of.volumes);
        }
        state.past.is_known = false;
        state.positions_changed();
        self.update_skin();
    }
}
