/**
 * Colours of values. Each map is a few stops in sRGB, blended between; all of them keep their order in greyscale or around a
 * middle, and none asks anybody to tell red from green.
 */
export type ColourMapName = 'sequential' | 'diverging' | 'binary';

type Stop = readonly [red: number, green: number, blue: number];

const STOPS: Record<ColourMapName, readonly Stop[]> = {
  // Cividis-like, from deep blue to straw: readable with every common colour blindness.
  sequential: [
    [24, 43, 88],
    [54, 85, 122],
    [101, 118, 125],
    [150, 147, 119],
    [205, 183, 101],
    [253, 231, 109],
  ],
  // Blue shrinks, orange swells, pale is unchanged.
  diverging: [
    [20, 74, 130],
    [92, 146, 192],
    [206, 219, 224],
    [238, 226, 210],
    [224, 140, 72],
    [146, 62, 10],
  ],
  binary: [
    [70, 118, 158],
    [240, 178, 70],
  ],
};

/** The colour at `fraction` of the map, 0 to 1; values outside are held at the ends. Components 0 to 255. */
export function colourAt(map: ColourMapName, fraction: number): [number, number, number] {
  const stops = STOPS[map];
  const held = Math.min(1, Math.max(0, Number.isFinite(fraction) ? fraction : 0));
  if (map === 'binary') return [...stops[held < 0.5 ? 0 : 1]!];
  const place = held * (stops.length - 1);
  const lower = Math.min(stops.length - 2, Math.floor(place));
  const weight = place - lower;
  const [from, to] = [stops[lower]!, stops[lower + 1]!];
  const blend = (index: 0 | 1 | 2) => Math.round(from[index] + weight * (to[index] - from[index]));
  return [blend(0), blend(1), blend(2)];
}

/** The map as a row of texels with four bytes each. */
export function colourRow(map: ColourMapName, width: number): Uint8Array<ArrayBuffer> {
  const row = new Uint8Array(4 * width);
  for (let texel = 0; texel < width; texel++) {
    row.set([...colourAt(map, texel / (width - 1)), 255], 4 * texel);
  }
  return row;
}

/** The map as a CSS gradient from left to right. */
export function colourGradient(map: ColourMapName): string {
  const steps = map === 'binary' ? 2 : 9;
  const stops: string[] = [];
  for (let step = 0; step < steps; step++) {
    const colour = `rgb(${colourAt(map, step / (steps - 1)).join(' ')})`;
    if (map === 'binary') stops.push(`${colour} ${50 * step}%`, `${colour} ${50 * (step + 1)}%`);
    else stops.push(`${colour} ${((100 * step) / (steps - 1)).toFixed(1)}%`);
  }
  return `linear-gradient(to right, ${stops.join(', ')})`;
}
