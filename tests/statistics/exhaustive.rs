//! Errors of stopping rules without sampling: all sequences of outcomes up to a length, each with its probability as a whole number
//! over a power of 8, which is exact. `docs/proofs.md` has the proofs that these numbers check.
//!
//! ```text
//!   p = 3/8, trials 1 1 0:  3 * 3 * 5 of 8 * 8 * 8
//! ```

use smc::stats::ranking::{Allocation, Booleans, Contest as _, Race};
use smc::stats::{
    Counts, Decision, Evidence, Hypothesis, Outcome, Plan, Sequential, Sprt, Test, ThreeWay, TwoSprt,
    clopper_pearson, sequence,
};
use std::collections::BTreeMap;

/// Probabilities are this many eighths.
const PARTS: u128 = 8;
/// Length of the sequences that are followed as numbers of successes, and of those that are followed one by one.
const LONG: u32 = 40;
const SHORT: u32 = 16;

/// How many sequences of each number of successes and failures end in each decision.
type Ends = BTreeMap<(u32, u32, u8), u128>;

/// All sequences, each by itself.
fn one_by_one<T: Test + Clone>(test: &Sequential<T>, most: u32) -> Ends {
    fn follow<T: Test + Clone>(test: &Sequential<T>, (s, f): (u32, u32), most: u32, ends: &mut Ends) {
        if s + f == most {
            return;
        }
        for success in [true, false] {
            let mut next = test.clone();
            let counts = if success { (s + 1, f) } else { (s, f + 1) };
            match next.observe(success) {
                Some(decision) => *ends.entry((counts.0, counts.1, decision as u8)).or_default() += 1,
                None => follow(&next, counts, most, ends),
            }
        }
    }
    let mut ends = Ends::new();
    follow(test, (0, 0), most, &mut ends);
    ends
}

/// The same, where sequences with the same counts are one: a dynamic programme. The number of sequences is exact.
fn by_counts<T: Test + Clone>(test: &Sequential<T>, most: u32) -> Ends {
    let mut ends = Ends::new();
    let mut open = BTreeMap::from([((0, 0), (test.clone(), 1_u128))]);
    for _ in 0..most {
        let mut next: BTreeMap<(u32, u32), (Sequential<T>, u128)> = BTreeMap::new();
        for ((s, f), (test, ways)) in open {
            for success in [true, false] {
                let mut test = test.clone();
                let counts = if success { (s + 1, f) } else { (s, f + 1) };
                match test.observe(success) {
                    Some(decision) => *ends.entry((counts.0, counts.1, decision as u8)).or_default() += ways,
                    None => next.entry(counts).or_insert((test, 0)).1 += ways,
                }
            }
        }
        open = next;
    }
    ends
}

/// The probability of a decision within some trials at p = parts / 8, times 8 to the power of these.
fn weight(ends: &Ends, decision: Decision, parts: u128, most: u32) -> u128 {
    let of = |((s, f, found), ways): (&(u32, u32, u8), &u128)| {
        let all = ways * parts.pow(*s) * (PARTS - parts).pow(*f) * PARTS.pow(most - s - f);
        if *found == decision as u8 { all } else { 0 }
    };
    ends.iter().map(of).sum()
}

