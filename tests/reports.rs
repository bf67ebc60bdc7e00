//! Every report format over one rich run.

use smc::engine::outcome::{
    AskedQuery, CallResult, Comparison, ConsumedTrials, Counts, Decider, Distribution, Failure, Histogram,
    Interval, Kind, Method, Quantile, QueryResult, RankedOption, Ranking, Shows, Side, Status, Step, Stop,
    Verdict, Witness,
};
use smc::report::html::{Page, page};
use smc::report::{ExitCode, Format, Palette, exit_code, json, render};

fn counts(successes: u64, failures: u64, unresolved: u64) -> Counts {
    Counts { trials: successes + failures + unresolved, successes, failures, unresolved }
}

fn consumed(counts: Counts) -> ConsumedTrials {
    ConsumedTrials { counts, steps: 29_117, ..ConsumedTrials::default() }
}

fn value(estimate: f64, low: f64, high: f64) -> Interval {
    Interval { estimate, low, high }
}

fn method(name: &str, numbers: &[(&str, f64)]) -> Method {
    Method { name: name.into(), numbers: numbers.iter().map(|&(n, v)| (n.to_owned(), v)).collect() }
}

fn asked(index: usize, kind: Kind, query: &str) -> AskedQuery {
    AskedQuery { file: "corridor.bltl".into(), line: 10 + index, ..AskedQuery::new(index, kind, query) }
}

fn result(asked: AskedQuery) -> QueryResult {
    QueryResult {
        replay: format!("smc check corridor.scn corridor.bltl --seed 7 --only {}", asked.index),
        elapsed_s: 0.021,
        consumed: consumed(Counts::default()),
        ..QueryResult::new(asked)
    }
}

fn checks() -> Vec<QueryResult> {
    let safe = "check P(safe) >= 0.5 by sprt(alpha = 0.01,\n    beta = 0.01, indifference = 0.02)";
    vec![
        QueryResult {
            verdict: Some(Verdict::Satisfied),
            certifies: "P(safe) > 0.48, error at most 0.01".into(),
            estimate: Some(0.939_393_94),
            low: 0.8412,
            high: 0.9813,
            interval: "time-uniform, 95 %".into(),
            method: method(
                "sprt",
                &[("alpha", 0.01), ("beta", 0.01), ("theta", 0.5), ("indifference", 0.02)],
            ),
            consumed: consumed(counts(62, 4, 0)),
            stopped_by: Stop::Boundary,
            witnesses: vec![Witness {
                shows: Shows::Fails,
                value: None,
                trial: 17,
                time: 3.42,
                unit: "s",
                what: "gap(oncoming[4]) > 0.1 m".into(),
                decider: Some(Decider {
                    agent: "oncoming[4]".into(),
                    place: [9.2, 1.4],
                    level: None,
                    value: Some(0.03),
                    unit: "m".into(),
                    against: None,
                    other: None,
                    is_between: true,
                }),
                agents: vec!["oncoming[4]".into()],
                command: "smc simulate corridor.scn --seed 7 --trial 17".into(),
            }],
            ..result(AskedQuery { name: Some("safe".into()), ..asked(0, Kind::Check, safe) })
        },
        QueryResult {
            verdict: Some(Verdict::Violated),
            certifies: "P(arrives) < 0.3, error at most 0.01".into(),
            estimate: Some(0.0),
            low: 0.0,
            high: 0.066_1,
            interval: "time-uniform, 95 %".into(),
            method: method("mixture", &[("theta", 0.3), ("alpha", 0.01)]),
            consumed: consumed(counts(0, 88, 0)),
            stopped_by: Stop::Boundary,
            warnings: vec!["never true in any trial: is the goal reachable?".into()],
            ..result(AskedQuery {
                name: Some("arrives".into()),
                horizon: Some("30 s".into()),
                ..asked(1, Kind::Check, "check P(arrives) >= 0.3")
            })
        },
        QueryResult {
            verdict: Some(Verdict::Undecided),
            estimate: Some(0.900_12),
            low: 0.899_5,
            high: 0.900_7,
            interval: "time-uniform, 95 %".into(),
            method: method("mixture", &[("theta", 0.9), ("alpha", 0.01)]),
            consumed: consumed(counts(900_119, 99_876, 5)),
            stopped_by: Stop::Cap,
            elapsed_s: 128.4,
            ..result(AskedQuery {
                name: Some("brief".into()),
                ..asked(2, Kind::Check, "check P(brief) >= 0.9")
            })
        },
    ]
}

