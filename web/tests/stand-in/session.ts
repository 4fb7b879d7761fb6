import { decode, encode } from '@msgpack/msgpack';
import type { WebSocketRoute } from '@playwright/test';
import {
  PROTOCOL_VERSION,
  type Command,
  type FrameInstrument,
  type SceneInstrument,
} from '../../src/engine/messages';
import { blob, bytesOf } from './blob';
import { catalogue, parameters, sceneInstruments } from './scene';

/**
 * Stands in for a session where a test needs what a real one does not do on demand: to watch, to refuse, to restart, to say
 * nonsense. It has no physics: the blob bulges towards the tools.
 */
export class StandIn {
  readonly heard: Command[] = [];
  role: 'controller' | 'watcher' = 'controller';
  sessionNumber = 1;
  /** What its body tells of volumes that it keeps and parts that are pre-computed. */
  errors: { volumeError?: number; interfaceResidual?: number } = {};
  private route: WebSocketRoute | undefined;
  private readonly blob = blob();
  private sequence = 0;
  private running = true;
  private colouring = 'none';
  private ghost = false;
  private cutAway = 0;
  private timer: ReturnType<typeof setInterval> | undefined;
  private readonly tools = new Map<number, FrameInstrument>();
  private readonly instruments: SceneInstrument[] = sceneInstruments();
  readonly parameters = parameters();

  constructor() {
    for (const { instrument, kind } of this.instruments) {
      const tip: [number, number, number] =
        kind === 'grasper' ? [0.1, 0.1, 0.06] : kind === 'cautery' ? [-0.01, 0.1, 0.05] : [-0.12, 0.1, 0.07];
      const direction: [number, number, number] = [kind === 'probe' ? 0.5 : -0.35, -1, -0.5];
      this.tools.set(instrument, {
        instrument,
        tip,
        direction,
        roll: 0.6,
        trigger: 0,
        active: false,
        holds: false,
        force: [0, 0, 0],
        torque: [0, 0, 0],
        ...(kind === 'cautery' ? { trocar: [0.06, 0.2, 0.11] } : {}),
      });
    }
  }

  /** To be handed to `page.routeWebSocket`. */
  readonly serve = (route: WebSocketRoute): void => {
    this.route = route;
    route.onMessage((data) => typeof data !== 'string' && this.hear(decode(data) as Command));
    route.onClose(() => clearInterval(this.timer));
  };

  say(message: Record<string, unknown>): void {
    this.route?.send(Buffer.from(encode(message)));
  }

  sayBytes(bytes: Uint8Array): void {
    this.route?.send(Buffer.from(bytes));
  }

  /** Breaks off as a program does that ends. */
  async drop(): Promise<void> {
    clearInterval(this.timer);
    await this.route?.close({ code: 1001 });
  }

  /** Cuts the first `triangles` away and lays open what is there. */
  cut(triangles: number): void {
    this.cutAway = triangles;
    this.saySurface();
    this.sayFrame();
  }

  private hear(command: Command): void {
    this.heard.push(command);
    switch (command.type) {
      case 'hello':
        this.greet();
        break;
      case 'set': {
        const parameter = this.parameters.find(({ key }) => key === command.key);
        if (parameter) Object.assign(parameter, { value: command.value });
        this.sayScene();
        break;
      }
      case 'colour':
        this.colouring = command.by;
        this.sayScene();
        break;
      case 'ghost':
        this.ghost = command.on;
        this.sayScene();
        this.saySurface();
        break;
      case 'pause':
      case 'play':
        this.running = command.type === 'play';
        break;
      case 'move-instrument': {
        const tool = this.tools.get(command.instrument);
        const { tip, direction, roll, trigger, stamp } = command;
        if (tool)
          Object.assign(tool, {
            tip,
            direction,
            roll,
            trigger,
            stamp,
            active: trigger > 0.5,
          });
        break;
      }
      case 'set-trocar': {
        const tool = this.tools.get(command.instrument);
        if (!tool) break;
        if (command.trocar === false) delete tool.trocar;
        else tool.trocar = command.trocar === true ? [0.02, 0.09, 0.12] : command.trocar;
        break;
      }
    }
    this.sayFrame();
  }

  private greet(): void {
    const session = this.sessionNumber;
    this.say({
      type: 'welcome',
      version: PROTOCOL_VERSION,
      program: 'stand-in',
      engine: 'native',
      session,
      role: this.role,
      threads: 2,
    });
    this.say({ type: 'catalogue', ...catalogue });
    this.sayScene();
    this.saySurface();
    this.timer = setInterval(() => this.running && this.sayFrame(), 250);
  }

