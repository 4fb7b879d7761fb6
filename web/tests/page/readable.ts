import type { Page } from '@playwright/test';

/** Controls that are shown and have no name for those who hear the page. */
export async function unnamedControls(page: Page): Promise<string[]> {
  return page.evaluate(() =>
    [...document.querySelectorAll<HTMLElement>('button, input, select, canvas[tabindex], [role=radio]')]
      .filter((control) => control.checkVisibility({ visibilityProperty: true }))
      .filter((control) => {
        const labels =
          control instanceof HTMLInputElement || control instanceof HTMLSelectElement ? control.labels : null;
        const own = control instanceof HTMLSelectElement ? '' : control.textContent;
        return ![
          control.getAttribute('aria-label'),
          own,
          ...[...(labels ?? [])].map((label) => label.textContent),
        ].some((name) => name?.trim());
      })
      .map((control) => control.outerHTML.slice(0, 120)),
  );
}

/**
 * Texts whose contrast with what lies behind them is below 4.5 : 1 (WCAG 2.2, success criterion 1.4.3), with the ratio. Behind
 * half-transparent paper the ground of the page is assumed; what is switched off need not be read.
 */
export async function lowContrast(page: Page): Promise<string[]> {
  // Colours blend for a moment after the theme changes.
  await page.waitForTimeout(250);
  return page.evaluate(() => {
    const context = new OffscreenCanvas(1, 1).getContext('2d', { willReadFrequently: true })!;
    type Colour = [number, number, number, number];
    const parse = (colour: string): Colour => {
      context.clearRect(0, 0, 1, 1);
      context.fillStyle = colour;
      context.fillRect(0, 0, 1, 1);
      const [red, green, blue, alpha] = context.getImageData(0, 0, 1, 1).data;
      return [red!, green!, blue!, alpha! / 255];
    };
    const over = (top: Colour, below: Colour): Colour =>
      [...([0, 1, 2] as const).map((part) => top[part] * top[3] + below[part] * (1 - top[3])), 1] as Colour;
    const luminance = (colour: Colour) => {
      const linear = (part: number) =>
        part / 255 <= 0.04045 ? part / 255 / 12.92 : ((part / 255 + 0.055) / 1.055) ** 2.4;
      return 0.2126 * linear(colour[0]) + 0.7152 * linear(colour[1]) + 0.0722 * linear(colour[2]);
    };
    const ground = parse(getComputedStyle(document.documentElement).getPropertyValue('--ground-bottom'));
    const behind = (node: Element): Colour => {
      const layers: Colour[] = [];
      for (let here: Element | null = node; here; here = here.parentElement) {
        if (here.id === 'theatre') break;
        layers.push(parse(getComputedStyle(here).backgroundColor));
      }
      return layers.reverse().reduce((below, layer) => over(layer, below), ground);
    };
    const poor: string[] = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
      const parent = walker.currentNode.parentElement;
      const text = walker.currentNode.textContent?.trim();
      if (!parent || !text || !parent.checkVisibility({ visibilityProperty: true, opacityProperty: true }))
        continue;
      if (parent.closest(':disabled, option, script, noscript, .unseen')) continue;
      const back = behind(parent);
      const front = over(parse(getComputedStyle(parent).color), back);
      const [darker, lighter] = [luminance(front), luminance(back)].sort((one, other) => one - other) as [
        number,
        number,
      ];
      const ratio = (lighter + 0.05) / (darker + 0.05);
      if (ratio < 4.5) poor.push(`${ratio.toFixed(2)}: ${text.slice(0, 40)}`);
    }
    return poor;
  });
}
