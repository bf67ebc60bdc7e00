//! Models beside recordings: what `smc monitor` and `smc evaluate` compute, against plain sums over the recordings.
//!
//! The recordings may not be shipped; where they are absent the tests say so and pass.

use crate::program::recordings;
use smc::base::geometry::Vec2;
use smc::data::tracks::{Recording, Velocity, read_eth_biwi};
use smc::engine::Threads;
use smc::gait;
use smc::library::{Folder, Names, Parsed, parse};
use smc::model::Scenario;
use smc::replay::{
    Beyond, Displacement, Evaluating, Instant, Predicted, Replay, Whose, eligible, evaluate, monitor,
};
use smc::route::Ways;

/// A model, its properties, and the file of its tracks.
struct Texts<'t> {
    scenario: &'t str,
    properties: &'t str,
    tracks: String,
}

impl Folder for Texts<'_> {
    fn text(&mut self, name: &str) -> Result<Vec<u8>, String> {
        Ok(if name == "a.scn" { self.scenario } else { self.properties }.as_bytes().to_vec())
    }

    fn file(&mut self, _: &str) -> Result<Vec<u8>, String> {
        Ok(self.tracks.as_bytes().to_vec())
    }
}

fn parsed(scenario: &str, properties: &str, tracks: &str) -> Parsed {
    let mut texts = Texts { scenario, properties, tracks: tracks.to_owned() };
    let names = Names {
        scenario: "a.scn",
        properties: &["a.bltl".to_owned()],
        settings: &[],
        setting: "--set",
        velocity: None,
        models: &[],
        calibration: None,
    };
    let parsed = parse(names, &mut texts);
    assert!(parsed.inputs.diagnostics.is_empty(), "{:?}", parsed.inputs.diagnostics);
    parsed
}

fn replay(scenario: &str, properties: &str, tracks: &str, velocity: Velocity, whose: Whose) -> Replay {
    Replay::new(&parsed(scenario, properties, tracks).input(), "here", velocity, whose).unwrap()
}

fn threads(count: usize) -> Threads {
    Threads::new(Some(count)).unwrap()
}

fn everything() -> (f64, f64) {
    (f64::NEG_INFINITY, f64::INFINITY)
}

/// Three people on lines: 1 and 2 meet head-on beside each other, 3 leaves early.
const LINES: &str = "time,id,x,y\n0,1,0,0\n0,2,10,1\n0,3,0,3\n1,1,1,0\n1,2,9,1\n1,3,1,3\n2,1,2,0\n2,2,8,1\n2,3,2,3\n\
    3,1,3,0\n3,2,7,1\n4,1,4,0\n4,2,6,1\n5,1,5,0\n5,2,5,1\n6,1,6,0\n6,2,4,1\n7,1,7,0\n7,2,3,1\n8,1,8,0\n8,2,2,1\n";
const PAIR: &str = "horizon = 4 s\nstep = 0.1 s\ntracks here = csv \"lines.csv\"\n\
    kind adult: sfm preset helbing2000 { noise = 0.05 m/s }\n\
    agent user: adult from here at 0 s id 1\nagents others: adult from here at 0 s except 1\n";

fn truths(properties: &str, beyond: Beyond, whose: Whose) -> Vec<(f64, u32, Vec<Option<bool>>)> {
    let replay = replay(PAIR, properties, LINES, Velocity::Seen, whose);
    let instants = replay.instants(1.0, everything());
    let judged = monitor(&replay, &instants, beyond, &threads(2)).unwrap();
    judged.into_iter().map(|one| (one.instant.time, one.instant.person, one.truths)).collect()
}

#[test]
fn formulas_hold_where_the_recording_says_so() {
    // The two are 1 m apart at 5 s, and nearer than 2 m from (10 - sqrt(3)) / 2 s to (10 + sqrt(3)) / 2 s.
    let near = "property near = F<=2 s (exists a in others: distance(user, a) < 2 m)\n";
    let found = truths(near, Beyond::Unresolved, Whose::Written);
    let near: Vec<Option<bool>> = found.iter().map(|(_, _, truths)| truths[0]).collect();
    let (yes, no) = (Some(true), Some(false));
    // Sets consist of those who are there. The window of the last two instants is longer than the track of the user.
    assert_eq!(near, [no, no, no, yes, yes, yes, no, None, None]);
    let far = "property far = G<=2 s (distance(user, third) > 1 m)\n";
    let named = PAIR.replace("except 1", "except 1, 3") + "agent third: adult from here at 0 s id 3\n";
    for (beyond, known) in [(Beyond::Unresolved, [yes, None]), (Beyond::Onward, [yes, yes])] {
        let replay = replay(&named, far, LINES, Velocity::Seen, Whose::Written);
        let judged = monitor(&replay, &replay.instants(1.0, (0.0, 1.0)), beyond, &threads(1)).unwrap();
        let truths: Vec<Option<bool>> = judged.iter().map(|one| one.truths[0]).collect();
        assert_eq!(truths, known, "after the end of the track of the third");
    }
}

