use super::{LawFamily, LawKind, LawVisitor, MaterialError, QuadraticLaw, RestStiffness};

/// A law with its parameters, the same everywhere or one set for each cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Tissue {
    kind: LawKind,
    /// Parameter values, law after law; one law, or one for each cell.
    values: Vec<f64>,
    stride: usize,
    uniform: bool,
}

impl Tissue {
    /// The same law in every cell.
    pub fn uniform<L: LawFamily>(law: L) -> Self {
        Self { values: law.values(), stride: L::PARAMETERS.len(), uniform: true, kind: law.into() }
    }

    /// One law for each cell, in the order of the mesh's cells.
    ///
    /// # Errors
    /// [`MaterialError::WrongCount`] for an empty list; a list of another length than the mesh is found when the body
    /// is built.
    pub fn per_cell<L: LawFamily>(laws: &[L]) -> Result<Self, MaterialError> {
        let first = *laws.first().ok_or(MaterialError::WrongCount { given: 0, cells: 1 })?;
        Ok(Self {
            kind: first.into(),
            values: laws.iter().flat_map(LawFamily::values).collect(),
            stride: L::PARAMETERS.len(),
            uniform: false,
        })
    }

    /// The law.
    pub fn kind(&self) -> LawKind {
        self.kind
    }

    /// Whether every cell has the same parameters.
    pub fn is_uniform(&self) -> bool {
        self.uniform
    }

    /// Parameter values of the law in `cell`.
    pub fn values(&self, cell: usize) -> &[f64] {
        let law = if self.is_uniform() { 0 } else { cell };
        &self.values[law * self.stride..(law + 1) * self.stride]
    }

    /// The tissue of these cells, in their order.
    pub(crate) fn of_cells(&self, cells: &[u32]) -> Self {
        if self.uniform {
            return self.clone();
        }
        let values = cells.iter().flat_map(|&cell| self.values(cell as usize)).copied().collect();
        Self { values, ..self.clone() }
    }

    /// λ, μ, fibres of the law in `cell` at rest.
    pub fn at_rest(&self, cell: usize) -> RestStiffness {
        struct AtRest<'a>(&'a [f64]);
        impl LawVisitor for AtRest<'_> {
            type Output = RestStiffness;
            fn visit<L: LawFamily>(self) -> RestStiffness {
                L::from_values(self.0).at_rest()
            }
        }
        self.kind.visit(AtRest(self.values(cell)))
    }

    /// The law in `cell` as a quadratic one, if it is.
    pub fn quadratic(&self, cell: usize) -> Option<QuadraticLaw> {
        struct Quadratic<'a>(&'a [f64]);
        impl LawVisitor for Quadratic<'_> {
            type Output = Option<QuadraticLaw>;
            fn visit<L: LawFamily>(self) -> Option<QuadraticLaw> {
                L::from_values(self.0).quadratic()
            }
        }
        self.kind.visit(Quadratic(self.values(cell)))
    }

    /// Checks that there is one law, or one for each of `cells` cells.
    ///
    /// # Errors
    /// [`MaterialError::WrongCount`].
    pub fn check_count(&self, cells: usize) -> Result<(), MaterialError> {
        let given = self.values.len() / self.stride;
        if self.is_uniform() || given == cells { Ok(()) } else { Err(MaterialError::WrongCount { given, cells }) }
    }
}
