//! Pre-computed bodies and bodies with a pre-computed part: their responses, what these are kept as, and how they live in a world.

mod hybrid;
mod kept;
mod refusals;
mod responses;
mod rest;
mod support;
mod tools;