#[test]
fn everybody_is_the_user_in_turn() {
    let gone = "property gone = F<=4 s (travelled(user) > 1.95 m)\n";
    let found = truths(gone, Beyond::Onward, Whose::Everybody);
    assert_eq!(found.len(), 9 + 9 + 3);
    for (time, person, truths) in found {
        let last = if person == 3 { 2.0 } else { 8.0 };
        let known = (time + 2.0 <= last).then_some(true);
        assert_eq!(truths, [known], "person {person} at {time} s");
    }
}

#[test]
fn velocities_and_ways_are_those_of_the_recording() {
    let asked = "property steady = G<=3 s (speed(user) > 0.99 m/s & speed(user) < 1.01 m/s)\n\
        property level = G<=3 s (y(user) < 0.001 m)\n";
    let replay = replay(PAIR, asked, LINES, Velocity::Seen, Whose::Written);
    assert_eq!(replay.formulas.names, ["steady", "level"]);
    let instants = replay.instants(1.0, (1.0, 4.0));
    let judged = monitor(&replay, &instants, Beyond::Onward, &threads(1)).unwrap();
    assert_eq!(judged.len(), 4);
    assert!(judged.iter().all(|one| one.truths == [Some(true), Some(true)]), "{judged:?}");
}

#[test]
fn a_party_is_where_the_mean_of_its_members_is() {
    let scenario = "horizon = 4 s\nstep = 0.1 s\ntracks here = csv \"lines.csv\" { velocity = seen }\n\
        kind adult: sfm preset helbing2000 { noise = 0.05 m/s }\n\
        group party: adult as particle from here at 4 s group of 1\n\
        groups crowd: adult as particle from here at 4 s except group of 1\n\
        moves party for 1 s { heading 0 deg; stop }\n";
    // From 3.9 s on both go beside each other, with 1 m between them.
    let tracks: String = (0..20)
        .flat_map(|k| {
            [(1, 0.0), (2, 0.8)]
                .map(|(id, y)| format!("{},{id},{},{y}\n", f64::from(k) * 0.4, f64::from(k) * 0.4))
        })
        .collect();
    let asked = "property middle = G<=2 s (y(party) > 0.39 m & y(party) < 0.41 m)\n";
    let replay = replay(scenario, asked, &format!("time,id,x,y\n{tracks}"), Velocity::Seen, Whose::Everybody);
    let instants = replay.instants(0.4, (0.4, 4.0));
    let judged = monitor(&replay, &instants, Beyond::Unresolved, &threads(2)).unwrap();
    assert_eq!(judged.len(), 20);
    assert!(judged.iter().all(|one| one.truths == [Some(true)]), "{judged:?}");
}

fn evaluated(replay: &Replay, kind: &str, instants: &[Instant], trials: u64, count: usize) -> Predicted {
    let ways = Ways::default();
    let drivers = move |scenario: &Scenario, seed: u64| gait::drivers(&ways, scenario, seed);
    let options = Evaluating { trials, seed: 1 };
    let judged = monitor(replay, instants, Beyond::Onward, &threads(count)).unwrap();
    evaluate(replay, kind, &judged, &options, (&threads(count), &drivers)).unwrap()
}

