//! Which processes hang together: those that read one another's variables.
//!
//! Only a process itself sets its variables, and no process waits for another. So an error in one says nothing about
//! those that read nothing of it, and processes that read nothing of each other can be looked at one after the other.

use crate::compile::process::reachable::Lines;
use crate::model::{Process, Processes, Timing, VariableId};
use std::collections::BTreeSet;
use std::ops::Range;

/// How a process is written.
pub(crate) struct Writing {
    /// Its commands.
    pub(crate) lines: Vec<Lines>,
    /// Its variables.
    pub(crate) variables: Range<usize>,
    /// Whether nothing is wrong with it.
    pub(crate) is_sound: bool,
}

/// Processes that hang together.
pub(crate) struct Part<'p> {
    /// These, and how they are written.
    pub(crate) members: Vec<(&'p Process, &'p Writing)>,
    /// Their variables, ascending.
    pub(crate) variables: Vec<usize>,
}

/// Which processes are looked at.
#[derive(Clone, Copy)]
pub(crate) struct Scope {
    /// Whether commands have rates.
    pub(crate) jumps: bool,
    /// Whether only those that read nothing but variables.
    pub(crate) closed: bool,
}

impl<'p> Part<'p> {
    /// The parts of all processes.
    pub(crate) fn of(processes: &'p Processes, writings: &'p [Writing], scope: Scope) -> Vec<Self> {
        let owned = |w: &Writing| w.variables.clone();
        let mut owners: Vec<Option<usize>> = vec![None; processes.variables.len()];
        for (process, writing) in writings.iter().enumerate() {
            for variable in owned(writing) {
                owners[variable] = Some(process);
            }
        }
        // For each, the processes whose variables it reads; `None` if its commands are unknown.
        let reads: Vec<Option<BTreeSet<usize>>> = processes
            .list
            .iter()
            .zip(writings)
            .map(|(process, writing)| {
                let mut read = BTreeSet::new();
                let closed = process.reads(&mut read);
                let whole = |v: usize| processes.variables[v].domain.values().is_some();
                let timed = |timing: &Timing| match timing {
                    Timing::Step => !scope.jumps,
                    Timing::Rate(_) => scope.jumps,
                    // Which of several delays ends first is not known here.
                    Timing::Delay(..) => false,
                };
                let foreseen = writing.is_sound
                    && (closed || !scope.closed)
                    && owned(writing).all(whole)
                    && process.commands.iter().all(|command| timed(&command.timing));
                let owner = |VariableId(v): VariableId| owners.get(v as usize).copied().flatten();
                read.into_iter().map(owner).collect::<Option<BTreeSet<usize>>>().filter(|_| foreseen)
            })
            .collect();
        let known = known(&reads);
        let mut groups = Groups((0..reads.len()).collect());
        for (process, read) in reads.iter().enumerate().filter(|(process, _)| known[*process]) {
            for other in read.iter().flatten() {
                groups.join(process, *other);
            }
        }
        let mut parts: Vec<(usize, Self)> = Vec::new();
        for process in (0..reads.len()).filter(|process| known[*process]) {
            let group = groups.root_of(process);
            // A group is called by its first.
            let at = parts.binary_search_by_key(&group, |(first, _)| *first).unwrap_or_else(|at| {
                parts.insert(at, (group, Part { members: Vec::new(), variables: Vec::new() }));
                at
            });
            let part = &mut parts[at].1;
            part.members.push((&processes.list[process], &writings[process]));
            part.variables.extend(owned(&writings[process]));
        }
        parts.into_iter().map(|(_, part)| part).collect()
    }
}

/// A process is unknown if one that it reads, directly or indirectly, is unknown.
fn known(reads: &[Option<BTreeSet<usize>>]) -> Vec<bool> {
    let mut known: Vec<bool> = reads.iter().map(Option::is_some).collect();
    let mut readers: Vec<Vec<usize>> = vec![Vec::new(); reads.len()];
    for (process, read) in reads.iter().enumerate() {
        for other in read.iter().flatten() {
            readers[*other].push(process);
        }
    }
    let mut lost: Vec<usize> = (0..reads.len()).filter(|process| !known[*process]).collect();
    while let Some(process) = lost.pop() {
        for &reader in &readers[process] {
            if std::mem::replace(&mut known[reader], false) {
                lost.push(reader);
            }
        }
    }
    known
}

/// Sets that are joined; each is called by its least member.
struct Groups(Vec<usize>);

impl Groups {
    fn root_of(&mut self, mut member: usize) -> usize {
        while self.0[member] != member {
            self.0[member] = self.0[self.0[member]];
            member = self.0[member];
        }
        member
    }

    fn join(&mut self, one: usize, other: usize) {
        let (one, other) = (self.root_of(one), self.root_of(other));
        let (least, greatest) = (one.min(other), one.max(other));
        self.0[greatest] = least;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_reads_an_unknown_one_is_unknown() {
        let some = |read: &[usize]| Some(read.iter().copied().collect::<BTreeSet<_>>());
        // 3 is unknown; 1 reads it, 0 reads 1; 2 and 4 do not.
        let reads = [some(&[1]), some(&[3]), some(&[4]), None, some(&[])];
        assert_eq!(known(&reads), [false, false, true, false, true]);
        let circle = [some(&[1]), some(&[0]), some(&[1, 2])];
        assert_eq!(known(&circle), [true, true, true]);
    }

    #[test]
    fn groups_are_called_by_their_least_member() {
        let mut groups = Groups((0..6).collect());
        groups.join(5, 3);
        groups.join(1, 5);
        groups.join(4, 2);
        let firsts: Vec<usize> = (0..6).map(|member| groups.root_of(member)).collect();
        assert_eq!(firsts, [0, 1, 2, 1, 2, 1]);
    }
}
