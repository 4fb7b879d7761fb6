import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { afterAll, expect, test } from 'vitest';
import { build } from 'vite';
import { engineFirst } from '../../vite.config';

const folder = mkdtempSync(join(tmpdir(), 'viscera-build-'));
afterAll(() => rmSync(folder, { recursive: true, force: true }));

/** Builds a page of one line behind a script for the engine that ends so; gives what was said and what came out. */
async function pageAfter(script?: string): Promise<{ warnings: string[]; page: string }> {
  const file = join(folder, 'build-engine.sh');
  rmSync(file, { force: true });
  if (script !== undefined) writeFileSync(file, `cd '${folder}'\n${script}\n`);
  writeFileSync(join(folder, 'index.html'), '<script type="module" src="./page.js"></script>');
  writeFileSync(join(folder, 'page.js'), "console.log(Object.keys(import.meta.glob('./engine.js')));");
  rmSync(join(folder, 'engine.js'), { force: true });
  const warnings: string[] = [];
  const built = await build({
    configFile: false,
    root: folder,
    logLevel: 'silent',
    plugins: [engineFirst(file)],
    build: {
      write: false,
      modulePreload: false,
      rollupOptions: { onwarn: ({ message }) => warnings.push(message) },
    },
  });
  const { output } = built as Exclude<typeof built, { on: unknown } | unknown[]>;
  return { warnings, page: output.map((part) => ('code' in part ? part.code : '')).join('') };
}

test('the page has the engine that is built first', async () => {
  const { warnings, page } = await pageAfter('echo "export const engine = 5;" > engine.js');
  expect(page).toContain('./engine.js');
  expect(warnings).toEqual([]);
});

test('where the engine cannot be built, the page is built without it and says so aloud', async () => {
  const { warnings, page } = await pageAfter('exit 3');
  expect(warnings.join()).toContain('THE ENGINE WAS NOT BUILT');
  expect(page).not.toContain('./engine.js');
});

test('an engine that is broken breaks the build', async () => {
  await expect(pageAfter('exit 101')).rejects.toThrow('ended with 101');
});

test('the copy from which the program builds its page has no engine to build', async () => {
  const { warnings, page } = await pageAfter();
  expect(warnings).toEqual([]);
  expect(page).not.toContain('./engine.js');
});