#[test]
fn predictions_do_not_depend_on_the_number_of_threads() {
    let asked = "property near = F<=2 s (exists a in others: distance(user, a) < 2 m)\n";
    let replay = replay(PAIR, asked, LINES, Velocity::Seen, Whose::Everybody);
    let instants = eligible(&replay, replay.instants(1.0, everything()), 0.5, 4.0);
    let whole: Vec<(f64, u32)> = instants.iter().map(|one| (one.time, one.person)).collect();
    assert_eq!(whole, [(1.0, 1), (1.0, 2), (2.0, 1), (2.0, 2), (3.0, 1), (3.0, 2), (4.0, 1), (4.0, 2)]);
    let one = evaluated(&replay, "adult", &instants, 20, 1);
    let two = evaluated(&replay, "adult", &instants, 20, 2);
    assert_eq!(one.predictions, two.predictions);
    assert_eq!(one.displacements, two.displacements);
    // Whoever keeps the velocity is where the recording says.
    let constant = evaluated(&replay, "constant", &instants, 20, 1);
    assert!(constant.predictions[0].iter().all(|one| one.probability == f64::from(u8::from(one.happened))));
    assert!(constant.displacements.iter().all(|one| one.average < 1e-9 && one.last < 1e-9));
}

#[test]
fn instants_far_apart_are_some_of_those_at_each_step() {
    let asked = "property near = F<=2 s (exists a in others: distance(user, a) < 2 m)\n";
    let replay = replay(PAIR, asked, LINES, Velocity::Seen, Whose::Everybody);
    let at_each = eligible(&replay, replay.instants(1.0, everything()), 0.5, 3.0);
    for every in [0.5, 2.0, 3.0, 4.0, 8.0] {
        let found = eligible(&replay, replay.instants(every, everything()), 0.5, 3.0);
        let is_whole = |time: f64| (time / every).fract() == 0.0;
        let wanted: Vec<Instant> = at_each.iter().copied().filter(|one| is_whole(one.time)).collect();
        let is_of_a_step = |one: &Instant| one.time.fract() == 0.0;
        let found: Vec<Instant> = found.into_iter().filter(is_of_a_step).collect();
        assert_eq!(found, wanted, "every {every} s");
    }
    // The step of the recording does not divide this time.
    assert_eq!(eligible(&replay, replay.instants(1.0, everything()), 0.5, 2.5), at_each);
}

/// Two people who pass each other with 0.5 m between their centres.
fn passing() -> String {
    let at = |k: i32| {
        let x = 0.4 * f64::from(k);
        format!("{x},1,{x},0\n{x},2,{},0.5\n", 8.0 - x)
    };
    format!("time,id,x,y\n{}", (0..=20).map(at).collect::<String>())
}

#[test]
fn kinds_without_forces_have_the_body_of_the_user() {
    let free = "A = 0 N; k1 = 0 kg/s^2; k2 = 0 kg/(m s)";
    let kinds = [
        format!("kind adult: sfm preset smc1 {{ radius = 0.2 m; headway = 0 s; {free} }}"),
        "kind base: sfm preset smc1 { radius = 0.2 m }\nkind adult: base { A2 = 300 N; B2 = 1 m }".to_owned(),
        "kind base: sfm preset helbing2000\nkind adult: base { radius = wide / 2; noise = 0.1 m/s }"
            .to_owned(),
        "kind wide_one: sfm { radius = 0.4 m }\nkind adult: wide_one preset smc1".to_owned(),
        "kind adult: planned { radius = 0.2 m; limit speed = 1.5 m/s }".to_owned(),
    ];
    let asked = "property apart = G<=2 s (clearance(user) > 0 m)\n";
    let tracks = passing();
    for kind in kinds {
        let people = "agent user: adult from here at 0 s id 1 { A = 9 N }\n\
            agents others: adult from here at 0 s except 1\n";
        let people =
            if kind.contains("planned") { people.replace("{ A = 9 N }", "") } else { people.to_owned() };
        let scenario = format!(
            "horizon = 4 s\nstep = 0.1 s\nparam wide = 0.4 m\ntracks here = csv \"lines.csv\"\n{kind}\n{people}"
        );
        let replay = replay(&scenario, asked, &tracks, Velocity::Seen, Whose::Everybody);
        let instants = eligible(&replay, replay.instants(0.4, (2.0, 4.0)), 0.5, 2.0);
        assert_eq!(instants.len(), 12, "{kind}");
        for name in ["constant", "langevin", "helbing2000"] {
            let found = evaluated(&replay, name, &instants, 4, 1);
            let held = found.predictions[0].iter().filter(|one| one.happened).count();
            assert_eq!(held, 12, "{name}: what happened is the same for all kinds\n{kind}");
            if name == "constant" {
                assert!(found.predictions[0].iter().all(|one| one.probability == 1.0), "{kind}");
                assert!(found.displacements.iter().all(|one| one.average < 1e-9), "{kind}");
            }
            let collisions: f64 = found.displacements.iter().map(|one| one.collisions).sum();
            assert!(name != "constant" || collisions == 0.0, "{name}: {collisions}\n{kind}");
        }
    }
}

