//! Answers in the margin: queries that run beside the editor, each in a thread of its own, and their verdicts. A verdict belongs to
//! the texts that it was asked of, and is marked as stale where they are others now.

use super::desk::{Checked, Desk};
use super::place;
use crate::base::visible::shortened;
use crate::cli::inputs;
use crate::engine::{Budget, Watch};
use crate::library::{Draft, Options, STACK};
use crate::report::brief;
use crate::report::svg::picture::Paper;
use crate::report::svg::plan;
use crate::syntax::ast::PropertyItem;
use lsp_server::{ErrorCode, Message, Notification, Request, RequestId, Response};
use lsp_types::{CodeLens, Command, Range};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicI32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Time between two reports of progress, s.
const PACE: f64 = 0.2;

/// The query of a file, by its place among the queries.
type Place = (String, usize);
/// The texts of a scenario and of a property file.
type Texts = (Arc<str>, Arc<str>);

#[derive(Default)]
struct State {
    verdicts: BTreeMap<Place, (Texts, String)>,
    /// Queries that run, by the token of their progress, and by the number of the request.
    running: BTreeMap<String, (Place, RequestId, Arc<Budget>)>,
}

/// Sends messages to the editor, from any thread.
#[derive(Clone)]
pub(super) struct Editor {
    pub(super) send: Arc<dyn Fn(Message) + Send + Sync>,
    next: Arc<AtomicI32>,
}

impl Editor {
    pub(super) fn new(send: Arc<dyn Fn(Message) + Send + Sync>) -> Self {
        Self { send, next: Arc::default() }
    }

    /// Asks the editor for something; its answer is of no interest.
    pub(super) fn ask(&self, method: &str, parameters: Value) {
        let id = self.next.fetch_add(1, Ordering::Relaxed);
        (self.send)(Request::new(id.into(), method.to_owned(), parameters).into());
    }

    pub(super) fn tell(&self, method: &str, parameters: Value) {
        (self.send)(Notification::new(method.to_owned(), parameters).into());
    }

    fn progress(&self, token: &str, value: &Value) {
        self.tell("$/progress", json!({ "token": token, "value": value }));
    }

    pub(super) fn answer(&self, id: RequestId, result: Result<Value, (ErrorCode, String)>) {
        let answer = match result {
            Ok(value) => Response::new_ok(id, value),
            Err((code, reason)) => Response::new_err(id, code as i32, reason),
        };
        (self.send)(answer.into());
    }
}

/// Queries that run, and verdicts.
pub(super) struct Runs {
    state: Arc<Mutex<State>>,
    editor: Editor,
    /// Threads of a query.
    pub(super) threads: Option<usize>,
    /// Whether the editor shows pages itself.
    pub(super) shows_pages: bool,
}

impl Runs {
    pub(super) fn new(editor: Editor) -> Self {
        Self { state: Arc::default(), editor, threads: None, shows_pages: true }
    }

    /// The model of a scenario as it is on the desk.
    fn draft(desk: &Desk, scenario: &str) -> Result<Draft, String> {
        let path = place::path(scenario).map_or(scenario.to_owned(), |path| path.display().to_string());
        let data: Vec<PathBuf> = desk.data.clone();
        let names = data.iter().map(|folder| folder.display().to_string()).collect();
        let beside = path.clone();
        Ok(Draft::new(path, &*desk.text(scenario)?)
            .reading(names, move |file| inputs::read(&inputs::find(file, &beside, &data)?.to_string_lossy())))
    }

