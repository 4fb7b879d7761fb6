import { spawn, type ChildProcess } from 'node:child_process';
import { existsSync } from 'node:fs';
import { once } from 'node:events';
import { PROGRAM_PORT } from '../../playwright.config';
import { newest } from './newest';

/** The program that VISCERA names, or else the one that cargo built last, with or without optimisation. */
function programFile(): string {
  const named = process.env['VISCERA'];
  if (named !== undefined && existsSync(named)) return named;
  const target = process.env['CARGO_TARGET_DIR'] ?? '../target';
  const built = newest([`${target}/release/viscera`, `${target}/debug/viscera`]);
  if (built === undefined)
    throw new Error('These tests need the program: run `cargo build -p viscera-cli`, or name it in VISCERA.');
  return built;
}

/** `viscera serve`, started and ended by a test. */
export class Program {
  private child: ChildProcess | undefined;
  said = '';

  async start(): Promise<void> {
    const child = spawn(programFile(), ['serve', '--port', String(PROGRAM_PORT), '--no-open'], {
      stdio: ['ignore', 'pipe', 'pipe'],
    });
    this.child = child;
    for (const stream of [child.stdout, child.stderr])
      stream?.on('data', (text: Buffer) => (this.said += text.toString()));
    for (let attempt = 0; attempt < 200; attempt++) {
      if (child.exitCode !== null) throw new Error(`the program ended: ${this.said}`);
      const answer = await fetch(`http://127.0.0.1:${PROGRAM_PORT}/`).catch(() => undefined);
      if (answer) return;
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    throw new Error(`the program does not listen: ${this.said}`);
  }

  async stop(): Promise<void> {
    const child = this.child;
    this.child = undefined;
    if (!child || child.exitCode !== null) return;
    const gone = once(child, 'exit');
    child.kill('SIGKILL');
    await gone;
  }
}
