import { expect, test, type Page } from '@playwright/test';
import type { PageState } from '../../src/hook';
import { StandIn } from '../stand-in/session';
import { lowContrast, unnamedControls } from './readable';

/** What a real session does not do on demand; the real ones are tested beside this file. */

const DESK = { width: 1280, height: 720 };
const TABLET = { width: 1024, height: 768 };

async function begin(page: Page, session: StandIn, quality = 'least'): Promise<void> {
  await page.routeWebSocket('**/ws', session.serve);
  await page.goto(`/?engine=native&quality=${quality}`);
  await expect(page.getByRole('radio', { name: 'Grasper' })).toBeVisible();
  await drawn(page);
}

/** Waits until a picture was drawn after this moment. */
async function drawn(page: Page): Promise<void> {
  const before = await page.evaluate(() => window.viscera.state().drawn);
  await page.waitForFunction((count) => window.viscera.state().drawn > count + 1, before);
}

const state = (page: Page): Promise<PageState> => page.evaluate(() => window.viscera.state());

async function keep(page: Page, name: string): Promise<void> {
  await page.screenshot({ path: `tests/artefacts/stand-in-${name}.png` });
}

test('everything on the page has a name and can be read, light and dark, at a desk', async ({ page }) => {
  await page.setViewportSize(DESK);
  const session = new StandIn();
  await begin(page, session);
  await expect(page.getByText('Press on the tissue to grasp it')).toBeVisible();
  expect(await unnamedControls(page)).toEqual([]);
  expect(await lowContrast(page)).toEqual([]);
  await keep(page, 'light');
  await page.getByRole('button', { name: 'Understood' }).click();
  await page.getByRole('button', { name: 'Dark theme' }).click();
  expect(await lowContrast(page)).toEqual([]);
  await drawn(page);
  await keep(page, 'dark');
  // Both are kept for the next visit.
  await page.reload();
  await expect(page.getByRole('button', { name: 'Light theme' })).toBeVisible();
  await expect(page.getByText('Press on the tissue to grasp it')).toBeHidden();
});

test.describe('on a tablet', () => {
  test.use({ hasTouch: true, viewport: TABLET });

  test('nothing is out of reach or too small for a finger', async ({ page }) => {
    const session = new StandIn();
    await begin(page, session);
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
    await keep(page, 'tablet');
    await page.getByRole('button', { name: 'Show or hide the panel' }).click();
    await expect(page.locator('#panel')).toBeHidden();
  });
});

test('colours come with a legend, the ghost as lines, and a cut with its rim', async ({ page }) => {
  await page.setViewportSize(DESK);
  const session = new StandIn();
  await begin(page, session, 'medium');
  await page.getByRole('button', { name: 'Understood' }).click();
  await page.getByLabel('Colours').selectOption('stress');
  await expect(page.locator('.legend')).toContainText('Von Mises stress [kPa]');
  await expect(page.locator('.legend')).toContainText('5.6');
  await drawn(page);
  await keep(page, 'stress');
  await page.getByLabel('Colours').selectOption('volume');
  await expect(page.locator('.legend')).toContainText('−10');
  await page.getByLabel('Linear model as wireframe').check();
  await expect(page.getByLabel('Linear model as wireframe')).toBeChecked();
  await page.waitForTimeout(1500);
  await keep(page, 'volume-and-ghost');
  await page.getByLabel('Colours').selectOption('none');
  await page.getByLabel('Linear model as wireframe').uncheck();
  session.cut(500);
  await expect(page.locator('.status')).toContainText('(−500)');
  await page.waitForTimeout(1500);
  await keep(page, 'cut');
});

