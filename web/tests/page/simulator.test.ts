import { existsSync } from 'node:fs';
import { expect, test, type Page } from '@playwright/test';
import type { PageState } from '../../src/hook';
import { PROGRAM_PORT } from '../../playwright.config';
import { Program } from './program';
import { BLOCK } from './scenes';

/** The page with a real session, for both engines: the program, and WebAssembly in a worker. Each uses one page throughout. */

const WASM = 'src/engine/generated/viscera_web_bg.wasm';

const state = (page: Page): Promise<PageState> => page.evaluate(() => window.viscera.state() as PageState);

/** A number of the page's state as it is now. */
const number = (page: Page, read: (state: PageState) => number): Promise<number> =>
  page.evaluate(
    (source) =>
      (new Function('state', `return (${source})(state)`) as (state: PageState) => number)(
        window.viscera.state(),
      ),
    read.toString(),
  );

const time = (page: Page) => number(page, ({ frame }) => frame?.time ?? 0);
const steps = (page: Page) => number(page, ({ frame }) => frame?.steps ?? 0);

/** A measurement of the first body, from the next frame that has any: one in ten, and looked for at every one. */
const measured = async (page: Page, of: 'largestDisplacement' | 'removed'): Promise<number> => {
  const found = await page.waitForFunction(
    (of) => {
      const seen = window.viscera.state().frame?.observables?.[0];
      return seen && { value: seen[of] };
    },
    of,
    { polling: 8 },
  );
  return ((await found.jsonValue()) as { value: number }).value;
};

/** The largest displacement of the first body [m]. */
const sag = (page: Page) => measured(page, 'largestDisplacement');

/** Where a point of the scene is on the page. */
const place = (page: Page, point: [number, number, number]) =>
  page.evaluate((x) => window.viscera.state().project(x), point);

async function openText(page: Page, name: string, text: string): Promise<void> {
  await page
    .locator('input[type=file]')
    .setInputFiles({ name, mimeType: 'application/toml', buffer: Buffer.from(text) });
}

/** Brings a tool of this kind in, and waits until it is in hand. */
async function bringIn(page: Page, title: string): Promise<void> {
  const before = await number(page, ({ scene }) => scene?.instruments.length ?? 0);
  await page.getByRole('button', { name: 'Add' }).click();
  await page.getByRole('menuitem', { name: title }).click();
  await expect(page.getByRole('radio', { checked: true, name: new RegExp(title, 'i') })).toBeVisible();
  await expect.poll(() => number(page, ({ frame }) => frame?.instruments.length ?? 0)).toBe(before + 1);
}

const holds = (page: Page) =>
  number(page, ({ frame, chosen }) =>
    Number(frame?.instruments.find(({ instrument }) => instrument === chosen)?.holds ?? false),
  );

/** What the tool in hand feels [N]. */
const force = (page: Page) =>
  number(page, ({ frame, chosen }) => {
    const tool = frame?.instruments.find(({ instrument }) => instrument === chosen);
    return Math.hypot(...(tool?.force ?? [0, 0, 0]));
  });

/** Milliseconds within which 95 of 100 poses of the tool in hand were in a frame. */
async function latency(page: Page): Promise<number> {
  const { latencies } = await state(page);
  const sorted = [...latencies].sort((one, other) => one - other);
  return sorted[Math.ceil(0.95 * sorted.length) - 1] ?? NaN;
}

/** Cells of the first body that are gone. */
const removed = (page: Page) => measured(page, 'removed');

/** Waits until the first body's largest displacement changes by less than half a millimetre in 0.3 s of simulated time. */
async function comeToRest(page: Page): Promise<void> {
  let [moment, way] = [await time(page), await sag(page)];
  const rests = async () => {
    if ((await time(page)) < moment + 0.3) return false;
    const [later, now] = [await time(page), await sag(page)];
    const changed = Math.abs(now - way);
    [moment, way] = [later, now];
    return changed < 5e-4;
  };
  await expect.poll(rests).toBe(true);
}

/** A place on the left lobe of the first scene's liver that the eye sees now. */
async function lobe(page: Page): Promise<{ x: number; y: number }> {
  const seen = () =>
    page.evaluate(() => {
      const { project, under, scene } = window.viscera.state();
      const [x, y, z] = scene!.centre;
      const places = [0.08, 0.06, 0.04, 0.02, 0].map((across) => project([x + across, y, z + 0.04]));
      return places.find(({ x: left, y: top }) => under(left, top) === 'tissue');
    });
  await expect.poll(seen).toBeDefined();
  return (await seen())!;
}

