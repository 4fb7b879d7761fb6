import type { Transport, TransportListener } from './transport';

export type ToWorker = { kind: 'bytes'; bytes: Uint8Array } | { kind: 'frame-shown' };
export type FromWorker =
  | { kind: 'ready' }
  | { kind: 'bytes'; bytes: Uint8Array }
  | { kind: 'frame-end' }
  | { kind: 'failed'; reason: string };

/** A session in this very page: the engine as WebAssembly, in a worker. */
export class WorkerTransport implements Transport {
  readonly peer = 'the engine in this page';
  private worker: Worker | undefined;

  open(listener: TransportListener): void {
    const worker = new Worker(new URL('./wasm-worker.ts', import.meta.url), { type: 'module' });
    this.worker = worker;
    worker.onmessage = (event: MessageEvent<FromWorker>) => {
      const message = event.data;
      switch (message.kind) {
        case 'ready':
          return listener.opened();
        case 'bytes':
          return listener.received(message.bytes);
        case 'frame-end':
          // Asked for only once the last was taken in, so that a slow page hears less and never late.
          return this.post({ kind: 'frame-shown' });
        case 'failed':
          return listener.lost(message.reason);
      }
    };
    worker.onerror = (event) => listener.lost(event.message || 'The engine could not be loaded.');
  }

  send(bytes: Uint8Array<ArrayBuffer>): boolean {
    if (!this.worker) return false;
    this.post({ kind: 'bytes', bytes });
    return true;
  }

  close(): void {
    this.worker?.terminate();
    this.worker = undefined;
  }

  private post(message: ToWorker): void {
    this.worker?.postMessage(message);
  }
}
