/**
 * A small scene, so that a step takes a millisecond also where everything is slow: a block held at its left end, 12 cm long, that
 * sags by about 1.5 cm. Tools are brought in by the tests, as a person would.
 */
export const BLOCK = `title = "A block"
duration = "10 s"
step = "10 ms"
gravity = [0, -0.3, 0]
output = { camera = { look = [-0.1, -0.3, -1] } }

[body.block]
mesh = { generate = "box", size = [0.12, 0.04, 0.04], cells = [9, 3, 3] }
density = 1000
damping = "4 1/s"
law = { kind = "stable-neo-hookean", young = "4 kPa", poisson = 0.4 }
model = { kind = "total-lagrangian" }
fix = "x-min"
`;
