//! Discrete bodies: nets of springs, nodes that remember their shape, volumes that are kept exactly, rigid parts, muscles,
//! actuators, fields of force.

mod actuator;
mod exact_volume;
mod field;
mod mass_spring;
mod muscle;
mod rigid_part;
mod shape_memory;
mod support;
mod trunk;
