import type { Transport } from './transport';
import { serverIsThere, WebSocketTransport } from './websocket';
import { WorkerTransport } from './worker';

/** The program where there is one, else the engine in this page; `?engine=native` or `?engine=wasm` decides it. */
export async function chooseTransport(location: Location): Promise<Transport> {
  const wanted = new URLSearchParams(location.search).get('engine');
  if (wanted === 'wasm') return new WorkerTransport();
  const address = new URL('ws', location.href);
  address.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
  address.search = '';
  address.hash = '';
  if (wanted === 'native' || (await serverIsThere(address.href))) return new WebSocketTransport(address.href);
  return new WorkerTransport();
}
