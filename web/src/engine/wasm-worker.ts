/// <reference lib="webworker" />
import type { FromWorker, ToWorker } from './worker';

/** The part of the WebAssembly module that is used here; `docs/protocol.md` describes it. */
interface WasmSession {
  receive(bytes: Uint8Array): void;
  advance(elapsed: number, budget: number): void;
  messages(): Uint8Array<ArrayBuffer>[];
  frame(): Uint8Array<ArrayBuffer>[];
}

interface WasmModule {
  default(options: { module_or_path: string }): Promise<unknown>;
  Session: new () => WasmSession;
}

// Globs, as the module is there only after `build-engine.sh`: without it the page still builds, and says what is missing.
const modules = import.meta.glob<WasmModule>('./generated/viscera_web.js');
const binaries = import.meta.glob<string>('./generated/viscera_web_bg.wasm', {
  query: '?url',
  import: 'default',
});

/** Seconds between two turns of the loop, and how many of them may be spent computing. */
const TURN = 0.016;
const BUDGET = 0.012;

const worker = self as unknown as DedicatedWorkerGlobalScope;

function post(message: FromWorker, transfer: Transferable[] = []): void {
  worker.postMessage(message, transfer);
}

function postAll(all: Uint8Array<ArrayBuffer>[], frame: boolean): void {
  for (const bytes of all) post({ kind: 'bytes', bytes }, [bytes.buffer]);
  if (frame && all.length > 0) post({ kind: 'frame-end' });
}

async function begin(): Promise<void> {
  const load = modules['./generated/viscera_web.js'];
  const locate = binaries['./generated/viscera_web_bg.wasm'];
  if (!load || !locate)
    throw new Error(
      'This page was built without the engine: run `npm run build:engine`, then build the page again.',
    );
  const module = await load();
  await module.default({ module_or_path: await locate() });
  const session = new module.Session();

  let shown = true;
  worker.onmessage = (event: MessageEvent<ToWorker>) => {
    if (event.data.kind === 'frame-shown') shown = true;
    else session.receive(event.data.bytes);
  };
  post({ kind: 'ready' });

  let last = performance.now();
  const turn = () => {
    const start = performance.now();
    try {
      session.advance((start - last) / 1000, BUDGET);
      last = start;
      postAll(session.messages(), false);
      if (shown) {
        const frame = session.frame();
        if (frame.length > 0) shown = false;
        postAll(frame, true);
      }
    } catch (error) {
      post({ kind: 'failed', reason: `The engine broke off: ${String(error)}` });
      return;
    }
    setTimeout(turn, Math.max(0, 1000 * TURN - (performance.now() - start)));
  };
  turn();
}

begin().catch((error: unknown) => {
  post({ kind: 'failed', reason: error instanceof Error ? error.message : String(error) });
});
