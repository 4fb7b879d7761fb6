import { decodeMessage, encodeCommand, EncodingError } from './encoding';
import {
  PROTOCOL_VERSION,
  type Catalogue,
  type Command,
  type ExportedFile,
  type Frame,
  type Message,
  type Notice,
  type Refusal,
  type Role,
  type Scene,
  type Surface,
  type Welcome,
} from './messages';
import type { Transport } from './transport';

export type Connection =
  { state: 'connecting' } | { state: 'connected' } | { state: 'lost'; reason: string; again: boolean };

interface Events {
  connection: Connection;
  welcome: Welcome;
  /** The program was started anew since the page last spoke with it. */
  restarted: Welcome;
  role: Role;
  catalogue: Catalogue;
  scene: Scene;
  surface: Surface;
  frame: Frame;
  notice: Notice;
  refusal: Refusal;
  file: ExportedFile;
}

type Handler<Name extends keyof Events> = (event: Events[Name]) => void;

/** The page's end of a session: says commands, and passes on what it hears as typed events. Holds the last of each. */
export class SessionClient {
  connection: Connection = { state: 'connecting' };
  welcome: Welcome | undefined;
  catalogue: Catalogue | undefined;
  scene: Scene | undefined;
  frame: Frame | undefined;
  role: Role = { type: 'role', role: 'controller', clients: 1 };

  private readonly transport: Transport;
  private readonly handlers: { [Name in keyof Events]?: Handler<Name>[] } = {};
  private lastRequest = 0;

  constructor(transport: Transport) {
    this.transport = transport;
  }

  open(): void {
    this.transport.open({
      opened: () => {
        this.send({ type: 'hello', version: PROTOCOL_VERSION, client: 'page' });
      },
      received: (bytes) => this.receive(bytes),
      lost: (reason, retryIn) => this.become({ state: 'lost', reason, again: retryIn !== undefined }),
    });
  }

  /** Says a command; false where nobody can hear it at present. */
  send(command: Command): boolean {
    return this.transport.send(encodeCommand(command));
  }

  /** Says a command that will be answered; the number that the answer will carry. */
  request(command: Command): number {
    this.lastRequest += 1;
    this.send({ ...command, request: this.lastRequest });
    return this.lastRequest;
  }

  on<Name extends keyof Events>(name: Name, handler: Handler<Name>): void {
    const known = (this.handlers[name] ??= []) as Handler<Name>[];
    known.push(handler);
  }

  private emit<Name extends keyof Events>(name: Name, event: Events[Name]): void {
    for (const handler of (this.handlers[name] ?? []) as Handler<Name>[]) handler(event);
  }

  private become(connection: Connection): void {
    this.connection = connection;
    this.emit('connection', connection);
  }

  private receive(bytes: Uint8Array): void {
    let message: Message | undefined;
    try {
      message = decodeMessage(bytes);
    } catch (error) {
      if (!(error instanceof EncodingError)) throw error;
      const help = 'Reload the page; if it comes again, page and program are of different versions.';
      this.emit('notice', {
        type: 'notice',
        level: 'error',
        text: `A message could not be read: ${error.message}.`,
        help,
      });
      return;
    }
    if (message) this.take(message);
  }

  private take(message: Message): void {
    switch (message.type) {
      case 'welcome': {
        const before = this.welcome;
        this.welcome = message;
        this.role = { type: 'role', role: message.role, clients: 1 };
        this.become({ state: 'connected' });
        this.emit('welcome', message);
        if (before && before.session !== message.session) this.emit('restarted', message);
        return;
      }
      case 'role':
        this.role = message;
        return this.emit('role', message);
      case 'catalogue':
        this.catalogue = message;
        return this.emit('catalogue', message);
      case 'scene':
        this.scene = message;
        return this.emit('scene', message);
      case 'surface':
        return this.emit('surface', message);
      case 'frame':
        this.frame = message;
        return this.emit('frame', message);
      case 'notice':
        return this.emit('notice', message);
      case 'refusal':
        return this.emit('refusal', message);
      case 'file':
        return this.emit('file', message);
    }
  }
}
