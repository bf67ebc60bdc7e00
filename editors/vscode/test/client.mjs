// Tests the extension with a stand-in for the editor: `node test/client.mjs`.
//
// The server is the program that the variable SMC names, or else `test/server.mjs`, which only answers like it.

import assert from 'node:assert/strict';
import { chmodSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import esbuild from 'esbuild';

const require = createRequire(import.meta.url);
const here = fileURLToPath(new URL('.', import.meta.url));
const stub = join(here, 'vscode.cjs');
const folder = mkdtempSync(join(tmpdir(), 'smc-client-'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));

const bundle = join(here, '../dist/test.cjs');
await esbuild.build({
  entryPoints: [join(here, '../src/extension.ts')],
  bundle: true,
  platform: 'node',
  format: 'cjs',
  outfile: bundle,
  plugins: [
    { name: 'vscode', setup: build => build.onResolve({ filter: /^vscode$/ }, () => ({ path: stub, external: true })) },
  ],
});
const vscode = require(stub);
const { state } = vscode;
state.folder = folder;
const extension = require(bundle);

let program = process.env.SMC;
if (program === undefined) {
  program = join(folder, 'smc');
  writeFileSync(program, `#!/bin/sh\nexec "${process.execPath}" "${join(here, 'server.mjs')}" "$@"\n`);
  chmodSync(program, 0o755);
}

/** Waits until a condition holds. */
async function until(condition, what, seconds = 30) {
  const end = Date.now() + 1000 * seconds;
  while (!condition()) {
    assert.ok(Date.now() < end, `waited ${seconds} s for ${what}\n${state.output.join('\n')}`);
    await new Promise(resolve => setTimeout(resolve, 20));
  }
}

function document(name, languageId, text) {
  const path = join(folder, name);
  writeFileSync(path, text);
  const made = {
    uri: vscode.Uri.file(path),
    fileName: path,
    languageId,
    version: 1,
    isClosed: false,
    text,
    getText: () => made.text,
  };
  state.documents.push(made);
  state.opened.fire(made);
  return made;
}

/** Replaces the text of a document. */
function edit(made, text) {
  const lines = made.text.split('\n');
  const range = new vscode.Range(0, 0, lines.length - 1, lines.at(-1).length);
  const change = { range, rangeOffset: 0, rangeLength: made.text.length, text };
  made.text = text;
  made.version += 1;
  state.edited.fire({ document: made, contentChanges: [change], reason: undefined });
}

const diagnostics = made => state.diagnostics.get(made.uri.toString());
const errors = made => (diagnostics(made) ?? []).filter(one => one.severity === vscode.DiagnosticSeverity.Error);

async function lenses(made) {
  const token = new vscode.CancellationTokenSource().token;
  const found = [];
  for (const provider of state.lenses) {
    const given = (await provider.provideCodeLenses(made, token)) ?? [];
    for (const one of given) {
      found.push(one.command === undefined && provider.resolveCodeLens ? await provider.resolveCodeLens(one, token) : one);
    }
  }
  return found.map(one => one.command);
}

const click = command => vscode.commands.executeCommand(command.command, ...command.arguments);

const SCENARIO = `scenario "Die"
horizon = 20 steps
process die {
  var s: 0 .. 7 = 0
  when s < 7 -> 1/2: s = s + 1 | 1/2: s = 0
}
`;
const PROPERTIES = `property six = F<=15 steps (die.s == 7)
check P(six) <= 0.9
estimate P(six) within 0.0001
`;

// A program that is not there.
state.settings['smc.path'] = join(folder, 'no-such-program');
const context = { subscriptions: [] };
await extension.activate(context);
assert.equal(state.errors.length, 1);
assert.match(state.errors[0], /no-such-program` was not found/);
assert.equal(state.commands.has('smc.run'), false);

// A program without the command. Node.js has none, and ends with an error.
state.settings['smc.path'] = process.execPath;
await vscode.commands.executeCommand('smc.restart');
assert.match(state.errors[1] ?? '', /has no command `lsp`/);
state.errors.length = 0;

// A new setting starts the server.
Object.assign(state.settings, { 'smc.path': program, 'smc.data': ['recordings', '~/more'], 'smc.threads': 2 });
const scenario = document('die.scn', 'scn', SCENARIO);
state.configured.fire({ affectsConfiguration: name => name === 'smc.path' });
await until(() => state.commands.has('smc.run') || state.errors.length > 0, 'the server');
assert.deepEqual(state.errors, []);

// Errors come and go.
const properties = document('die.bltl', 'bltl', PROPERTIES.replace('check', 'chekc'));
await until(() => errors(properties).length > 0, 'an error');
assert.equal(errors(properties)[0].range.start.line, 1);
edit(properties, PROPERTIES);
await until(() => diagnostics(properties) !== undefined && errors(properties).length === 0, 'no error');

// A query runs.
const run = (await lenses(properties)).filter(command => command.command === 'smc.run');
const [short, long] = [run.find(one => one.arguments[1] === 0), run.findLast(one => one.arguments[1] === 1)];
assert.ok(short && long, `lenses of both queries, in ${JSON.stringify(run)}`);
await click(short);
await until(() => state.progress.length === 1 && state.progress[0].done, 'the end of the query');

// A query that takes long is cancelled.
const running = click({ ...long, arguments: [...long.arguments.slice(0, 2), 600] });
await until(() => state.progress.length === 2, 'progress');
await until(() => state.progress[1].reports.length > 0, 'a report of progress');
assert.equal(state.progress[1].options.cancellable, true);
assert.equal(state.progress[1].done, false);
state.progress[1].cancel();
await until(() => state.progress[1].done, 'the end after cancelling');
await running.catch(() => undefined);

// Pages open beside the editor, and once more in the same view.
const play = (await lenses(scenario)).find(command => command.command === 'smc.play');
assert.ok(play, 'a lens that plays a trial');
await click(play);
await click(play);
assert.equal(state.panels.length, 1);
const [panel] = state.panels;
assert.equal(panel.title, 'Trial of die.scn');
assert.equal(panel.options.enableScripts, true);
assert.equal(panel.place.viewColumn, vscode.ViewColumn.Beside);
assert.equal(panel.revealed, true);
assert.match(panel.webview.html, /<script/);
assert.match(panel.webview.html, /Content-Security-Policy/);

// The server can be started again, and stops with the editor.
await vscode.commands.executeCommand('smc.restart');
assert.ok(state.commands.has('smc.run'));
await until(() => diagnostics(properties) !== undefined, 'diagnostics of the new server');
await extension.deactivate();
for (const one of context.subscriptions) one.dispose();
assert.equal(state.commands.size, 0);
console.log(`client: errors, lenses, run, cancel, page, restart with ${process.env.SMC ?? 'a stand-in for the server'}`);
process.exit(0);
