/// A setting that makes no sense.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettingError {
    /// A number is out of its range: of the channel's settings, or of a device's rating.
    #[error("{name} = {value} is out of range: it must be {range}")]
    OutOfRange {
        /// Which.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        range: &'static str,
    },
    /// The axes of the workspace are not those of a turned frame.
    #[error("workspace.rotation is no rotation: its columns must be unit vectors, at right angles and right-handed")]
    NotARotation,
}

/// Refuses a number that is not above zero; infinity is above it.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), SettingError> {
    check(name, value, value > 0.0, "positive")
}

/// Refuses a number below zero.
pub(crate) fn not_negative(name: &'static str, value: f64) -> Result<(), SettingError> {
    check(name, value, value >= 0.0, "zero or positive")
}

/// Refuses what is not positive, or has no end.
pub(crate) fn positive_and_finite(name: &'static str, value: f64) -> Result<(), SettingError> {
    check(name, value, value > 0.0 && value.is_finite(), "positive and finite")
}

/// Refuses infinity, and what is no number.
pub(crate) fn finite(name: &'static str, value: f64) -> Result<(), SettingError> {
    check(name, value, value.is_finite(), "finite")
}

fn check(name: &'static str, value: f64, holds: bool, range: &'static str) -> Result<(), SettingError> {
    if holds { Ok(()) } else { Err(SettingError::OutOfRange { name, value, range }) }
}
