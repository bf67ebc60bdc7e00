//! What the command line adds to a study, and the calls that show what was found.

use crate::kernel::driver::MakeDrivers;

/// What the command line adds to a study.
pub struct Call<'c> {
    /// Seed of all random numbers.
    pub seed: u64,
    /// The call up to its options, for replay lines: `smc check a.scn b.bltl --set density=0.8`.
    pub command: String,
    /// The same without sweeps.
    pub point: String,
    /// The call that shows a trial: `smc simulate a.scn --set density=0.8`.
    pub simulate: String,
    /// Indices of the queries to ask; all of them if empty.
    pub only: Vec<usize>,
    /// File and line of a span, for reports.
    pub place: &'c (dyn Fn(crate::syntax::source::Span) -> (String, usize) + Sync),
    /// Makes the drivers of the agents of a world. Trials that ranks run have only those that are built in.
    pub drivers: &'c MakeDrivers,
    /// Name for reports where the scenario has no title.
    pub file: String,
}

impl Call<'_> {
    /// The call that shows a trial under some settings: each takes the place of one of the call, and the last of several
    /// of one name holds.
    pub(super) fn simulate_with(&self, settings: &[(String, String)], trial: u64) -> String {
        let mut command = String::new();
        for (k, piece) in self.simulate.split(" --set ").enumerate() {
            let quoted = piece.strip_prefix('\'');
            let name = quoted.unwrap_or(piece).split('=').next().unwrap_or_default();
            if k > 0 && settings.iter().any(|(own, _)| own == name) {
                // What follows the value stays.
                let end = quoted.map_or_else(
                    || piece.find(' ').unwrap_or(piece.len()),
                    |rest| rest.find('\'').map_or(piece.len(), |at| at + 2),
                );
                command.push_str(&piece[end..]);
                continue;
            }
            if k > 0 {
                command.push_str(" --set ");
            }
            command.push_str(piece);
        }
        for (k, (name, value)) in settings.iter().enumerate() {
            if settings[k + 1..].iter().all(|(later, _)| later != name) {
                command.push_str(&format!(" --set '{name}={value}'"));
            }
        }
        format!("{command} --seed {} --trial {trial}", self.seed)
    }
}
