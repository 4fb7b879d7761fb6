import { Vector3 } from 'three';
import type { FrameInstrument, InstrumentPart, SceneInstrument, Vector } from '../engine/messages';
import type { SessionClient } from '../engine/session';
import { Hand } from './hand';

/** Milliseconds between two poses that are said. */
const TURN = 16;
/** How fast a tool goes, and how far it backs out, in radii of the scene (per second). */
const SPEED = 7;
const CLEARANCE = 0.22;
/** Farther from where the hand left it [radii of the scene], a tool is no longer in hand. More than a hand goes before a picture tells of it. */
const FAR = 3;
/** Latencies that are kept for the numbers. */
const KEPT = 200;

/** How far within its trocar a tip stays, in radii of the scene: past it, a tool would turn round. */
const WITHIN = 0.12;

/** The instruments of the scene, which of them is in hand, and what the session is told about it. */
export class Tools {
  /** Milliseconds from a pose that was said to a frame that knows it, the last ones. */
  readonly latencies: number[] = [];
  /** The trigger stays where it is when the pointer is released. */
  latched = false;
  private chosenNumber: number | undefined;
  private hand: Hand | undefined;
  private readonly session: SessionClient;
  private readonly onChange: () => void;
  private last = performance.now();
  private stamp = 0;
  private wantsNewest = false;
  /** Where trocars were that were taken away, to be given back there. */
  private readonly trocars = new Map<string, Vector>();

  constructor(session: SessionClient, onChange: () => void) {
    this.session = session;
    this.onChange = onChange;
    session.on('scene', () => this.follow());
    session.on('frame', (frame) => {
      const state = frame.instruments.find((instrument) => instrument.instrument === this.chosenNumber);
      this.lookAfter(state, frame.replay !== undefined);
      this.hand?.enterThrough(state?.trocar && new Vector3(...state.trocar));
      if (state?.stamp !== undefined && state.stamp !== this.stamp) {
        this.stamp = state.stamp;
        this.latencies.push(performance.now() - state.stamp);
        if (this.latencies.length > KEPT) this.latencies.shift();
      }
    });
    // Not with the pictures: a machine that draws slowly leads its tools all the same.
    setInterval(() => this.turn(), TURN);
  }

  get list(): readonly SceneInstrument[] {
    return this.session.scene?.instruments ?? [];
  }

  get chosen(): SceneInstrument | undefined {
    return this.list.find((instrument) => instrument.instrument === this.chosenNumber);
  }

  /** Where the chosen instrument is, as the last frame says. */
  get state(): FrameInstrument | undefined {
    return this.session.frame?.instruments.find((instrument) => instrument.instrument === this.chosenNumber);
  }

  get mayDrive(): boolean {
    return this.session.role.role === 'controller' && this.session.frame?.replay === undefined;
  }

  choose(instrument: number | undefined): void {
    if (instrument === this.chosenNumber) return;
    this.chosenNumber = instrument;
    this.hand = undefined;
    this.latched = false;
    this.onChange();
  }

  /** Brings another instrument of this kind in, and takes it in hand once it is there. */
  add(kind: string): void {
    this.wantsNewest = this.session.send({ type: 'add-instrument', kind, trocar: this.throughWalls });
  }

  /** Whether tools come through the wall of the belly here: a new one comes as the others do. */
  private get throughWalls(): boolean {
    return this.session.frame?.instruments.some(({ trocar }) => trocar !== undefined) ?? false;
  }

  /** Gives the chosen tool a trocar, where it was or where the session has it, or takes it away. */
  toggleTrocar(): void {
    const { chosen, state } = this;
    if (!chosen || !state || !this.mayDrive) return;
    const key = `${this.session.scene?.name} ${this.session.scene?.epoch} ${chosen.instrument}`;
    if (state.trocar) this.trocars.set(key, state.trocar);
    const trocar = state.trocar ? false : (this.trocars.get(key) ?? true);
    this.session.send({ type: 'set-trocar', instrument: chosen.instrument, trocar });
    // The hand takes the tool as it is then.
    this.hand = undefined;
  }

  /** Where the trocar of the chosen tool is. */
  get trocar(): Vector3 | undefined {
    const at = this.state?.trocar;
    return at && new Vector3(...at);
  }

  moveTrocar(to: Vector3): void {
    const { chosen } = this;
    if (!chosen || !this.mayDrive || !this.trocar) return;
    this.session.send({ type: 'set-trocar', instrument: chosen.instrument, trocar: to.toArray() });
  }

  remove(instrument: number): void {
    this.session.send({ type: 'remove-instrument', instrument });
  }

  /**
   * Begins work at a point of the surface with the outward `normal`. `heading`: from where a free tool comes. With no tool at all, one
   * is brought in.
   */
  begin(point: Vector3, normal: Vector3, heading: Vector3): void {
    const instrument = this.chosen;
    if (!instrument && this.mayDrive) this.bringInAt(point, heading);
    const hand = this.inHand();
    if (!instrument || !hand) return;
    const direction = this.trocar ? point.clone().sub(this.trocar) : heading;
    hand.approach(this.depthOf(instrument, point, normal, direction), direction, this.clearance, 1);
  }

