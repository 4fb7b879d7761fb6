//! Numbers with a unit, as they stand in a scene file: a TOML number is SI, a string carries its unit.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::unit::{self, Dimension};

macro_rules! quantities {
    ($($name:ident = $dimension:ident, $doc:literal;)+) => { $(
        #[doc = $doc]
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
        pub struct $name(pub f64);

        impl Quantity for $name {
            const DIMENSION: &'static Dimension = &unit::$dimension;
            fn si(self) -> f64 {
                self.0
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
                source.deserialize_any(NumberOrText(&unit::$dimension)).map(Self)
            }
        }

        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, target: S) -> Result<S::Ok, S::Error> {
                target.serialize_f64(self.0)
            }
        }

        impl JsonSchema for $name {
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }
            fn inline_schema() -> bool {
                true
            }
            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!({
                    "type": ["number", "string"],
                    "pattern": unit::$dimension.pattern(),
                    "x-dimension": unit::$dimension.name,
                })
            }
        }
    )+ };
}

/// A number of one dimension.
pub trait Quantity: Copy {
    /// What is measured.
    const DIMENSION: &'static Dimension;
    /// The value in SI.
    fn si(self) -> f64;
}

quantities! {
    Length = LENGTH, "A length [m].";
    Time = TIME, "A time [s].";
    Density = DENSITY, "A density [kg/m³].";
    Pressure = PRESSURE, "A pressure, stress or stiffness [Pa].";
    Stiffness = STIFFNESS, "A stiffness of a spring or a membrane [N/m].";
    Force = FORCE, "A force [N].";
    ForceDensity = FORCE_DENSITY, "A force for each volume [N/m³].";
    Acceleration = ACCELERATION, "An acceleration [m/s²].";
    Angle = ANGLE, "An angle [rad].";
    Rate = RATE, "A rate [1/s].";
    Power = POWER, "A power [W].";
    EnergyDensity = ENERGY_DENSITY, "An energy for each volume [J/m³].";
}

struct NumberOrText(&'static Dimension);

impl Visitor<'_> for NumberOrText {
    type Value = f64;

    fn expecting(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(formatter, "{} (number in {} or string with a unit)", self.0.with_article(), self.0.si())
    }
    fn visit_f64<E: Error>(self, value: f64) -> Result<f64, E> {
        Ok(value)
    }
    fn visit_i64<E: Error>(self, value: i64) -> Result<f64, E> {
        Ok(value as f64)
    }
    fn visit_u64<E: Error>(self, value: u64) -> Result<f64, E> {
        Ok(value as f64)
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<f64, E> {
        self.0.parse(text).map_err(E::custom)
    }
}
