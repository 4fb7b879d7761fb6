import { existsSync } from 'node:fs';
import { expect, test, type Page } from '@playwright/test';
import type { PageState } from '../../src/hook';
import { StandIn } from '../stand-in/session';
import { lowContrast, unnamedControls } from './readable';

/** What a real session does not do on demand; the real ones are tested beside this file. One page goes through all of it. */

const DESK = { width: 1280, height: 720 };
const TABLET = { width: 1024, height: 768 };

async function begin(page: Page, session: StandIn): Promise<void> {
  await page.routeWebSocket('**/ws', session.serve);
  await page.goto('/?engine=native&quality=least');
  await expect(page.getByRole('radio', { name: 'Grasper' })).toBeVisible();
  await drawn(page);
}

/** Waits until a picture was drawn after this moment. */
async function drawn(page: Page): Promise<void> {
  const before = await page.evaluate(() => window.viscera.state().drawn);
  await page.waitForFunction((count) => window.viscera.state().drawn > count + 1, before);
}

const state = (page: Page): Promise<PageState> => page.evaluate(() => window.viscera.state());

test.describe('with a stand-in for the session', () => {
  test.describe.configure({ mode: 'serial' });
  const session = new StandIn();
  let page: Page;

  const keep = (name: string) => page.screenshot({ path: `tests/artefacts/stand-in-${name}.png` });

  test.beforeAll(async ({ browser }) => {
    page = await browser.newPage({ viewport: DESK });
    await begin(page, session);
  });
  test.afterAll(() => page?.close());

  test('everything on the page has a name and can be read, light and dark', async () => {
    await expect(page.getByText('Press on the tissue to grasp it')).toBeVisible();
    expect(await unnamedControls(page)).toEqual([]);
    expect(await lowContrast(page)).toEqual([]);
    await keep('light');
    await page.getByRole('button', { name: 'Understood' }).click();
    await expect(page.getByText('Press on the tissue to grasp it')).toBeHidden();
    await page.getByRole('button', { name: 'Dark theme' }).click();
    expect(await lowContrast(page)).toEqual([]);
    await drawn(page);
    await keep('dark');
    await page.getByRole('button', { name: 'Light theme' }).click();
  });

  test('colours come with a legend, the ghost as lines, and a cut with its rim', async () => {
    await page.getByLabel('Colours').selectOption('stress');
    await expect(page.locator('.legend')).toContainText('Von Mises stress [kPa]');
    await expect(page.locator('.legend')).toContainText('5.6');
    await drawn(page);
    await keep('stress');
    await page.getByLabel('Colours').selectOption('volume');
    await expect(page.locator('.legend')).toContainText('−10');
    await page.getByLabel('Linear model as wireframe').check();
    await drawn(page);
    await keep('volume-and-ghost');
    await page.getByLabel('Colours').selectOption('none');
    await expect(page.locator('.legend')).toBeHidden();
    await page.getByLabel('Linear model as wireframe').uncheck();
    session.cut(500);
    await expect(page.locator('.status')).toContainText('(−500)');
    await drawn(page);
    await keep('cut');
  });

  test('a body that keeps its volume or has a pre-computed part tells how well, and another nothing', async () => {
    const errors = page.locator('.errors');
    await expect(errors).toBeHidden();
    session.errors = { volumeError: 2.5e-6, interfaceResidual: 0.031 };
    await expect(errors.locator('dt')).toHaveText(['liver, volume error', 'liver, interface']);
    await expect(errors.locator('dd')).toHaveText(['0.00025 %', '3.1 %']);
    session.errors = {};
    await expect(errors).toBeHidden();
  });

  test('a change is said in SI units, and a refusal stands beside its control', async () => {
    const young = page.getByRole('textbox', { name: 'stiffness (Young)' });
    await expect(young).toHaveValue('3');
    await young.fill('4,5');
    await young.press('Enter');
    await expect
      .poll(() => session.heard.at(-1))
      .toEqual({ type: 'set', key: 'liver.law.young', value: 4500 });
    // A tenth of the slider, which spans a factor of 100.
    const slider = page.getByRole('slider', { name: 'stiffness (Young)' });
    await slider.press('PageDown');
    await expect
      .poll(() => session.heard.at(-1))
      .toEqual({ type: 'set', key: 'liver.law.young', value: 2830 });
    await expect(young).toHaveValue('2.83');
    await expect(slider).toHaveAttribute('aria-valuetext', '2.83 kPa');
    await young.fill('five');
    await young.press('Enter');
    await expect(page.getByText('This is no number.')).toBeVisible();
    const reason = 'A Poisson ratio lies below 0.5.';
    session.say({ type: 'refusal', command: 'set', key: 'liver.law.poisson', reason, help: '' });
    await expect(page.locator('[data-key="liver.law.poisson"]')).toContainText(reason);
    await expect(page.locator('[data-key="liver.density"]')).toContainText('restarts');
  });

  test('a refused scene shows the line that is wrong', async () => {
    const excerpt = { source: 'own.toml', line: 12, column: 3, text: '  youngs = "5 kPa"', length: 6 };
    session.say({
      type: 'refusal',
      command: 'open-text',
      reason: 'unknown key',
      help: 'did you mean `young`?',
      excerpt,
    });
    const notice = page.getByRole('alert').filter({ hasText: 'unknown key' });
    await expect(notice).toContainText('own.toml:12');
    await expect(notice.locator('mark')).toHaveText('youngs');
    await notice.getByRole('button', { name: 'Close this notice' }).click();
  });

  test('a file that is too large is refused on the page, and nothing of it is sent', async () => {
    const dataTransfer = await page.evaluateHandle(() => {
      const carried = new DataTransfer();
      carried.items.add(new File([new ArrayBuffer(65 * 2 ** 20)], 'huge.stl'));
      return carried;
    });
    await page.dispatchEvent('#theatre', 'drop', { dataTransfer });
    const notice = page.getByRole('alert').filter({ hasText: 'huge.stl is too large: it has 65 MiB.' });
    await expect(notice).toContainText('At most 64 MiB');
    await notice.getByRole('button', { name: 'Close this notice' }).click();
    // One that came later is sent, and would have come behind it.
    await page.evaluate(() => {
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File(['solid small'], 'small.stl'));
      document
        .querySelector('#theatre')!
        .dispatchEvent(new DragEvent('drop', { dataTransfer, bubbles: true }));
    });
    const meshes = () => session.heard.flatMap((said) => (said.type === 'open-mesh' ? [said.name] : []));
    await expect.poll(meshes).toEqual(['small.stl']);
  });

  test('keys move the chosen tool, close it and let it go', async () => {
    const tip = async () => (await state(page)).frame!.instruments[0]!.tip;
    const trigger = async () => (await state(page)).frame!.instruments[0]!.trigger;
    const before = await tip();
    await page.locator('#view').focus();
    await page.keyboard.press('ArrowRight');
    await expect.poll(async () => (await tip())[0] - before[0]).toBeGreaterThan(0.003);
    await page.keyboard.press('Space');
    await expect.poll(trigger).toBe(1);
    await expect(page.getByRole('button', { name: 'Hold' })).toHaveAttribute('aria-pressed', 'true');
    await page.keyboard.press('Space');
    await expect.poll(trigger).toBe(0);
    await page.keyboard.press('2');
    await expect(page.getByRole('radio', { name: 'Cautery' })).toHaveAttribute('aria-checked', 'true');
  });

  test('where a shaft enters can be given, dragged, moved by keys and taken away', async () => {
    const last = () => session.heard.filter(({ type }) => type === 'set-trocar').at(-1);
    const entry = page.getByRole('button', { name: 'Entry' });
    await page.getByRole('radio', { name: 'Grasper' }).click();
    await expect(entry).toHaveAttribute('aria-pressed', 'false');
    await entry.click();
    await expect.poll(last).toEqual({ type: 'set-trocar', instrument: 0, trocar: true });
    await expect(entry).toHaveAttribute('aria-pressed', 'true');
    await drawn(page);
    // Where the stand-in puts it.
    const at = await page.evaluate(() => window.viscera.state().project([0.02, 0.09, 0.12]));
    expect(await page.evaluate(({ x, y }) => window.viscera.state().under(x, y), at)).toBe('trocar');
    await page.mouse.move(at.x, at.y);
    await page.mouse.down();
    await page.mouse.move(at.x + 30, at.y, { steps: 3 });
    await page.mouse.up();
    const dragged = last();
    if (dragged?.type !== 'set-trocar' || !Array.isArray(dragged.trocar)) throw new Error('it was not moved');
    expect(dragged.trocar[0] - 0.02).toBeGreaterThan(0.005);
    // Keys move that of the tool in hand.
    await page.getByRole('radio', { name: 'Cautery' }).click();
    await page.locator('#view').focus();
    await page.keyboard.press('i');
    await expect.poll(() => last()).toMatchObject({ instrument: 1 });
    await page.getByRole('radio', { name: 'Grasper' }).click();
    await page.locator('#view').focus();
    await page.keyboard.press('t');
    await expect.poll(last).toEqual({ type: 'set-trocar', instrument: 0, trocar: false });
    await expect(entry).toHaveAttribute('aria-pressed', 'false');
  });

  test('held upright, everything is within reach', async () => {
    await page.setViewportSize({ width: 768, height: 1024 });
    await drawn(page);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    expect(wide).toBe(0);
    const cut = await page.evaluate(() =>
      [...document.querySelectorAll('#bar button, #bar select, .tool, .chart .value, .chart figcaption')]
        .filter((part) => part.checkVisibility())
        .filter((part) => {
          const { left, right } = part.getBoundingClientRect();
          return left < 0 || right > innerWidth || part.scrollWidth > part.clientWidth + 1;
        })
        .map((part) => part.textContent || part.getAttribute('aria-label')),
    );
    expect(cut).toEqual([]);
    await keep('upright');
    // However low the window is, charts leave the tools free.
    for (const size of [{ width: 768, height: 1024 }, { width: 800, height: 500 }, DESK]) {
      await page.setViewportSize(size);
      const [tools, charts] = await Promise.all(
        ['.tools', '.charts'].map((part) => page.locator(part).boundingBox()),
      );
      expect(tools!.y + tools!.height).toBeLessThan(charts!.y);
    }
  });

  test('help shows every key, and escape closes it', async () => {
    await page.keyboard.press('h');
    await expect(page.getByRole('dialog')).toContainText('Shift + arrows');
    await keep('help');
    await page.keyboard.press('Escape');
    await expect(page.getByRole('dialog')).toBeHidden();
  });

  test('nonsense is said to be nonsense, and the page goes on', async () => {
    session.sayBytes(new Uint8Array([0xc1, 1, 2]));
    await expect(page.getByText('A message could not be read')).toBeVisible();
    const before = (await state(page)).frame!.sequence;
    await expect.poll(async () => (await state(page)).frame!.sequence).toBeGreaterThan(before);
  });

  test('who watches may look and turn, and changes nothing', async () => {
    session.say({ type: 'role', role: 'watcher', clients: 2 });
    await expect(page.locator('.chip')).toContainText('watching');
    await expect(page.getByRole('button', { name: 'Pause (P)' })).toBeDisabled();
    await expect(page.getByRole('textbox', { name: 'stiffness (Young)' })).toBeDisabled();
    session.say({ type: 'role', role: 'controller', clients: 1 });
    await expect(page.getByRole('button', { name: 'Pause (P)' })).toBeEnabled();
  });

  test('a lost program is looked for, and found again says what became of it', async () => {
    session.sessionNumber = 2;
    await session.drop();
    await expect(page.getByText('The program was restarted; the scene begins anew.')).toBeVisible();
    await expect(page.getByText('Lost the way to the program.')).toBeHidden();
  });
});

