/** Values along wall time: the last seconds of them, in rings that never grow. */
export class Series {
  private readonly times: Float64Array;
  private readonly values: Float64Array;
  private next = 0;
  private count = 0;

  constructor(capacity = 1200) {
    this.times = new Float64Array(capacity);
    this.values = new Float64Array(capacity);
  }

  push(time: number, value: number): void {
    this.times[this.next] = time;
    this.values[this.next] = value;
    this.next = (this.next + 1) % this.times.length;
    this.count = Math.min(this.count + 1, this.times.length);
  }

  clear(): void {
    this.count = 0;
  }

  get last(): number | undefined {
    return this.count === 0
      ? undefined
      : this.values[(this.next - 1 + this.values.length) % this.values.length];
  }

  /** Points not older than `since`, oldest first. */
  *after(since: number): Generator<readonly [time: number, value: number]> {
    const first = (this.next - this.count + this.times.length) % this.times.length;
    for (let index = 0; index < this.count; index++) {
      const place = (first + index) % this.times.length;
      const time = this.times[place]!;
      if (time >= since) yield [time, this.values[place]!];
    }
  }
}
