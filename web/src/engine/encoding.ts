import { decode, encode } from '@msgpack/msgpack';
import type { Command, Message } from './messages';

/** Bytes that are no message of this protocol. */
export class EncodingError extends Error {}

export function encodeCommand(command: Command): Uint8Array<ArrayBuffer> {
  return encode(command, { ignoreUndefined: true });
}

const TYPES: readonly string[] = [
  'welcome',
  'role',
  'catalogue',
  'scene',
  'surface',
  'frame',
  'notice',
  'refusal',
  'file',
] satisfies Message['type'][];

/**
 * The message in `bytes`, or nothing where its type is one that this page does not know: a newer program may say more.
 * Bulk arrays become typed arrays here, so that nobody else has to think of bytes.
 */
export function decodeMessage(bytes: Uint8Array): Message | undefined {
  let value: unknown;
  try {
    value = decode(bytes);
  } catch (error) {
    throw new EncodingError(`what came is no MessagePack: ${String(error)}`);
  }
  if (!isMap(value) || typeof value['type'] !== 'string') throw new EncodingError('what came has no `type`');
  if (!TYPES.includes(value['type'])) return undefined;
  if (value['type'] === 'surface') {
    value['triangles'] = unsigned(bulk(value, 'triangles'));
    value['cut'] = bulk(value, 'cut');
    value['rest'] = floats(bulk(value, 'rest'));
  } else if (value['type'] === 'frame') {
    for (const body of list(value, 'bodies')) {
      body['positions'] = floats(bulk(body, 'positions'));
      for (const key of ['scalars', 'seared']) if (body[key] != null) body[key] = floats(bulk(body, key));
    }
    for (const tool of list(value, 'instruments'))
      if (tool['parts'] != null) tool['parts'] = floats(bulk(tool, 'parts'));
  }
  return value as unknown as Message;
}

type Fields = Record<string, unknown>;

function isMap(value: unknown): value is Fields {
  return (
    typeof value === 'object' && value !== null && !Array.isArray(value) && !(value instanceof Uint8Array)
  );
}

function list(fields: Fields, key: string): Fields[] {
  const value = fields[key];
  if (!Array.isArray(value) || !value.every(isMap)) throw new EncodingError(`\`${key}\` is no list of maps`);
  return value;
}

function bulk(fields: Fields, key: string): Uint8Array {
  const value = fields[key];
  if (!(value instanceof Uint8Array)) throw new EncodingError(`\`${key}\` is no bulk array`);
  return value;
}

// Bytes inside a message begin anywhere, typed arrays only at multiples of four: copied where they have to be.
function aligned(bytes: Uint8Array): Uint8Array {
  if (bytes.byteLength % 4 !== 0)
    throw new EncodingError(`a bulk array of ${bytes.byteLength} bytes is cut off`);
  return bytes.byteOffset % 4 === 0 ? bytes : bytes.slice();
}

function floats(bytes: Uint8Array): Float32Array {
  const whole = aligned(bytes);
  return new Float32Array(whole.buffer, whole.byteOffset, whole.byteLength / 4);
}

function unsigned(bytes: Uint8Array): Uint32Array {
  const whole = aligned(bytes);
  return new Uint32Array(whole.buffer, whole.byteOffset, whole.byteLength / 4);
}