test('static files with no program behind them begin with the engine in the page', async ({ page }) => {
  const complaints: string[] = [];
  page.on('console', (message) => {
    // The browser itself reports that nobody answers.
    if (message.type() === 'error' && !/WebSocket connection|ERR_CONNECTION_REFUSED/.test(message.text()))
      complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(String(error)));
  await page.goto('/?quality=least');
  if (existsSync('src/engine/generated/viscera_web_bg.wasm')) {
    // At first there is no page to ask.
    await page.waitForFunction(() => window.viscera?.state().frame !== undefined);
    expect((await state(page)).engine).toBe('wasm');
  } else {
    await expect(page.getByText('The engine in this page is not to be had.')).toBeVisible();
    await expect(page.getByText('built without the engine')).toBeVisible();
  }
  expect(complaints).toEqual([]);
});

test.describe('on a tablet', () => {
  test.use({ hasTouch: true, viewport: TABLET });

  test('nothing is out of reach or too small for a finger', async ({ page }) => {
    await begin(page, new StandIn());
    const small = await page.evaluate(() =>
      [...document.querySelectorAll<HTMLElement>('button, select, summary')]
        .filter((control) => control.offsetParent !== null)
        .map((control) => ({
          name: control.title || control.textContent,
          box: control.getBoundingClientRect(),
        }))
        .filter(({ box }) => box.width < 24 || box.height < 24 || box.right > innerWidth || box.left < 0)
        .map(({ name }) => name),
    );
    expect(small).toEqual([]);
    expect(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth)).toBe(true);
    await page.screenshot({ path: 'tests/artefacts/stand-in-tablet.png' });
    // Either way it is held, with depth strip and all, no tool hides under the edge of their list.
    for (const size of [TABLET, { width: TABLET.height, height: TABLET.width }]) {
      await page.setViewportSize(size);
      const hidden = await page
        .locator('.tools')
        .evaluate((tools) => tools.scrollHeight - tools.clientHeight);
      expect(hidden).toBeLessThanOrEqual(0);
    }
    const [tools, hint] = await Promise.all(
      ['.tools', '.hint'].map((part) => page.locator(part).boundingBox()),
    );
    expect(hint!.x).toBeGreaterThanOrEqual(tools!.x + tools!.width);
    expect(hint!.x + hint!.width).toBeLessThan(TABLET.height);
    await page.screenshot({ path: 'tests/artefacts/stand-in-tablet-upright.png' });
    await page.setViewportSize(TABLET);
    await page.getByRole('button', { name: 'Show or hide the panel' }).click();
    await expect(page.locator('#panel')).toBeHidden();
  });
});
