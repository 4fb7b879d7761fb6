import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import type { Plugin } from 'vite';
import { defineConfig } from 'vitest/config';

// The session is another program's; it answers only to pages that it served itself, so the proxy speaks as one of them.
const program = `http://127.0.0.1:${process.env['VISCERA_PORT'] ?? '8472'}`;
const proxy = { '/ws': { target: program, ws: true, changeOrigin: true, rewriteWsOrigin: true } };

/** How `build-engine.sh` ends where it says what is missing to build with. */
const NOTHING_TO_BUILD_WITH = 3;

/**
 * Builds the engine as WebAssembly before the page, so that static files need no program behind them. Where there is no such script, as
 * in the copy from which the program builds the page that it embeds, the page is built alone.
 */
export function engineFirst(script: string): Plugin {
  return {
    name: 'engine-first',
    buildStart() {
      if (!existsSync(script)) return;
      const { status, error } = spawnSync('bash', [script], { stdio: ['ignore', 'inherit', 'inherit'] });
      if (status === 0) return;
      if (status !== NOTHING_TO_BUILD_WITH && !error) this.error(`${script} ended with ${status}`);
      this.warn(
        'THE ENGINE WAS NOT BUILT: this page works only with `viscera serve` behind it, or with the engine of an earlier build. ' +
          (error ? `It is built by bash: ${error.message}.` : 'What is missing stands above.'),
      );
    },
  };
}

// Relative addresses: the built page is served by the program at `/`, and by any static host below any path.
export default defineConfig(({ mode }) => ({
  base: './',
  build: { target: 'es2022', chunkSizeWarningLimit: 900 },
  plugins:
    mode === 'with-engine' ? [engineFirst(fileURLToPath(new URL('build-engine.sh', import.meta.url)))] : [],
  worker: { format: 'es' },
  server: { port: 5173, proxy },
  preview: { proxy },
  test: { include: ['tests/unit/**/*.test.ts'], environment: 'node' },
}));
