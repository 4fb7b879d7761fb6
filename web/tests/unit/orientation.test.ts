import { Vector3 } from 'three';
import { expect, test } from 'vitest';
import { orientation } from '../../src/drawing/orientation';

const turned = (axis: [number, number, number], direction: [number, number, number], roll: number) =>
  new Vector3(...axis).applyQuaternion(orientation(new Vector3(...direction), roll)).toArray();

function expectVector(actual: number[], expected: number[]): void {
  actual.forEach((component, axis) => expect(component).toBeCloseTo(expected[axis]!, 9));
}

test('the shaft points where the tool points', () => {
  for (const direction of [
    [0, -1, 0],
    [0.6, 0, 0.8],
    [0, 1, 0],
    [-0.48, 0.6, 0.64],
  ] as [number, number, number][]) {
    expectVector(turned([0, 0, 1], direction, 0.7), direction);
  }
});

test('jaws of a tool that points down open along x, and along z after a quarter of a roll', () => {
  expectVector(turned([0, 1, 0], [0, -1, 0], 0), [1, 0, 0]);
  expectVector(turned([0, 1, 0], [0, -1, 0], Math.PI / 2), [0, 0, 1]);
});

test('a tool swings the shortest way: what lies across that way stays', () => {
  // From down to +x the axis of the swing is z.
  expectVector(turned([0, 1, 0], [1, 0, 0], Math.PI / 2), [0, 0, 1]);
  expectVector(turned([0, 1, 0], [1, 0, 0], 0), [0, 1, 0]);
});
