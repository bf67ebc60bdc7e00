//! Progress on standard error, where that is a terminal.

use crate::engine::{Forecast, Watch};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;

/// Shows how far a query is.
pub(super) struct Progress {
    bar: Option<ProgressBar>,
    quiet: bool,
}

impl Progress {
    /// On a terminal a line that changes; elsewhere nothing but long forecasts.
    pub(super) fn new(quiet: bool) -> Self {
        let bar = (!quiet && std::io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(10));
            let style = ProgressStyle::with_template("{spinner} {wide_msg} {elapsed}")
                .unwrap_or_else(|_| ProgressStyle::default_spinner());
            bar.set_style(style);
            bar
        });
        Self { bar, quiet }
    }
}

impl Watch for Progress {
    fn forecast(&self, forecast: &Forecast) {
        // What is over in a moment needs no forecast.
        if self.quiet || forecast.seconds < 2.0 {
            return;
        }
        let line = format!(
            "about {} trials, {}: {}",
            round(forecast.trials),
            duration(forecast.seconds),
            forecast.query
        );
        match &self.bar {
            Some(bar) => bar.println(line),
            None => super::terminal::say(&format!("{line}\n")),
        }
    }

    fn consumed(&self, query: &str, trials: u64, of: Option<u64>) {
        let Some(bar) = &self.bar else { return };
        let of = of.map_or(String::new(), |of| format!(" of about {}", round(of)));
        bar.set_message(format!("{trials}{of} trials · {query}"));
        bar.tick();
    }

    fn finished(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Two digits are enough for a forecast.
fn round(n: u64) -> u64 {
    let mut scale = 1;
    while n / scale >= 100 {
        scale *= 10;
    }
    n.div_ceil(scale) * scale
}

fn duration(seconds: f64) -> String {
    if seconds < 90.0 {
        format!("{seconds:.0} s")
    } else if seconds < 5400.0 {
        format!("{:.0} min", seconds / 60.0)
    } else {
        format!("{:.1} h", seconds / 3600.0)
    }
}
