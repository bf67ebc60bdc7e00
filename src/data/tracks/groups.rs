//! Reader of annotated groups (`groups.txt`): one group per line, ids as in the recording.
//!
//! A line is a set: a repeated id counts once. Lines that share a person are one group, because the eth sequence
//! lists some groups twice with different members.

use super::line::{LineError, fields, quoted};
use std::collections::BTreeMap;

/// Reads groups: each ascending, in the order of their smallest members. Empty lines are passed over; a
/// line with one person is ignored.
///
/// # Errors
/// Every field that is not a whole number from 0 to 4294967295.
pub fn read_groups(text: &str) -> Result<Vec<Vec<u32>>, Vec<LineError>> {
    let mut errors = Vec::new();
    let mut parents = BTreeMap::<u32, u32>::new();
    for (k, line) in text.lines().enumerate() {
        let mut first = None;
        for (column, field) in fields(line) {
            let Ok(id) = field.parse::<u32>() else {
                let message = format!("{} is not the id of a person", quoted(field));
                errors.push(LineError::at(k + 1, column, message));
                continue;
            };
            let head = *first.get_or_insert(id);
            join(&mut parents, head, id);
        }
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    let ids: Vec<u32> = parents.keys().copied().collect();
    let mut groups = BTreeMap::<u32, Vec<u32>>::new();
    for id in ids {
        let root = root(&mut parents, id);
        groups.entry(root).or_default().push(id);
    }
    Ok(groups.into_values().filter(|group| group.len() > 1).collect())
}

/// The smallest id known to be of the same group; shortens the way to it.
fn root(parents: &mut BTreeMap<u32, u32>, id: u32) -> u32 {
    let mut at = id;
    while let Some(&parent) = parents.get(&at)
        && parent != at
    {
        let above = parents.get(&parent).copied().unwrap_or(parent);
        parents.insert(at, above);
        at = above;
    }
    parents.entry(at).or_insert(at);
    at
}

fn join(parents: &mut BTreeMap<u32, u32>, a: u32, b: u32) {
    let (a, b) = (root(parents, a), root(parents, b));
    parents.insert(a.max(b), a.min(b));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_sets_and_overlaps_are_one_group() {
        let text = " 240 239 238 237\n 241 242 238 238\n 5 4\n\n 242 241\n 9\n7 7\n";
        assert_eq!(read_groups(text).unwrap(), [vec![4, 5], vec![237, 238, 239, 240, 241, 242]]);
    }

    #[test]
    fn all_faults_come_at_once() {
        let said: Vec<String> =
            read_groups("1 b\n-2 3.5").unwrap_err().iter().map(ToString::to_string).collect();
        assert_eq!(
            said,
            [
                "line 1, column 3: `b` is not the id of a person",
                "line 2, column 1: `-2` is not the id of a person",
                "line 2, column 4: `3.5` is not the id of a person",
            ]
        );
    }
}
