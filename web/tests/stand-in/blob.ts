/** A lobed blob about as large as a liver [m]: what the stand-in session shows in place of an organ. */
export interface Blob {
  rest: Float32Array;
  triangles: Uint32Array;
}

export function blob(rings = 36, sectors = 60): Blob {
  const rest: number[] = [];
  for (let ring = 0; ring <= rings; ring++) {
    const polar = (Math.PI * ring) / rings;
    for (let sector = 0; sector < sectors; sector++) {
      const around = (2 * Math.PI * sector) / sectors;
      const [x, y, z] = [
        Math.sin(polar) * Math.cos(around),
        Math.cos(polar),
        Math.sin(polar) * Math.sin(around),
      ];
      const taper = 0.62 + 0.38 * (0.5 - 0.5 * x);
      rest.push(0.14 * x, 0.075 * y * taper + 0.02 * x * x - 0.012 * Math.sin(9 * x), 0.085 * z * taper);
    }
  }
  const triangles: number[] = [];
  const at = (ring: number, sector: number) => ring * sectors + (sector % sectors);
  for (let ring = 0; ring < rings; ring++) {
    for (let sector = 0; sector < sectors; sector++) {
      const [a, b, c, d] = [
        at(ring, sector),
        at(ring, sector + 1),
        at(ring + 1, sector),
        at(ring + 1, sector + 1),
      ];
      if (ring > 0) triangles.push(a, b, c);
      if (ring < rings - 1) triangles.push(b, d, c);
    }
  }
  return { rest: new Float32Array(rest), triangles: new Uint32Array(triangles) };
}

export const bytesOf = (array: Float32Array | Uint32Array): Uint8Array =>
  new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
