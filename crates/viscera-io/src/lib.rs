//! Meshes in, results and pictures out: part of [Viscera](viscera).

pub mod picture;
