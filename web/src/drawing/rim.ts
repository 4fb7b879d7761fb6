/**
 * A surface made ready for drawing. A vertex on the rim of a cut belongs to skin and to inner faces alike; here it is drawn
 * twice, once for either, so that the rim stays a crisp edge in normals and colour.
 */
export interface DrawnSurface {
  /** For every drawn vertex the vertex of the surface that it shows; the first ones are the surface's own, in order. */
  readonly source: Uint32Array;
  /** Triangles over drawn vertices. */
  readonly triangles: Uint32Array;
  /** 1 where a drawn vertex belongs to faces that a cut laid open. */
  readonly inner: Float32Array;
}

export function splitRim(vertices: number, triangles: Uint32Array, cut: Uint8Array): DrawnSurface {
  const onSkin = new Uint8Array(vertices);
  for (let face = 0; face < cut.length; face++) {
    if (cut[face] === 1) continue;
    for (let corner = 3 * face; corner < 3 * face + 3; corner++) onSkin[triangles[corner]!] = 1;
  }
  const drawn = triangles.slice();
  const extra: number[] = [];
  const twin = new Map<number, number>();
  const innerOwn = new Uint8Array(vertices);
  for (let face = 0; face < cut.length; face++) {
    if (cut[face] !== 1) continue;
    for (let corner = 3 * face; corner < 3 * face + 3; corner++) {
      const vertex = triangles[corner]!;
      if (!onSkin[vertex]) {
        innerOwn[vertex] = 1;
        continue;
      }
      let copy = twin.get(vertex);
      if (copy === undefined) {
        copy = vertices + extra.length;
        twin.set(vertex, copy);
        extra.push(vertex);
      }
      drawn[corner] = copy;
    }
  }
  const source = new Uint32Array(vertices + extra.length);
  for (let vertex = 0; vertex < vertices; vertex++) source[vertex] = vertex;
  source.set(extra, vertices);
  const inner = new Float32Array(source.length).fill(1);
  for (let vertex = 0; vertex < vertices; vertex++) inner[vertex] = innerOwn[vertex]!;
  return { source, triangles: drawn, inner };
}
