// Writes src/keywords.h, the words that the scanner needs, from ../keywords.json. `--check` only compares.
import { readFileSync, writeFileSync } from 'node:fs';

const here = new URL('.', import.meta.url);
const keywords = JSON.parse(readFileSync(new URL('../keywords.json', here), 'utf8'));
const table = (name, words) =>
  `static const char *const ${name}[] = {${words.map(word => `${JSON.stringify(word)}, `).join('')}0};\n`;
const text = [
  '// Written by keywords.mjs from the table of keywords. Do not edit.\n',
  '// A line that begins with one of these words goes on with the line before.\n',
  table('CONTINUES', keywords.continues),
  table('UNITS', keywords.units.filter(unit => unit !== '%')),
].join('');
const target = new URL('src/keywords.h', here);
if (!process.argv.includes('--check')) {
  writeFileSync(target, text);
} else if (readFileSync(target, 'utf8') !== text) {
  console.error('src/keywords.h is older than keywords.json: run `npm run generate`');
  process.exit(1);
}
