import * as THREE from 'three';
import { expect, test } from 'vitest';
import { Stage } from '../../src/drawing/stage';
import type { Scene, Surface } from '../../src/engine/messages';

/** A tetrahedron 0.4 m high and 0.1 m across. */
const TALL = [0.05, -0.2, 0, -0.05, -0.2, 0, 0, -0.2, 0.1, 0, 0.2, 0];

const scene = {
  type: 'scene',
  epoch: 1,
  name: 'tall',
  radius: 0.2,
  bodies: [{ name: 'tall', cells: 1, nodes: 4, vertices: 4, law: '', model: '' }],
  instruments: [],
} as unknown as Scene;

const surface: Surface = {
  type: 'surface',
  scene: 1,
  body: 0,
  epoch: 0,
  vertices: 4,
  triangles: new Uint32Array([0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0]),
  cut: new Uint8Array(4),
  rest: new Float32Array(TALL),
};

test('what is tall is seen from foot to head', () => {
  const stage = new Stage();
  stage.setScene(scene, false);
  const [centre, look, up] = [
    new THREE.Vector3(),
    new THREE.Vector3(0, 0, -1),
    new THREE.Vector3(0, 1, 0),
  ] as const;
  expect(stage.distanceToSee(centre, look, up, 0.25)).toBe(0);
  stage.setSurface(surface);
  // 0.2 m at a slope of a quarter, from the corner that is 0.1 m nearer.
  expect(stage.distanceToSee(centre, look, up, 0.25)).toBeCloseTo(0.8 + 0.1, 6);
});
