// Tests the TextMate grammars on shipped files: `node test/grammar.mjs`.
//
// A small scanner finds the comments, texts, numbers with units and the keywords that begin items; the grammar must give
// each of them its scope.

import { readFileSync, readdirSync, existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import { extname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const require = createRequire(import.meta.url);
const textmate = require('vscode-textmate');
const oniguruma = require('vscode-oniguruma');

const here = fileURLToPath(new URL('.', import.meta.url));
const root = join(here, '../../..');
const keywords = JSON.parse(readFileSync(join(here, '../../keywords.json'), 'utf8'));
const folders = ['models', 'properties', 'examples', 'validation', 'benches', 'tests/languages', '../shared/examples'];

const wasm = readFileSync(require.resolve('vscode-oniguruma/release/onig.wasm'));
await oniguruma.loadWASM(wasm.buffer.slice(wasm.byteOffset, wasm.byteOffset + wasm.byteLength));
const registry = new textmate.Registry({
  onigLib: Promise.resolve({
    createOnigScanner: patterns => new oniguruma.OnigScanner(patterns),
    createOnigString: text => new oniguruma.OnigString(text),
  }),
  loadGrammar: async scope => {
    const path = join(here, `../syntaxes/${scope.split('.')[1]}.tmLanguage.json`);
    return textmate.parseRawGrammar(readFileSync(path, 'utf8'), path);
  },
});

/** The scopes of each character of a text. */
async function scopes(language, text) {
  const grammar = await registry.loadGrammar(`source.${language}`);
  const found = [];
  let state = textmate.INITIAL;
  for (const line of text.split('\n')) {
    const result = grammar.tokenizeLine(line, state);
    state = result.ruleStack;
    for (const token of result.tokens) {
      for (let at = token.startIndex; at < Math.min(token.endIndex, line.length); at++) found.push(token.scopes.join(' '));
    }
    if (result.tokens.length === 0) for (const _ of line) found.push('');
    found.push('end of line');
  }
  return found;
}

const escaped = keywords.units.filter(unit => unit !== '%').sort((a, b) => b.length - a.length);
const factor = String.raw`(?:${escaped.join('|')})(?:\^-?\d+)?(?![\p{L}\p{N}_.(])`;
const TOKEN = new RegExp(
  [
    String.raw`(?<comment>//[^\n]*|/\*[^]*?\*/)`,
    String.raw`(?<text>"(?:\\.|[^"\\\n])*")`,
    String.raw`(?<number>(?:\d+(?:\.\d+)?|\.\d+)(?:[eE][+-]?\d+)?)(?:[ ]?(?<unit>%|/?${factor}(?:/${factor})*)(?![ ]*=[^=>]))?`,
    String.raw`(?<word>[\p{L}_][\p{L}\p{N}_]*)`,
    String.raw`(?<mark>[^\s])`,
  ].join('|'),
  'gu',
);

/** What the grammar must find in a text: place, length and the name of a scope. */
function expected(text) {
  const found = [];
  // Whether an item can begin here, and how many brackets are open.
  let isStart = true;
  let depth = 0;
  let end = 0;
  for (const match of text.matchAll(TOKEN)) {
    const { comment, text: quoted, number, unit, word, mark } = match.groups;
    if (text.slice(end, match.index).includes('\n') && depth === 0) isStart = true;
    end = match.index + match[0].length;
    if (comment !== undefined) {
      found.push([match.index, comment.length, 'comment.']);
      continue;
    }
    if (quoted !== undefined) found.push([match.index, quoted.length, 'string.']);
    if (number !== undefined) {
      found.push([match.index, number.length, 'constant.numeric']);
      if (unit !== undefined) found.push([end - unit.length, unit.length, 'storage.type.unit']);
    }
    if (word !== undefined && isStart && keywords.items.includes(word)) {
      const isName = /^\s*(=(?![=>])|:|\|)/.test(text.slice(end));
      found.push([match.index, word.length, isName ? '' : 'keyword.control']);
    }
    isStart = mark === '{' || mark === ';';
    if (mark === '(' || mark === '[') depth += 1;
    if (mark === ')' || mark === ']') depth -= 1;
  }
  return found;
}

function files(folder) {
  if (!existsSync(folder)) return [];
  return readdirSync(folder, { recursive: true }).filter(name => /\.(scn|bltl)$/.test(name)).map(name => join(folder, name));
}

let checks = 0;
let failures = 0;
function check(holds, message) {
  checks += 1;
  if (holds) return;
  failures += 1;
  if (failures <= 20) console.log(message);
}

const seen = new Set();
const all = folders.flatMap(folder => files(join(root, folder)));
for (const path of all) {
  const text = readFileSync(path, 'utf8').replaceAll('\r', '');
  const found = await scopes(extname(path).slice(1), text);
  for (const [at, length, scope] of expected(text)) {
    if (scope === 'keyword.control') seen.add(text.slice(at, at + length));
    for (let i = at; i < at + length; i++) {
      if (text[i] === '\n') continue;
      const given = found[i];
      const holds = scope === '' ? !given.includes('keyword.control') : given.includes(scope);
      check(holds, `${path}: "${text.slice(at, at + length)}" at ${at} has "${given}", not "${scope}"`);
      if (!holds) break;
    }
  }
}

// Every keyword that begins an item, whether or not a shipped file has it.
for (const word of keywords.items) {
  const given = (await scopes('scn', `  ${word} x`))[2];
  check(given.includes('keyword.control'), `"${word}" has "${given}"`);
  const setting = (await scopes('scn', `  ${word} = 3`))[2];
  check(setting.includes('variable.other.property'), `"${word} =" has "${setting}"`);
}

// Single places: a line, a part of it, and its scope.
const places = [
  ['scn', 'agents crowd[12]: adult { at = uniform in room; route = exit then leave }', 'crowd', 'entity.name.type'],
  ['scn', 'agents crowd[12]: adult { at = uniform in room; route = exit then leave }', 'uniform', 'keyword.other'],
  ['scn', 'agents crowd[12]: adult { at = uniform in room; route = exit then leave }', 'then', 'keyword.other.clause'],
  ['scn', 'agents crowd[12]: adult { at = uniform in room; route = exit then leave }', 'leave', 'keyword.other'],
  ['scn', '  speed = normal(1.34 m/s, 0.26 m/s) in 0.4 m/s .. 2.2 m/s', 'm/s', 'storage.type.unit'],
  ['scn', '  k2 = 2.4e5 kg/(m s)', 'kg/(m s)', 'storage.type.unit'],
  ['scn', '  velocity = (1, 0) m/s', 'm/s', 'storage.type.unit'],
  ['scn', '  when s == 0 -> 1/2: s = 1 | 1/2: s = 2', 's = 1', ''],
  ['scn', '  at = base + radius(a)', 'radius', 'support.function'],
  ['bltl', 'property safe = G<=10 s (forall a in others(user): gap(a) > 0.1 m)', 'G', 'keyword.operator.word'],
  ['bltl', 'property safe = G<=10 s (forall a in others(user): gap(a) > 0.1 m)', 'forall', 'keyword.operator.word'],
  ['bltl', 'property safe = G<=10 s (forall a in others(user): gap(a) > 0.1 m)', 'gap', 'entity.name.function'],
  ['bltl', 'check P(safe) >= 0.5 by sprt(alpha = 1 %)', 'sprt', 'support.function.procedure'],
  ['bltl', 'check P(safe) >= 0.5 by sprt(alpha = 1 %)', '%', 'storage.type.unit'],
  ['bltl', 'let gap(a) = distance(user, a)', 'gap', 'entity.name.type'],
  ['bltl', 'estimate E(min<=10 s (clearance(user)))', 'min', 'support.function'],
  ['bltl', '// check P(safe)', 'check', 'comment.'],
];
for (const [language, line, part, scope] of places) {
  const given = (await scopes(language, line))[line.indexOf(part)];
  const holds = scope === '' ? given === `source.${language}` : given.includes(scope);
  check(holds, `"${part}" in "${line}" has "${given}", not "${scope}"`);
}

console.log(`${all.length} files, ${seen.size} of ${keywords.items.length} keywords in them, ${checks} checks, ${failures} failed`);
process.exit(failures === 0 ? 0 : 1);
