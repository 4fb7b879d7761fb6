import type { ColourMapName } from './colour-map';

/**
 * The colour map that suits a colouring: two colours where there are two classes, one with a middle where values go below
 * zero, else one from low to high. Nothing for "none".
 */
export function mapOf(name: string, low: number): ColourMapName | null {
  if (name === 'none') return null;
  if (/linear|mode/.test(name)) return 'binary';
  return low < 0 ? 'diverging' : 'sequential';
}
