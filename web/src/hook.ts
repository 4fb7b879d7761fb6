import type { View } from './drawing/view';
import type { Frame, Scene } from './engine/messages';
import type { Connection, SessionClient } from './engine/session';
import type { Tools } from './handling/tools';

/** What the page knows at this moment, to be read by tests and by the curious from the browser's console. */
export interface PageState {
  connection: Connection;
  engine: string | undefined;
  session: number | undefined;
  scene: Scene | undefined;
  frame: Frame | undefined;
  /** Pictures drawn so far, and in the last second. */
  drawn: number;
  drawnPerSecond: number;
  quality: string;
  chosen: number | undefined;
  /** Milliseconds from a pose to a frame that knows it: the latest ones. */
  latencies: readonly number[];
  /** Where a point of the scene [m] appears on the page [CSS pixels]. */
  project(point: readonly [number, number, number]): { x: number; y: number };
  /** What lies under a point of the page. */
  under(x: number, y: number): string | undefined;
}

declare global {
  interface Window {
    viscera: { state(): PageState };
  }
}

/** `window.viscera.state()`; nothing can be changed by it. */
export function exposeState(session: SessionClient, view: View, tools: Tools): void {
  window.viscera = Object.freeze({
    state: (): PageState => ({
      connection: session.connection,
      engine: session.welcome?.engine,
      session: session.welcome?.session,
      scene: session.scene,
      frame: session.frame,
      drawn: view.drawn,
      drawnPerSecond: view.drawnPerSecond,
      quality: view.qualityName,
      chosen: tools.chosen?.instrument,
      latencies: tools.latencies,
      project: (point) => view.project(view.camera.position.clone().set(...point)),
      under: (x, y) => view.pick(x, y)?.kind,
    }),
  });
}
