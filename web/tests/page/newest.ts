import { existsSync, statSync } from 'node:fs';

/** The file that was written last; nothing where none is there. */
export function newest(files: readonly string[]): string | undefined {
  const written = (file: string) => statSync(file).mtimeMs;
  return files.filter((file) => existsSync(file)).sort((one, other) => written(other) - written(one))[0];
}
