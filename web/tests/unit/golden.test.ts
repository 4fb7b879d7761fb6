import { readdirSync, readFileSync } from 'node:fs';
import { decode } from '@msgpack/msgpack';
import { expect, test } from 'vitest';
import { decodeMessage, encodeCommand } from '../../src/engine/encoding';
import type { Command } from '../../src/engine/messages';

/** The session's tests keep one message of each kind as bytes; this side has to read and write the same. */
const DATA = new URL('../../../crates/viscera-session/tests/data/', import.meta.url);
const files = readdirSync(DATA).filter((name) => name.endsWith('.msgpack'));
const bytesOf = (name: string) => new Uint8Array(readFileSync(new URL(name, DATA)));

test.each(files.filter((name) => name.startsWith('answer-')))('%s is read', (name) => {
  const message = decodeMessage(bytesOf(name));
  expect(message?.type).toBe(name.slice('answer-'.length, -'.msgpack'.length));
});

test.each(files.filter((name) => name.startsWith('command-')))(
  '%s means the same when this page says it',
  (name) => {
    const kept = decode(bytesOf(name)) as Command;
    expect(decode(encodeCommand(kept))).toEqual(kept);
  },
);

test('the arrays of a kept surface and frame fit together', () => {
  const surface = decodeMessage(bytesOf('answer-surface.msgpack'));
  const frame = decodeMessage(bytesOf('answer-frame.msgpack'));
  if (surface?.type !== 'surface' || frame?.type !== 'frame') throw new Error('these are other messages');
  expect(surface.rest.length).toBe(3 * surface.vertices);
  expect(surface.triangles.length).toBe(3 * surface.cut.length);
  expect(Math.max(...surface.triangles)).toBeLessThan(surface.vertices);
  for (const body of frame.bodies) expect(body.positions.length % 3).toBe(0);
  expect(frame.observables?.[0]).toMatchObject({
    atRest: false,
    volumeError: 1e-12,
    interfaceResidual: 0.02,
  });
});