/// The mean errors of constant velocity by the definition: everybody over 0.5 m/s with a position before and twelve after.
fn plain(recording: &Recording, velocity: Velocity) -> (usize, f64, f64) {
    let (mut count, mut average, mut last) = (0, 0.0, 0.0);
    for person in recording.people() {
        let times: Vec<f64> = person.samples.iter().map(|sample| recording.time_of(sample.frame)).collect();
        for k in 1..person.samples.len().saturating_sub(12) {
            let (before, now) = (&person.samples[k - 1], &person.samples[k]);
            let is_whole = (k..k + 12).all(|j| (times[j + 1] - times[j] - 0.4).abs() < 0.01)
                && (times[k] - times[k - 1] - 0.4).abs() < 0.01;
            if !is_whole || now.velocity.unwrap().norm() <= 0.5 {
                continue;
            }
            let v = match velocity {
                Velocity::Recorded => now.velocity.unwrap(),
                Velocity::Seen => (now.position - before.position) / (times[k] - times[k - 1]),
            };
            let off = |j: usize| {
                (now.position + v * (times[k + j] - times[k]) - person.samples[k + j].position).norm()
            };
            count += 1;
            average += (1..=12).map(off).sum::<f64>() / 12.0;
            last += off(12);
        }
    }
    (count, average / count as f64, last / count as f64)
}

#[test]
fn constant_velocity_has_the_known_errors() {
    let Some(folder) = recordings() else { return };
    let scenario = "horizon = 4.8 s\nstep = 0.1 s\ntracks here = eth_biwi \"obsmat.txt\"\n\
        kind adult: sfm preset helbing2000 { noise = 0.05 m/s }\n\
        agent user: adult from here at 0 s id 1\nagents others: adult from here at 0 s except 1\n";
    let asked = "property safe = G<=4.8 s (forall a in others: distance(user, a) > 0.5 m)\n";
    let known = [
        ("hotel", Velocity::Seen, 1327, 0.595, 1.174),
        ("hotel", Velocity::Recorded, 1327, 0.440, 0.931),
        ("eth", Velocity::Seen, 4033, 0.749, 1.469),
        ("eth", Velocity::Recorded, 4033, 0.537, 1.131),
    ];
    for (name, velocity, count, ade, fde) in known {
        let text = std::fs::read_to_string(folder.join(format!("seq_{name}/obsmat.txt"))).unwrap();
        let recording = read_eth_biwi(&text).unwrap();
        let (plain_count, plain_ade, plain_fde) = plain(&recording, velocity);
        assert_eq!(plain_count, count, "{name}");
        assert!((plain_ade - ade).abs() < 6e-4 && (plain_fde - fde).abs() < 6e-4, "{plain_ade} {plain_fde}");
        let replay = replay(scenario, asked, &text, velocity, Whose::Everybody);
        let instants = eligible(&replay, replay.instants(0.4, everything()), 0.5, 4.8);
        assert_eq!(instants.len(), count, "{name}");
        let found = evaluated(&replay, "constant", &instants, 1, 2).displacements;
        let mean = |of: fn(&Displacement) -> f64| found.iter().map(of).sum::<f64>() / found.len() as f64;
        let (average, last) = (mean(|one| one.average), mean(|one| one.last));
        println!("{name} {velocity:?}: {} ways, ADE {average:.4} m, FDE {last:.4} m", found.len());
        assert!((average - plain_ade).abs() < 2e-3 && (last - plain_fde).abs() < 2e-3, "{average} {last}");
    }
}

#[test]
fn positions_between_frames_are_in_proportion() {
    let replay =
        replay(PAIR, "property p = G<=1 s (x(user) >= 0 m)\n", LINES, Velocity::Seen, Whose::Written);
    let at = replay.recording.person_at(1, 2.25).unwrap();
    assert!((at.position - Vec2::new(2.25, 0.0)).norm() < 1e-12);
    assert_eq!(replay.recording.person_at(3, 2.25), None);
}
