import * as THREE from 'three';

const DOWN = new THREE.Vector3(0, -1, 0);

/**
 * The turn of an instrument: from its own frame, where the shaft comes along +z and the jaws open along y, to the scene. As in
 * the engine, a tool that points down opens along x, its roll turns it from x to z, and from there it swings the shortest way.
 */
export function orientation(direction: THREE.Vector3, roll: number): THREE.Quaternion {
  const [cos, sin] = [Math.cos(roll), Math.sin(roll)];
  const across = new THREE.Vector3(cos, 0, sin);
  const frame = new THREE.Matrix4().makeBasis(new THREE.Vector3().crossVectors(across, DOWN), across, DOWN);
  const heading = direction.lengthSq() > 0 ? direction.clone().normalize() : DOWN;
  const swing = new THREE.Quaternion();
  // Straight up every turn is as short as any other; the engine turns about x.
  if (heading.y > 1 - 1e-12) swing.set(1, 0, 0, 0);
  else swing.setFromUnitVectors(DOWN, heading);
  return swing.multiply(new THREE.Quaternion().setFromRotationMatrix(frame));
}
