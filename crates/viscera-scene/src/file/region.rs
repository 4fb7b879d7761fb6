use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::quantity::Length;

/// A part of a body, in the coordinates of the scene: the name of a group of its mesh, "all", "surface", a shape, or a list of
/// regions, which means all of them together.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "region")]
pub enum RegionFile {
    /// A named group of the mesh, or "all", or "surface".
    Name(String),
    /// A shape.
    Shape(Box<RegionShape>),
    /// Several regions together.
    Union(#[schemars(length(min = 1))] Vec<RegionFile>),
}

/// A shape in space.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(title = "region")]
pub enum RegionShape {
    /// Everything in a box with sides along the axes.
    #[serde(rename_all = "kebab-case")]
    Box {
        /// Corner with the smallest coordinates [m].
        low: [Length; 3],
        /// Corner with the largest coordinates [m].
        high: [Length; 3],
    },
    /// Everything in a sphere.
    Sphere {
        /// Centre [m].
        centre: [Length; 3],
        /// Radius [m].
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Length,
    },
    /// Everything near a plane.
    Plane {
        /// A point of the plane [m].
        point: [Length; 3],
        /// Direction at a right angle to it; any length.
        normal: [f64; 3],
        /// Nodes up to half of it on either side belong to the region [m]; by default a millionth of the
        /// body's size.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        thickness: Option<Length>,
    },
    /// Everything on the side of a plane to which the normal points.
    HalfSpace {
        /// A point of the plane [m].
        point: [Length; 3],
        /// Direction into the region; any length.
        normal: [f64; 3],
    },
    /// The one node that is nearest to a place [m].
    Nearest([Length; 3]),
    /// A named group of the mesh, also where its name is that of a shape or "all".
    Group(String),
    /// Nodes by their numbers, from 0.
    Nodes(#[schemars(length(min = 1))] Vec<u32>),
    /// What lies in all of several regions.
    Intersection(#[schemars(length(min = 1))] Vec<RegionFile>),
}