async function openBlock(page: Page): Promise<void> {
  const before = await number(page, ({ scene }) => scene?.epoch ?? -1);
  await openText(page, 'block.toml', BLOCK);
  await expect.poll(() => number(page, ({ scene }) => scene?.epoch ?? -1)).toBeGreaterThan(before);
  await expect.poll(async () => (await state(page)).scene?.title).toBe('A block');
  await expect.poll(() => time(page)).toBeGreaterThan(0.1);
}

for (const engine of ['native', 'wasm'] as const) {
  test.describe(engine, () => {
    test.describe.configure({ mode: 'serial' });
    test.skip(
      engine === 'wasm' && !existsSync(WASM),
      'the engine was not built as WebAssembly: npm run build:engine',
    );

    const program = new Program();
    const complaints: string[] = [];
    let page: Page;

    test.beforeAll(async ({ browser }) => {
      if (engine === 'native') await program.start();
      page = await browser.newPage({ viewport: { width: 800, height: 500 }, acceptDownloads: true });
      page.on('console', (message) => {
        // The browser itself reports a refused connection, which one of the tests brings about.
        if (message.type() === 'error' && !/WebSocket connection|ERR_CONNECTION_REFUSED/.test(message.text()))
          complaints.push(message.text());
      });
      page.on('pageerror', (error) => complaints.push(String(error)));
      // The program brings its own page along; WebAssembly needs no more than static files.
      const home = engine === 'native' ? `http://127.0.0.1:${PROGRAM_PORT}/` : '/';
      await page.goto(`${home}?engine=${engine}`);
      await expect.poll(async () => (await state(page)).frame !== undefined, { timeout: 60_000 }).toBe(true);
      // It lies over the tissue on a page as small as this one.
      await page.getByRole('button', { name: 'Understood' }).click();
    });

    test.afterAll(async () => {
      await page?.close();
      await program.stop();
    });

    test('the first scene is there, and its organ is seen', async () => {
      const { scene } = await state(page);
      expect(scene?.bodies.length).toBeGreaterThan(0);
      await expect(page.getByRole('combobox', { name: 'Scene' })).not.toBeEmpty();
      await page.waitForFunction(() => window.viscera.state().drawn > 2);
      await page.screenshot({ path: `tests/artefacts/${engine}-first.png` });
      // Tissue is red; the ground is grey. A good part of the picture's middle has to be tissue.
      const red = await page.evaluate(async () => {
        const canvas = document.querySelector<HTMLCanvasElement>('#view')!;
        const sheet = new OffscreenCanvas(64, 40).getContext('2d')!;
        let count = 0;
        // The canvas can be read in a frame in which something was drawn, and not every frame is one.
        for (let frame = 0; frame < 600 && count === 0; frame++) {
          await new Promise((resolve) => requestAnimationFrame(resolve));
          sheet.drawImage(canvas, 0, 0, 64, 40);
          const { data } = sheet.getImageData(0, 0, 64, 40);
          for (let pixel = 0; pixel < data.length; pixel += 4)
            if (data[pixel + 3]! > 128 && data[pixel]! > 1.5 * data[pixel + 1]!) count += 1;
        }
        return count / (64 * 40);
      });
      expect(red).toBeGreaterThan(0.05);
    });

    test('whoever comes for the first time grasps and cuts at once', async () => {
      // The tools that the scene has beside the organ.
      await expect(page.getByRole('radio', { checked: true })).toHaveText('Grasper');
      const grip = await lobe(page);
      await page.mouse.move(grip.x, grip.y);
      await page.mouse.down();
      await expect.poll(() => holds(page)).toBe(1);
      await page.mouse.move(grip.x + 30, grip.y - 60, { steps: 6 });
      await expect.poll(() => force(page)).toBeGreaterThan(0.02);
      await page.mouse.up();
      await expect.poll(() => holds(page)).toBe(0);
      // Let go, the lobe swings back: it is burnt where it comes to rest.
      await comeToRest(page);
      await page.getByRole('radio', { name: 'Cautery' }).click();
      const spot = await lobe(page);
      await page.mouse.move(spot.x, spot.y);
      await page.mouse.down();
      await expect.poll(() => removed(page)).toBeGreaterThan(0);
      await page.mouse.up();
    });

    test('the recordings that come along replay as they were', async () => {
      for (const title of ['The left lobe is grasped', 'The edge of the left lobe is cut']) {
        await page.getByRole('button', { name: 'Replay' }).click();
        await page.getByRole('menuitem', { name: title }).click();
        await expect(page.locator('.tape')).toContainText('agrees');
        await expect(page.locator('.tape')).toBeHidden({ timeout: 120_000 });
        await expect(page.getByText(/replayed \d+ steps to the same (bits|numbers)/).last()).toBeVisible();
        // What lies under the notice can be worked on.
        const notice = (await page.locator('.notice').first().boundingBox())!;
        const below = (x: number, y: number) =>
          page.evaluate(([x, y]) => document.elementFromPoint(x!, y!)?.id, [x, y]);
        expect(await below(notice.x + 20, notice.y + notice.height / 2)).toBe('view');
        await expect(page.locator('.notice.warning, .notice.error')).toHaveCount(0);
        await page.screenshot({
          path: `tests/artefacts/${engine}-${title.includes('cut') ? 'edge' : 'lobe'}.png`,
        });
        // A replay ends in pause, where it ended.
        await page.getByRole('button', { name: 'Go on (P)' }).click();
      }
    });

    test('pictures are counted, and the simulation goes on', async () => {
      await openBlock(page);
      const before = await steps(page);
      await expect.poll(() => steps(page)).toBeGreaterThan(before + 5);
      await expect(page.locator('.pictures')).toHaveText(/^[\d.]+ pictures\/s$/);
    });

    test('grasped and dragged, tissue comes along', async () => {
      await bringIn(page, 'Grasper');
      const grip = await place(page, [0.1, 0.02, 0.04]);
      expect(await page.evaluate(({ x, y }) => window.viscera.state().under(x, y), grip)).toBe('tissue');
      const before = await sag(page);
      await page.mouse.move(grip.x, grip.y);
      await page.mouse.down();
      await expect.poll(() => holds(page)).toBe(1);
      // Up, against the sag: past the place at rest, and twice as far again.
      await page.mouse.move(grip.x + 20, grip.y - 110, { steps: 8 });
      await expect.poll(() => sag(page)).toBeGreaterThan(before + 0.005);
      expect(await force(page)).toBeGreaterThan(0);
      await page.screenshot({ path: `tests/artefacts/${engine}-grasped.png` });
      await page.mouse.up();
      await expect.poll(() => holds(page)).toBe(0);
      const within = await latency(page);
      expect(within).toBeGreaterThan(0);
      console.log(`${engine}: 95 of 100 poses are in a frame within ${within.toFixed(0)} ms`);
    });

    test('a finger grasps and drags, and a second one pushes deeper', async () => {
      const touch = await page.context().newCDPSession(page);
      const fingers = (
        type: 'touchStart' | 'touchMove' | 'touchEnd',
        ...places: { x: number; y: number }[]
      ) =>
        touch.send('Input.dispatchTouchEvent', {
          type,
          touchPoints: places.map((at, id) => ({ ...at, id })),
        });
      await page.getByRole('button', { name: 'Reset (R)' }).click();
      await expect.poll(() => time(page)).toBeGreaterThan(1);
      await comeToRest(page);
      const before = await sag(page);
      const grip = await place(page, [0.1, 0.02, 0.04]);
      await fingers('touchStart', grip);
      await expect.poll(() => holds(page)).toBe(1);
      const lifted = { x: grip.x + 20, y: grip.y - 110 };
      for (let part = 1; part <= 8; part++)
        await fingers('touchMove', {
          x: grip.x + (part / 8) * (lifted.x - grip.x),
          y: grip.y + (part / 8) * (lifted.y - grip.y),
        });
      await expect.poll(() => sag(page)).toBeGreaterThan(before + 0.005);
      // The jaws come after the finger: only where they have arrived is their depth that of the first finger alone.
      await comeToRest(page);
      // Up the page is away from the eye, which looks along −z here.
      const depth = () =>
        number(
          page,
          ({ frame, chosen }) => frame!.instruments.find(({ instrument }) => instrument === chosen)!.tip[2],
        );
      const near = await depth();
      const second = { x: 100, y: 300 };
      await fingers('touchStart', lifted, second);
      await fingers('touchMove', lifted, { ...second, y: second.y - 60 });
      await expect.poll(depth).toBeLessThan(near - 0.005);
      // And back: the block will begin anew where the jaws would be.
      await fingers('touchMove', lifted, second);
      await expect.poll(depth).toBeGreaterThan(near - 0.002);
      await fingers('touchEnd');
      await expect.poll(() => holds(page)).toBe(0);
      await touch.detach();
    });

    test('softer tissue sags more, typed and by the slider', async () => {
      const before = await time(page);
      await page.getByRole('button', { name: 'Reset (R)' }).click();
      await expect.poll(() => time(page)).toBeLessThan(before);
      const young = page.getByRole('textbox', { name: /young/i });
      await expect.poll(() => time(page)).toBeGreaterThan(2);
      const stiff = await sag(page);
      await young.fill('1.5');
      await young.press('Enter');
      await expect.poll(() => sag(page)).toBeGreaterThan(1.3 * stiff);
      await young.fill('4');
      await young.press('Enter');
      await expect.poll(() => sag(page)).toBeLessThan(1.15 * stiff);
      // A tenth of the slider, which spans a factor of 400.
      const slider = page.getByRole('slider', { name: /young/i });
      await slider.press('PageDown');
      await expect(young).toHaveValue('2.2');
      await expect.poll(() => sag(page)).toBeGreaterThan(1.3 * stiff);
      await slider.press('PageUp');
      await expect(young).toHaveValue('4');
      await expect.poll(() => sag(page)).toBeLessThan(1.15 * stiff);
    });

    test('pause pauses, one step is one step, and on it goes', async () => {
      await page.getByRole('button', { name: 'Pause (P)' }).click();
      await expect.poll(async () => (await state(page)).frame?.state).toBe('paused');
      const still = await steps(page);
      await page.waitForTimeout(300);
      expect(await steps(page)).toBe(still);
      await page.getByRole('button', { name: 'One step' }).click();
      await expect.poll(() => steps(page)).toBe(still + 1);
      await page.getByRole('button', { name: 'Go on (P)' }).click();
      await expect.poll(() => steps(page)).toBeGreaterThan(still + 5);
    });

    test('what is recorded replays as it was', async () => {
      await page.getByRole('button', { name: 'Record', exact: true }).click();
      await expect(page.locator('.tape')).toContainText('recording');
      const from = await time(page);
      await page.locator('#view').focus();
      for (let press = 0; press < 5; press++) await page.keyboard.press('ArrowLeft');
      await expect.poll(() => time(page)).toBeGreaterThan(from + 0.8);
      const download = page.waitForEvent('download');
      await page.getByRole('button', { name: /Stop recording/ }).click();
      expect((await download).suggestedFilename()).toMatch(/\.viscera-recording$/);
      await page.getByRole('button', { name: 'Replay' }).click();
      await page.getByRole('menuitem', { name: /just recorded/ }).click();
      await expect(page.locator('.tape')).toContainText('agrees');
      await expect(page.locator('.tape')).toBeHidden();
      await expect(page.locator('.notice.warning, .notice.error')).toHaveCount(0);
      // A replay ends in pause, where it ended.
      await page.getByRole('button', { name: 'Go on (P)' }).click();
    });

    test('the cautery takes cells away', async () => {
      await bringIn(page, 'Cautery');
      const spot = await place(page, [0.05, 0.02, 0.04]);
      await page.mouse.move(spot.x, spot.y);
      await page.mouse.down();
      await expect.poll(() => removed(page), { timeout: 30_000 }).toBeGreaterThan(0);
      await page.mouse.move(spot.x, spot.y - 25, { steps: 5 });
      await page.waitForTimeout(500);
      await page.mouse.up();
      await expect(page.locator('.status')).toContainText(/\(−\d+\)/);
      await page.waitForTimeout(800);
      await page.screenshot({ path: `tests/artefacts/${engine}-cut.png` });
    });

    test('every colouring of the catalogue has its legend', async () => {
      const colours = page.getByLabel('Colours');
      const options = colours.locator('option');
      const names = await options.evaluateAll((all) => all.map((one) => (one as HTMLOptionElement).value));
      expect(names).toContain('adaptive-mode');
      for (const name of names.slice(1)) {
        await colours.selectOption(name);
        await expect.poll(async () => (await state(page)).frame?.colouring.by).toBe(name);
        await expect(page.locator('.legend')).toBeVisible();
        const { low, high } = (await state(page)).frame!.colouring;
        expect(high).toBeGreaterThan(low);
        await page.screenshot({ path: `tests/artefacts/${engine}-${name}.png` });
      }
      await colours.selectOption('none');
      await expect(page.locator('.legend')).toBeHidden();
    });

    test('measurements, state and scene can be taken away', async () => {
      for (const [entry, ending] of [
        ['Measurements', '.csv'],
        ['The present state', '.vtu'],
        ['The scene', '.toml'],
      ] as const) {
        const download = page.waitForEvent('download');
        await page.getByRole('button', { name: 'Export' }).click();
        await page.getByRole('menuitem', { name: entry }).click();
        expect((await download).suggestedFilename().endsWith(ending)).toBe(true);
      }
      const picture = page.waitForEvent('download');
      await page.getByRole('button', { name: 'Save a picture' }).click();
      expect((await picture).suggestedFilename()).toBe('viscera.png');
    });

    test('a wrong mesh and a wrong scene say what is wrong, and the scene goes on', async () => {
      await page.locator('input[type=file]').setInputFiles({
        name: 'broken.stl',
        mimeType: 'model/stl',
        buffer: Buffer.from('solid nothing\nfacet'),
      });
      await expect(page.locator('.notice.error').first()).toBeVisible();
      await openText(page, 'own.toml', 'title = "x"\n[body.a]\nyoungs = 1\n');
      await expect(page.locator('.notice.error pre').first()).toContainText('own.toml');
      await page.screenshot({ path: `tests/artefacts/${engine}-refused.png` });
      const before = await steps(page);
      await expect.poll(() => steps(page)).toBeGreaterThan(before);
    });

    test('a mesh that is dropped becomes tissue', async () => {
      // A cube of 40 mm, in millimetres.
      const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((corner) =>
        [1, 2, 4].map((bit) => (corner & bit ? 40 : 0)).join(' '),
      );
      const sides = ['1 3 4 2', '5 6 8 7', '1 2 6 5', '3 7 8 4', '1 5 7 3', '2 4 8 6'];
      const text = [...corners.map((corner) => `v ${corner}`), ...sides.map((side) => `f ${side}`)].join(
        '\n',
      );
      const dataTransfer = await page.evaluateHandle((content) => {
        const carried = new DataTransfer();
        carried.items.add(new File([content], 'cube.obj'));
        return carried;
      }, text);
      await page.dispatchEvent('#theatre', 'dragenter', { dataTransfer });
      await expect(page.getByText('Drop a mesh, a scene or a recording')).toBeVisible();
      await page.dispatchEvent('#theatre', 'drop', { dataTransfer });
      await expect.poll(async () => (await state(page)).scene?.name).toBe('cube');
      await expect(page.getByText('Drop a mesh, a scene or a recording')).toBeHidden();
      const before = await steps(page);
      await expect.poll(() => steps(page)).toBeGreaterThan(before);
    });

    test('who comes second watches, and leads when the first has gone', async ({ browser }) => {
      test.skip(engine === 'wasm', 'a worker has one page');
      const home = page.url();
      const second = await browser.newPage({ viewport: { width: 800, height: 500 } });
      await second.goto(home);
      await expect(second.locator('.chip')).toContainText('watching');
      await expect(second.getByRole('button', { name: 'Pause (P)' })).toBeDisabled();
      await expect.poll(() => steps(second)).toBeGreaterThan(0);
      // What the first does is seen by both, and the second does nothing.
      await page.getByRole('button', { name: 'Pause (P)' }).click();
      await expect.poll(async () => (await state(second)).frame?.state).toBe('paused');
      expect((await state(second)).scene?.name).toBe((await state(page)).scene?.name);
      await expect.poll(async () => (await steps(second)) - (await steps(page))).toBe(0);
      await page.goto('about:blank');
      await second.getByRole('button', { name: 'Go on (P)' }).click();
      await expect.poll(async () => (await state(second)).frame?.state).toBe('running');
      await second.close();
      await page.goto(home);
      await expect(page.getByRole('button', { name: 'Pause (P)' })).toBeEnabled();
    });

    test('a restarted program is found again', async () => {
      test.skip(engine === 'wasm', 'a worker ends with its page');
      const before = (await state(page)).session;
      await program.stop();
      await expect(page.getByText('Lost the way to the program.')).toBeVisible();
      await program.start();
      await expect(page.getByText('The program was restarted; the scene begins anew.')).toBeVisible();
      expect((await state(page)).session).not.toBe(before);
      const here = await steps(page);
      await expect.poll(() => steps(page)).toBeGreaterThan(here);
    });

    test('nothing complained meanwhile', () => {
      expect(complaints).toEqual([]);
    });
  });
}