test('a change is said in SI units, and a refusal stands beside its control', async ({ page }) => {
  const session = new StandIn();
  await begin(page, session);
  const young = page.getByRole('textbox', { name: 'stiffness (Young)' });
  await expect(young).toHaveValue('3');
  await young.fill('4,5');
  await young.press('Enter');
  await expect.poll(() => session.heard.at(-1)).toEqual({ type: 'set', key: 'liver.law.young', value: 4500 });
  await young.fill('five');
  await young.press('Enter');
  await expect(page.getByText('This is no number.')).toBeVisible();
  session.say({
    type: 'refusal',
    command: 'set',
    key: 'liver.law.poisson',
    reason: 'A Poisson ratio lies below 0.5.',
    help: '',
  });
  await expect(page.locator('[data-key="liver.law.poisson"]')).toContainText(
    'A Poisson ratio lies below 0.5.',
  );
  await expect(page.locator('[data-key="liver.density"]')).toContainText('restarts');
});

test('a refused scene shows the line that is wrong', async ({ page }) => {
  const session = new StandIn();
  await begin(page, session);
  const excerpt = { source: 'own.toml', line: 12, column: 3, text: '  youngs = "5 kPa"', length: 6 };
  session.say({
    type: 'refusal',
    command: 'open-text',
    reason: 'unknown key `youngs`',
    help: 'did you mean `young`?',
    excerpt,
  });
  const notice = page.getByRole('alert').filter({ hasText: 'unknown key' });
  await expect(notice).toContainText('own.toml:12');
  await expect(notice.locator('mark')).toHaveText('youngs');
});

test('keys move the chosen tool, close it and let it go', async ({ page }) => {
  const session = new StandIn();
  await begin(page, session);
  const tip = async () => (await state(page)).frame!.instruments[0]!.tip;
  const before = await tip();
  await page.locator('#view').focus();
  await page.keyboard.press('ArrowRight');
  await expect.poll(async () => (await tip())[0] - before[0]).toBeGreaterThan(0.003);
  await page.keyboard.press('Space');
  await expect.poll(async () => (await state(page)).frame!.instruments[0]!.trigger).toBe(1);
  await expect(page.getByRole('button', { name: 'Hold' })).toHaveAttribute('aria-pressed', 'true');
  await page.keyboard.press('Space');
  await expect.poll(async () => (await state(page)).frame!.instruments[0]!.trigger).toBe(0);
  await page.keyboard.press('2');
  await expect(page.getByRole('radio', { name: 'Cautery' })).toHaveAttribute('aria-checked', 'true');
});

test('who watches may look and turn, and changes nothing', async ({ page }) => {
  const session = new StandIn();
  session.role = 'watcher';
  await begin(page, session);
  await expect(page.getByRole('status')).toContainText('watching');
  await expect(page.getByRole('button', { name: 'Pause (P)' })).toBeDisabled();
  await expect(page.getByRole('textbox', { name: 'stiffness (Young)' })).toBeDisabled();
  session.say({ type: 'role', role: 'controller', clients: 1 });
  await expect(page.getByRole('button', { name: 'Pause (P)' })).toBeEnabled();
});

test('a lost program is looked for, and found again says what became of it', async ({ page }) => {
  const session = new StandIn();
  await begin(page, session);
  session.sessionNumber = 2;
  await session.drop();
  await expect(page.getByText('Lost the way to the program.')).toBeVisible();
  await expect(page.getByText('The program was restarted; the scene begins anew.')).toBeVisible();
  await expect(page.getByText('Lost the way to the program.')).toBeHidden();
  await keep(page, 'found-again');
});

test('nonsense is said to be nonsense, and the page goes on', async ({ page }) => {
  const session = new StandIn();
  await begin(page, session);
  session.sayBytes(new Uint8Array([0xc1, 1, 2]));
  await expect(page.getByText('A message could not be read')).toBeVisible();
  const before = (await state(page)).frame!.sequence;
  await expect.poll(async () => (await state(page)).frame!.sequence).toBeGreaterThan(before);
});

test('help shows every key, and escape closes it', async ({ page }) => {
  const session = new StandIn();
  await begin(page, session);
  await page.keyboard.press('h');
  await expect(page.getByRole('dialog')).toContainText('Shift + arrows');
  await keep(page, 'help');
  await page.keyboard.press('Escape');
  await expect(page.getByRole('dialog')).toBeHidden();
});
