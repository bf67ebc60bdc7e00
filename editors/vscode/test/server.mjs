// A language server that answers as `smc lsp` does, for tests of the client without the program.

import { createRequire } from 'node:module';
import { writeFileSync } from 'node:fs';
import { fileURLToPath, pathToFileURL } from 'node:url';

if (process.argv.includes('--help')) process.exit(0);

const require = createRequire(import.meta.url);
const rpc = require('vscode-jsonrpc/node');
const connection = rpc.createMessageConnection(
  new rpc.StreamMessageReader(process.stdin),
  new rpc.StreamMessageWriter(process.stdout),
);
const texts = new Map();
const cancelled = new Set();
let tokens = 0;

const starts = text => text.split('\n').flatMap((line, at) => (/^(check|estimate|compare|rank)\b/.test(line) ? [at] : []));
const range = line => ({ start: { line, character: 0 }, end: { line, character: 1 } });

function publish(uri) {
  const lines = texts.get(uri).split('\n');
  const diagnostics = lines.flatMap((line, at) =>
    /^chekc\b/.test(line) ? [{ range: range(at), severity: 1, code: 'E0101', source: 'smc', message: 'unknown item' }] : []);
  connection.sendNotification('textDocument/publishDiagnostics', { uri, diagnostics });
}

connection.onRequest('initialize', ({ initializationOptions }) => {
  if (initializationOptions.webview !== true) throw new Error('no web view');
  return {
    capabilities: {
      textDocumentSync: { openClose: true, change: 1 },
      codeLensProvider: {},
      executeCommandProvider: { commands: ['smc.run', 'smc.play', 'smc.plan'] },
    },
  };
});
connection.onNotification('textDocument/didOpen', ({ textDocument }) => {
  texts.set(textDocument.uri, textDocument.text);
  publish(textDocument.uri);
});
connection.onNotification('textDocument/didChange', ({ textDocument, contentChanges }) => {
  texts.set(textDocument.uri, contentChanges.at(-1).text);
  publish(textDocument.uri);
});
connection.onRequest('textDocument/codeLens', ({ textDocument: { uri } }) => {
  if (uri.endsWith('.scn')) {
    return ['play', 'plan'].map(name => ({ range: range(0), command: { title: name, command: `smc.${name}`, arguments: [uri] } }));
  }
  return starts(texts.get(uri)).flatMap((line, query) => [
    { range: range(line), command: { title: 'run', command: 'smc.run', arguments: [uri, query, null] } },
    { range: range(line), command: { title: 'run with 10 s', command: 'smc.run', arguments: [uri, query, 10] } },
  ]);
});
connection.onNotification('window/workDoneProgress/cancel', ({ token }) => cancelled.add(token));
connection.onRequest('workspace/executeCommand', async ({ command, arguments: [uri, query] }) => {
  if (command !== 'smc.run') {
    const page = fileURLToPath(uri).replace(/scn$/, 'html');
    writeFileSync(page, `<!DOCTYPE html><html><head><title>${command}</title></head><body><script>1</script></body></html>`);
    return { page: pathToFileURL(page).href };
  }
  const token = `run ${++tokens}`;
  await connection.sendRequest('window/workDoneProgress/create', { token });
  const send = value => connection.sendNotification('$/progress', { token, value });
  await send({ kind: 'begin', title: 'smc', message: `query ${query} of ${uri}`, cancellable: true, percentage: 0 });
  // The last query of the test takes long.
  const steps = texts.get(uri).split('\n')[starts(texts.get(uri))[query]].includes('0.0001') ? 10_000 : 5;
  for (let step = 1; step <= steps && !cancelled.has(token); step++) {
    await new Promise(resolve => setTimeout(resolve, 20));
    await send({ kind: 'report', message: `${step} trials`, percentage: (100 * step) / steps });
  }
  await send({ kind: 'end' });
  return null;
});
connection.onRequest('shutdown', () => null);
connection.onNotification('exit', () => process.exit(0));
connection.listen();