fn estimates() -> Vec<QueryResult> {
    let sweep = |density: &str, successes, failures, estimate, low, high| QueryResult {
        certifies: "the interval holds with confidence 95 %".into(),
        estimate: Some(estimate),
        low,
        high,
        interval: "calibrated sequential, 95 %".into(),
        method: method("calibrated", &[("epsilon", 0.01), ("delta", 0.05)]),
        consumed: consumed(counts(successes, failures, 0)),
        stopped_by: Stop::Width,
        ..result(AskedQuery {
            settings: vec![("density".into(), density.into())],
            ..asked(3, Kind::Estimate, "estimate P(safe) within 0.01 confidence 95 %")
        })
    };
    vec![
        sweep("0.2 /m^2", 2_228, 112, 0.952_1, 0.943_2, 0.961_0),
        sweep("0.8 /m^2", 5_912, 3_630, 0.619_6, 0.609_8, 0.629_3),
        QueryResult {
            estimate: Some(-0.041_7),
            low: -0.046_6,
            high: -0.036_7,
            unit: "m".into(),
            interval: "time-uniform, 95 %".into(),
            certifies: "the interval holds with confidence 95 %".into(),
            method: method("betting", &[("delta", 0.05)]),
            consumed: ConsumedTrials {
                clipped: 3,
                shrunk: 40,
                ..consumed(Counts { trials: 1_000, unresolved: 2, ..Counts::default() })
            },
            warnings: vec![
                "radii of bodies that overlapped at the start were reduced in 40 trials; in trial 3: `user` at the wall `south` \
                 from a radius of 0.3 m to 0.2 m"
                    .into(),
            ],
            stopped_by: Stop::Plan,
            distribution: Some(Distribution {
                histogram: Some(Histogram {
                    low: -0.5,
                    high: 1.5,
                    counts: vec![2, 0, 12, 140, 320, 270, 130, 80, 40, 4],
                    below: 0,
                    beyond: 0,
                }),
                quantiles: vec![],
                empirical: vec![Step { value: -0.2, share: 0.5 }, Step { value: 1.4, share: 1.0 }],
                curve: None,
                band: Some(0.042_95),
            }),
            ..result(asked(4, Kind::Estimate, "estimate E(min<=10 s (gap(a))) in -0.5 m .. 20 m"))
        },
        QueryResult {
            estimate: Some(f64::INFINITY),
            low: 28.31,
            high: f64::INFINITY,
            censored: Some(30.0),
            unit: "s".into(),
            interval: "order statistics, 95 %".into(),
            certifies: "the interval holds with confidence 95 %".into(),
            method: method("order-statistics", &[("level", 0.95), ("trials", 1000.0)]),
            consumed: consumed(Counts { trials: 1_000, ..Counts::default() }),
            distribution: Some(Distribution {
                histogram: None,
                quantiles: vec![
                    Quantile { level: 0.5, value: value(21.42, 21.11, 21.73) },
                    Quantile { level: 0.95, value: value(f64::INFINITY, 28.31, f64::INFINITY) },
                ],
                ..Distribution::default()
            }),
            ..result(AskedQuery {
                horizon: Some("30 s".into()),
                ..asked(5, Kind::Estimate, "estimate Q(0.95, time_until(user in exit))")
            })
        },
    ]
}

fn compare() -> QueryResult {
    let side = |label: &str, value, counts| Side { label: label.into(), value, counts };
    QueryResult {
        estimate: Some(0.336),
        low: 0.309,
        high: 0.363,
        certifies: "the difference lies in the interval with confidence 95 %".into(),
        interval: "time-uniform, 95 %, common random numbers".into(),
        method: method("paired", &[("delta", 0.05)]),
        consumed: consumed(counts(3_293, 906, 1)),
        stopped_by: Stop::Width,
        compare: Some(Comparison {
            first: side("density = 0.2 /m^2", value(0.952, 0.936, 0.965), counts(2_000, 100, 0)),
            second: side("density = 0.8 /m^2", value(0.616, 0.588, 0.643), counts(1_293, 806, 1)),
            difference: side(
                "first - second",
                value(0.336, 0.309, 0.363),
                Counts { trials: 2_100, ..counts(780, 73, 1) },
            ),
        }),
        ..result(asked(6, Kind::Compare, "compare P(safe) under density = 0.2 /m^2 with density = 0.8 /m^2"))
    }
}