  private sayScene(): void {
    const body = {
      name: 'liver',
      cells: 1893,
      nodes: 521,
      vertices: this.blob.rest.length / 3,
      law: 'st-venant-kirchhoff',
      model: 'total-lagrangian',
    };
    this.say({
      type: 'scene',
      epoch: this.ghost ? 2 : 1,
      name: 'liver-resection',
      title: 'Resection of the left lobe of a liver',
      step: 0.01,
      precision: 'single',
      centre: [0, 0, 0],
      radius: 0.15,
      camera: { look: [-0.15, -0.45, -1], up: [0, 1, 0] },
      bodies: this.ghost ? [body, { ...body, ghostOf: 0 }] : [body],
      instruments: this.instruments,
      parameters: this.parameters,
      snapshots: [{ time: 1.2 }, null, null, null, null, null, null, null],
      ghost: this.ghost,
      colouring: this.colouring,
    });
  }

  private saySurface(): void {
    const { rest, triangles } = this.blob;
    const cut = new Uint8Array(triangles.length / 3);
    cut.fill(1, 0, this.cutAway);
    for (let body = 0; body < (this.ghost ? 2 : 1); body++) {
      this.say({
        type: 'surface',
        scene: this.ghost ? 2 : 1,
        body,
        epoch: this.cutAway > 0 ? 1 : 0,
        vertices: rest.length / 3,
        triangles: bytesOf(triangles),
        cut,
        rest: bytesOf(rest),
      });
    }
  }

  private sayFrame(): void {
    if (this.running) this.sequence += 1;
    const time = 0.01 * this.sequence;
    const { rest } = this.blob;
    const positions = rest.slice();
    const scalars = new Float32Array(rest.length / 3);
    const seared = new Float32Array(rest.length / 3);
    for (let vertex = 0; vertex < scalars.length; vertex++) {
      const place = [rest[3 * vertex]!, rest[3 * vertex + 1]!, rest[3 * vertex + 2]!] as const;
      let pull = 0;
      for (const tool of this.tools.values()) {
        const distance = Math.hypot(...place.map((x, axis) => x - tool.tip[axis]!));
        pull += tool.trigger * Math.exp(-((distance / 0.035) ** 2));
      }
      positions[3 * vertex + 1]! += 0.03 * pull + 0.002 * Math.sin(6 * place[0] * 10 + time);
      scalars[vertex] =
        this.colouring === 'volume' ? 0.1 * Math.sin(30 * place[0]) : Math.abs(place[0]) * 4e4 * (1 + pull);
      seared[vertex] = this.cutAway > 0 ? Math.exp(-(((place[0] - 0.03) / 0.012) ** 2)) : 0;
    }
    const epoch = this.cutAway > 0 ? 1 : 0;
    const body = {
      epoch,
      positions: bytesOf(positions),
      seared: bytesOf(seared),
      ...(this.colouring === 'none' ? {} : { scalars: bytesOf(scalars) }),
    };
    const observables = {
      kinetic: 1e-3 * Math.abs(Math.sin(time)),
      elastic: 0.02 + 0.01 * Math.sin(0.3 * time),
      gravity: 0,
      volumeVariation: -0.013 + 0.004 * Math.sin(time),
      largestDisplacement: 0.01,
      cells: 1893 - this.cutAway,
      removed: this.cutAway,
      inverted: 0,
      worstQuality: 0.3,
      nonlinearNodes: 0,
      atRest: false,
      ...this.errors,
    };
    const unit = { volume: '', stress: 'Pa', displacement: 'm' }[this.colouring] ?? '';
    const [low, high] = this.colouring === 'volume' ? [-0.1, 0.1] : [0, 5600];
    this.say({
      type: 'frame',
      scene: this.ghost ? 2 : 1,
      sequence: this.sequence,
      time,
      steps: this.sequence,
      state: this.running ? 'running' : 'paused',
      pace: { stepsPerSecond: 100, realTime: 1, lag: 0 },
      bodies: this.ghost ? [body, { epoch, positions: bytesOf(rest) }] : [body],
      colouring: { by: this.colouring, unit, low, high },
      instruments: [...this.tools.values()].map((tool) => ({ ...tool, parts: bytesOf(partsOf(tool)) })),
      observables: this.ghost ? [observables, observables] : [observables],
    });
  }
}

/** The rods of a tool of the stand-in: shaft, and for the first of them two jaws that close with the trigger. */
function partsOf({ instrument, tip, direction, trocar, trigger }: FrameInstrument): Float32Array {
  const way = trocar ? tip.map((x, axis) => x - trocar[axis]!) : direction;
  const size = Math.hypot(...way);
  const behind = (length: number, aside = 0) =>
    tip.map((x, axis) => x - (length * way[axis]!) / size + (axis === 0 ? aside : 0));
  const jaws = instrument === 0 ? 0.02 : 0;
  const shaft = [...behind(jaws + 0.3), ...behind(jaws), 0.0025];
  const jaw = (side: number) => [
    ...behind(jaws),
    ...behind(0, side * (0.002 + 0.006 * (1 - trigger))),
    0.002,
  ];
  return new Float32Array(jaws > 0 ? [...shaft, ...jaw(1), ...jaw(-1)] : shaft);
}
