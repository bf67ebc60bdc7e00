use super::InstantVerdict::{False, True, Unresolved};
use super::*;
use crate::stats::Estimate;

/// Three persons; the second property is never resolved.
fn monitored(names: [&str; 2]) -> Monitored {
    let instant = |time: f64, person, first| MonitoredInstant {
        time,
        person,
        verdicts: vec![first, Unresolved("the track ends")],
    };
    let instants = vec![
        instant(0.1 + 0.2, 4, True),
        instant(0.4, 4, False),
        instant(0.4, 7, True),
        instant(0.8, 7, Unresolved("the track ends")),
        instant(0.8, 9, Unresolved("")),
    ];
    let result = |k: usize| MonitoredProperty::of(names[k], k, &instants, 0.95);
    Monitored {
        numbers: Vec::new(),
        model: "hall.scn".to_owned(),
        properties: vec!["safe.bltl".to_owned()],
        recording: "hotel.txt".to_owned(),
        velocity: Velocity::Seen,
        user: None,
        every: 0.4,
        beyond: Beyond::Unresolved,
        confidence: 0.95,
        results: vec![result(0), result(1)],
        instants,
    }
}

fn csv(report: &Monitored) -> String {
    let mut out = Vec::new();
    write_csv(&mut out, report).unwrap();
    String::from_utf8(out).unwrap()
}

#[test]
fn a_property_counts_its_instants() {
    let report = monitored(["safe", "arrives"]);
    let [safe, arrives] = &report.results[..] else { panic!() };
    assert_eq!((safe.satisfied, safe.violated, safe.unresolved, safe.instants()), (2, 1, 2, 5));
    assert_eq!((safe.persons, safe.share.map(|share| share.value)), (3, Some(2.0 / 3.0)));
    assert_eq!(
        safe.reasons.iter().map(|(reason, n)| (*reason, *n)).collect::<Vec<_>>(),
        [("", 1), ("the track ends", 1)]
    );
    assert_eq!((arrives.unresolved, arrives.share), (5, None));
    let none = MonitoredProperty::of("safe", 0, &[], 0.95);
    assert_eq!((none.persons, none.share), (0, None));
    let alone = MonitoredProperty::of("safe", 0, &report.instants[..2], 0.95);
    assert_eq!(alone.share, Some(Estimate { value: 0.5, interval: None }));
}

#[test]
fn json_is_as_its_schema_says() {
    let schema = serde_json::from_str(include_str!("../../../docs/schema/monitor.schema.json")).unwrap();
    assert!(jsonschema::draft202012::meta::is_valid(&schema));
    let schema = jsonschema::validator_for(&schema).unwrap();
    let all = monitored(["safe", "arrives"]);
    let none =
        Monitored { user: Some(4), results: vec![], instants: vec![], beyond: Beyond::Onward, ..all.clone() };
    for report in [all, none] {
        let json: serde_json::Value = serde_json::from_str(&to_json(&report)).unwrap();
        if let Err(error) = schema.validate(&json) {
            panic!("{error}: {json:#}");
        }
        assert_eq!(json["user"].as_u64(), report.user.map(u64::from));
    }
}

#[test]
fn csv_has_a_row_for_each_instant() {
    insta::assert_snapshot!(csv(&monitored(["safe", "arrives"])), @r#"
    time,person,safe,arrives
    0.3,4,true,unresolved
    0.4,4,false,unresolved
    0.4,7,true,unresolved
    0.8,7,unresolved,unresolved
    0.8,9,unresolved,unresolved
    "#);
    let hostile = csv(&monitored(["<b>\"x\",", "a\nb"]));
    assert!(hostile.starts_with("time,person,\"<b>\"\"x\"\",\",\"a\nb\"\n"), "{hostile}");
}

#[test]
fn text_has_a_row_for_each_property() {
    insta::assert_snapshot!(to_text(&monitored(["safe", "arrives"])), @r#"
    hotel.txt (seen velocities), hall.scn, safe.bltl
    each person is the user in turn, every 0.4 s; after the end of a track: nothing is assumed

    property  satisfied  violated  unresolved  persons    share satisfied
    safe              2         1           2        3  0.67 [0.50, 1.00]
    arrives           0         0           5        3                  -

    share satisfied: of the resolved instants, with a 95 % interval (bootstrap over persons)
    safe: 1 instant unresolved: the track ends
    arrives: 5 instants unresolved: the track ends
    "#);
}
