//! The known name nearest to an unknown one, for hints.

/// So many letters of a name are looked at.
const LONGEST: usize = 64;

/// Edit distance with transpositions of neighbours (optimal string alignment).
fn distance(a: &[char], b: &[char]) -> usize {
    let width = b.len() + 1;
    let mut rows = vec![vec![0usize; width]; a.len() + 1];
    for (j, cell) in rows[0].iter_mut().enumerate() {
        *cell = j;
    }
    for i in 1..=a.len() {
        rows[i][0] = i;
        for j in 1..width {
            let change = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = change.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            rows[i][j] = best;
        }
    }
    rows[a.len()][b.len()]
}

/// The nearest of the known names, if it is near enough to be meant.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let chars: Vec<char> = name.chars().take(LONGEST).collect();
    // Of one letter every other one would be near.
    let limit = if chars.len() == 1 { 0 } else { (chars.len() / 3).max(1) };
    known
        .filter(|candidate| *candidate != name)
        // Each letter more or less is a change.
        .filter(|candidate| candidate.chars().take(LONGEST).count().abs_diff(chars.len()) <= limit)
        .map(|candidate| {
            let other: Vec<char> = candidate.chars().take(LONGEST).collect();
            let other_case = candidate.eq_ignore_ascii_case(name);
            (if other_case { 0 } else { distance(&chars, &other) }, candidate)
        })
        .filter(|(d, _)| *d <= limit)
        .min_by_key(|(d, _)| *d)
        .map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_recognised_and_strangers_are_not() {
        let known = ["velocity", "user", "exit"];
        assert_eq!(nearest("velcoity", known.into_iter()), Some("velocity"));
        assert_eq!(nearest("User", known.into_iter()), Some("user"));
        assert_eq!(nearest("density", known.into_iter()), None);
        // A third of the letters may differ, also by being there or not.
        assert_eq!(nearest("veloci", known.into_iter()), Some("velocity"));
        assert_eq!(nearest("veloc", known.into_iter()), None);
        assert_eq!(nearest("EXIT", known.into_iter()), Some("exit"));
        assert_eq!(nearest("t", ["w", "T"].into_iter()), Some("T"));
        assert_eq!(nearest("q", ["w", "p"].into_iter()), None);
    }
}
