import { defineConfig } from 'vitest/config';

// Relative addresses: the built page is served by the program at `/`, and by any static host below any path.
export default defineConfig({
  base: './',
  build: { target: 'es2022', chunkSizeWarningLimit: 900 },
  worker: { format: 'es' },
  server: { port: 5173, proxy: { '/ws': { target: 'ws://127.0.0.1:7878', ws: true } } },
  preview: { proxy: {} },
  test: { include: ['tests/unit/**/*.test.ts'], environment: 'node' },
});
