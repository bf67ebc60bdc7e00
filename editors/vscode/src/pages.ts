// The pages of `smc.play` and `smc.plan`, each in a web view beside the editor.

import { readFile } from 'node:fs/promises';
import * as vscode from 'vscode';

/** The address of the page that a command returned, if it returned one. */
export function pageOf(result: unknown): vscode.Uri | undefined {
  if (typeof result !== 'object' || result === null || !('page' in result)) return undefined;
  return typeof result.page === 'string' ? vscode.Uri.parse(result.page) : undefined;
}

// A page is one file with its scripts and styles; it needs nothing from elsewhere.
const POLICY =
  "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; font-src data:";

/** The text of a page that may load nothing. A page with a policy of its own keeps it. */
function restricted(html: string): string {
  if (/http-equiv=["']Content-Security-Policy/i.test(html)) return html;
  const policy = `<meta http-equiv="Content-Security-Policy" content="${POLICY}">`;
  const head = /<head[^>]*>/i.exec(html);
  if (head === null) return policy + html;
  const end = head.index + head[0].length;
  return html.slice(0, end) + policy + html.slice(end);
}

/** The open pages: a page that is asked for once more takes the place of the old one. */
export class Pages implements vscode.Disposable {
  private readonly open = new Map<string, vscode.WebviewPanel>();

  async show(key: string, title: string, page: vscode.Uri): Promise<void> {
    const html = restricted(await readFile(page.fsPath, 'utf8'));
    let panel = this.open.get(key);
    if (panel === undefined) {
      const place = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
      const options = { enableScripts: true, localResourceRoots: [], retainContextWhenHidden: true };
      panel = vscode.window.createWebviewPanel('smc.page', title, place, options);
      panel.onDidDispose(() => this.open.delete(key));
      this.open.set(key, panel);
    } else {
      panel.reveal(undefined, true);
    }
    panel.webview.html = html;
  }

  dispose(): void {
    for (const panel of [...this.open.values()]) panel.dispose();
  }
}
