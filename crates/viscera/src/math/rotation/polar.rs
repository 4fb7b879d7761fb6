use super::{scaled, svd};
use crate::math::{Mat3, Real, Sym3, Vec3};

/// The most Newton steps to the largest root of the quartic; from √3 down they leave roundings of it wherever
/// ζ > [`SMALLEST_ZETA`]. Tissue that is strained by less than a third needs two or three.
const ROOT_STEPS: usize = 8;

/// Least ζ = (σ1+σ2)(σ2+σ3)(σ3+σ1)/‖F‖³ for which the closed form is good; 1.54 at rest, 0.5 for stretches 1, 0.3, 0.1.
const SMALLEST_ZETA: f64 = 0.1;

/// The most steps of Newton's method for the polar factor; stretches from an eighth to eight take seven.
const POLAR_STEPS: usize = 7;

/// The rotation R of F = R S that maximises tr(RᵀF) over all rotations: the polar decomposition, with the axis of the
/// smallest stretch flipped where F is inverted, so that det R = +1.
///
/// Newton's method for the polar factor, X ← ½(X + cof X/det X) from F, without a memory. A stretch σ becomes ½(σ + 1/σ): after the first step
/// none is below 1, and det X − 1 bounds how far any is above it; the next step squares that. (Rounding makes det X negative where F is nearly
/// flat: such cells do not arrive.) Tissue that is strained by a fiftieth takes two steps in single precision, by a third four. Where a lane is
/// inverted, or stretched beyond what the steps reach, all lanes take their closed form.
///
/// Source: Higham, Computing the polar decomposition with applications (1986), section 3.
#[inline(always)]
pub fn polar<R: Real>(f: &Mat3<R>) -> Mat3<R> {
    let one = f.columns[0].x.like(1.0);
    let arrived = one.like(R::ROUNDING.sqrt());
    let (mut x, mut cofactor) = (*f, f.cofactor());
    let mut determinant = f.columns[0].dot(cofactor.columns[0]);
    if !R::all(one.zero_like().less_than(determinant)) {
        return closed(f);
    }
    for _ in 0..POLAR_STEPS {
        x = cofactor.mul_add(one.half() / determinant, x * one.half());
        cofactor = x.cofactor();
        determinant = x.columns[0].dot(cofactor.columns[0]);
        let beyond = determinant - one;
        if R::all(beyond.abs().less_than(arrived)) {
            // 1/(1 + d) = 1 − d + d², to the cube of a root of a rounding.
            let inverse = beyond.mul_add(beyond - one, one);
            return cofactor.mul_add(inverse.half(), x * one.half());
        }
    }
    closed(f)
}

/// The same in closed form, for every F.
///
/// With B = F/‖F‖, λ = max tr(RᵀB) is the largest root of
/// λ⁴ − 2λ² − 8λ det B + 1 − 4‖cof B‖², to which Newton's method falls monotonically from its bound √3, and
///
/// R = [(κ + 1) B + λ cof B − B BᵀB]/ζ,   κ = (λ² − 1)/2,   ζ = κλ − det B = (σ1+σ2)(σ2+σ3)(σ3+σ1)
///
/// One Newton step of the rotation itself then brings it to rounding. Where ζ is small the rotation hardly is defined
/// (σ3 ≈ −σ2: flat and inverted cells, or no second stretch), and lanes with such a cell take [`svd`].
///
/// Source: Markley (1993), *Attitude determination using vector observations: a fast optimal matrix algorithm*, for the
/// closed form; Kugelstadt, Koschier, Bender (2018), section 4, for the step.
#[inline(always)]
fn closed<R: Real>(f: &Mat3<R>) -> Mat3<R> {
    let (f, _) = scaled(f);
    let one = f.columns[0].x.like(1.0);
    let square = f.squared_norm();
    let null = square.less_than(one.half());
    let b = f * (one / R::select(null, one, square.sqrt()));

    let cofactor = b.cofactor();
    let determinant = b.columns[0].dot(cofactor.columns[0]);
    let slope = determinant * one.like(-8.0);
    let last = cofactor.squared_norm().mul_add(one.like(-4.0), one);
    let mut root = one.like(3.0).sqrt();
    for _ in 0..ROOT_STEPS {
        let reduced = root.mul_add(root, one.like(-2.0));
        let value = reduced.mul_add(root, slope).mul_add(root, last);
        let derivative = (reduced + one).mul_add(root * one.like(4.0), slope);
        let change = value / derivative;
        root -= change;
        // the error is about the square of the last change
        if !R::any(one.like(0.3 * R::ROUNDING.sqrt()).less_than(change.abs())) {
            break;
        }
    }
    let kappa = root.mul_add(root, -one).half();
    let zeta = kappa.mul_add(root, -determinant);
    let closed = (b * (kappa + one) + cofactor * root - b * b.gram()) * (one / zeta);
    let rotation = polished(closed, &b);

    // false for NaN, which a null F and a multiple root leave
    let good = one.like(SMALLEST_ZETA).less_than(zeta);
    if !R::all(good) {
        return Mat3::select(good, rotation, svd(&f).rotation());
    }
    rotation
}

/// One Newton step of the rotation: R (I + [w]×) with (tr S I − S) w = axis of RᵀB − BᵀR, made orthonormal.
#[inline(always)]
fn polished<R: Real>(r: Mat3<R>, b: &Mat3<R>) -> Mat3<R> {
    let turned = r.transpose() * *b;
    let w = spin(turned.symmetric_part(), turned.double_axis());
    let [x, y, z] = r.columns;
    let x = x + y * w.z - z * w.y;
    let y = y + z * w.x - r.columns[0] * w.z;
    let one = b.columns[0].x.like(1.0);
    let x = x * (one / x.norm());
    let y = y - x * x.dot(y);
    let y = y * (one / y.norm());
    Mat3::from_columns(x, y, x.cross(y))
}

/// w of (tr S I − S) w = a.
#[inline(always)]
fn spin<R: Real>(s: Sym3<R>, a: Vec3<R>) -> Vec3<R> {
    let matrix = Mat3::from(Sym3::diagonal(s.trace()) - s);
    let cofactor = matrix.cofactor();
    (cofactor * a) * (s.xx.like(1.0) / matrix.columns[0].dot(cofactor.columns[0]))
}

/// The derivative of [`polar`] along `df`: R [w]×, (tr S I − S) w = axis of Rᵀ dF − dFᵀ R, S = RᵀF.
///
/// Nothing where the rotation is hardly defined: ζ below 1e-6 ‖F‖³, or F so small that it counts as nothing.
#[inline(always)]
pub fn polar_along<R: Real>(f: &Mat3<R>, r: &Mat3<R>, df: &Mat3<R>) -> Mat3<R> {
    let (unit, scale) = scaled(f);
    let s = (r.transpose() * unit).symmetric_part();
    let w = spin(s, (r.transpose() * *df).double_axis() * (scale.like(1.0) / scale));
    let zeta = Mat3::from(Sym3::diagonal(s.trace()) - s).determinant();
    let size = unit.squared_norm();
    let defined = (size * size.sqrt() * scale.like(1e-6)).less_than(zeta);
    let w = Vec3::select(defined, w, w.zero_like());
    // Scaled, the largest entry is 1, or else F is nothing: then both sides of the comparison may have vanished.
    let w = Vec3::select(scale.like(0.5).less_than(size), w, w.zero_like());
    let [x, y, z] = r.columns;
    Mat3::from_columns(y * w.z - z * w.y, z * w.x - x * w.z, x * w.y - y * w.x)
}
