import type { Transport, TransportListener } from './transport';

/** Seconds between attempts: quick at first, as a restarted program is there at once, then patient. */
const PAUSES = [0.3, 0.6, 1, 2, 4] as const;

/** A session in the program, over its WebSocket; comes back by itself when the connection is lost. */
export class WebSocketTransport implements Transport {
  readonly peer = 'the program';
  private socket: WebSocket | undefined;
  private listener: TransportListener | undefined;
  private attempts = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private readonly address: string;

  constructor(address: string) {
    this.address = address;
  }

  open(listener: TransportListener): void {
    this.listener = listener;
    this.connect();
  }

  send(bytes: Uint8Array<ArrayBuffer>): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(bytes);
    return true;
  }

  close(): void {
    clearTimeout(this.timer);
    this.listener = undefined;
    this.socket?.close();
  }

  private connect(): void {
    const socket = new WebSocket(this.address);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    socket.onopen = () => {
      this.attempts = 0;
      this.listener?.opened();
    };
    socket.onmessage = (event: MessageEvent<ArrayBuffer>) =>
      this.listener?.received(new Uint8Array(event.data));
    // An error is always followed by a close, which says more.
    socket.onclose = (event) => this.retry(event);
  }

  private retry(event: CloseEvent): void {
    if (!this.listener) return;
    // 1008 and 1009: the program does not want this page as it is; asking again would change nothing.
    if (event.code === 1008 || event.code === 1009) {
      this.listener.lost(event.reason || 'The program refused the connection.');
      return;
    }
    const pause = PAUSES[Math.min(this.attempts, PAUSES.length - 1)]!;
    this.attempts += 1;
    this.listener.lost(event.reason || 'The program does not answer.', pause);
    this.timer = setTimeout(() => this.connect(), 1000 * pause);
  }
}

/** Whether a program is there that serves sessions, known after a second at the latest. */
export async function serverIsThere(address: string): Promise<boolean> {
  return new Promise((resolve) => {
    const socket = new WebSocket(address);
    const answer = (there: boolean) => {
      clearTimeout(timer);
      socket.onopen = socket.onclose = null;
      socket.close();
      resolve(there);
    };
    const timer = setTimeout(() => answer(false), 1000);
    socket.onopen = () => answer(true);
    socket.onclose = () => answer(false);
  });
}
