use viscera::mesh::Point;

/// Values at nodes or cells, for ParaView to colour or to warp by.
#[derive(Clone, Debug, PartialEq)]
pub struct Field<'a> {
    /// Name, with its unit where it has one.
    pub name: &'a str,
    /// Values for each node or cell: 1 for a scalar, 3 for a vector, 9 for a tensor (row by row).
    pub components: usize,
    /// All values, those of one node or cell together.
    pub values: Values<'a>,
}

/// The numbers of a field.
#[derive(Clone, Debug, PartialEq)]
pub enum Values<'a> {
    /// Single precision.
    F32(&'a [f32]),
    /// Double precision.
    F64(&'a [f64]),
    /// Labels and counts.
    I32(&'a [i32]),
    /// Vectors, three components each.
    Vectors(&'a [Point]),
}

impl<'a> Field<'a> {
    /// One number for each node or cell.
    pub fn scalar(name: &'a str, values: &'a [f64]) -> Self {
        Self { name, components: 1, values: Values::F64(values) }
    }

    /// One vector for each node or cell.
    pub fn vector(name: &'a str, values: &'a [Point]) -> Self {
        Self { name, components: 3, values: Values::Vectors(values) }
    }

    /// One label for each node or cell, such as the number of a material.
    pub fn label(name: &'a str, values: &'a [i32]) -> Self {
        Self { name, components: 1, values: Values::I32(values) }
    }
}

impl Values<'_> {
    /// How many numbers there are.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::F64(values) => values.len(),
            Self::I32(values) => values.len(),
            Self::Vectors(values) => 3 * values.len(),
        }
    }

    /// VTK's name of the type.
    pub(super) fn type_name(&self) -> &'static str {
        match self {
            Self::F32(_) => "Float32",
            Self::F64(_) | Self::Vectors(_) => "Float64",
            Self::I32(_) => "Int32",
        }
    }

    /// The numbers as bytes, lowest byte first.
    pub(super) fn bytes(&self) -> Vec<u8> {
        match self {
            Self::F32(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::F64(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::I32(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::Vectors(values) => {
                values.iter().flat_map(|value| value.to_array()).flat_map(f64::to_le_bytes).collect()
            }
        }
    }
}