  /** Brings in the first kind of tool that has a trigger, a little off the tissue. */
  private bringInAt(point: Vector3, heading: Vector3): void {
    const kinds = this.session.catalogue?.instruments ?? [];
    const kind = (kinds.find(({ trigger }) => trigger !== '') ?? kinds[0])?.kind;
    if (kind === undefined) return;
    const tip = point.clone().addScaledVector(heading, -this.clearance).toArray();
    const direction = heading.toArray();
    this.wantsNewest = this.session.send({ type: 'add-instrument', kind, tip, direction });
  }

  /** Takes the tool as it is, to move it without working. */
  lead(): Vector3 | undefined {
    return this.inHand()?.goal.clone();
  }

  moveTo(tip: Vector3): void {
    this.inHand()?.moveTo(tip);
  }

  /** Ends work: jaws open and the electrode cools, unless the trigger is latched. */
  end(): void {
    const instrument = this.chosen;
    if (!instrument || !this.hand || this.latched) return;
    this.hand.release(instrument.manner === 'hold' ? 0 : 0.3 * this.clearance);
    this.say(this.hand);
  }

  nudge(by: Vector3): void {
    const hand = this.inHand();
    hand?.moveTo(hand.goal.clone().add(by));
  }

  roll(angle: number): void {
    const hand = this.inHand();
    if (!hand) return;
    hand.turnRoll(angle);
    this.say(hand);
  }

  /** Closes what is open and opens what is closed, and leaves it so. */
  toggleTrigger(): void {
    const hand = this.inHand();
    if (!hand) return;
    this.latched = hand.pose.trigger < 0.5;
    hand.setTrigger(this.latched ? 1 : 0);
    this.say(hand);
    this.onChange();
  }

  setLatched(latched: boolean): void {
    if (this.latched && !latched && this.hand) {
      this.hand.setTrigger(0);
      this.say(this.hand);
    }
    this.latched = latched;
    this.onChange();
  }

  /** The trigger that the hand asks for, 0 to 1. */
  get trigger(): number {
    return this.hand?.pose.trigger ?? this.state?.trigger ?? 0;
  }

  private get clearance(): number {
    return CLEARANCE * (this.session.scene?.radius ?? 1);
  }

  /** How deep work goes: jaws enclose what they take, an electrode sinks in, a probe presses. */
  private depthOf(instrument: SceneInstrument, point: Vector3, normal: Vector3, direction: Vector3): Vector3 {
    const radius = this.session.scene?.radius ?? 1;
    const { manner, parts, reach } = instrument;
    const of = (kind: InstrumentPart['kind']) => parts.find((part) => part.kind === kind);
    const depth =
      manner === 'hold'
        ? 0.35 * (of('jaw')?.length ?? reach)
        : manner === 'burn'
          ? (of('shaft')?.radius ?? 0.5 * reach)
          : 0.14 * radius;
    const tip = point.clone().addScaledVector(direction.clone().normalize(), depth);
    // A trocar may lead jaws along the surface: they would slide over it and close on nothing.
    return manner === 'hold' ? tip.addScaledVector(normal, -depth) : tip;
  }

  /** Takes the hand off a tool that was put elsewhere: by a replay, a kept state, another scene. */
  private lookAfter(state: FrameInstrument | undefined, replaying: boolean): void {
    const hand = this.hand;
    if (!hand?.arrived || !state) return;
    const away = hand.pose.tip.distanceTo(new Vector3(...state.tip));
    if (replaying || away > FAR * (this.session.scene?.radius ?? 1)) this.drop();
  }

  /** The hand on the chosen instrument, which takes it where it is. */
  private inHand(): Hand | undefined {
    if (!this.mayDrive) return undefined;
    const state = this.state;
    if (!this.hand && state) {
      const { tip, direction, roll, trigger } = state;
      const pose = { tip: new Vector3(...tip), direction: new Vector3(...direction), roll, trigger };
      const radius = this.session.scene?.radius ?? 1;
      this.hand = new Hand(pose, SPEED * radius, WITHIN * radius);
      this.hand.enterThrough(this.trocar);
    }
    return this.hand;
  }

  private follow(): void {
    const numbers = this.list.map((instrument) => instrument.instrument);
    const newest = Math.max(...numbers);
    const gone = this.chosenNumber === undefined || !numbers.includes(this.chosenNumber);
    if (numbers.length > 0 && (gone || (this.wantsNewest && newest !== this.chosenNumber))) {
      this.choose(this.wantsNewest ? newest : numbers[0]);
      this.wantsNewest = false;
    } else if (numbers.length === 0) {
      this.choose(undefined);
    }
    this.onChange();
  }

  /** Takes the hands off: what the session says about the tools holds again. */
  drop(): void {
    this.hand = undefined;
    this.latched = false;
    this.onChange();
  }

  private turn(): void {
    const now = performance.now();
    const seconds = Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    if (this.hand && this.mayDrive && this.hand.advance(seconds)) this.say(this.hand);
  }

  private say(hand: Hand): void {
    if (this.chosenNumber === undefined) return;
    const { tip, direction, roll, trigger } = hand.pose;
    this.session.send({
      type: 'move-instrument',
      instrument: this.chosenNumber,
      tip: tip.toArray(),
      direction: direction.toArray(),
      roll,
      trigger,
      stamp: performance.now(),
    });
  }
}