fn rank() -> QueryResult {
    let option = |label: &str, value, counts, status| RankedOption {
        also: Vec::new(),
        label: label.into(),
        under: Vec::new(),
        settings: Vec::new(),
        value,
        counts,
        status,
    };
    QueryResult {
        estimate: Some(0.911),
        low: 0.887,
        high: 0.932,
        certifies: "heading 15 deg is within 0.02 of the best, confidence 95 %".into(),
        interval: "time-uniform, 95 %, common random numbers".into(),
        method: method("paired-betting", &[("epsilon", 0.02), ("delta", 0.05)]),
        consumed: consumed(counts(2_700, 500, 0)),
        stopped_by: Stop::Width,
        rank: Some(Ranking {
            aim: "P(safe)".to_owned(),
            is_empty: false,
            choice: Some("heading 15 deg".into()),
            means: None,
            gap: 0.017_23,
            tied: true,
            options: vec![
                option("heading 15 deg", value(0.911, 0.887, 0.932), counts(1_399, 137, 0), Status::Chosen),
                option("heading 0 deg", value(0.905, 0.879, 0.926), counts(1_390, 146, 0), Status::Tied),
                option("heading -60 deg", value(0.71, 0.62, 0.79), counts(90, 37, 1), Status::Open),
                option("stop", value(0.0, 0.0, 0.041), counts(0, 128, 0), Status::Beaten),
            ],
        }),
        ..result(asked(7, Kind::Rank, "rank moves of user by P(safe) within 0.02 confidence 95 %"))
    }
}

fn run() -> CallResult {
    let mut results = checks();
    results.extend(estimates());
    results.extend([compare(), rank()]);
    CallResult {
        scenario: "Corridor with an oncoming crowd".into(),
        seed: 7,
        version: "0.1.0".into(),
        trials: results.iter().map(|result| result.consumed.counts.trials).sum(),
        results,
        warnings: vec!["param width is never used".into()],
        replay: "smc check corridor.scn corridor.bltl --seed 7 --set 'density=0.2..0.8 by 0.6'".into(),
        elapsed_s: 130.2,
        ..CallResult::default()
    }
}

#[test]
fn text() {
    insta::assert_snapshot!(render(&run(), Format::Text, Palette::PLAIN));
}

#[test]
fn text_in_colour_says_the_same() {
    let painted = render(&run(), Format::Text, Palette::ANSI);
    let mut plain = String::new();
    for (k, part) in painted.split('\u{1b}').enumerate() {
        plain += if k == 0 { part } else { part.split_once('m').expect("a code ends with m").1 };
    }
    assert_ne!(painted, plain);
    assert_eq!(plain, render(&run(), Format::Text, Palette::PLAIN));
}

#[test]
fn text_of_a_run_that_ended_early() {
    let mut run = CallResult { interrupted: true, warnings: vec![], ..run() };
    run.results.truncate(1);
    run.trials = run.results[0].consumed.counts.trials;
    run.results[0].stopped_by = Stop::Interrupt;
    run.failure = Some(Failure::Input("trial 12: two commands of `die` are enabled, s = 3".into()));
    insta::assert_snapshot!(render(&run, Format::Text, Palette::PLAIN));
    assert_eq!(exit_code(&run), ExitCode::Wrong);
    assert_eq!(exit_code(&CallResult { failure: None, ..run }).code(), 130);
}

#[test]
fn text_ends_with_the_replay_line_even_without_results() {
    let empty = CallResult { replay: "smc check a b".into(), ..CallResult::default() };
    assert_eq!(
        render(&empty, Format::Text, Palette::PLAIN),
        "no results; 0 trials in 0 µs\nreplay: smc check a b\n"
    );
}

#[test]
fn json_object() {
    insta::assert_snapshot!(render(&run(), Format::Json, Palette::ANSI));
}

#[test]
fn csv_table() {
    insta::assert_snapshot!(render(&run(), Format::Csv, Palette::PLAIN));
}

#[test]
fn one_line_a_query() {
    insta::assert_snapshot!(render(&run(), Format::Brief, Palette::PLAIN));
}

