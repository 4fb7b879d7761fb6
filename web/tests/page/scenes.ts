/** Small scenes, so that a step takes a millisecond also where everything is slow. Axes as in every scene: y up, metres. */

const BODY = `
[body.block]
mesh = { generate = "box", size = [0.12, 0.04, 0.04], cells = [9, 3, 3] }
density = 1000
damping = "4 1/s"
law = { kind = "stable-neo-hookean", young = "4 kPa", poisson = 0.4 }
model = { kind = "total-lagrangian" }
fix = { plane = { point = [0, 0, 0], normal = [-1, 0, 0] } }
`;

/** A block held at its left end, with a grasper and a cautery beside it. */
export const BLOCK = `title = "A block"
duration = "10 s"
step = "10 ms"
gravity = [0, -1, 0]
output = { camera = { look = [-0.1, -0.3, -1] } }
${BODY}
[instrument.grasper]
kind = "grasper"
radius = "1 cm"
path = [["0 s", [0.11, 0.09, 0.06]]]

[instrument.cautery]
kind = "cautery"
radius = "8 mm"
path = [["0 s", [0.03, 0.09, 0.06]]]
`;
