/** The way between the page and a session: bytes there, bytes back, and whether there is a way at present. */
export interface Transport {
  /** What the user calls it, such as "the program". */
  readonly peer: string;
  /** Begins; `listener` hears all that happens from then on. */
  open(listener: TransportListener): void;
  /** Takes a command along; one that is sent while there is no way is lost, and false comes back. */
  send(bytes: Uint8Array<ArrayBuffer>): boolean;
  close(): void;
}

export interface TransportListener {
  /** There is a way; the page says hello. */
  opened(): void;
  received(bytes: Uint8Array): void;
  /** The way is lost. `retryIn`: seconds until the transport tries again by itself; missing where it never will. */
  lost(reason: string, retryIn?: number): void;
}
