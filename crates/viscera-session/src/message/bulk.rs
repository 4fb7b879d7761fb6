//! Arrays of numbers as the bytes of one `bin`: little-endian, no copy of each number by the encoder.

use std::fmt;

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

macro_rules! bulk {
    ($($name:ident of $number:ty, $doc:literal;)+) => {$(
        #[doc = $doc]
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct $name(pub Vec<$number>);

        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, target: S) -> Result<S::Ok, S::Error> {
                let bytes: Vec<u8> = self.0.iter().flat_map(|number| number.to_le_bytes()).collect();
                target.serialize_bytes(&bytes)
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
                struct Numbers;
                impl Visitor<'_> for Numbers {
                    type Value = $name;
                    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                        write!(formatter, "binary data, {} bytes to a number", size_of::<$number>())
                    }
                    fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<$name, E> {
                        let (numbers, rest) = bytes.as_chunks();
                        match rest {
                            [] => Ok($name(numbers.iter().map(|bytes| <$number>::from_le_bytes(*bytes)).collect())),
                            _ => Err(E::invalid_length(bytes.len(), &self)),
                        }
                    }
                }
                source.deserialize_bytes(Numbers)
            }
        }
    )+};
}

bulk! {
    F32s of f32, "Single-precision numbers.";
    U32s of u32, "Whole numbers.";
    Bytes of u8, "Bytes.";
}
