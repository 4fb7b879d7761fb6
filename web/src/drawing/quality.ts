/**
 * How much is drawn, after how long drawing takes. A slow machine (or one that draws in software) first loses clearcoat and
 * pixels, then the shadow; it wins them back only when there is plenty of time, so that the picture does not flicker.
 */
export interface Quality {
  readonly name: 'full' | 'medium' | 'low' | 'least';
  /** At most so many canvas pixels per CSS pixel. */
  readonly pixelRatio: number;
  readonly shadow: boolean;
  /** The physical material with its wet coat, and not the plain one. */
  readonly coat: boolean;
}

export const LEVELS: readonly Quality[] = [
  { name: 'least', pixelRatio: 0.6, shadow: false, coat: false },
  { name: 'low', pixelRatio: 0.8, shadow: false, coat: false },
  { name: 'medium', pixelRatio: 1, shadow: true, coat: true },
  { name: 'full', pixelRatio: 2, shadow: true, coat: true },
];

/** Frames that have to agree before anything changes. */
const PATIENCE = 12;
/** Milliseconds per frame above which less is drawn, and below which more may be. */
const SLOW = 40;
const FAST = 18;

export class QualityControl {
  private slow = 0;
  private fast = 0;
  /** A level that was too slow once is not tried again. */
  private ceiling = LEVELS.length - 1;
  private level: number;

  constructor(start: number = LEVELS.length - 1) {
    this.level = start;
  }

  get quality(): Quality {
    return LEVELS[this.level]!;
  }

  /** Hears how many milliseconds passed between two drawn frames; true when the quality changed. */
  observe(milliseconds: number): boolean {
    // A pause of seconds is a hidden tab, not a slow machine.
    if (milliseconds > 2000) return false;
    this.slow = milliseconds > SLOW ? this.slow + 1 : 0;
    this.fast = milliseconds < FAST ? this.fast + 1 : 0;
    // The slower the frames, the fewer of them have to tell.
    const patience = milliseconds > 4 * SLOW ? PATIENCE / 4 : PATIENCE;
    if (this.slow >= patience && this.level > 0) {
      this.ceiling = this.level - 1;
      return this.change(this.level - 1);
    }
    if (this.fast >= 10 * PATIENCE && this.level < this.ceiling) return this.change(this.level + 1);
    return false;
  }

  private change(level: number): boolean {
    this.level = level;
    this.slow = 0;
    this.fast = 0;
    return true;
  }
}
