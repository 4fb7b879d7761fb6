import { existsSync, readFileSync } from 'node:fs';
import { describe, expect, test } from 'vitest';
import { decodeMessage, encodeCommand } from '../../src/engine/encoding';
import {
  PROTOCOL_VERSION,
  type Catalogue,
  type Command,
  type Frame,
  type Message,
} from '../../src/engine/messages';

/** The engine as WebAssembly without a browser; `build-engine.sh` makes it. */
const GENERATED = new URL('../../src/engine/generated/', import.meta.url);
const BINARY = new URL('viscera_web_bg.wasm', GENERATED);

interface Session {
  receive(bytes: Uint8Array): void;
  advance(elapsed: number, budget: number): void;
  messages(): Uint8Array[];
  frame(): Uint8Array[];
}

interface Engine {
  initSync(options: { module: Uint8Array }): unknown;
  Session: new () => Session;
}

async function begin(): Promise<(command?: Command, elapsed?: number) => Message[]> {
  const script = new URL('viscera_web.js', GENERATED).href;
  const engine = (await import(/* @vite-ignore */ script)) as Engine;
  engine.initSync({ module: readFileSync(BINARY) });
  const session = new engine.Session();
  return (command, elapsed = 0) => {
    if (command) session.receive(encodeCommand(command));
    session.advance(elapsed, 10);
    const heard = [...session.messages(), ...session.frame()].map((bytes) => decodeMessage(bytes));
    return heard.filter((message) => message !== undefined);
  };
}

describe.skipIf(!existsSync(BINARY))('the engine as WebAssembly', () => {
  test('recordings of the program come to the same numbers', { timeout: 600_000 }, async () => {
    const say = await begin();
    const catalogue = say({ type: 'hello', version: PROTOCOL_VERSION }).find(
      (message): message is Catalogue => message.type === 'catalogue',
    )!;
    expect(catalogue.recordings.length).toBeGreaterThanOrEqual(2);
    for (const { name } of catalogue.recordings) {
      const notices: string[] = [];
      let last: Frame | undefined;
      let heard = say({ type: 'replay', name });
      while (!notices.some((text) => text.startsWith('replayed'))) {
        for (const message of heard) {
          if (message.type === 'frame') last = message;
          else if (message.type === 'notice') notices.push(message.text);
          else expect(message.type).not.toBe('refusal');
        }
        heard = say(undefined, 0.1);
      }
      // Recorded with longer vectors, and with products that are rounded once: contact and cuts multiply the difference.
      expect(notices.at(-1)).toMatch(/^replayed \d+ steps to the same numbers$/);
      expect(last!.steps).toBeGreaterThan(100);
    }
  });
});
