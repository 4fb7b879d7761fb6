import { defineConfig } from 'vitest/config';

// The session is another program's; it answers only to pages that it served itself, so the proxy speaks as one of them.
const program = `http://127.0.0.1:${process.env['VISCERA_PORT'] ?? '8472'}`;
const proxy = { '/ws': { target: program, ws: true, changeOrigin: true, rewriteWsOrigin: true } };

// Relative addresses: the built page is served by the program at `/`, and by any static host below any path.
export default defineConfig({
  base: './',
  build: { target: 'es2022', chunkSizeWarningLimit: 900 },
  worker: { format: 'es' },
  server: { port: 5173, proxy },
  preview: { proxy },
  test: { include: ['tests/unit/**/*.test.ts'], environment: 'node' },
});
