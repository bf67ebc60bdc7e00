//! `smc lsp`: a language server for both languages, over standard input and output. Each answer reads the checked files: names of
//! the trees (`syntax/names`), what the compiler notes and knows (`compile/context/notes.rs`, `Diagnostic::known`), and the tables
//! of the language. Everything is checked anew after a change, which takes some milliseconds, so nothing is kept up to date by parts.

mod changes;
mod completion;
mod desk;
mod hover;
mod outline;
mod place;
mod runs;

use super::complaint;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use desk::{Checked, Desk, Open};
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, RequestId};
use lsp_types::{
    DiagnosticRelatedInformation, DiagnosticSeverity, Location, NumberOrString, Position, Range,
    SemanticTokens, Uri,
};
use runs::{Editor, Runs};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

/// Runs the command, until the editor ends it.
pub(super) fn run() -> Result<(), Diagnostic> {
    let failed = |error: String| {
        complaint::input(format!("the editor and the server do not understand each other: {error}"))
    };
    let (connection, _threads) = Connection::stdio();
    let options = match connection.initialize(capabilities()) {
        Ok(options) => options,
        // The editor has gone.
        Err(error) if error.channel_is_disconnected() => return Ok(()),
        Err(error) => return Err(failed(error.to_string())),
    };
    let sender = connection.sender.clone();
    // An editor that has gone needs no answer.
    let editor = Editor::new(Arc::new(move |message| drop(sender.send(message))));
    let mut server = Server::new(editor, &options);
    loop {
        // Errors are shown when the editor has said everything that it has to say.
        let mut message = connection.receiver.try_recv().ok();
        if message.is_none() {
            server.publish();
            message = connection.receiver.recv().ok();
        }
        let Some(message) = message else { return Ok(()) };
        match message {
            Message::Request(request) => {
                if connection.handle_shutdown(&request).map_err(|error| failed(error.to_string()))? {
                    return Ok(());
                }
                server.request(request);
            }
            Message::Notification(told) => server.told(told),
            Message::Response(_) => {}
        }
    }
}

/// The features of the server.
fn capabilities() -> Value {
    json!({
        "textDocumentSync": 1,
        "hoverProvider": true,
        "completionProvider": { "triggerCharacters": [" ", "(", "."], "resolveProvider": true },
        "definitionProvider": true,
        "referencesProvider": true,
        "renameProvider": { "prepareProvider": true },
        "documentSymbolProvider": true,
        "semanticTokensProvider": {
            "legend": { "tokenTypes": outline::KINDS, "tokenModifiers": [] },
            "full": true,
        },
        "foldingRangeProvider": true,
        "inlayHintProvider": true,
        "documentFormattingProvider": true,
        "documentRangeFormattingProvider": true,
        "codeActionProvider": true,
        "codeLensProvider": {},
        "executeCommandProvider": { "commands": ["smc.run", "smc.play", "smc.plan"] },
    })
}

struct Server {
    desk: Desk,
    runs: Runs,
    editor: Editor,
    /// Texts whose errors are to be shown again.
    changed: BTreeSet<String>,
}

impl Server {
    fn new(editor: Editor, options: &Value) -> Self {
        let given = &options["initializationOptions"];
        let mut desk = Desk::default();
        let folders = given["data"].as_array().into_iter().flatten();
        desk.data = folders.filter_map(Value::as_str).map(PathBuf::from).collect();
        let mut runs = Runs::new(editor.clone());
        runs.threads =
            given["threads"].as_u64().and_then(|threads| usize::try_from(threads).ok()).filter(|n| *n > 0);
        let can_show = options["capabilities"]["window"]["showDocument"]["support"] == true;
        runs.shows_pages = given["webview"] == true || !can_show;
        Self { desk, runs, editor, changed: BTreeSet::new() }
    }

