//! Starts `smc lsp` for scenarios and properties.

use zed_extension_api::{self as zed, LanguageServerId, Worktree};

struct Smc;

impl zed::Extension for Smc {
    fn new() -> Self {
        Self
    }

    fn language_server_command(
        &mut self,
        _server: &LanguageServerId,
        worktree: &Worktree,
    ) -> zed::Result<zed::Command> {
        let command = worktree.which("smc").ok_or("the program `smc` is not on the path")?;
        Ok(zed::Command { command, args: vec!["lsp".into()], env: worktree.shell_env() })
    }
}

zed::register_extension!(Smc);
