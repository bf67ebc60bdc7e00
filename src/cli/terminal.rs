//! Standard output and standard error: colours, broken pipes.

use super::complaint;
use crate::base::visible::visible;
use crate::syntax::diagnostic::Diagnostic;
use clap::ValueEnum;
use std::io::{IsTerminal, Write};

/// When to colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ColorChoice {
    /// On a terminal.
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

/// Whether output is colored.
#[derive(Clone, Copy, Debug)]
pub(super) struct Colors {
    /// On standard output.
    pub(super) out: bool,
    /// On standard error.
    pub(super) err: bool,
}

impl Colors {
    /// Follows the choice, then `NO_COLOR` and `CLICOLOR_FORCE`, then whether it is a terminal that has colors.
    #[allow(clippy::disallowed_methods, reason = "the command line reads the environment")]
    pub(super) fn chosen(choice: ColorChoice) -> Self {
        let set = |name: &str| std::env::var(name).is_ok_and(|v| !v.is_empty() && v != "0");
        match choice {
            ColorChoice::Always => Self { out: true, err: true },
            ColorChoice::Never => Self { out: false, err: false },
            ColorChoice::Auto if set("NO_COLOR") => Self { out: false, err: false },
            ColorChoice::Auto if set("CLICOLOR_FORCE") || set("FORCE_COLOR") => Self { out: true, err: true },
            ColorChoice::Auto => {
                let able = std::env::var("TERM").is_ok_and(|term| term != "dumb") || cfg!(windows);
                let (out, err) = (std::io::stdout().is_terminal(), std::io::stderr().is_terminal());
                Self { out: able && out, err: able && err }
            }
        }
    }
}

/// Writes to standard output. A reader that went away is no error.
pub(super) fn print(text: &str) -> Result<(), Diagnostic> {
    print_to_reader(text).map(|_| ())
}

/// Writes to standard output; false where its reader went away.
pub(super) fn print_to_reader(text: &str) -> Result<bool, Diagnostic> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(false),
        Err(error) => Err(complaint::output(format!("standard output: {error}"))),
    }
}

/// Writes text that may quote anything to standard error.
pub(super) fn warn(text: &str) {
    say(&visible(text));
}

/// Writes what is ready for a terminal to standard error; nothing can be done where that fails.
pub(super) fn say(text: &str) {
    let mut err = std::io::stderr().lock();
    let _ = err.write_all(text.as_bytes());
}
