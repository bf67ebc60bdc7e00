//! Launchers: how the shards of a round are started. Each is a line for the shell that returns when the shards are over; the
//! queue that it talks to keeps order, repeats and accounts.

use super::parts::{PartsFolder, bytes};
use super::{complaint, output};
use crate::engine::shards::Plan;
use crate::engine::{Budget, CommandLine, quoted};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Between two looks at the folder.
const LOOK: Duration = Duration::from_millis(20);

/// The lines of the engines that are known by name.
const ENGINES: [(&str, &str); 2] = [
    ("hq", "hq submit --wait --array 0-{last} --stdout none --stderr none -- sh {shard}"),
    ("slurm", "sbatch --wait --array=0-{last} --output={parts}/shards.log --open-mode=append {shard}"),
];
/// The job for Kubernetes.
const MANIFEST: &str = include_str!("../../templates/shards.yaml");

/// How shards are started.
pub(super) struct Launcher<'a> {
    /// An engine, or a line of its own.
    pub(super) engine: &'a str,
    /// The call.
    pub(super) line: CommandLine,
    /// Shards that run side by side on this machine.
    pub(super) jobs: usize,
}

impl Launcher<'_> {
    /// Writes the script of a shard: the index is its argument, or what the queue says.
    fn script(&self, folder: &PartsFolder, program: &Path) -> Result<PathBuf, Diagnostic> {
        let file = folder.path.join("shard.sh");
        let path = |path: &Path| quoted(&path.display().to_string());
        let (plan, parts) = (path(&folder.plan_file()), path(&folder.path));
        let call = self.line.shard();
        let call = call.strip_prefix("smc ").unwrap_or(&call);
        let script = format!(
            "#!/bin/sh\n\
             index=${{1:-${{HQ_TASK_ID:-${{SLURM_ARRAY_TASK_ID:-$JOB_COMPLETION_INDEX}}}}}}\n\
             {} {call} --round {plan} --index \"$index\" -o {parts} || exit 1\n",
            path(program)
        );
        output::save(&file, script.as_bytes())?;
        Ok(file)
    }

    /// The job for Kubernetes, if it is asked for.
    pub(super) fn manifest(&self, folder: &PartsFolder, plan: &Plan) -> Result<Option<String>, Diagnostic> {
        let script = || self.script(folder, Path::new("smc"));
        (self.engine == "k8s").then(|| Ok(self.fill(MANIFEST, folder, plan, &script()?))).transpose()
    }

    /// A line or a manifest with its names replaced.
    fn fill(&self, text: &str, folder: &PartsFolder, plan: &Plan, script: &Path) -> String {
        let count = plan.shards.len();
        let path = |path: &Path| quoted(&path.display().to_string());
        text.replace("{plan}", &path(&folder.plan_file()))
            .replace("{parts}", &path(&folder.path))
            .replace("{shard}", &path(script))
            .replace("{round}", &plan.round.to_string())
            .replace("{count}", &count.to_string())
            .replace("{last}", &(count - 1).to_string())
            .replace("{jobs}", &self.jobs.to_string())
    }

    /// Starts the shards of a plan and waits until they are over, or the budget ends. `told` hears how many are done.
    pub(super) fn launch(
        &self,
        folder: &PartsFolder,
        plan: &Plan,
        budget: &Budget,
        told: &dyn Fn(usize),
    ) -> Result<(), Diagnostic> {
        let script = self.script(folder, &std::env::current_exe().unwrap_or_else(|_| "smc".into()))?;
        let line =
            ENGINES.iter().find(|(name, _)| *name == self.engine).map_or(self.engine, |(_, line)| line);
        let command = self.fill(line, folder, plan, &script);
        let log = folder.path.join("launcher.log");
        let failed = |reason: String| {
            let said = bytes(&log).unwrap_or_default();
            let said = String::from_utf8_lossy(&said);
            let said = said.lines().last().map_or(String::new(), |last| format!(": {last}"));
            Diagnostic::placeless(Code::E0725, format!("the launcher `{command}` {reason}{said}"))
                .hint("see `smc explain E0725` for the launchers; parts that are there are used when you call again")
        };
        let out = File::options().write(true).create(true).truncate(true).open(&log);
        let out = out.map_err(|error| complaint::unwritten(&log, &error))?;
        let mut shell = Command::new("sh");
        shell.arg("-c").arg(format!("exec 2>&1\n{command}")).stdin(Stdio::null()).stdout(out);
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut shell, 0);
        let mut child = shell.spawn().map_err(|error| failed(format!("cannot be started: {error}")))?;
        let done = || plan.shards.len() - folder.missing(plan).len();
        loop {
            match child.try_wait() {
                Ok(None) if budget.must_stop() => break end(&mut child),
                Ok(None) => {}
                Ok(Some(status)) if status.success() || done() > 0 => break,
                Ok(Some(status)) => return Err(failed(format!("failed ({status})"))),
                Err(error) => return Err(failed(format!("cannot be waited for: {error}"))),
            }
            told(done());
            std::thread::sleep(LOOK);
        }
        Ok(())
    }
}

/// Ends a launcher and all that it has started on this machine.
fn end(child: &mut Child) {
    #[cfg(unix)]
    let _ = Command::new("kill")
        .args(["-TERM", "--", &format!("-{}", child.id())])
        .stderr(Stdio::null())
        .status();
    let _ = child.kill();
    let _ = child.wait();
}
