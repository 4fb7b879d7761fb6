import * as THREE from 'three';
import { expect, test } from 'vitest';
import { DrawnInstrument } from '../../src/drawing/instrument';
import { jawShape } from '../../src/drawing/instrument-parts';
import type { FrameInstrument, SceneInstrument } from '../../src/engine/messages';

const SHAFT = { kind: 'shaft', radius: 0.0025, length: 0.3 } as const;
const JAW = { kind: 'jaw', radius: 0.0015, length: 0.02 } as const;

function described(manner: SceneInstrument['manner'], parts: SceneInstrument['parts']): SceneInstrument {
  return { instrument: 0, kind: 'tool', name: 'tool', scripted: false, manner, reach: 0.01, parts };
}

function told(parts: number[], trocar?: FrameInstrument['trocar']): FrameInstrument {
  return {
    instrument: 0,
    tip: [0.1, 0.2, 0.3],
    direction: [0, -1, 0],
    roll: 0,
    trigger: 0,
    active: false,
    holds: false,
    force: [0, 0, 0],
    torque: [0, 0, 0],
    parts: new Float32Array(parts),
    ...(trocar ? { trocar } : {}),
  };
}

/** Every corner that is drawn and throws a shadow, in the scene [m]. */
function solid(group: THREE.Object3D): THREE.Vector3[] {
  group.updateMatrixWorld(true);
  const corners: THREE.Vector3[] = [];
  group.traverseVisible((part) => {
    if (!(part instanceof THREE.Mesh) || !part.castShadow) return;
    const places = (part.geometry as THREE.BufferGeometry).getAttribute('position');
    for (let corner = 0; corner < places.count; corner++)
      corners.push(new THREE.Vector3().fromBufferAttribute(places, corner).applyMatrix4(part.matrixWorld));
  });
  return corners;
}

/** How far a point lies outside of the rods that tissue feels [m]. */
function outside(point: THREE.Vector3, parts: number[]): number {
  const distances: number[] = [];
  for (let first = 0; first < parts.length; first += 7) {
    const from = new THREE.Vector3().fromArray(parts, first);
    const to = new THREE.Vector3().fromArray(parts, first + 3);
    const nearest = new THREE.Line3(from, to).closestPointToPoint(point, true, new THREE.Vector3());
    distances.push(nearest.distanceTo(point) - parts[first + 6]!);
  }
  return Math.min(...distances);
}

test('what is drawn of a tool is what touches', () => {
  const hinge = [0.1, 0.22, 0.3];
  const shaft = [0.1, 0.52, 0.3, ...hinge, 0.0025];
  const jaws = [...hinge, 0.108, 0.2017, 0.3, 0.0015, ...hinge, 0.092, 0.2017, 0.3, 0.0015];
  for (const [manner, parts, rods] of [
    ['hold', [SHAFT, JAW, JAW], [...shaft, ...jaws]],
    ['burn', [SHAFT], shaft],
    ['push', [SHAFT], shaft],
  ] as const) {
    const drawn = new DrawnInstrument(described(manner, [...parts]));
    drawn.setFrame(told([...rods]));
    const corners = solid(drawn.group);
    // The ring that shows which tool is in hand stands out of its shaft by a fiftieth of its radius.
    for (const corner of corners) expect(outside(corner, [...rods])).toBeLessThan(0.021 * 0.0025);
    // And all of it is drawn: its ends, from one to the other.
    const heights = corners.map(({ y }) => y);
    expect(Math.max(...heights)).toBeCloseTo(0.52 + 0.0025, 4);
    expect(Math.min(...heights)).toBeCloseTo(manner === 'hold' ? 0.2017 - 0.0015 : 0.22 - 0.0025, 3);
    drawn.dispose();
  }
});

test('a tool that touches nothing is a field of light: no rod, no shadow', () => {
  const drawn = new DrawnInstrument(described('burn', []));
  drawn.setFrame(told([]));
  expect(solid(drawn.group)).toEqual([]);
  const field = new THREE.Box3().setFromObject(drawn.group.children[0]!);
  expect(field.min.y).toBeCloseTo(0.2 - 0.01, 4);
});

test('teeth of jaws stay within the rod and face one side', () => {
  const places = jawShape(0.0015, 0.02).getAttribute('position');
  let [highest, lowest] = [-Infinity, Infinity];
  for (let corner = 0; corner < places.count; corner++) {
    const behind = -places.getZ(corner);
    const end = Math.max(0, -behind, behind - 0.02);
    expect(Math.hypot(places.getX(corner), places.getY(corner), end)).toBeLessThan(0.0015 + 1e-8);
    if (behind > 0.001 && behind < 0.016) highest = Math.max(highest, places.getY(corner));
    lowest = Math.min(lowest, places.getY(corner));
  }
  expect(highest).toBeLessThan(0.8 * 0.0015);
  expect(lowest).toBeCloseTo(-0.0015, 8);
});

test('a trocar is drawn where it is, and only while there is one', () => {
  const drawn = new DrawnInstrument(described('push', [SHAFT]));
  const rods = [0.1, 0.5, 0.3, 0.1, 0.2, 0.3, 0.0025];
  const collar = drawn.group.children.at(-1)!;
  drawn.setFrame(told(rods));
  expect(collar.visible).toBe(false);
  drawn.setFrame(told(rods, [0.1, 0.4, 0.3]));
  expect(collar.visible).toBe(true);
  expect(collar.position.toArray()).toEqual([0.1, 0.4, 0.3]);
  // Its sleeve points to the tip.
  expect(collar.getWorldDirection(new THREE.Vector3()).y).toBeCloseTo(-1, 6);
});
