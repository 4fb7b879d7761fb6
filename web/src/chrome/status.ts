import type { View } from '../drawing/view';
import { element, say } from '../dom';
import type { Frame } from '../engine/messages';
import type { SessionClient } from '../engine/session';
import { shownNumber } from '../panel/units';

/** From which lag [s] on the page says that simulated time falls behind. */
const NOTABLE_LAG = 0.25;

/** The line at the upper left: time, pace, cells, pictures a second, and what is recorded or replayed. */
export function statusLine(session: SessionClient, view: View): HTMLElement {
  const time = element('span', { className: 'time' });
  const pace = element('span');
  const cells = element('span');
  const pictures = element('span', { className: 'pictures', title: 'Pictures drawn in the last second' });
  const tape = element('span', { className: 'tape', hidden: true });
  let counted = '';
  session.on('frame', (frame) => {
    say(time, `${frame.time.toFixed(2)} s${frame.state === 'running' ? '' : ` · ${frame.state}`}`);
    say(pace, paceOf(frame));
    pace.classList.toggle('late', frame.state === 'running' && frame.pace.lag > NOTABLE_LAG);
    counted = cellsOf(frame, session) || counted;
    say(cells, counted);
    const shown = tapeOf(frame);
    tape.hidden = shown === undefined;
    say(tape, shown ?? '');
    tape.classList.toggle('departs', frame.replay?.agrees === false);
  });
  setInterval(() => say(pictures, `${shownNumber(view.drawnPerSecond, 2)} pictures/s`), 500);
  return element('div', { className: 'status' }, time, pace, cells, pictures, tape);
}

function paceOf({ pace, state }: Frame): string {
  if (state !== 'running') return '';
  const speed = `${shownNumber(pace.realTime, 2)} × real time`;
  return pace.lag > NOTABLE_LAG ? `${speed}, ${pace.lag.toFixed(1)} s behind` : speed;
}

function cellsOf({ observables }: Frame, session: SessionClient): string {
  if (!observables) return '';
  let [cells, removed] = [0, 0];
  observables.forEach((body, index) => {
    if (session.scene?.bodies[index]?.ghostOf !== undefined) return;
    cells += body.cells;
    removed += body.removed;
  });
  const gone = removed > 0 ? ` (−${removed.toLocaleString('en')})` : '';
  return `${cells.toLocaleString('en')} cells${gone}`;
}

function tapeOf({ recording, replay }: Frame): string | undefined {
  if (replay) {
    const verdict = replay.agrees ? 'agrees' : 'departs from its recording';
    return `replaying ${replay.seconds.toFixed(1)} of ${replay.of.toFixed(1)} s · ${verdict}`;
  }
  return recording ? `recording ${recording.seconds.toFixed(1)} s` : undefined;
}
