//! Within and between people: the mean step of each subject is the typical one plus an offset, a one-way model with random effects
//! (Searle, Casella, `McCulloch` 1992, chapter 3), column by column, shrunk by the ratio of variances. Rows are seen from the
//! foot (`columns::seen_from`), so that both feet share an offset.

use super::basis::{combined, moments, square_root};
use super::columns::{COLUMNS, Columns, plus};
use nalgebra::SMatrix;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A subject that was recorded.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Subject {
    pub(super) name: String,
    pub(super) steps: usize,
    /// Its shrunk mean.
    pub(super) offset: Columns,
}

/// How people differ.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct People {
    /// By name.
    pub(super) subjects: Vec<Subject>,
    /// The mean over people.
    pub(super) typical: Columns,
    /// Variance of the steps of one subject, m^2 and s^2.
    pub(super) within: Columns,
    /// Variance of the means of people.
    pub(super) between: Columns,
    /// Offsets of a new person are the typical one and a sum of these with standard normal factors.
    pub(super) loadings: Vec<Columns>,
}

impl People {
    /// From rows about the mean of their foot, with the names of the subjects. Without `differ` all offsets are 0.
    pub(super) fn fit(rows: &[(&str, Columns)], differ: bool) -> Self {
        let mut groups: BTreeMap<&str, Vec<Columns>> = BTreeMap::new();
        for (name, row) in rows {
            groups.entry(name).or_default().push(*row);
        }
        let groups: Vec<(&str, usize, Columns, Columns)> = groups
            .into_iter()
            .map(|(name, rows)| {
                let (mean, covariance) = moments(&rows);
                (name, rows.len(), mean, std::array::from_fn(|k| covariance[(k, k)] * rows.len() as f64))
            })
            .collect();
        let count = groups.len() as f64;
        let freedom = (rows.len() as f64 - count).max(1.0);
        let within: Columns = std::array::from_fn(|k| groups.iter().map(|g| g.3[k]).sum::<f64>() / freedom);
        // Unweighted means, so that a subject with many steps counts once.
        let between: Columns = std::array::from_fn(|k| {
            let mean = groups.iter().map(|g| g.2[k]).sum::<f64>() / count;
            let spread = groups.iter().map(|g| (g.2[k] - mean) * (g.2[k] - mean)).sum::<f64>()
                / (count - 1.0).max(1.0);
            let chance = groups.iter().map(|g| within[k] / g.1 as f64).sum::<f64>() / count;
            if differ { (spread - chance).max(0.0) } else { 0.0 }
        });
        let typical = std::array::from_fn(|k| {
            if between[k] <= 0.0 {
                return 0.0;
            }
            let weight = |g: &(&str, usize, Columns, Columns)| 1.0 / (between[k] + within[k] / g.1 as f64);
            groups.iter().map(|g| weight(g) * g.2[k]).sum::<f64>() / groups.iter().map(weight).sum::<f64>()
        });
        let mut people = Self { subjects: Vec::new(), typical, within, between, loadings: Vec::new() };
        let subject = |g: &(&str, usize, Columns, Columns)| Subject {
            name: g.0.to_string(),
            steps: g.1,
            offset: people.shrunk(&g.2, g.1),
        };
        people.subjects = groups.iter().map(subject).collect();
        // The correlation of the offsets with the variances between people.
        let offsets: Vec<Columns> = people.subjects.iter().map(|s| plus(&s.offset, -1.0, &typical)).collect();
        let square = |i: usize, j: usize| offsets.iter().map(|o| o[i] * o[j]).sum::<f64>();
        let scale = |k: usize| if square(k, k) > 0.0 { (between[k] / square(k, k)).sqrt() } else { 0.0 };
        people.loadings = square_root(&SMatrix::from_fn(|i, j| square(i, j) * scale(i) * scale(j)));
        people
    }