    /// Reads a notification.
    fn told(&mut self, told: Notification) {
        let parameters = told.params;
        let uri = parameters["textDocument"]["uri"].as_str().map(str::to_owned);
        match (told.method.as_str(), uri) {
            ("textDocument/didOpen", Some(uri)) => {
                let document = &parameters["textDocument"];
                let asks = document["languageId"] == "bltl" || place::asks(&uri);
                self.put(uri, &document["text"], &document["version"], asks);
            }
            ("textDocument/didChange", Some(uri)) => {
                // Each change is the whole text.
                let changes = &parameters["contentChanges"];
                let last = &changes[changes.as_array().map_or(0, |all| all.len().saturating_sub(1))];
                let asks = self.desk.open.get(&uri).is_some_and(|open| open.asks);
                self.put(uri, &last["text"], &parameters["textDocument"]["version"], asks);
            }
            ("textDocument/didClose", Some(uri)) => {
                self.desk.take(&uri);
                self.editor.tell("textDocument/publishDiagnostics", json!({ "uri": uri, "diagnostics": [] }));
                self.changed.extend(self.desk.open.keys().cloned());
            }
            ("textDocument/didSave" | "workspace/didChangeWatchedFiles", _) => {
                for uri in self.desk.open.keys().cloned().collect::<Vec<_>>() {
                    self.desk.forget(&uri);
                    self.changed.insert(uri);
                }
            }
            ("window/workDoneProgress/cancel", _) => {
                let token = parameters["token"].as_str().unwrap_or_default();
                self.runs.cancel(|running, _| running == token);
            }
            ("$/cancelRequest", _) => {
                let id: Option<RequestId> = serde_json::from_value(parameters["id"].clone()).ok();
                self.runs.cancel(|_, running| Some(running) == id.as_ref());
            }
            _ => {}
        }
    }

    fn put(&mut self, uri: String, text: &Value, version: &Value, asks: bool) {
        let Some(text) = text.as_str() else { return };
        let version = version.as_i64().unwrap_or_default() as i32;
        self.desk.put(&uri, Open { text: text.into(), version, asks });
        self.changed.insert(uri);
    }

    /// Shows the errors of everything that changed.
    fn publish(&mut self) {
        let mut shown = BTreeSet::new();
        for uri in std::mem::take(&mut self.changed) {
            if !self.desk.open.contains_key(&uri) {
                continue;
            }
            let checked = self.desk.checked(&uri);
            if !checked.uris.contains(&uri) {
                // In a file in which nothing is written nothing is wrong.
                self.editor.tell("textDocument/publishDiagnostics", json!({ "uri": uri, "diagnostics": [] }));
            }
            let is_new = shown.insert(self.desk.key(&uri));
            for (number, own) in checked.uris.iter().enumerate().filter(|_| is_new) {
                let Some(open) = self.desk.open.get(own) else { continue };
                let of_file = checked.inputs.diagnostics.iter().filter(|one| {
                    let file = one.place.as_ref().map_or(0, |place| usize::from(place.span.source.0));
                    file == number || number == 0 && file >= checked.uris.len()
                });
                let list: Vec<lsp_types::Diagnostic> = of_file.map(|one| shown_as(&checked, one)).collect();
                let told = json!({ "uri": own, "version": open.version, "diagnostics": list });
                self.editor.tell("textDocument/publishDiagnostics", told);
            }
        }
    }

    /// Answers a request.
    fn request(&mut self, request: Request) {
        let Request { id, method, params } = request;
        let answer = match method.as_str() {
            // A command is answered when it has ended, unless it cannot begin.
            "workspace/executeCommand" => match self.command(id.clone(), &params) {
                Ok(()) => return,
                Err(reason) => Err((ErrorCode::RequestFailed, reason)),
            },
            method => self.answer(method, &params),
        };
        self.editor.answer(id, answer);
    }

