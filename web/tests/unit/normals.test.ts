import { expect, test } from 'vitest';
import { smoothNormals } from '../../src/drawing/normals';
import { blob } from '../stand-in/blob';

test('normals of a flat quadrilateral are those of its plane, however it is divided', () => {
  const positions = new Float32Array([0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0]);
  const normals = new Float32Array(12);
  smoothNormals(positions, new Uint32Array([0, 1, 2, 0, 2, 3]), normals);
  expect([...normals]).toEqual([0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1]);
});

test('at a corner of a cube the normal is its diagonal', () => {
  const positions = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]);
  const normals = new Float32Array(12);
  smoothNormals(positions, new Uint32Array([0, 2, 1, 0, 3, 2, 0, 1, 3]), normals);
  for (const component of normals.slice(0, 3)) expect(component).toBeCloseTo(-1 / Math.sqrt(3), 6);
});

test('normals of a sphere point outward', () => {
  const { rest, triangles } = blob(24, 48);
  const sphere = rest.map((_, index) => {
    const vertex = index - (index % 3);
    const length = Math.hypot(rest[vertex]! / 0.14, rest[vertex + 1]! / 0.075, rest[vertex + 2]! / 0.085);
    return [rest[vertex]! / 0.14, rest[vertex + 1]! / 0.075, rest[vertex + 2]! / 0.085][index % 3]! / length;
  });
  const normals = new Float32Array(sphere.length);
  smoothNormals(sphere, triangles, normals);
  const used = new Set(triangles);
  for (const vertex of used) {
    const cosine = [0, 1, 2].reduce(
      (sum, axis) => sum + normals[3 * vertex + axis]! * sphere[3 * vertex + axis]!,
      0,
    );
    // Half the angle between neighbouring faces of a coarse sphere, at most.
    expect(cosine).toBeGreaterThan(0.95);
  }
});

test('a vertex without triangles gets no normal, and no NaN', () => {
  const normals = new Float32Array(3);
  smoothNormals(new Float32Array([1, 2, 3]), new Uint32Array(), normals);
  expect([...normals]).toEqual([0, 0, 0]);
});
