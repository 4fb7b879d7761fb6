import { Vector3 } from 'three';

/** Where an instrument is wanted: what `move-instrument` says. */
export interface Pose {
  tip: Vector3;
  direction: Vector3;
  roll: number;
  trigger: number;
}

/**
 * The hand on an instrument. It is given goals, one after the other, and goes to them at a hand's speed: back out of the
 * tissue, over it, then in, so that a tool that is sent across the organ does not plough through it.
 */
export class Hand {
  readonly pose: Pose;
  private goals: Goal[] = [];
  private readonly speed: number;
  private readonly within: number;
  private trocar: Vector3 | undefined;

  /** `speed`: how fast the tip goes at most [m/s]. `within`: how far inside of its trocar it stays [m]. */
  constructor(pose: Pose, speed: number, within = 0) {
    this.pose = pose;
    this.speed = speed;
    this.within = within;
  }

  /** The point that the shaft passes through: the tip stays on its own side of it, as a tool that is pulled out would turn round. */
  enterThrough(trocar: Vector3 | undefined): void {
    this.trocar = trocar;
  }

  /** The place that is meant, or the nearest on the tool's side of its trocar. */
  private inside(tip: Vector3): Vector3 {
    if (!this.trocar) return tip;
    const inwards = this.pose.tip.clone().sub(this.trocar).normalize();
    const aside = tip.clone().sub(this.trocar);
    const depth = aside.dot(inwards);
    if (depth >= this.within) return tip;
    // Not farther to the side than within: along the wall, a shaft would lie in it.
    aside.addScaledVector(inwards, -depth).clampLength(0, this.within);
    return tip.copy(this.trocar).addScaledVector(inwards, this.within).add(aside);
  }

  get arrived(): boolean {
    return this.goals.length === 0;
  }

  /** Out by `clearance` [m], across, and in to `tip`, coming from `direction`; then the trigger. */
  approach(tip: Vector3, direction: Vector3, clearance: number, trigger: number): void {
    const heading = direction.clone().normalize();
    const here = this.pose.tip;
    const above = this.inside(tip.clone().addScaledVector(heading, -clearance));
    this.goals = [];
    if (here.distanceTo(tip) > clearance) {
      this.goals.push({
        tip: this.inside(here.clone().addScaledVector(this.pose.direction.clone().normalize(), -clearance)),
        trigger: 0,
      });
      this.goals.push({ tip: above, direction: heading, trigger: 0 });
    }
    this.goals.push({ tip: tip.clone(), direction: heading, trigger: 0 });
    this.goals.push({ tip: tip.clone(), direction: heading, trigger });
  }

  /** Straight on to `tip` with the trigger as it is. While an approach is under way, its end moves along. */
  moveTo(wanted: Vector3): void {
    const tip = this.inside(wanted.clone());
    const last = this.goals.at(-1);
    const before = this.goals.at(-2);
    if (last) last.tip.copy(tip);
    if (last && before) before.tip.copy(tip);
    if (!last) this.goals = [{ tip: tip.clone() }];
  }

  /** Where the last goal is, or the tip is if there is none. */
  get goal(): Vector3 {
    return this.goals.at(-1)?.tip ?? this.pose.tip;
  }

  /** Lets go, and backs out by `clearance` [m] of what it worked on. */
  release(clearance: number): void {
    this.pose.trigger = 0;
    const heading = this.pose.direction.clone().normalize();
    this.goals =
      clearance > 0
        ? [{ tip: this.inside(this.pose.tip.clone().addScaledVector(heading, -clearance)), trigger: 0 }]
        : [];
  }

  setTrigger(trigger: number): void {
    this.pose.trigger = trigger;
    for (const goal of this.goals) if (goal.trigger !== undefined) goal.trigger = trigger;
  }

  turnRoll(angle: number): void {
    this.pose.roll += angle;
  }

  /** Goes on for `seconds`; true when the pose changed. */
  advance(seconds: number): boolean {
    let left = this.speed * seconds;
    let changed = false;
    while (this.goals.length > 0) {
      const goal = this.goals[0]!;
      const way = goal.tip.clone().sub(this.pose.tip);
      const distance = way.length();
      if (goal.direction) {
        const part = distance > 0 ? Math.min(1, left / distance) : 1;
        this.pose.direction.normalize().lerp(goal.direction, part);
        // Half-way between a heading and its opposite there is none.
        if (this.pose.direction.lengthSq() < 1e-6) this.pose.direction.copy(goal.direction);
        this.pose.direction.normalize();
      }
      changed = true;
      if (distance > left) {
        this.pose.tip.addScaledVector(way, left / distance);
        return true;
      }
      this.pose.tip.copy(goal.tip);
      left -= distance;
      if (goal.trigger !== undefined) this.pose.trigger = goal.trigger;
      this.goals.shift();
      // One goal a turn at the end: the tool arrives before its jaws begin to close.
      if (distance > 0 && this.goals.length === 1) break;
    }
    return changed;
  }
}

interface Goal {
  tip: Vector3;
  direction?: Vector3;
  trigger?: number;
}
