/** Light or dark: as the system says, until the reader says otherwise; that is kept for the next visit. */
const KEY = 'viscera.theme';

export class Theme {
  private readonly system = matchMedia('(prefers-color-scheme: dark)');
  private readonly listeners: ((dark: boolean) => void)[] = [];

  constructor() {
    this.system.addEventListener('change', () => this.apply());
    this.apply();
  }

  get dark(): boolean {
    const chosen = remembered(KEY);
    return chosen === null ? this.system.matches : chosen === 'dark';
  }

  toggle(): void {
    remember(KEY, this.dark ? 'light' : 'dark');
    this.apply();
  }

  /** Hears of every change, and of the present state at once. */
  follow(listener: (dark: boolean) => void): void {
    this.listeners.push(listener);
    listener(this.dark);
  }

  private apply(): void {
    document.documentElement.dataset['theme'] = this.dark ? 'dark' : 'light';
    for (const listener of this.listeners) listener(this.dark);
  }
}

/** What was kept under `key`; nothing where the browser keeps nothing, as in some private windows. */
export function remembered(key: string): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

export function remember(key: string, value: string): void {
  try {
    localStorage.setItem(key, value);
  } catch {
    // The choice holds until the page is closed; there is nowhere to keep it longer.
  }
}
