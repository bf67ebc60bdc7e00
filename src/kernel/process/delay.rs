//! Random delays by address: how long something that has just become possible waits.
//!
//! The n-th delay of an entity in a trial takes two uniform numbers, whatever its law: the first becomes the
//! delay by the inverse distribution function, the second is left for what happens at its end.

use crate::base::random::{Purpose, Stream, TrialKey};
use crate::model::law::Ready;

/// A delay in seconds, and a number in (0, 1) that decides what happens after it.
pub(in crate::kernel) fn delay(trial: TrialKey, entity: u32, number: u32, law: &Ready) -> (f64, f64) {
    let [first, second] = Stream::of(trial, entity, Purpose::Delay).uniform_pair(number);
    (law.draw(first), second)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Family, Law};

    #[test]
    fn delays_have_their_law_and_the_rest_is_uniform() {
        let law = Law::Random {
            family: Family::Uniform { low: 2.0, high: 5.0 },
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
        };
        let law = law.ready();
        let trial = TrialKey { seed: 4, index: 9, branch: 0 };
        let drawn: Vec<(f64, f64)> = (0..4000).map(|n| delay(trial, 77, n, &law)).collect();
        assert!(drawn.iter().all(|(delay, _)| (2.0..5.0).contains(delay)));
        let mean = |f: &dyn Fn(&(f64, f64)) -> f64| drawn.iter().map(f).sum::<f64>() / 4000.0;
        assert!((mean(&|d| d.0) - 3.5).abs() < 0.05);
        assert!((mean(&|d| d.1) - 0.5).abs() < 0.02);
        // The two are independent.
        assert!((mean(&|d| (d.0 - 3.5) * (d.1 - 0.5))).abs() < 0.02);
        assert_ne!(delay(trial, 78, 0, &law), drawn[0]);
    }
}
