import { decode, encode } from '@msgpack/msgpack';
import { expect, test } from 'vitest';
import { decodeMessage, encodeCommand, EncodingError } from '../../src/engine/encoding';

const bytes = (...values: number[]) => new Uint8Array(new Float32Array(values).buffer);

test('bulk arrays are read wherever they begin in the message', () => {
  // Names of growing length move the array through all alignments.
  for (const name of ['', 'a', 'ab', 'abc']) {
    const body = { epoch: 0, positions: bytes(1, 2.5, -3) };
    const message = decodeMessage(encode({ type: 'frame', name, bodies: [body], instruments: [] }));
    expect(message?.type).toBe('frame');
    if (message?.type === 'frame') expect([...message.bodies[0]!.positions]).toEqual([1, 2.5, -3]);
  }
});

test('a message of a kind that a newer program may say is passed over', () => {
  expect(decodeMessage(encode({ type: 'weather' }))).toBeUndefined();
});

test.each([
  ['no MessagePack', new Uint8Array([0xc1])],
  ['nothing', new Uint8Array()],
  ['no map', encode([1, 2])],
  ['no type', encode({ kind: 'frame' })],
  [
    'an array that is cut off',
    encode({ type: 'frame', bodies: [{ epoch: 0, positions: new Uint8Array(7) }], instruments: [] }),
  ],
  ['positions that are numbers', encode({ type: 'frame', bodies: [{ epoch: 0, positions: [1, 2, 3] }] })],
  ['bodies that are none', encode({ type: 'frame', bodies: 7 })],
])('%s is refused', (_, wrong) => {
  expect(() => decodeMessage(wrong)).toThrow(EncodingError);
});

test('keys of a command that are not given are not said', () => {
  const said = decode(
    encodeCommand({
      type: 'move-instrument',
      instrument: 1,
      tip: [0, 1, 2],
      direction: [0, 0, 1],
      roll: 0,
      trigger: 1,
    }),
  );
  expect(said).toEqual({
    type: 'move-instrument',
    instrument: 1,
    tip: [0, 1, 2],
    direction: [0, 0, 1],
    roll: 0,
    trigger: 1,
  });
});