/// Decisions that are wrong at p = k / 8, for each k.
type Wrong<'w> = &'w [(Decision, &'w dyn Fn(u128) -> bool)];

/// That no wrong decision has more than the error, one in `of`; the largest of them as a share of it.
fn keeps<T: Test + Clone>(test: &Sequential<T>, of: u128, wrong: Wrong<'_>) -> f64 {
    let (ends, all) = (by_counts(test, LONG), PARTS.pow(LONG));
    let mut largest = 0.0;
    for (decision, is_wrong) in wrong {
        for parts in (0..=PARTS).filter(|parts| is_wrong(*parts)) {
            let wrong = weight(&ends, *decision, parts, LONG);
            assert!(wrong * of <= all, "{decision:?} at {parts}/8: {wrong} of {all}");
            largest = f64::max(largest, (wrong * of) as f64 / all as f64);
        }
    }
    largest
}

#[test]
fn sequences_with_the_same_counts_are_one() {
    let eprocess = Evidence::new(Hypothesis::AtLeast, 0.5, 0.1, 0.1).unwrap();
    assert_eq!(one_by_one(&eprocess, SHORT), by_counts(&eprocess, SHORT));
    let sprt = Sprt::new(0.5, 0.125, 0.1, 0.1).unwrap();
    assert_eq!(one_by_one(&sprt, SHORT), by_counts(&sprt, SHORT));
}

#[test]
fn tests_of_a_probability_keep_their_errors() {
    // Thresholds and half widths of regions in eighths.
    let mut closest = [0.0_f64; 4];
    for (of, error) in [(5, 0.2), (10, 0.1), (20, 0.05)] {
        for at in [2, 4, 5] {
            let theta = at as f64 / 8.0;
            let evidence = Evidence::new(Hypothesis::AtLeast, theta, error, error).unwrap();
            let sides: Wrong<'_> = &[(Decision::Above, &|p| p <= at), (Decision::Below, &|p| p >= at)];
            closest[0] = closest[0].max(keeps(&evidence, of, sides));
            for wide in [1, 2_u128].into_iter().filter(|wide| *wide < at) {
                let half = wide as f64 / 8.0;
                let beyond: Wrong<'_> =
                    &[(Decision::Above, &|p| p + wide <= at), (Decision::Below, &|p| p >= at + wide)];
                let sprt = Sprt::new(theta, half, error, error).unwrap();
                closest[1] = closest[1].max(keeps(&sprt, of, beyond));
                let two = TwoSprt::new(theta, half, error, error).unwrap();
                closest[2] = closest[2].max(keeps(&two, of, beyond));
                if let Ok(plan) = Plan::new(theta, half, error, error) {
                    closest[3] = closest[3].max(keeps(&plan, of, beyond));
                }
            }
        }
    }
    // The rules come close to their errors, so the bounds are no formality.
    assert!(closest[0] > 0.02 && closest[1] > 0.8 && closest[2] > 0.4 && closest[3] > 0.9, "{closest:?}");
    // Negative control: half of the error is too little for a rule made for all of it.
    let sprt = Sprt::new(0.5, 0.125, 0.2, 0.2).unwrap();
    let wrong = weight(&by_counts(&sprt, LONG), Decision::Above, 3, LONG);
    assert!(wrong * 10 > PARTS.pow(LONG));
}

#[test]
fn the_third_answer_keeps_its_error() {
    // Sequences of one number of successes differ in what they have passed, so each is followed by itself.
    let test = ThreeWay::new(Hypothesis::AtLeast, 0.5, 0.25, 0.8).unwrap();
    let (ends, all) = (one_by_one(&test, SHORT), PARTS.pow(SHORT));
    let mut largest = 0;
    for parts in 0..=PARTS {
        let mut wrong = 0;
        for (decision, is_wrong) in [
            (Decision::Above, parts <= 4),
            (Decision::Below, parts >= 4),
            (Decision::Within, !(3..=5).contains(&parts)),
        ] {
            wrong += if is_wrong { weight(&ends, decision, parts, SHORT) } else { 0 };
        }
        assert!(wrong * 5 <= 4 * all, "at {parts}/8: {wrong} of {all}");
        largest = largest.max(wrong);
    }
    assert!(largest * 1000 > all, "{largest} of {all}");
}

#[test]
fn intervals_cover_every_probability() {
    let binomial = |n: u32, s: u32| (0..s).fold(1_u128, |all, k| all * u128::from(n - k) / u128::from(k + 1));
    for n in 1..=LONG {
        let all = PARTS.pow(n);
        for parts in 0..=PARTS {
            let p = parts as f64 / 8.0;
            let missed = |s: u32| {
                let counts = Counts { successes: u64::from(s), failures: u64::from(n - s) };
                let interval = clopper_pearson::interval(counts, 0.1);
                !(interval.low..=interval.high).contains(&p)
            };
            let of = |s: u32| binomial(n, s) * parts.pow(s) * (PARTS - parts).pow(n - s);
            let wrong: u128 = (0..=n).filter(|s| missed(*s)).map(of).sum();
            assert!(wrong * 10 <= all, "{n} trials at {parts}/8: {wrong} of {all}");
        }
    }
}

#[test]
fn the_confidence_sequence_ever_misses_with_its_error() {
    let mut largest = 0;
    let all = PARTS.pow(LONG);
    for parts in 1..PARTS {
        let p = parts as f64 / 8.0;
        let (mut open, mut wrong) = (BTreeMap::from([(0_u32, 1_u128)]), 0);
        for n in 1..=LONG {
            let mut next: BTreeMap<u32, u128> = BTreeMap::new();
            for (s, ways) in open {
                *next.entry(s).or_default() += ways;
                *next.entry(s + 1).or_default() += ways;
            }
            next.retain(|s, ways| {
                let counts = Counts { successes: u64::from(*s), failures: u64::from(n - s) };
                let holds = sequence::holds(counts, 0.2, p);
                if !holds {
                    wrong += *ways * parts.pow(*s) * (PARTS - parts).pow(n - s) * PARTS.pow(LONG - n);
                }
                holds
            });
            open = next;
        }
        assert!(wrong * 5 <= all, "at {parts}/8: {wrong} of {all}");
        largest = largest.max(wrong);
    }
    assert!(largest * 20 > all, "{largest} of {all}");
}

/// The gap of each choice that was claimed.
type Claims = Vec<(usize, f64)>;

/// Which gaps of which choices a race claims over a table of outcomes, at any of its rounds.
fn claims(arms: usize, each: u32, bits: u32, allocation: Allocation) -> Claims {
    let mut race = Race::<Booleans>::new(arms, 0.25, 0.3, 1, allocation).unwrap();
    let mut claims = Claims::new();
    while !race.finished() {
        let round = race.next_round().to_vec();
        if round.is_empty() || round.iter().any(|share| share.to > u64::from(each)) {
            break;
        }
        for share in round {
            let outcome =
                |index: u64| Outcome::from(bits >> (share.arm as u32 * each + index as u32) & 1 == 1);
            let outcomes: Vec<Outcome> = (share.from..share.to).map(outcome).collect();
            race.feed(share.arm, &outcomes).unwrap();
        }
        let choice = race.choice();
        match claims.iter_mut().find(|(arm, _)| *arm == choice.arm) {
            Some((_, gap)) => *gap = gap.min(choice.gap),
            None => claims.push((choice.arm, choice.gap)),
        }
    }
    claims
}

/// The largest probability that a race ever claims a gap that is too small, over a grid of probabilities; as a share of its error.
fn races(arms: usize, each: u32, allocation: Allocation) -> f64 {
    // Tables with the same successes of each option and the same claims are one.
    let mut tables: BTreeMap<(Vec<u32>, String), (u128, Claims)> = BTreeMap::new();
    for bits in 0..1_u32 << (arms as u32 * each) {
        let claims = claims(arms, each, bits, allocation);
        let successes = |arm| (bits >> (arm as u32 * each) & ((1 << each) - 1)).count_ones();
        let key = ((0..arms).map(successes).collect(), format!("{claims:?}"));
        tables.entry(key).or_insert((0, claims)).0 += 1;
    }
    let all = PARTS.pow(arms as u32 * each);
    let mut largest = 0.0;
    for place in 0..9_usize.pow(arms as u32) {
        let parts: Vec<u128> = (0..arms).map(|arm| (place / 9_usize.pow(arm as u32) % 9) as u128).collect();
        let best = *parts.iter().max().unwrap() as f64 / 8.0;
        let is_wrong = |(arm, gap): &(usize, f64)| best - parts[*arm] as f64 / 8.0 > gap + 1e-12;
        let mut wrong = 0;
        for ((successes, _), (ways, claims)) in &tables {
            if claims.iter().any(is_wrong) {
                let one = |(s, parts): (&u32, &u128)| parts.pow(*s) * (PARTS - parts).pow(each - s);
                wrong += ways * successes.iter().zip(&parts).map(one).product::<u128>();
            }
        }
        assert!(wrong * 10 <= 3 * all, "{parts:?}: {wrong} of {all}");
        largest = f64::max(largest, (wrong * 10) as f64 / (3 * all) as f64);
    }
    largest
}

#[test]
fn rankings_of_two_and_three_options_keep_their_error() {
    for allocation in [Allocation::AllFailing, Allocation::OneChallenger] {
        let (two, three) = (races(2, 7, allocation), races(3, 5, allocation));
        assert!(two > 0.01 && three > 0.0, "{two} {three}");
    }
}
