//! How instruments look: their rigid parts as they are; where only a tip is simulated, a shaft that comes from above and in front, and at
//! its tip jaws or a hook, which show where it is held from.

use viscera::mesh::Point;
use viscera_io::picture::{Colour, Solid, Tool};

use super::moment::ToolPose;

/// Radius of a shaft, as a part of the size of the scene: 6 mm across beside a liver of 30 cm.
const SHAFT: f64 = 0.008;

/// The solids of an instrument. `towards` leads from the tip to the hand, of length 1; `size` is that of the scene [m].
pub(super) fn solids(tool: &ToolPose, towards: Point, size: f64) -> Vec<Solid> {
    let radius = SHAFT * size;
    // A grasper takes tissue between its jaws, all around its tip: the jaws are shown as long as they reach.
    let neck = tool.tip + towards * tool.reach.clamp(2.0 * radius, 8.0 * radius);
    let hand = tool.tip + towards * (0.6 * size);
    let rod = |from: Point, to: Point, start: f64, end: f64| Tool::tapered(from.to_array(), to.to_array(), start, end);
    let shaft = rod(neck, hand, radius, radius);
    if !tool.parts.is_empty() {
        let hot = Colour::new(255, 150, 60);
        let colour = |solid: Solid| if tool.active && tool.kind == "cautery" { solid.colour(hot) } else { solid };
        return tool.parts.iter().map(|&(from, to, radius)| colour(rod(from, to, radius, radius))).collect();
    }
    match &*tool.kind {
        "cautery" => {
            let colour = if tool.active { Colour::new(255, 150, 60) } else { Colour::STEEL };
            let sleeve = rod(neck, hand, radius, radius).colour(Colour::new(60, 64, 70));
            vec![sleeve, rod(tool.tip, neck, 0.5 * radius, 0.5 * radius), tip(tool, radius, colour)]
        }
        "grasper" => {
            let across = side(towards) * if tool.active { 0.5 * radius } else { 2.2 * radius };
            let jaw = |offset: Point| rod(tool.tip + offset, neck, 0.45 * radius, 0.8 * radius);
            vec![shaft, jaw(across), jaw(-across)]
        }
        _ => vec![shaft, rod(tool.tip, neck, 0.5 * radius, radius)],
    }
}

fn tip(tool: &ToolPose, radius: f64, colour: Colour) -> Solid {
    Tool::sphere(tool.tip.to_array(), radius).colour(colour)
}

/// A direction across another one.
fn side(along: Point) -> Point {
    let other = if along.x.abs() < 0.7 { Point::new(1.0, 0.0, 0.0) } else { Point::new(0.0, 0.0, 1.0) };
    along.cross(other).normalized().unwrap_or(other)
}