#[test]
fn long_times_are_read_in_minutes_and_hours() {
    let waiting = |seconds: f64| {
        let mut result = result(asked(0, Kind::Estimate, "estimate E(time_until(done(a)))"));
        (result.estimate, result.low, result.high) =
            (Some(seconds), seconds - seconds / 10.0, seconds + seconds / 10.0);
        result.unit = "s".to_owned();
        let run = CallResult { results: vec![result], ..CallResult::default() };
        assert!(render(&run, Format::Json, Palette::PLAIN).contains(&format!("\"estimate\": {seconds}")));
        render(&run, Format::Brief, Palette::PLAIN)
    };
    assert!(waiting(100.0).contains("100 s  [90, 110] s"), "{}", waiting(100.0));
    assert!(waiting(600.0).contains("10.0 min  [9.0, 11.0] min"), "{}", waiting(600.0));
    assert!(waiting(36000.0).contains("10.0 h  [9.0, 11.0] h"), "{}", waiting(36000.0));
}

#[test]
fn json_has_the_promised_fields_in_order() {
    let promised = [
        "index",
        "name",
        "query",
        "kind",
        "verdict",
        "certifies",
        "horizon",
        "estimate",
        "low",
        "high",
        "unit",
        "interval",
        "method",
        "trials",
        "successes",
        "failures",
        "unresolved",
        "clipped",
        "steps",
        "stopped_by",
        "replay",
        "elapsed_s",
    ];
    let object = json::object(&run());
    let top: Vec<&str> = object.as_object().unwrap().keys().map(String::as_str).take(5).collect();
    assert_eq!(top, ["schema", "scenario", "seed", "version", "results"]);
    for result in object["results"].as_array().unwrap() {
        let keys: Vec<&str> = result
            .as_object()
            .unwrap()
            .keys()
            .map(String::as_str)
            .filter(|key| promised.contains(key))
            .collect();
        assert_eq!(keys, promised);
    }
}

#[test]
fn json_fits_its_schema_and_the_schema_is_strict() {
    let schema = serde_json::from_str(include_str!("../docs/schema/verdict.schema.json")).unwrap();
    assert!(jsonschema::draft202012::meta::is_valid(&schema));
    let validator = jsonschema::draft202012::new(&schema).unwrap();
    let good = json::object(&run());
    let faults: Vec<String> =
        validator.iter_errors(&good).map(|e| format!("{}: {e}", e.instance_path)).collect();
    assert_eq!(faults, [""; 0]);
    let mut failed = run();
    failed.failure = Some(Failure::Bug("index out of range".into()));
    assert!(validator.is_valid(&json::object(&failed)));

    let broken = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut object = good.clone();
        change(&mut object);
        !validator.is_valid(&object)
    };
    assert!(broken(&|o| o["schema"] = 4.into()));
    assert!(broken(&|o| o["results"][0]["verdict"] = "maybe".into()));
    assert!(broken(&|o| o["results"][0]["verdict"] = serde_json::Value::Null));
    assert!(broken(&|o| o["results"][3]["verdict"] = "satisfied".into()));
    assert!(broken(&|o| o["results"][0]["trials"] = (-1).into()));
    assert!(broken(&|o| o["results"][7]["difference"]["low"] = "x".into()));
    for field in ["certifies", "estimate", "unresolved", "stopped_by", "replay"] {
        assert!(broken(&|o| drop(o["results"][0].as_object_mut().unwrap().shift_remove(field))), "{field}");
    }
    assert!(broken(&|o| drop(o["results"][8].as_object_mut().unwrap().shift_remove("options"))));
}

#[test]
fn json_knows_no_infinity() {
    let object = json::object(&run());
    let quantile = &object["results"][6];
    assert_eq!(
        (&quantile["estimate"], &quantile["high"]),
        (&serde_json::Value::Null, &serde_json::Value::Null)
    );
    assert_eq!(quantile["censored"], true);
    assert_eq!(object["results"][5]["censored"], false);
}

#[test]
fn junit() {
    insta::assert_snapshot!(render(&run(), Format::Junit, Palette::PLAIN));
}

