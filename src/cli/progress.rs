//! Progress on standard error, where that is a terminal.

use super::deadline::{Deadline, Phase};
use crate::base::visible::visible;
use crate::engine::{CallForecast, Watch};
use crate::report;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;

/// Forecasts shorter than this are not shown, s.
const WORTH_TELLING: f64 = 10.0;

/// Shows how far a query is.
pub(super) struct Progress {
    bar: Option<ProgressBar>,
    quiet: bool,
    deadline: Deadline,
}

impl Progress {
    /// On a terminal a line that changes; elsewhere nothing but long forecasts.
    pub(super) fn new(quiet: bool, deadline: Deadline) -> Self {
        let bar = (!quiet && std::io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(10));
            let style = ProgressStyle::with_template("{spinner} {wide_msg} {elapsed}")
                .unwrap_or_else(|_| ProgressStyle::default_spinner());
            bar.set_style(style);
            bar
        });
        Self { bar, quiet, deadline }
    }
}

impl Progress {
    /// Shows how far a round of shards is.
    pub(super) fn shards(&self, message: &str) {
        let Some(bar) = &self.bar else { return };
        if bar.is_finished() {
            bar.reset();
        }
        bar.set_message(visible(message).into_owned());
        bar.tick();
    }
}

impl Watch for Progress {
    fn forecast(&self, forecast: &CallForecast) {
        // What is over in a moment needs no forecast.
        if self.quiet || forecast.seconds < WORTH_TELLING {
            return;
        }
        let lines = visible(&report::forecast::text(forecast)).into_owned();
        match &self.bar {
            Some(bar) => lines.lines().for_each(|line| bar.println(line)),
            None => super::terminal::say(&lines),
        }
    }

    fn samples(&self) {
        self.deadline.enter(Phase::Sampling);
    }

    fn consumed(&self, query: &str, trials: u64, of: Option<u64>) {
        let Some(bar) = &self.bar else { return };
        let of = of.map_or(String::new(), |of| format!(" of about {of}"));
        bar.set_message(format!("{trials}{of} trials · {}", visible(query)));
        bar.tick();
    }

    fn finished(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
