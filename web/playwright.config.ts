import { defineConfig } from '@playwright/test';
import { existsSync } from 'node:fs';

/** Chromium of the system where there is one (Debian's), else the one that Playwright brings. */
const system = process.env['CHROMIUM'] ?? ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(existsSync);

/** Where the page is served as static files, and where the program listens that the tests start. */
export const STATIC_PORT = 4179;
export const PROGRAM_PORT = 4187;

export default defineConfig({
  testDir: 'tests/page',
  outputDir: 'tests/artefacts/failures',
  // Limits, not expectations: on an idle machine nothing takes a quarter of that.
  timeout: 180_000,
  expect: { timeout: 45_000 },
  // One picture at a time: two processes that draw in software on two cores only make each other slow.
  workers: 1,
  // Beside other work a picture was read before it was drawn.
  retries: 1,
  reporter: [['list']],
  use: {
    baseURL: `http://127.0.0.1:${STATIC_PORT}`,
    viewport: { width: 800, height: 500 },
    screenshot: 'only-on-failure',
    launchOptions: {
      ...(system ? { executablePath: system } : {}),
      args: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
    },
  },
  webServer: {
    command: `npx vite preview --host 127.0.0.1 --port ${STATIC_PORT} --strictPort`,
    env: { VISCERA_PORT: String(PROGRAM_PORT) },
    port: STATIC_PORT,
    reuseExistingServer: true,
    stdout: 'ignore',
  },
});
