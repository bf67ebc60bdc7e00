// Starts `smc lsp` for scenarios and properties, and shows the pages that it writes.

import * as vscode from 'vscode';
import { LanguageClient, type LanguageClientOptions } from 'vscode-languageclient/node';
import { expand, missing } from './program';
import { Pages, pageOf } from './pages';

let client: LanguageClient | undefined;
// Starts and stops follow each other, also if settings change while the server starts.
let last: Promise<void> = Promise.resolve();

export function activate(context: vscode.ExtensionContext): Promise<void> {
  const output = vscode.window.createOutputChannel('smc');
  const pages = new Pages();
  const restart = () => {
    last = last.then(stop).then(() => start(output, pages));
    return last;
  };
  context.subscriptions.push(
    output,
    pages,
    vscode.commands.registerCommand('smc.restart', restart),
    vscode.workspace.onDidChangeConfiguration(change => {
      const read = ['smc.path', 'smc.data', 'smc.threads'];
      if (read.some(name => change.affectsConfiguration(name))) void restart();
    }),
    vscode.workspace.onDidGrantWorkspaceTrust(restart),
  );
  return restart();
}

export function deactivate(): Promise<void> {
  return last.then(stop);
}

async function stop(): Promise<void> {
  const stopped = client;
  client = undefined;
  // A server that has ended by itself needs no more.
  await stopped?.dispose().catch(() => undefined);
}

async function start(output: vscode.OutputChannel, pages: Pages): Promise<void> {
  if (!vscode.workspace.isTrusted) return;
  const settings = vscode.workspace.getConfiguration('smc');
  const program = expand(settings.get('path', 'smc').trim() || 'smc');
  const reason = await missing(program);
  if (reason !== undefined) {
    output.appendLine(reason);
    void offerSettings(reason);
    return;
  }
  const threads = settings.get('threads', 0);
  const options: LanguageClientOptions = {
    documentSelector: ['scn', 'bltl'].flatMap(language => [
      { scheme: 'file', language },
      { scheme: 'untitled', language },
    ]),
    initializationOptions: {
      data: settings.get<string[]>('data', []).map(expand),
      ...(threads > 0 ? { threads } : {}),
      webview: true,
    },
    outputChannel: output,
    middleware: {
      executeCommand: async (command, values, next) => {
        const result: unknown = await next(command, values);
        const page = pageOf(result);
        if (page !== undefined) await pages.show(`${command} ${values[0]}`, titleOf(command, values[0]), page);
        return result;
      },
    },
  };
  const started = new LanguageClient('smc', 'smc', { command: program, args: ['lsp'] }, options);
  client = started;
  try {
    await started.start();
  } catch (error) {
    client = undefined;
    const text = `\`${program} lsp\` did not start: ${error instanceof Error ? error.message : String(error)}`;
    output.appendLine(text);
    void offerSettings(text);
  }
}

function titleOf(command: string, uri: unknown): string {
  const name = String(uri).split('/').pop() ?? '';
  return `${command === 'smc.plan' ? 'Plan' : 'Trial'} of ${decodeURIComponent(name)}`;
}

async function offerSettings(text: string): Promise<void> {
  const choice = await vscode.window.showErrorMessage(text, 'Open settings');
  if (choice !== undefined) await vscode.commands.executeCommand('workbench.action.openSettings', 'smc.path');
}
