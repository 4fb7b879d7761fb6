import { element } from '../dom';
import { LONGEST_COMMAND, type ExportedFile } from '../engine/messages';
import type { SessionClient } from '../engine/session';
import type { Notices } from './notices';

/** What a file is to the page, by its name. */
export type FileKind = 'mesh' | 'scene' | 'recording';

export function kindOf(name: string, meshFormats: readonly string[]): FileKind | undefined {
  const extension = name.slice(name.lastIndexOf('.') + 1).toLowerCase();
  if (extension === 'toml') return 'scene';
  if (extension === 'viscera-recording') return 'recording';
  return meshFormats.some((format) => format.replace(/^\./, '').toLowerCase() === extension)
    ? 'mesh'
    : undefined;
}

/** The largest file that can be opened [bytes]: its name and the keys of the command need some room beside it. */
const LARGEST = LONGEST_COMMAND - 2 ** 12;
const MEBIBYTE = 2 ** 20;

/** Files into the session, by drop or by choice, and files out of it. */
export class Files {
  readonly overlay: HTMLElement;
  readonly input = element('input', {
    type: 'file',
    className: 'unseen',
    tabIndex: -1,
    ariaLabel: 'File to open',
  });
  private readonly session: SessionClient;
  private readonly notices: Notices;

  constructor(session: SessionClient, notices: Notices) {
    this.session = session;
    this.notices = notices;
    const formats = element('p', { className: 'note' });
    this.overlay = element(
      'div',
      { className: 'drop', hidden: true },
      element('p', {}, 'Drop a mesh, a scene or a recording'),
      formats,
    );
    session.on('catalogue', ({ meshFormats }) => {
      formats.textContent = `Meshes: ${meshFormats.join(', ')}. Scenes: toml.`;
    });
    session.on('file', (file) => save(file));
    this.input.addEventListener('change', () => {
      const file = this.input.files?.[0];
      this.input.value = '';
      if (file) void this.take(file);
    });
    this.listen();
  }

  choose(): void {
    this.input.click();
  }

  async take(file: File): Promise<void> {
    const formats = this.session.catalogue?.meshFormats ?? [];
    const kind = kindOf(file.name, formats);
    if (kind && file.size > LARGEST) {
      const larger = kind === 'mesh' ? ' A scene file may name larger ones: `viscera run` takes them.' : '';
      const help = `At most ${LONGEST_COMMAND / MEBIBYTE} MiB can be opened here.${larger}`;
      const size = `${Math.ceil(file.size / MEBIBYTE)} MiB`;
      this.notices.show('error', `${file.name} is too large: it has ${size}.`, help);
    } else if (kind === 'scene') {
      this.session.send({ type: 'open-text', text: await file.text(), name: file.name });
    } else if (kind === 'mesh' || kind === 'recording') {
      const bytes = new Uint8Array(await file.arrayBuffer());
      this.session.send(
        kind === 'mesh' ? { type: 'open-mesh', name: file.name, bytes } : { type: 'replay', bytes },
      );
    } else {
      const help = `Meshes may be ${formats.join(', ')}; scenes are toml.`;
      this.notices.show('error', `${file.name} is nothing that can be opened here.`, help);
    }
  }

  private listen(): void {
    // Entering a child leaves its parent: only leaving as often as entering means that the file is gone.
    let depth = 0;
    const carriesFiles = (event: DragEvent) => event.dataTransfer?.types.includes('Files') === true;
    window.addEventListener('dragenter', (event) => {
      if (!carriesFiles(event)) return;
      depth += 1;
      this.overlay.hidden = false;
    });
    window.addEventListener('dragleave', () => {
      depth = Math.max(0, depth - 1);
      this.overlay.hidden = depth === 0;
    });
    window.addEventListener('dragover', (event) => {
      if (carriesFiles(event)) event.preventDefault();
    });
    window.addEventListener('drop', (event) => {
      event.preventDefault();
      depth = 0;
      this.overlay.hidden = true;
      const file = event.dataTransfer?.files[0];
      if (file) void this.take(file);
    });
  }
}

/** Hands a file to the reader. */
export function save({ name, mime, bytes }: Pick<ExportedFile, 'name' | 'mime' | 'bytes'>): void {
  saveBlob(name, new Blob([bytes.slice()], { type: mime }));
}

export function saveBlob(name: string, blob: Blob): void {
  const address = URL.createObjectURL(blob);
  element('a', { href: address, download: name }).click();
  // Browsers read the address after the click has returned.
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
