/**
 * How numbers are shown. Values are SI; a parameter that spans kilopascals or millimetres is shown in those, and keeps its
 * unit while it changes, so that only the number moves.
 */
export interface ShownUnit {
  readonly unit: string;
  /** SI value = shown value × factor. */
  readonly factor: number;
}

const PREFIXED: Record<string, readonly (readonly [unit: string, factor: number])[]> = {
  Pa: [
    ['Pa', 1],
    ['kPa', 1e3],
    ['MPa', 1e6],
  ],
  m: [
    ['mm', 1e-3],
    ['m', 1],
  ],
  s: [
    ['ms', 1e-3],
    ['s', 1],
  ],
  J: [
    ['µJ', 1e-6],
    ['mJ', 1e-3],
    ['J', 1],
  ],
};

/** The unit in which values around `typical` [SI] have the fewest digits before and after the point. */
export function shownUnit(unit: string, typical: number): ShownUnit {
  const prefixed = PREFIXED[unit];
  if (!prefixed) return { unit, factor: 1 };
  let best = prefixed[0]!;
  for (const candidate of prefixed) if (Math.abs(typical) >= 0.999 * candidate[1]) best = candidate;
  return { unit: best[0], factor: best[1] };
}

/** A number with `digits` significant digits, without trailing zeros and without an exponent where one can do without. */
export function shownNumber(value: number, digits = 4): string {
  if (!Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  const rounded = Number(value.toPrecision(digits));
  if (size >= 1e6 || size < 1e-4) return rounded.toExponential().replace('e+', 'e').replace('-', '−');
  return String(rounded).replace('-', '−');
}

/** A quantity as text, such as "3.2 kPa"; the prefix follows the value. */
export function shownQuantity(value: number, unit: string, digits = 3): string {
  const shown = shownUnit(unit, value);
  return `${shownNumber(value / shown.factor, digits)} ${shown.unit}`.trim();
}

/** What was typed, as a number; nothing where it is none. Takes a comma and a real minus as well. */
export function typedNumber(text: string): number | undefined {
  const plain = text.trim().replace('−', '-').replace(',', '.');
  const value = Number(plain);
  return plain !== '' && Number.isFinite(value) ? value : undefined;
}
