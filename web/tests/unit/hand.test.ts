import { Vector3 } from 'three';
import { expect, test } from 'vitest';
import { Hand } from '../../src/handling/hand';

const DOWN = new Vector3(0, -1, 0);
const hand = (tip: Vector3) => new Hand({ tip, direction: DOWN.clone(), roll: 0, trigger: 0 }, 1);

/** Goes on in turns of 10 ms until nothing is left to do; the ways between. */
function finish(moving: Hand, seen: (moving: Hand) => void = () => undefined): number {
  let turns = 0;
  while (moving.advance(0.01)) {
    seen(moving);
    turns += 1;
    if (turns > 10_000) throw new Error('the hand never arrives');
  }
  return turns;
}

test('a hand is never faster than it may be', () => {
  const moving = hand(new Vector3(0, 0.1, 0));
  moving.approach(new Vector3(0.3, 0, 0), DOWN, 0.05, 1);
  let before = moving.pose.tip.clone();
  finish(moving, ({ pose }) => {
    expect(pose.tip.distanceTo(before)).toBeLessThanOrEqual(0.01 + 1e-12);
    before = pose.tip.clone();
  });
  expect(moving.pose.tip.toArray()).toEqual([0.3, 0, 0]);
});

test('a tool that crosses the organ goes over it, not through it', () => {
  const moving = hand(new Vector3(-0.2, 0, 0));
  moving.approach(new Vector3(0.2, 0, 0), DOWN, 0.05, 1);
  finish(moving, ({ pose }) => {
    if (Math.abs(pose.tip.x) < 0.19) expect(pose.tip.y).toBeGreaterThan(0.049);
  });
});

test('jaws close only when the tool has arrived', () => {
  const moving = hand(new Vector3(-0.2, 0, 0));
  const goal = new Vector3(0.2, 0, 0);
  moving.approach(goal, DOWN, 0.05, 1);
  finish(moving, ({ pose }) => {
    if (pose.trigger > 0) expect(pose.tip.distanceTo(goal)).toBeLessThan(1e-9);
  });
  expect(moving.pose.trigger).toBe(1);
});

test('dragging before the tool has arrived moves where it goes, and it still works there', () => {
  const moving = hand(new Vector3(-0.2, 0, 0));
  moving.approach(new Vector3(0.2, 0, 0), DOWN, 0.05, 1);
  moving.advance(0.01);
  moving.moveTo(new Vector3(0.25, 0.02, 0));
  finish(moving);
  expect(moving.pose.tip.toArray()).toEqual([0.25, 0.02, 0]);
  expect(moving.pose.trigger).toBe(1);
});

test('released, the trigger opens at once and the tool backs out along its shaft', () => {
  const moving = hand(new Vector3(0, 0, 0));
  moving.setTrigger(1);
  moving.release(0.03);
  expect(moving.pose.trigger).toBe(0);
  finish(moving);
  expect(moving.pose.tip.y).toBeCloseTo(0.03, 12);
});

test('a tool that has to turn right round keeps a direction on the way', () => {
  const moving = hand(new Vector3(0, 0, 0));
  moving.approach(new Vector3(0.3, 0, 0), new Vector3(0, 1, 0), 0.05, 0);
  finish(moving, ({ pose }) => expect(pose.direction.length()).toBeCloseTo(1, 9));
  expect(moving.pose.direction.y).toBeCloseTo(1, 9);
});

test('a tip stays on its own side of the trocar', () => {
  const trocar = new Vector3(0, 0.3, 0);
  const moving = new Hand({ tip: new Vector3(), direction: DOWN.clone(), roll: 0, trigger: 0 }, 1, 0.02);
  moving.enterThrough(trocar);
  // Pulled out by far, backed out by an approach and after work, led on from there: always below it.
  const within = () => finish(moving, ({ pose }) => expect(pose.tip.y).toBeLessThan(0.3));
  moving.moveTo(new Vector3(0.01, 0.9, 0));
  within();
  expect(moving.pose.tip.y).toBeCloseTo(0.28, 12);
  moving.approach(new Vector3(0.1, 0, 0), DOWN, 0.25, 1);
  within();
  expect(moving.pose.tip.toArray()).toEqual([0.1, 0, 0]);
  moving.release(0.5);
  finish(moving, ({ pose }) => expect(pose.tip.distanceTo(trocar)).toBeGreaterThanOrEqual(0.02 - 1e-12));
  // Without one it goes where it is led.
  moving.enterThrough(undefined);
  moving.moveTo(new Vector3(0, 0.9, 0));
  finish(moving);
  expect(moving.pose.tip.y).toBe(0.9);
});
