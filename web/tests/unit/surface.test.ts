import { expect, test } from 'vitest';
import { edgesOf } from '../../src/drawing/edges';
import { splitRim } from '../../src/drawing/rim';

// Two triangles that share the edge 1–2.
const TRIANGLES = new Uint32Array([0, 1, 2, 2, 1, 3]);

test('a surface without a cut is drawn as it is', () => {
  const drawn = splitRim(4, TRIANGLES, new Uint8Array([0, 0]));
  expect([...drawn.triangles]).toEqual([...TRIANGLES]);
  expect([...drawn.source]).toEqual([0, 1, 2, 3]);
  expect([...drawn.inner]).toEqual([0, 0, 0, 0]);
});

test('the rim between skin and a cut is drawn twice, once as either', () => {
  const drawn = splitRim(4, TRIANGLES, new Uint8Array([0, 1]));
  expect([...drawn.triangles.slice(0, 3)]).toEqual([0, 1, 2]);
  const shown = [...drawn.triangles.slice(3)].map((vertex) => drawn.source[vertex]);
  expect(shown).toEqual([2, 1, 3]);
  expect(drawn.source.length).toBe(6);
  for (const vertex of drawn.triangles.slice(0, 3)) expect(drawn.inner[vertex]).toBe(0);
  for (const vertex of drawn.triangles.slice(3)) expect(drawn.inner[vertex]).toBe(1);
});

test('a wireframe has every edge once', () => {
  const edges = edgesOf(TRIANGLES, 4);
  expect(edges.length / 2).toBe(5);
});

test('a closed surface has 3/2 as many edges as triangles', () => {
  const tetrahedron = new Uint32Array([0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3]);
  expect(edgesOf(tetrahedron, 4).length / 2).toBe(6);
});
