/// One parameter of a law: what scenes, pages and messages need to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name, a whole word.
    pub name: &'static str,
    /// SI unit; empty for a pure number.
    pub unit: &'static str,
    /// Where the value may lie.
    pub range: ParameterRange,
    /// What it does, in a few words.
    pub meaning: &'static str,
}

/// Where the value of a parameter may lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterRange {
    /// Any finite number.
    Any,
    /// Above zero.
    Positive,
}

impl Parameter {
    pub(super) const LAMBDA: Self =
        Self {
            name: "lambda", unit: "Pa", range: ParameterRange::Any, meaning: "first Lamé parameter, above -2 mu/3"
        };
    pub(super) const MU: Self =
        Self { name: "mu", unit: "Pa", range: ParameterRange::Positive, meaning: "shear modulus" };
    pub(super) const DIRECTION: [Self; 3] = {
        const fn component(name: &'static str) -> Parameter {
            Parameter { name, unit: "", range: ParameterRange::Any, meaning: "component of the unit fibre direction" }
        }
        [component("direction-x"), component("direction-y"), component("direction-z")]
    };
    pub(super) const FIBRE_STIFFNESS: Self = Self {
        name: "fibre-stiffness",
        unit: "Pa",
        range: ParameterRange::Any,
        meaning: "what the fibres add: (lambda_L - lambda)/2 + mu_L - mu",
    };
}
