// Where the program is, and whether it has the command `lsp`.

import { execFile } from 'node:child_process';
import { homedir } from 'node:os';
import { isAbsolute, join } from 'node:path';
import * as vscode from 'vscode';

/** A path of the settings with its variables replaced. A name without a slash stays as it is. */
export function expand(path: string): string {
  const folder = vscode.workspace.workspaceFolders?.[0]?.uri.fsPath;
  let full = path.startsWith('~/') ? join(homedir(), path.slice(2)) : path;
  if (folder !== undefined) full = full.replaceAll('${workspaceFolder}', folder);
  const isName = !/[\\/]/.test(full);
  return isName || isAbsolute(full) || folder === undefined ? full : join(folder, full);
}

/** Why a program cannot be used, if so. */
export function missing(program: string): Promise<string | undefined> {
  return new Promise(resolve => {
    execFile(program, ['lsp', '--help'], { timeout: 10_000 }, error => {
      if (error === null) return resolve(undefined);
      const code: unknown = error.code;
      if (code === 'ENOENT') {
        return resolve(`The program \`${program}\` was not found. Install it, or set \`smc.path\` to its place.`);
      }
      if (code === 'EACCES') {
        return resolve(`The file \`${program}\` cannot be executed. Set \`smc.path\` to the program \`smc\`.`);
      }
      resolve(`\`${program}\` has no command \`lsp\`. Install a newer version, or set \`smc.path\` to its place.`);
    });
  });
}
