import { mkdtempSync, rmSync, utimesSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { afterEach, expect, test } from 'vitest';
import { newest } from '../page/newest';

const folder = mkdtempSync(join(tmpdir(), 'viscera-newest-'));
afterEach(() => rmSync(folder, { recursive: true, force: true }));

test('of two programs the one that was built last is tested, however it was optimised', () => {
  const [release, debug] = [join(folder, 'release'), join(folder, 'debug')] as const;
  expect(newest([release, debug])).toBeUndefined();
  writeFileSync(release, '');
  expect(newest([release, debug])).toBe(release);
  writeFileSync(debug, '');
  utimesSync(release, 1000, 1000);
  utimesSync(debug, 2000, 2000);
  expect(newest([release, debug])).toBe(debug);
  utimesSync(release, 3000, 3000);
  expect(newest([release, debug])).toBe(release);
});
