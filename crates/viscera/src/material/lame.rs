use super::MaterialError;

/// Isotropic stiffness: the two Lamé parameters [Pa].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lame {
    /// First Lamé parameter λ [Pa], > −2μ/3 (a positive bulk modulus).
    pub lambda: f64,
    /// Shear modulus μ [Pa], > 0.
    pub mu: f64,
}

impl Lame {
    /// E = 5 kPa, ν = 0.4: as soft as liver, and compressible enough for every element.
    pub(super) const EXAMPLE: Self = Self { lambda: 5e3 * 0.4 / (1.4 * 0.2), mu: 5e3 / 2.8 };

    /// From λ [Pa, > −2μ/3] and μ [Pa, > 0].
    ///
    /// # Errors
    /// [`MaterialError::OutOfRange`] where the tissue would have no stiffness against shear or compression.
    pub fn new(lambda: f64, mu: f64) -> Result<Self, MaterialError> {
        if !(mu.is_finite() && mu > 0.0) {
            return Err(MaterialError::OutOfRange { name: "mu", value: mu, range: "positive [Pa]", hint: "" });
        }
        if !(lambda.is_finite() && 3.0 * lambda + 2.0 * mu > 0.0) {
            let hint = ", so that the tissue resists compression";
            return Err(MaterialError::OutOfRange { name: "lambda", value: lambda, range: "above -2 mu/3 [Pa]", hint });
        }
        Ok(Self { lambda, mu })
    }

    /// From Young's modulus E [Pa, > 0] and Poisson's ratio ν [−1 < ν < 0.5].
    ///
    /// λ = Eν/((1+ν)(1−2ν)),  μ = E/(2(1+ν))
    ///
    /// # Errors
    /// [`MaterialError::OutOfRange`]; ν = 0.5 would make λ infinite.
    pub fn from_young_poisson(young: f64, poisson: f64) -> Result<Self, MaterialError> {
        if !(young.is_finite() && young > 0.0) {
            return Err(MaterialError::OutOfRange { name: "young", value: young, range: "positive [Pa]", hint: "" });
        }
        if !(poisson > -1.0 && poisson < 0.5) {
            let hint = if poisson == 0.5 {
                "; 0.5 makes lambda infinite: take 0.49 for nearly incompressible tissue"
            } else {
                "; soft tissue lies between 0.4 and 0.49"
            };
            return Err(MaterialError::OutOfRange {
                name: "poisson",
                value: poisson,
                range: "above -1 and below 0.5",
                hint,
            });
        }
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        Ok(Self { lambda, mu: young / (2.0 * (1.0 + poisson)) })
    }

    /// Young's modulus E = μ(3λ+2μ)/(λ+μ) [Pa].
    pub fn young(self) -> f64 {
        self.mu * (3.0 * self.lambda + 2.0 * self.mu) / (self.lambda + self.mu)
    }

    /// Poisson's ratio ν = λ/(2(λ+μ)).
    pub fn poisson(self) -> f64 {
        self.lambda / (2.0 * (self.lambda + self.mu))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn young_and_poisson_come_back_from_lambda_and_mu() {
        let lame = Lame::from_young_poisson(5e3, 0.45).unwrap();
        approx::assert_relative_eq!(lame.young(), 5e3, max_relative = 1e-14);
        approx::assert_relative_eq!(lame.poisson(), 0.45, max_relative = 1e-14);
    }

    #[test]
    fn incompressible_poisson_is_refused_with_advice() {
        let message = Lame::from_young_poisson(5e3, 0.5).unwrap_err().to_string();
        assert_eq!(
            message,
            "poisson = 0.5 is out of range: it must be above -1 and below 0.5; \
             0.5 makes lambda infinite: take 0.49 for nearly incompressible tissue"
        );
    }

    #[test]
    fn negative_and_nan_moduli_are_refused() {
        for young in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
            assert!(Lame::from_young_poisson(young, 0.3).is_err(), "young = {young}");
        }
        assert!(Lame::from_young_poisson(1.0, f64::NAN).is_err());
        assert!(Lame::new(-0.7, 1.0).is_err());
        assert!(Lame::new(-0.6, 1.0).is_ok());
    }
}
