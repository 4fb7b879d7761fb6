/** What share of the other side is too little to be shown. */
const SLIVER = 0.02;

/** The span of a chart that holds all values, begins and ends at round numbers, and shows zero where zero is near. */
export function roundSpan(low: number, high: number): [low: number, high: number] {
  if (!Number.isFinite(low) || !Number.isFinite(high)) return [0, 1];
  // What is a sliver beyond zero, as energies are by rounding, opens no step there.
  if (low < 0 && -low < SLIVER * high) low = 0;
  if (high > 0 && high < -SLIVER * low) high = 0;
  // Zero belongs to it where it is as near as the values are from each other.
  const width = high - low;
  let from = low > 0 && low <= width ? 0 : low;
  let to = high < 0 && -high <= width ? 0 : high;
  if (from === to) {
    // One value alone: from zero to it, or around zero if it is zero.
    from = Math.min(0, from);
    to = Math.max(0, to);
    if (from === to) return [0, 1];
  }
  const step = roundStep((to - from) / 4);
  return [step * Math.floor(from / step + 1e-9), step * Math.ceil(to / step - 1e-9)];
}

/** The smallest of 1, 2, 5 × 10ⁿ that is no smaller than `least`. */
export function roundStep(least: number): number {
  const decade = 10 ** Math.floor(Math.log10(least));
  for (const factor of [1, 2, 5]) if (factor * decade >= least * (1 - 1e-9)) return factor * decade;
  return 10 * decade;
}
