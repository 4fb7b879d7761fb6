/** What is said between the page and a session; `docs/protocol.md` says what each key means. SI units throughout. */

export const PROTOCOL_VERSION = 2;
/** The longest command that a session takes [bytes]. */
export const LONGEST_COMMAND = 64 * 2 ** 20;

export type Vector = [x: number, y: number, z: number];
export type ParameterValue = number | string | boolean | Vector;

/** The point that a shaft passes through [m]: this one, one that the session chooses, or none. */
export type Trocar = Vector | boolean;

// --- What the page says ------------------------------------------------------------------------------------------------

export type Command = { request?: number } & (
  | { type: 'hello'; version: number; client?: string }
  | { type: 'open-scene'; name: string }
  | { type: 'open-text'; text: string; name?: string }
  | { type: 'open-mesh'; name: string; bytes: Uint8Array; unit?: 'm' | 'cm' | 'mm'; edge?: number }
  | { type: 'set'; key: string; value: ParameterValue }
  | { type: 'add-instrument'; kind: string; tip?: Vector; direction?: Vector; trocar?: Trocar }
  | { type: 'set-trocar'; instrument: number; trocar: Trocar }
  | { type: 'remove-instrument'; instrument: number }
  | {
      type: 'move-instrument';
      instrument: number;
      tip: Vector;
      direction: Vector;
      roll: number;
      trigger: number;
      stamp?: number;
    }
  | { type: 'pause' | 'play' | 'reset' | 'start-recording' | 'stop-recording' | 'stop-replay' }
  | { type: 'step'; count?: number }
  | { type: 'take-snapshot' | 'restore-snapshot'; slot: number }
  | { type: 'colour'; by: string }
  | { type: 'ghost'; on: boolean }
  | { type: 'replay'; name?: string; bytes?: Uint8Array }
  | { type: 'export'; what: 'observables' | 'state' | 'scene' }
);

// --- What the page hears -----------------------------------------------------------------------------------------------

export interface Welcome {
  type: 'welcome';
  version: number;
  program: string;
  engine: 'native' | 'wasm';
  session: number;
  role: 'controller' | 'watcher';
  threads: number;
}

export interface Role {
  type: 'role';
  role: 'controller' | 'watcher';
  clients: number;
}

export interface Named {
  name: string;
  title: string;
  summary?: string;
}

export interface InstrumentKind {
  kind: string;
  title: string;
  summary: string;
  trigger: string;
}

export interface Colouring {
  name: string;
  title: string;
  unit: string;
  summary: string;
}

export interface Recording {
  name: string;
  title: string;
  scene: string;
  seconds: number;
}

export interface Catalogue {
  type: 'catalogue';
  scenes: Named[];
  recordings: Recording[];
  laws: Named[];
  models: Named[];
  integrators: Named[];
  instruments: InstrumentKind[];
  colourings: Colouring[];
  meshFormats: string[];
}

export interface Choice {
  name: string;
  title: string;
  available: boolean;
  reason?: string;
}

interface AnyParameter {
  key: string;
  group: string;
  title: string;
  summary: string;
  unit: string;
  effect: 'continues' | 'restarts';
  body?: number;
}

export interface NumberParameter extends AnyParameter {
  kind: 'number';
  value: number;
  default: number;
  least?: number;
  most?: number;
  leastExcluded?: boolean;
  mostExcluded?: boolean;
  scale: 'linear' | 'logarithmic';
  low: number;
  high: number;
}

export interface ChoiceParameter extends AnyParameter {
  kind: 'choice';
  value: string;
  default: string;
  choices: Choice[];
}

export interface VectorParameter extends AnyParameter {
  kind: 'vector';
  value: Vector;
  default: Vector;
}

export interface FlagParameter extends AnyParameter {
  kind: 'flag';
  value: boolean;
  default: boolean;
}

export type Parameter = NumberParameter | ChoiceParameter | VectorParameter | FlagParameter;

export interface SceneBody {
  name: string;
  ghostOf?: number;
  cells: number;
  nodes: number;
  vertices: number;
  law: string;
  model: string;
}

export interface SceneInstrument {
  instrument: number;
  kind: string;
  name: string;
  scripted: boolean;
  /** What pressing does with it. */
  manner: 'hold' | 'burn' | 'push';
  /** How far from its tip it takes hold or burns [m]. */
  reach: number;
  /** Its rigid parts, in the order of a frame's; none where it touches nothing. */
  parts: InstrumentPart[];
}

/** A rod with round ends, `length` [m] between the middles of them. */
export interface InstrumentPart {
  kind: 'shaft' | 'jaw';
  radius: number;
  length: number;
}

export interface Scene {
  type: 'scene';
  epoch: number;
  name: string;
  title: string;
  step: number;
  precision: 'single' | 'double';
  centre: Vector;
  radius: number;
  camera: { look: Vector; up: Vector };
  bodies: SceneBody[];
  instruments: SceneInstrument[];
  parameters: Parameter[];
  snapshots: ({ time: number } | null)[];
  ghost: boolean;
  colouring: string;
}

export interface Surface {
  type: 'surface';
  scene: number;
  body: number;
  epoch: number;
  vertices: number;
  triangles: Uint32Array;
  cut: Uint8Array;
  rest: Float32Array;
}

export interface FrameBody {
  epoch: number;
  positions: Float32Array;
  scalars?: Float32Array;
  seared?: Float32Array;
}

export interface FrameInstrument {
  instrument: number;
  tip: Vector;
  direction: Vector;
  roll: number;
  /** The point that its shaft passes through [m]. */
  trocar?: Vector;
  trigger: number;
  active: boolean;
  holds: boolean;
  force: Vector;
  torque: Vector;
  /** Its rigid parts as tissue feels them, seven numbers each: from, to, radius [m]. */
  parts?: Float32Array;
  stamp?: number;
}

export interface Observables {
  kinetic: number;
  elastic: number;
  gravity: number;
  volumeVariation: number;
  largestDisplacement: number;
  cells: number;
  removed: number;
  inverted: number;
  worstQuality: number;
  nonlinearNodes: number;
  atRest: boolean;
  /** Where volumes are kept exactly, the largest |V − V0|/V0 of them. */
  volumeError?: number;
  /** Of a hybrid body: how much the reaction of its pre-computed part changed in the last step, over its size. */
  interfaceResidual?: number;
}

export interface Frame {
  type: 'frame';
  scene: number;
  sequence: number;
  time: number;
  steps: number;
  state: 'running' | 'paused' | 'stopped';
  pace: { stepsPerSecond: number; realTime: number; lag: number };
  bodies: FrameBody[];
  colouring: { by: string; unit: string; low: number; high: number };
  instruments: FrameInstrument[];
  /** Number of the last command that this frame knows of. */
  request?: number;
  observables?: Observables[];
  recording?: { seconds: number };
  replay?: { name: string; seconds: number; of: number; agrees: boolean };
}

export interface Notice {
  type: 'notice';
  level: 'info' | 'warning' | 'error';
  text: string;
  help: string;
}

export interface Refusal {
  type: 'refusal';
  command: string;
  reason: string;
  help?: string;
  key?: string;
  request?: number;
  excerpt?: { source: string; line: number; column: number; text: string; length: number };
}

export interface ExportedFile {
  type: 'file';
  purpose: 'observables' | 'state' | 'scene' | 'recording';
  name: string;
  mime: string;
  bytes: Uint8Array;
  request?: number;
}

export type Message = Welcome | Role | Catalogue | Scene | Surface | Frame | Notice | Refusal | ExportedFile;
