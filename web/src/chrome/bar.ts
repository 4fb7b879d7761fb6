import { element } from '../dom';
import type { ExportedFile, Frame } from '../engine/messages';
import type { SessionClient } from '../engine/session';
import { iconButton, relabel } from './button';
import type { Files } from './files';
import { menuOn, type Entry } from './menu';
import { scenePicker } from './scene-picker';
import type { Theme } from './theme';

/** What the buttons of the bar do that is not said to the session alone. */
export interface BarActions {
  pauseOrPlay(): void;
  step(): void;
  reset(): void;
  picture(): void;
  help(): void;
  togglePanel(): void;
}

/** The bar along the top: scene, clock, tape, and what goes out of the page. */
export function fillBar(
  bar: HTMLElement,
  session: SessionClient,
  actions: BarActions,
  files: Files,
  theme: Theme,
  chip: HTMLElement,
): void {
  const play = iconButton('pause', 'Pause (P)', actions.pauseOrPlay);
  play.classList.add('primary');
  const step = iconButton('step', 'One step (full stop)', actions.step);
  const reset = iconButton('reset', 'Reset (R)', actions.reset);
  const record = iconButton('record', 'Record', () =>
    session.send({ type: session.frame?.recording ? 'stop-recording' : 'start-recording' }),
  );
  record.classList.add('record');
  const replay = iconButton('replay', 'Replay');
  const snapshots = iconButton('keep', 'Kept states');
  const exports = iconButton('export', 'Export');
  const open = iconButton('open', 'Open a mesh, scene or recording', () => files.choose());
  const picture = iconButton('picture', 'Save a picture', actions.picture);
  const look = iconButton('dark', 'Dark', () => theme.toggle());
  const panel = iconButton('panel', 'Show or hide the panel', actions.togglePanel);
  theme.follow((dark) => relabel(look, dark ? 'light' : 'dark', dark ? 'Light theme' : 'Dark theme'));

  let last: ExportedFile | undefined;
  session.on('file', (file) => {
    if (file.purpose === 'recording') last = file;
  });

  bar.append(
    element('span', { className: 'brand' }, mark(), element('h1', {}, 'Viscera')),
    scenePicker(session),
    group('Clock', play, step, reset),
    group('Tape', record, replay, snapshots),
    group('Files', open, picture, exports),
    element('span', { className: 'spring' }),
    chip,
    group('Page', look, iconButton('help', 'Help (H)', actions.help), panel),
    files.input,
    menuOn(replay, 'Replay', () => recordings(session, last)),
    menuOn(snapshots, 'Kept states', () => keptStates(session)),
    menuOn(exports, 'Export', () => exported(session)),
  );

  const driving = [play, step, reset, record, replay, snapshots, open];
  const enable = () => {
    const { frame, role } = session;
    for (const button of driving) button.disabled = role.role !== 'controller';
    step.disabled ||= frame?.state === 'running';
  };
  session.on('role', enable);
  session.on('frame', (frame) => {
    const running = frame.state === 'running';
    relabel(play, running ? 'pause' : 'play', running ? 'Pause (P)' : 'Go on (P)');
    relabel(
      record,
      frame.recording ? 'stop' : 'record',
      frame.recording ? 'Stop recording and keep the file' : 'Record',
    );
    record.classList.toggle('on', frame.recording !== undefined);
    replay.classList.toggle('on', frame.replay !== undefined);
    enable();
  });
}

function group(title: string, ...children: HTMLElement[]): HTMLElement {
  return element(
    'div',
    { className: 'group', attributes: { role: 'group', 'aria-label': title } },
    ...children,
  );
}

function mark(): HTMLElement {
  return element('img', {
    src: new URL('../style/icon.svg', import.meta.url).href,
    alt: '',
    width: 28,
    height: 28,
  });
}

function recordings(session: SessionClient, last: ExportedFile | undefined): readonly Entry[] {
  const frame: Frame | undefined = session.frame;
  if (frame?.replay) return [{ title: 'Stop the replay', run: () => session.send({ type: 'stop-replay' }) }];
  const own: Entry[] = last
    ? [
        {
          title: 'The one just recorded',
          note: last.name,
          run: () => session.send({ type: 'replay', bytes: last.bytes }),
        },
      ]
    : [];
  const known = (session.catalogue?.recordings ?? []).map(({ name, title, seconds }) => ({
    title,
    note: `${seconds.toFixed(0)} s`,
    run: () => session.send({ type: 'replay', name }),
  }));
  const all = [...own, ...known];
  return all.length > 0 ? all : [{ title: 'Nothing recorded yet', disabled: true, run: () => undefined }];
}

function keptStates(session: SessionClient): readonly Entry[] {
  const slots = session.scene?.snapshots ?? [];
  const free = slots.findIndex((slot) => slot === null);
  const oldest = slots.reduce(
    (best, slot, index) => ((slot?.time ?? 0) < (slots[best]?.time ?? 0) ? index : best),
    0,
  );
  const slot = free >= 0 ? free : oldest;
  const keep: Entry = {
    title: 'Keep the present state',
    note: free >= 0 ? '' : 'takes the place of the earliest',
    run: () => session.send({ type: 'take-snapshot', slot }),
  };
  const kept = slots.flatMap((state, index): Entry[] =>
    state
      ? [
          {
            title: `Back to ${state.time.toFixed(2)} s`,
            note: `state ${index + 1}`,
            run: () => session.send({ type: 'restore-snapshot', slot: index }),
          },
        ]
      : [],
  );
  return [keep, ...kept];
}

function exported(session: SessionClient): readonly Entry[] {
  const entry = (title: string, note: string, what: 'observables' | 'state' | 'scene'): Entry => ({
    title,
    note,
    run: () => session.request({ type: 'export', what }),
  });
  return [
    entry('Measurements of the last minutes', 'CSV', 'observables'),
    entry('The present state', 'VTU, for ParaView', 'state'),
    entry('The scene with its parameters', 'TOML', 'scene'),
  ];
}