    /// The answer to a request about a text, and perhaps a position or a range in it.
    fn answer(&mut self, method: &str, asked: &Value) -> Result<Value, (ErrorCode, String)> {
        let invalid = |reason: &str| (ErrorCode::InvalidParams, format!("`{method}`: {reason}"));
        if method == "completionItem/resolve" {
            let item = serde_json::from_value(asked.clone()).map_err(|error| invalid(&error.to_string()))?;
            return Ok(json!(completion::resolved(item)));
        }
        let uri = asked["textDocument"]["uri"]
            .as_str()
            .ok_or_else(|| invalid("the address of a text is missing"))?;
        let position = || {
            let position = serde_json::from_value::<Position>(asked["position"].clone());
            position.map_err(|error| invalid(&error.to_string()))
        };
        let range = || {
            serde_json::from_value::<Range>(asked["range"].clone())
                .map_err(|error| invalid(&error.to_string()))
        };
        let desk = &mut self.desk;
        Ok(match method {
            "textDocument/hover" => json!(hover::hover(&desk.checked(uri), uri, position()?)),
            "textDocument/completion" => json!(completion::complete(desk, uri, position()?)),
            "textDocument/definition" => json!(changes::places(&desk.checked(uri), uri, position()?).first()),
            "textDocument/references" => {
                let places = changes::places(&desk.whole(uri), uri, position()?);
                let own = usize::from(asked["context"]["includeDeclaration"] == false);
                json!(places.get(own..).unwrap_or_default())
            }
            "textDocument/prepareRename" => {
                let at = position()?;
                let places = changes::places(&desk.checked(uri), uri, at);
                let is_here =
                    |one: &&Location| one.uri.as_str() == uri && one.range.start <= at && at <= one.range.end;
                json!(places.iter().find(is_here).map(|one| one.range))
            }
            "textDocument/rename" => {
                let new = asked["newName"].as_str().unwrap_or_default();
                let edits = changes::rename(desk, uri, position()?, new);
                json!(edits.map_err(|reason| (ErrorCode::RequestFailed, reason))?)
            }
            "textDocument/documentSymbol" => json!(outline::symbols(&desk.checked(uri), uri)),
            "textDocument/semanticTokens/full" => {
                json!(SemanticTokens { result_id: None, data: outline::tokens(&desk.checked(uri), uri) })
            }
            "textDocument/foldingRange" => json!(desk.checked(uri).source(uri).map(outline::folds)),
            "textDocument/inlayHint" => json!(outline::hints(&desk.checked(uri), uri)),
            "textDocument/formatting" => json!(self.formatted(uri, None)),
            "textDocument/rangeFormatting" => json!(self.formatted(uri, Some(range()?))),
            "textDocument/codeAction" => json!(changes::fixes(desk, uri, range()?)),
            "textDocument/codeLens" => json!(self.runs.lenses(desk, uri)),
            _ => return Err((ErrorCode::MethodNotFound, format!("`{method}` is not known"))),
        })
    }

    fn formatted(&self, uri: &str, range: Option<Range>) -> Vec<lsp_types::TextEdit> {
        let Some(open) = self.desk.open.get(uri) else { return Vec::new() };
        changes::format(&open.text, open.asks, range).into_iter().collect()
    }

    fn command(&mut self, id: RequestId, parameters: &Value) -> Result<(), String> {
        let arguments = &parameters["arguments"];
        let uri = arguments[0].as_str().ok_or("the first argument is the address of a file")?;
        match parameters["command"].as_str() {
            Some("smc.run") => {
                let number = arguments[1].as_u64().ok_or("the second argument is the number of a query")?;
                let asked = (uri, number as usize, arguments[2].as_f64());
                self.runs.run(&mut self.desk, id, asked)
            }
            Some("smc.play") => self.runs.look(&self.desk, id, uri, true),
            Some("smc.plan") => self.runs.look(&self.desk, id, uri, false),
            other => Err(format!("`{}` is not known", other.unwrap_or_default())),
        }
    }
}

/// An error or warning as the protocol has it.
fn shown_as(checked: &Checked, one: &Diagnostic) -> lsp_types::Diagnostic {
    let place = |span| {
        let (uri, source) = checked.file(span)?;
        Some((Uri::from_str(uri).ok()?, place::range(source, span)))
    };
    let range =
        one.place.as_ref().and_then(|label| place(label.span)).map_or(Range::default(), |(_, range)| range);
    let label = one.place.as_ref().map_or("", |place| &*place.text);
    let parts = [one.title.as_str(), label, one.hint.as_deref().unwrap_or_default()];
    let message = parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n");
    let related = one.related.iter().filter_map(|label| {
        let (uri, range) = place(label.span)?;
        Some(DiagnosticRelatedInformation {
            location: Location::new(uri, range),
            message: label.text.clone(),
        })
    });
    let related: Vec<_> = related.collect();
    lsp_types::Diagnostic {
        range,
        severity: Some(if one.severity == Severity::Error {
            DiagnosticSeverity::ERROR
        } else {
            DiagnosticSeverity::WARNING
        }),
        code: Some(NumberOrString::String(one.code.to_string())),
        source: Some("smc".to_owned()),
        message,
        related_information: (!related.is_empty()).then_some(related),
        ..lsp_types::Diagnostic::default()
    }
}
