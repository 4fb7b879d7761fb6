use super::{frame, scaled};
use crate::math::{Mat3, Real};

/// The rotation of a QR decomposition: Gram–Schmidt on the first two columns of F, the third axis by cross product.
///
/// Right-handed for every F, and dependent on the order of the columns: the first keeps its direction, whatever the
/// others do.
///
/// Source: Nesme, Marchal, Promayon, Chabanas, Payan, Faure (2005), section 3.
#[inline(always)]
pub fn qr<R: Real>(f: &Mat3<R>) -> Mat3<R> {
    let (f, _) = scaled(f);
    let [a, b, _] = f.columns;
    frame(a, b, a.x.like(1e-36))
}
