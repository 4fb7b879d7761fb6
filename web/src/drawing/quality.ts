/**
 * How much is drawn, after how long drawing takes. A slow machine (or one that draws in software) first loses clearcoat and
 * pixels, then shadow and reflections; it wins them back only when there is plenty of time, so that the picture does not flicker.
 */
export interface Quality {
  readonly name: 'full' | 'medium' | 'low' | 'least';
  /** At most so many canvas pixels per CSS pixel. */
  readonly pixelRatio: number;
  readonly shadow: boolean;
  /** The physical material with grain and wet coat, and not the plain one. */
  readonly coat: boolean;
  /** Milliseconds from one picture to the next at least: where drawing takes all there is, the rest of the page needs some. */
  readonly pause: number;
  /** The room shines in tissue and steel, and not the lamps alone. */
  readonly reflections: boolean;
}

export const LEVELS: readonly Quality[] = [
  { name: 'least', pixelRatio: 0.6, shadow: false, coat: false, reflections: false, pause: 100 },
  { name: 'low', pixelRatio: 0.8, shadow: false, coat: false, reflections: true, pause: 0 },
  { name: 'medium', pixelRatio: 1, shadow: true, coat: true, reflections: true, pause: 0 },
  { name: 'full', pixelRatio: 2, shadow: true, coat: true, reflections: true, pause: 0 },
];

/** Where to begin: as `wanted` says, else low for a machine without graphics of its own, else at the top. */
export function firstLevel(wanted: string | null, renderer: string): number {
  const named = LEVELS.findIndex(({ name }) => name === wanted);
  if (named >= 0) return named;
  return /swiftshader|llvmpipe|software/i.test(renderer) ? 0 : LEVELS.length - 1;
}

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
  private readonly fixed: boolean;

  /** `fixed`: stays where it starts, however long drawing takes. */
  constructor(start: number = LEVELS.length - 1, fixed = false) {
    this.level = start;
    this.fixed = fixed;
  }

  get quality(): Quality {
    return LEVELS[this.level]!;
  }

  /** Hears how many milliseconds passed between two drawn frames; true when the quality changed. */
  observe(milliseconds: number): boolean {
    // A pause of seconds is a hidden tab, not a slow machine.
    if (this.fixed || milliseconds > 2000) return false;
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