/// A sweep comes point by point, with the queries of all files at each.
#[test]
fn junit_has_one_suite_for_each_file_of_a_sweep() {
    let at = |index: usize, p: &str| {
        result(AskedQuery {
            file: ["a.bltl", "b.bltl"][index].into(),
            settings: vec![("p".into(), p.into())],
            ..asked(index, Kind::Estimate, "estimate P(safe)")
        })
    };
    let results = vec![at(0, "0.2"), at(1, "0.2"), at(0, "0.5"), at(1, "0.5")];
    let text = render(&CallResult { results, ..CallResult::default() }, Format::Junit, Palette::PLAIN);
    let suites: Vec<&str> = text.lines().filter(|line| line.contains("<testsuite ")).collect();
    assert_eq!(suites.len(), 2, "{text}");
    for (suite, name) in suites.iter().zip(["a.bltl", "b.bltl"]) {
        assert!(suite.contains(&format!("name=\"{name}\" tests=\"2\"")), "{suite}");
    }
}

/// A time that does not come is told from a distance to nobody, alike in all reports.
#[test]
fn what_lies_above_a_histogram_has_one_name() {
    let said = |query: &str, word: &str| {
        let histogram = Histogram { low: 0.0, high: 1.0, counts: vec![1, 2], below: 17, beyond: 349 };
        let results = vec![QueryResult {
            distribution: Some(Distribution { histogram: Some(histogram), ..Distribution::default() }),
            ..result(asked(0, Kind::Estimate, query))
        }];
        let run = CallResult { results, ..CallResult::default() };
        for text in [render(&run, Format::Text, Palette::PLAIN), page_of(run)] {
            assert!(text.contains(&format!("349 {word}")), "{text}");
            assert!(text.contains("17 at -∞"), "{text}");
        }
    };
    said("estimate E(time_until(user in exit)) in 0 s .. 9 s", "beyond the horizon");
    said("estimate E(late) in 0 s .. 9 s", "infinite");
    said("estimate E(distance(user, a) at end) in 0 m .. 9 m", "infinite");
}

#[test]
fn junit_is_red_where_the_run_failed() {
    let failed = CallResult { failure: Some(Failure::Bug("\u{0}<&>".into())), ..CallResult::default() };
    let text = render(&failed, Format::Junit, Palette::PLAIN);
    assert!(text.contains("errors=\"1\"") && text.contains("&#60;&#38;&#62;"), "{text}");
}

#[test]
fn github() {
    insta::assert_snapshot!(render(&run(), Format::Github, Palette::PLAIN));
}

#[test]
fn the_exit_code_is_that_of_the_worst_check() {
    assert_eq!(exit_code(&run()), ExitCode::Violated);
    let mut run = run();
    run.results.retain(|r| r.verdict != Some(Verdict::Violated));
    assert_eq!(exit_code(&run), ExitCode::Undecided);
    run.results.retain(|r| r.verdict != Some(Verdict::Undecided));
    assert_eq!(exit_code(&run), ExitCode::Success);
}

fn page_of(run: CallResult) -> String {
    page(Page { run, ..Page::default() })
}

#[test]
fn html() {
    let page = page_of(run());
    // The template has its own files for the script and the style.
    let between = |page: String, name: &str| {
        let (before, rest) = page.split_once(&format!("<{name}>")).unwrap();
        let (_, after) = rest.split_once(&format!("</{name}>")).unwrap();
        format!("{before}<{name}></{name}>{after}")
    };
    let page = between(between(page, "style"), "script");
    insta::with_settings!({filters => vec![("sha256-[A-Za-z0-9+/=]+", "sha256-HASH")]}, {
        insta::assert_snapshot!(page);
    });
}

/// Every element is closed in order, and nothing is loaded from elsewhere.
#[test]
fn html_is_well_nested_and_stands_alone() {
    let page = page_of(run());
    // The script and the style hold no elements; what they may do is said by their hashes.
    let mut elements = page.clone();
    for name in ["script", "style"] {
        let (start, end) = (format!("<{name}>"), format!("</{name}>"));
        assert_eq!((page.matches(&start).count(), page.matches(&end).count()), (1, 1), "{name}");
        let (from, to) = (elements.find(&start).unwrap() + start.len(), elements.find(&end).unwrap());
        elements.replace_range(from..to, "");
    }
    let mut open = Vec::new();
    for tag in elements.split('<').skip(1).filter(|tag| !tag.starts_with('!')) {
        let inside = tag.split('>').next().unwrap();
        let name = inside.trim_start_matches('/').split(' ').next().unwrap();
        if inside.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !inside.ends_with('/') && name != "meta" {
            open.push(name);
        }
    }
    assert_eq!(open, [""; 0]);
    for outside in ["http:", "https:", "src=", "url(", "@import", "<link", "<img", "fetch("] {
        assert!(!page.contains(outside), "{outside}");
    }
}
