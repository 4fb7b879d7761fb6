use crate::setting::{finite, positive_and_finite};
use crate::{Matrix, SettingError, Vector};

/// How the frame of a device lies in the scene: x_scene = origin + scale · R x_device, F_device = force · Rᵀ F_scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Workspace {
    /// Where the origin of the device is in the scene [m].
    pub origin: Vector,
    /// Axes of the device in the scene, as columns: R.
    pub rotation: Matrix,
    /// Metres in the scene for a metre of the hand [> 0]: below 1 for fine work.
    pub scale: f64,
    /// Newtons at the hand for a newton in the scene [> 0]: above 1 for tissue too soft to be felt.
    pub force: f64,
}

impl Default for Workspace {
    /// The scene's frame is the device's, and hand and tissue feel the same force.
    fn default() -> Self {
        Self { origin: Vector::ZERO, rotation: Matrix::IDENTITY, scale: 1.0, force: 1.0 }
    }
}

impl Workspace {
    /// # Errors
    /// [`SettingError`].
    pub fn check(&self) -> Result<(), SettingError> {
        positive_and_finite("workspace.scale", self.scale)?;
        positive_and_finite("workspace.force", self.force)?;
        let off = (self.rotation.transpose() * self.rotation - Matrix::IDENTITY).squared_norm().sqrt();
        // Axes written down with six digits still pass.
        if off.is_nan() || off > 1e-5 || self.rotation.determinant() < 0.0 {
            return Err(SettingError::NotARotation);
        }
        finite("workspace.origin", self.origin.squared_norm())
    }

    /// A place of the device in the scene [m].
    pub fn to_scene(&self, position: Vector) -> Vector {
        self.origin + self.turn(position) * self.scale
    }

    /// A direction of the device in the scene.
    pub fn turn(&self, direction: Vector) -> Vector {
        self.rotation * direction
    }

    /// A force of the scene at the hand [N].
    pub fn to_hand(&self, force: Vector) -> Vector {
        self.rotation.transpose_mul(force) * self.force
    }

    /// A stiffness at the hand, in the scene [N/m]: the hand feels `force` · `scale` times that of the scene.
    pub fn stiffness_in_scene(&self, at_hand: f64) -> f64 {
        at_hand / (self.force * self.scale)
    }
}