    /// Runs a query: the request is answered when it has ended.
    pub(super) fn run(
        &self,
        desk: &mut Desk,
        id: RequestId,
        asked: (&str, usize, Option<f64>),
    ) -> Result<(), String> {
        let (uri, number, seconds) = asked;
        let checked = desk.checked(uri);
        let only = indices(&checked, uri, number);
        if only.is_empty() {
            let reason = "it has errors, or no scenario: its first line may name one, `for \"file.scn\"`";
            return Err(format!("the file cannot be asked: {reason}"));
        }
        let scenario = desk.key(uri);
        let draft = Self::draft(desk, &scenario)?;
        let texts: Texts = (desk.text(&scenario)?, desk.text(uri)?);
        let name = place::path(uri).map_or(uri.to_owned(), |path| path.display().to_string());
        let mut options = Options::default();
        if let Some(limit) = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()) {
            options = options.timeout(limit);
        }
        if let Some(threads) = self.threads {
            options = options.threads(threads);
        }
        options = only.iter().fold(options, |options, index| options.only(index.to_string()));
        let budget = Arc::new(options.budget());
        let token = format!("smc-{id}");
        let place = (uri.to_owned(), number);
        let running = (place.clone(), id.clone(), Arc::clone(&budget));
        self.lock().running.insert(token.clone(), running);
        let (state, editor) = (Arc::clone(&self.state), self.editor.clone());
        Self::spawn(move || {
            editor.ask("window/workDoneProgress/create", json!({ "token": token }));
            let begin = json!({ "kind": "begin", "title": "smc", "cancellable": true, "message": "the trials begin" });
            editor.progress(&token, &begin);
            editor.ask("workspace/codeLens/refresh", Value::Null);
            let progress = Progress {
                editor: editor.clone(),
                token: token.clone(),
                budget: Arc::clone(&budget),
                last: Mutex::new(0.0),
            };
            let found = draft
                .parse()
                .and_then(|model| model.check_files(&[(&name, &texts.1)], &options, &budget, &progress));
            let said = match found {
                Ok(report) => brief::beside(report.run()),
                Err(wrong) => {
                    wrong.iter().map(|one| format!("cannot run: {}", one.title)).next().unwrap_or_default()
                }
            };
            let said = if budget.is_interrupted() { format!("cancelled: {said}") } else { said };
            let mut known = state.lock().unwrap_or_else(PoisonError::into_inner);
            known.running.remove(&token);
            known.verdicts.insert(place, (texts, shortened(said.clone())));
            drop(known);
            editor.progress(&token, &json!({ "kind": "end", "message": said }));
            editor.ask("workspace/codeLens/refresh", Value::Null);
            editor.answer(id, Ok(json!({ "verdict": said })));
        })
    }

    /// Plays a trial of a scenario, or draws its plan, as a page: the request is answered with the address of the page.
    pub(super) fn look(&self, desk: &Desk, id: RequestId, scenario: &str, plays: bool) -> Result<(), String> {
        let draft = Self::draft(desk, scenario)?;
        let (editor, shows_pages) = (self.editor.clone(), self.shows_pages);
        let name = if plays { "trial" } else { "plan" };
        let stem =
            place::path(scenario).and_then(|path| Some(path.file_stem()?.to_string_lossy().into_owned()));
        let file = format!("smc-{}-{}-{name}.html", std::process::id(), stem.unwrap_or_default());
        Self::spawn(move || {
            let page = draft.parse().map_err(|wrong| wrong.to_string()).and_then(|model| {
                if plays {
                    return model.play(0, &[0]).map_err(|wrong| wrong.to_string());
                }
                let svg = plan::draw(model.scenario()).svg(Paper { width: None });
                Ok(format!("<!doctype html>\n<meta charset=\"utf-8\">\n<title>Plan</title>\n{svg}"))
            });
            let path = std::env::temp_dir().join(file);
            let saved = page.and_then(|page| {
                crate::cli::output::save(&path, page.as_bytes()).map_err(|wrong| wrong.title)
            });
            let uri = place::uri(&path);
            if saved.is_ok() && !shows_pages {
                editor.ask("window/showDocument", json!({ "uri": uri, "external": true }));
            }
            editor.answer(
                id,
                saved.map(|()| json!({ "page": uri })).map_err(|reason| (ErrorCode::RequestFailed, reason)),
            );
        })
    }

    /// Starts a thread that may walk deep formulas.
    fn spawn(work: impl FnOnce() + Send + 'static) -> Result<(), String> {
        let thread = std::thread::Builder::new().stack_size(STACK).spawn(work);
        thread.map(drop).map_err(|error| format!("no thread can be started: {error}"))
    }

    /// Ends the query of a progress or of a request.
    pub(super) fn cancel(&self, is_it: impl Fn(&str, &RequestId) -> bool) {
        for (token, (_, id, budget)) in &self.lock().running {
            if is_it(token, id) {
                budget.interrupt();
            }
        }
    }

    /// The lenses of a file.
    pub(super) fn lenses(&self, desk: &mut Desk, uri: &str) -> Vec<CodeLens> {
        let checked = desk.checked(uri);
        let Some(source) = checked.source(uri) else { return Vec::new() };
        let lens = |range, title: &str, command: &str, arguments: Vec<Value>| CodeLens {
            range,
            command: Some(Command {
                title: title.to_owned(),
                command: command.to_owned(),
                arguments: Some(arguments),
            }),
            data: None,
        };
        if checked.has_scenario && source.id.0 == 0 {
            let top = Range::default();
            let arguments = || vec![json!(uri)];
            return vec![
                lens(top, "▷ play a trial", "smc.play", arguments()),
                lens(top, "plan", "smc.plan", arguments()),
            ];
        }
        let now = desk.text(&desk.key(uri)).ok().zip(desk.text(uri).ok());
        let known = self.lock();
        let mut lenses = Vec::new();
        for (number, span) in queries(&checked, uri).into_iter().enumerate() {
            let range = place::range(source, span);
            let range = Range::new(range.start, range.start);
            let place = (uri.to_owned(), number);
            if known.running.values().any(|(running, ..)| *running == place) {
                lenses.push(lens(range, "… sampling", "", Vec::new()));
                continue;
            }
            if let Some((texts, said)) = known.verdicts.get(&place) {
                let stale = if now.as_ref() == Some(texts) { "" } else { "stale: " };
                lenses.push(lens(range, &format!("{stale}{said}"), "", Vec::new()));
            }
            lenses.push(lens(range, "▷ run", "smc.run", vec![json!(uri), json!(number), Value::Null]));
            lenses.push(lens(range, "run with 10 s", "smc.run", vec![json!(uri), json!(number), json!(10)]));
        }
        lenses
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The places of the queries of a file.
fn queries(checked: &Checked, uri: &str) -> Vec<crate::syntax::source::Span> {
    let Some(source) = checked.source(uri) else { return Vec::new() };
    // The first source is the scenario, where there is one.
    let number = usize::from(source.id.0).checked_sub(usize::from(checked.has_scenario));
    let file = number.and_then(|number| checked.properties.get(number));
    let items = file.iter().flat_map(|file| &file.items);
    items
        .filter_map(|item| if let PropertyItem::Query(query) = item { Some(query.span) } else { None })
        .collect()
}

/// The numbers that the parts of a query have in a call with its file alone.
fn indices(checked: &Checked, uri: &str, number: usize) -> Vec<usize> {
    let (Some(study), Some(source)) = (&checked.inputs.study, checked.source(uri)) else { return Vec::new() };
    let Some(span) = queries(checked, uri).get(number).copied() else { return Vec::new() };
    let own = study.queries.iter().filter(|query| query.span.source == source.id);
    let first = own.clone().map(|query| query.index).min().unwrap_or(0);
    let mut found: Vec<usize> =
        own.filter(|query| query.span == span).map(|query| query.index - first).collect();
    found.dedup();
    found
}

/// Reports how far a query is, now and then.
struct Progress {
    editor: Editor,
    token: String,
    budget: Arc<Budget>,
    last: Mutex<f64>,
}

impl Watch for Progress {
    fn consumed(&self, _: &str, trials: u64, of: Option<u64>) {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if self.budget.elapsed() - *last < PACE {
            return;
        }
        *last = self.budget.elapsed();
        let share = of.map(|of| (100 * trials / of.max(1)).min(100));
        let of = of.map_or(String::new(), |of| format!(" of about {of}"));
        let value =
            json!({ "kind": "report", "message": format!("{trials}{of} trials"), "percentage": share });
        self.editor.progress(&self.token, &value);
    }
}