    /// The offset of a subject of whom so many steps have a mean: the best linear prediction.
    pub(super) fn shrunk(&self, mean: &Columns, steps: usize) -> Columns {
        std::array::from_fn(|k| {
            let share = self.between[k] + self.within[k] / steps.max(1) as f64;
            let ratio = if share > 0.0 { self.between[k] / share } else { 0.0 };
            self.typical[k] + ratio * (mean[k] - self.typical[k])
        })
    }

    /// The offset of a subject that was recorded.
    pub(super) fn recorded(&self, name: &str) -> Option<Columns> {
        let at = self.subjects.binary_search_by(|s| s.name.as_str().cmp(name)).ok()?;
        Some(self.subjects[at].offset)
    }

    /// The offset of a new person.
    pub(super) fn drawn(&self, normals: &[f64; COLUMNS]) -> Columns {
        plus(&self.typical, 1.0, &combined(&self.loadings, normals))
    }
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::disallowed_methods,
        clippy::print_stdout,
        reason = "tests may use the platform's functions"
    )]

    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};

    #[test]
    fn variances_and_offsets_of_made_people_are_found() {
        let stream = Stream::of(TrialKey::default(), 2, Purpose::Test);
        let names: Vec<String> = (0..150).map(|k| format!("{k:03}")).collect();
        let mut rows = Vec::new();
        let mut own = Vec::new();
        for (k, name) in names.iter().enumerate() {
            let [a, b] = stream.normal_pair(k as u32);
            own.push((0.06 * a, 0.06 * a + 0.02 * b));
            for step in 0..4 + 40 * (k % 3) {
                let [e, f] = stream.normal_pair((1000 + 1000 * k + step) as u32);
                let mut row = [0.0; COLUMNS];
                (row[0], row[1]) = (0.5 + 0.06 * a + 0.04 * e, 0.06 * a + 0.02 * b + 0.08 * f);
                rows.push((name.as_str(), row));
            }
        }
        let people = People::fit(&rows, true);
        assert!(
            (people.within[0] / 0.0016 - 1.0).abs() < 0.06 && (people.within[1] / 0.0064 - 1.0).abs() < 0.06
        );
        assert!(
            (people.between[0] / 0.0036 - 1.0).abs() < 0.25 && (people.between[1] / 0.0040 - 1.0).abs() < 0.3
        );
        assert_eq!(people.between[2], 0.0);
        assert!((people.typical[0] - 0.5).abs() < 0.02);
        // Shrunk means are closer to the truth than plain ones, where few steps are known.
        let error = |shrink: bool| -> f64 {
            (0..150)
                .step_by(3)
                .map(|k| {
                    let known: Vec<Columns> = rows.iter().filter(|r| r.0 == names[k]).map(|r| r.1).collect();
                    let got = if shrink { people.recorded(&names[k]).unwrap() } else { moments(&known).0 };
                    (got[1] - own[k].1).powi(2)
                })
                .sum()
        };
        assert!(error(true) < 0.85 * error(false), "{} {}", error(true), error(false));
        // New people have these variances and the correlation of the two columns.
        let drawn: Vec<Columns> = (0..20_000)
            .map(|k| {
                let mut normals = [0.0; COLUMNS];
                [normals[0], normals[1]] = stream.normal_pair(500_000 + k);
                people.drawn(&normals)
            })
            .collect();
        let (mean, covariance) = moments(&drawn);
        assert!((mean[0] - people.typical[0]).abs() < 0.002);
        assert!((covariance[(0, 0)] / people.between[0] - 1.0).abs() < 0.05);
        let correlation = covariance[(0, 1)] / (covariance[(0, 0)] * covariance[(1, 1)]).sqrt();
        // The truth is 0.949; what few steps say of an offset weakens it.
        assert!((0.8..1.0).contains(&correlation), "{correlation}");
        let same = People::fit(&rows, false);
        assert!(same.loadings.is_empty() && same.subjects.iter().all(|s| s.offset == [0.0; COLUMNS]));
    }
}
