/** Each edge of a triangulated surface once, as pairs of vertices: what a wireframe draws. */
export function edgesOf(triangles: Uint32Array, vertices: number): Uint32Array {
  const known = new Set<number>();
  const pairs: number[] = [];
  for (let corner = 0; corner < triangles.length; corner++) {
    const from = triangles[corner]!;
    const to = triangles[corner % 3 === 2 ? corner - 2 : corner + 1]!;
    const key = Math.min(from, to) * vertices + Math.max(from, to);
    if (known.has(key)) continue;
    known.add(key);
    pairs.push(from, to);
  }
  return new Uint32Array(pairs);
}
