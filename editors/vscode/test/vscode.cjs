// A stand-in for the module `vscode`: as much of it as the extension and `vscode-languageclient` use in the tests.

const { URI } = require('vscode-uri');
const { EventEmitter: NodeEmitter } = require('node:events');

class Disposable {
  constructor(call) {
    this.dispose = call ?? (() => undefined);
  }
  static from(...all) {
    return new Disposable(() => all.forEach(one => one.dispose()));
  }
}

class EventEmitter {
  constructor() {
    const emitter = new NodeEmitter();
    emitter.setMaxListeners(0);
    this.emitter = emitter;
    this.event = (listener, self, disposables) => {
      const call = value => listener.call(self, value);
      emitter.on('event', call);
      const disposable = new Disposable(() => emitter.off('event', call));
      disposables?.push(disposable);
      return disposable;
    };
  }
  fire(value) {
    this.emitter.emit('event', value);
  }
  dispose() {
    this.emitter.removeAllListeners();
  }
}

class CancellationTokenSource {
  constructor() {
    const emitter = new EventEmitter();
    this.token = { isCancellationRequested: false, onCancellationRequested: emitter.event };
    this.cancel = () => {
      this.token.isCancellationRequested = true;
      emitter.fire(undefined);
    };
    this.dispose = () => undefined;
  }
}

class Position {
  constructor(line, character) {
    Object.assign(this, { line, character });
  }
}

class Range {
  constructor(a, b, c, d) {
    this.start = typeof a === 'number' ? new Position(a, b) : a;
    this.end = typeof a === 'number' ? new Position(c, d) : b;
  }
}

class Diagnostic {
  constructor(range, message, severity) {
    Object.assign(this, { range, message, severity });
  }
}

class CodeLens {
  constructor(range, command) {
    Object.assign(this, { range, command });
  }
}

/** What the editor shows and holds, for the tests to look at. */
const state = {
  settings: {},
  diagnostics: new Map(),
  changed: new EventEmitter(),
  commands: new Map(),
  lenses: [],
  progress: [],
  panels: [],
  errors: [],
  output: [],
  documents: [],
  opened: new EventEmitter(),
  edited: new EventEmitter(),
  closed: new EventEmitter(),
  configured: new EventEmitter(),
  folder: undefined,
};

const key = uri => uri.toString();

/** A namespace whose other members are events and registrations that do nothing. */
function namespace(members) {
  return new Proxy(members, {
    get: (target, name) => (name in target ? target[name] : () => new Disposable()),
  });
}

const workspace = namespace({
  isTrusted: true,
  get textDocuments() {
    return state.documents;
  },
  get workspaceFolders() {
    return state.folder && [{ uri: URI.file(state.folder), name: 'folder', index: 0 }];
  },
  getWorkspaceFolder: () => undefined,
  notebookDocuments: [],
  getConfiguration: section => ({
    get: (name, preset) => state.settings[[section, name].filter(Boolean).join('.')] ?? preset,
  }),
  onDidOpenTextDocument: state.opened.event,
  onDidChangeTextDocument: state.edited.event,
  onDidCloseTextDocument: state.closed.event,
  onDidChangeConfiguration: state.configured.event,
});

const window = namespace({
  visibleTextEditors: [],
  createOutputChannel: () => ({
    append: text => state.output.push(text),
    appendLine: text => state.output.push(text),
    show: () => undefined,
    clear: () => undefined,
    dispose: () => undefined,
  }),
  showErrorMessage: async text => {
    state.errors.push(text);
    return undefined;
  },
  withProgress: (options, task) => {
    const source = new CancellationTokenSource();
    const shown = { options, reports: [], cancel: source.cancel, done: false };
    state.progress.push(shown);
    const finished = task({ report: value => shown.reports.push(value) }, source.token);
    finished.then(() => (shown.done = true), () => (shown.done = true));
    return finished;
  },
  createWebviewPanel: (type, title, place, options) => {
    const emitter = new EventEmitter();
    const panel = {
      type, title, place, options,
      webview: { html: '' },
      reveal: () => (panel.revealed = true),
      onDidDispose: emitter.event,
      dispose: () => emitter.fire(undefined),
    };
    state.panels.push(panel);
    return panel;
  },
});

const languages = namespace({
  match: (selector, document) =>
    selector.some(one => one.language === document.languageId && one.scheme === document.uri.scheme) ? 10 : 0,
  createDiagnosticCollection: () => ({
    set: (uri, diagnostics) => {
      state.diagnostics.set(key(uri), diagnostics ?? []);
      state.changed.fire(undefined);
    },
    delete: uri => state.diagnostics.delete(key(uri)),
    clear: () => state.diagnostics.clear(),
    has: uri => state.diagnostics.has(key(uri)),
    dispose: () => undefined,
  }),
  registerCodeLensProvider: (_selector, provider) => {
    state.lenses.push(provider);
    return new Disposable();
  },
});

const commands = {
  registerCommand: (name, call) => {
    if (state.commands.has(name)) throw new Error(`the command ${name} is registered twice`);
    state.commands.set(name, call);
    return new Disposable(() => state.commands.delete(name));
  },
  executeCommand: async (name, ...values) => state.commands.get(name)?.(...values),
};

/** Classes and enumerations that the tests do not look at. */
const known = {
  Uri: URI,
  Disposable, EventEmitter, CancellationTokenSource, Position, Range, Diagnostic, CodeLens,
  workspace, window, languages, commands,
  version: '1.82.0',
  env: { language: 'en', appName: 'test' },
  extensions: namespace({ all: [], getExtension: () => undefined }),
  notebooks: namespace({}),
  l10n: { t: text => text },
  ViewColumn: { Active: -1, Beside: -2 },
  ProgressLocation: { SourceControl: 1, Window: 10, Notification: 15 },
  DiagnosticSeverity: { Error: 0, Warning: 1, Information: 2, Hint: 3 },
  state,
};
const others = new Map();
module.exports = new Proxy(known, {
  get: (target, name) => {
    if (name in target || typeof name === 'symbol') return target[name];
    if (!others.has(name)) others.set(name, class {});
    return others.get(name);
  },
});
