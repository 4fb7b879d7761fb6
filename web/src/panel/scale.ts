import type { NumberParameter } from '../engine/messages';

/** Positions of a slider, 0 to `STEPS`, and the values they stand for. */
export const STEPS = 400;

type Span = Pick<NumberParameter, 'low' | 'high' | 'scale'>;

export function valueAt(position: number, { low, high, scale }: Span): number {
  const fraction = position / STEPS;
  // A logarithm has no place for zero: such a span is linear, whatever it says.
  if (scale === 'logarithmic' && low > 0) return low * (high / low) ** fraction;
  return low + fraction * (high - low);
}

export function positionOf(value: number, { low, high, scale }: Span): number {
  const fraction =
    scale === 'logarithmic' && low > 0
      ? Math.log(Math.max(value, low) / low) / Math.log(high / low)
      : (value - low) / (high - low);
  return Math.round(STEPS * Math.min(1, Math.max(0, Number.isFinite(fraction) ? fraction : 0)));
}

/** A value from a slider with three significant digits: nobody means 2983.4 Pa by a drag. Never beyond the span. */
export function tidy(value: number, { low, high }: Span): number {
  return Math.min(high, Math.max(low, Number(value.toPrecision(3))));
}
