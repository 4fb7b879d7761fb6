import { expect, test } from 'vitest';
import { roundSpan, roundStep } from '../../src/chart/axis';
import { Series } from '../../src/chart/series';
import { colourAt } from '../../src/drawing/colour-map';
import { LEVELS, QualityControl } from '../../src/drawing/quality';
import { positionOf, STEPS, tidy, valueAt } from '../../src/panel/scale';
import { shownNumber, shownQuantity, shownUnit, typedNumber } from '../../src/panel/units';

test('quantities are shown with the prefix that suits them', () => {
  expect(shownQuantity(3000, 'Pa')).toBe('3 kPa');
  expect(shownQuantity(0.012, 'm')).toBe('12 mm');
  expect(shownQuantity(0.01, 's')).toBe('10 ms');
  expect(shownQuantity(1060, 'kg/m³')).toBe('1060 kg/m³');
  expect(shownUnit('Pa', 2e6)).toEqual({ unit: 'MPa', factor: 1e6 });
});

test('what is shown can be typed again', () => {
  for (const value of [0, 3, 0.4499, -9.81, 1.5e7, -2.5e-6, 123456]) {
    const typed = typedNumber(shownNumber(value));
    expect(typed).toBeDefined();
    // Four significant digits are shown.
    expect(Math.abs(typed! - value)).toBeLessThanOrEqual(5e-4 * Math.abs(value));
  }
  expect(typedNumber('0,45')).toBe(0.45);
  expect(typedNumber('five')).toBeUndefined();
  expect(typedNumber(' ')).toBeUndefined();
});

test('a slider gives back the value that it shows', () => {
  for (const span of [
    { low: 300, high: 30_000, scale: 'logarithmic' as const },
    { low: -0.5, high: 0.5, scale: 'linear' as const },
  ]) {
    for (let position = 0; position <= STEPS; position += 50) {
      expect(positionOf(valueAt(position, span), span)).toBe(position);
    }
    expect(positionOf(1e9, span)).toBe(STEPS);
    expect(positionOf(-1e9, span)).toBe(0);
  }
  expect(valueAt(STEPS / 2, { low: 300, high: 30_000, scale: 'logarithmic' })).toBeCloseTo(3000, 6);
});

test('a tidy value stays within its span', () => {
  expect(tidy(2983.4, { low: 300, high: 30_000, scale: 'linear' })).toBe(2980);
  expect(tidy(0.4999, { low: 0, high: 0.4999, scale: 'linear' })).toBe(0.4999);
});

test('the span of a chart is round and holds all values', () => {
  expect(roundSpan(98, 101)).toEqual([98, 101]);
  expect(roundSpan(0.2, 0.9)).toEqual([0, 1]);
  expect(roundSpan(-0.3, 0.9)).toEqual([-0.5, 1]);
  // An energy that is below zero by rounding has no axis there.
  expect(roundSpan(-1e-5, 0.9)).toEqual([0, 1]);
  expect(roundSpan(5, 5)).toEqual([0, 6]);
  expect(roundSpan(0, 0)).toEqual([0, 1]);
  expect(roundSpan(Infinity, -Infinity)).toEqual([0, 1]);
  expect(roundStep(0.03)).toBeCloseTo(0.05, 12);
});

test('a full series forgets its oldest values first', () => {
  const series = new Series(3);
  for (const time of [1, 2, 3, 4]) series.push(time, 10 * time);
  expect([...series.after(0)]).toEqual([
    [2, 20],
    [3, 30],
    [4, 40],
  ]);
  expect([...series.after(3.5)]).toEqual([[4, 40]]);
  expect(series.last).toBe(40);
});

test('brightness grows all along the sequential map, so that it can be read without colours', () => {
  // Relative luminance after WCAG 2.2.
  const luminance = ([red, green, blue]: [number, number, number]) => {
    const linear = (part: number) =>
      part / 255 <= 0.04045 ? part / 255 / 12.92 : ((part / 255 + 0.055) / 1.055) ** 2.4;
    return 0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue);
  };
  let before = -1;
  for (let step = 0; step <= 20; step++) {
    const here = luminance(colourAt('sequential', step / 20));
    expect(here).toBeGreaterThan(before);
    before = here;
  }
});

test('a slow machine draws less, and does not try again what was too slow', () => {
  const control = new QualityControl();
  const [start] = [control.quality];
  for (let frame = 0; frame < 3; frame++) control.observe(300);
  expect(control.quality).not.toBe(start);
  for (let frame = 0; frame < 1000; frame++) control.observe(300);
  expect(control.quality).toBe(LEVELS[0]);
  for (let frame = 0; frame < 1000; frame++) control.observe(8);
  expect(LEVELS.indexOf(control.quality)).toBeLessThan(LEVELS.indexOf(LEVELS.at(-1)!));
});

test('a hidden tab is no slow machine', () => {
  const control = new QualityControl();
  for (let frame = 0; frame < 50; frame++) control.observe(5000);
  expect(control.quality).toBe(LEVELS.at(-1));
});
