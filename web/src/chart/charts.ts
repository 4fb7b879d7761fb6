import type { Frame } from '../engine/messages';
import type { SessionClient } from '../engine/session';
import { element } from '../dom';
import { Chart } from './chart';
import { Series } from './series';

/** Milliseconds between two drawings of the charts: quick enough for the eye, and nothing beside the organ. */
const PAUSE = 120;

/** Live charts along the lower edge: rate, volume, energy, tool force. */
export class Charts {
  readonly node = element('div', {
    className: 'charts',
    attributes: { role: 'group', 'aria-label': 'Measurements' },
  });
  private readonly rate = new Series();
  private readonly volume = new Series();
  private readonly elastic = new Series();
  private readonly kinetic = new Series();
  private readonly force = new Series();
  private readonly charts: readonly Chart[];
  private readonly session: SessionClient;
  private readonly chosenInstrument: () => number | undefined;
  private epoch = -1;

  constructor(session: SessionClient, chosenInstrument: () => number | undefined) {
    this.session = session;
    this.chosenInstrument = chosenInstrument;
    this.charts = [
      new Chart('Rate', 'steps/s', [{ name: 'steps', series: this.rate }], 10),
      new Chart('Volume', '%', [{ name: 'volume', series: this.volume }], 0.2),
      new Chart(
        'Energy',
        'J',
        [
          { name: 'elastic', series: this.elastic },
          { name: 'kinetic', series: this.kinetic },
        ],
        1e-7,
      ),
      new Chart('Tool force', 'N', [{ name: 'force', series: this.force }], 0.1),
    ];
    this.node.append(...this.charts.map(({ node }) => node));
    session.on('frame', (frame) => this.take(frame));
    session.on('scene', ({ epoch }) => this.follow(epoch));
    setInterval(() => {
      const now = performance.now() / 1000;
      if (!document.hidden) for (const chart of this.charts) chart.draw(now);
    }, PAUSE);
  }

  /** Another scene begins with empty charts. */
  private follow(epoch: number): void {
    if (epoch === this.epoch) return;
    this.epoch = epoch;
    for (const series of [this.rate, this.volume, this.elastic, this.kinetic, this.force]) series.clear();
  }

  private take(frame: Frame): void {
    const now = performance.now() / 1000;
    this.rate.push(now, frame.pace.stepsPerSecond);
    const tool = frame.instruments.find(({ instrument }) => instrument === this.chosenInstrument());
    this.force.push(now, tool ? Math.hypot(...tool.force) : 0);
    if (!frame.observables) return;
    let [kinetic, elastic, volume, cells] = [0, 0, 0, 0];
    frame.observables.forEach((body, index) => {
      if (this.session.scene?.bodies[index]?.ghostOf !== undefined) return;
      kinetic += body.kinetic;
      elastic += body.elastic;
      volume += body.volumeVariation * body.cells;
      cells += body.cells;
    });
    this.kinetic.push(now, kinetic);
    this.elastic.push(now, elastic);
    if (cells > 0) this.volume.push(now, (100 * volume) / cells);
  }
}
