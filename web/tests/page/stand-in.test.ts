import { expect, test } from '@playwright/test';
import { StandIn } from '../stand-in/session';

const picture = (name: string) => ({ path: `tests/artefacts/${name}.png` });

test('the page shows organ, tools, panel and charts, light and dark', async ({ page }) => {
  const session = new StandIn();
  await page.routeWebSocket('**/ws', session.serve);
  await page.setViewportSize({ width: 1280, height: 720 });
  await page.goto('/?engine=native');
  await expect(page.getByRole('radio', { name: 'Grasper' })).toBeVisible();
  await page.waitForTimeout(4000);
  await page.screenshot(picture('stand-in-light'));
  await page.getByRole('button', { name: 'Dark theme' }).click();
  await page.waitForTimeout(1500);
  await page.screenshot(picture('stand-in-dark'));
});
