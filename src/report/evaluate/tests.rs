use super::*;
use crate::report::svg::picture::Paper;
use crate::stats::{Bootstrap, Prediction, Predictions};

const HOSTILE: &str = "<b>\"x\",";

/// Twelve persons, and two kinds: one is often right, the other knows nothing.
fn evaluated(names: [&str; 2], property: &str) -> Evaluated {
    let predictions = |probability: fn(u32) -> f64| {
        let one =
            |k: u32| Prediction { person: k / 2, probability: probability(k), happened: k.is_multiple_of(3) };
        Predictions::new((0..24).map(one).collect())
    };
    let constant = predictions(|_| 0.5);
    let informed = predictions(|k| if k.is_multiple_of(3) || k == 7 { 0.8 } else { 0.1 });
    let bootstrap = Bootstrap { persons: 12, draws: 199, seed: 1, confidence: 0.95 };
    let estimate = |value: f64| Some(Estimate { value, interval: Some([0.9 * value, 1.1 * value]) });
    let displacement = Displacement {
        mean_ade: estimate(0.5),
        mean_fde: estimate(1.0),
        best_of: 20,
        best_ade: estimate(0.25),
        best_fde: Some(Estimate { value: 0.512_345, interval: None }),
        collisions: None,
    };
    let kind = |k: usize, own: &Predictions, displacement| EvaluatedKind {
        name: names[k].to_owned(),
        properties: vec![
            EvaluatedProperty {
                name: property.to_owned(),
                unresolved: 3,
                quality: Quality::of(own, (k == 0).then_some([own, &constant]), &bootstrap),
            },
            EvaluatedProperty { name: "never resolved".to_owned(), unresolved: 27, quality: None },
        ],
        displacement,
        realism: Vec::new(),
        coverage: match k {
            0 => vec![Coverage { seconds: 4.8, share: estimate(0.875), log_density: estimate(0.25) }],
            _ => Vec::new(),
        },
    };
    Evaluated {
        model: "hall.scn".to_owned(),
        properties: vec!["safe.bltl".to_owned()],
        recording: "hotel.txt".to_owned(),
        velocity: Velocity::Recorded,
        trials: 100,
        seed: 1,
        every: 0.4,
        moving: 0.5,
        horizon: 4.8,
        confidence: 0.95,
        instants: 27,
        persons: 12,
        kinds: vec![kind(0, &informed, Some(displacement)), kind(1, &constant, None)],
    }
}

fn csv(report: &Evaluated) -> String {
    let mut out = Vec::new();
    write_csv(&mut out, report).unwrap();
    String::from_utf8(out).unwrap()
}

#[test]
fn json_is_as_its_schema_says() {
    let schema = serde_json::from_str(include_str!("../../../docs/schema/evaluate.schema.json")).unwrap();
    assert!(jsonschema::draft202012::meta::is_valid(&schema));
    let schema = jsonschema::validator_for(&schema).unwrap();
    let all = evaluated(["helbing2000", "constant"], "safe");
    for report in [Evaluated { kinds: vec![], ..all.clone() }, all] {
        let json = serde_json::from_str(&to_json(&report)).unwrap();
        if let Err(error) = schema.validate(&json) {
            panic!("{error}: {json:#}");
        }
    }
}

#[test]
fn csv_has_a_row_for_each_bin() {
    insta::assert_snapshot!(csv(&evaluated(["helbing2000", "constant"], "safe")), @r#"
    kind,property,bin,count,low,high,mean,share
    helbing2000,safe,1,15,0.1,0.1,0.1,0
    helbing2000,safe,2,9,0.8,0.8,0.8,0.888889
    constant,safe,1,24,0.5,0.5,0.5,0.333333
    "#);
    let hostile = csv(&evaluated([HOSTILE, "constant"], "a\nb"));
    assert!(hostile.contains("\n\"<b>\"\"x\"\",\",\"a\nb\",1,"), "{hostile}");
}

#[test]
fn text_compares_with_the_kind_constant() {
    insta::assert_snapshot!(to_text(&evaluated(["helbing2000", "constant"], "safe")), @r#"
    hotel.txt (recorded velocities), hall.scn, safe.bltl
    27 instants of 12 persons faster than 0.5 m/s, every 0.4 s; horizon 4.8 s
    100 trials an instant, seed 1

    safe
      kind         predictions  unresolved        Brier score                skill  calibration error
      helbing2000           24           3  0.05 [0.01, 0.11]    0.79 [0.57, 0.91]  0.10 [0.05, 0.14]
      constant              24           3  0.25 [0.25, 0.25]  -0.12 [-0.52, 0.00]  0.17 [0.04, 0.30]
      helbing2000: better than constant by 82 % [59, 94] % of the Brier score
      terms        base rate  reliability  resolution  uncertainty  variance  covariance
      helbing2000      0.333        0.009       0.185        0.222     0.000       0.000
      constant         0.333        0.028       0.000        0.222     0.000       0.000

    never resolved
      kind         predictions  unresolved  Brier score  skill  calibration error
      helbing2000            0          27            -      -                  -
      constant               0          27            -      -                  -

    distances (m) of the mean path and of the best of 20 paths
      kind                  mean ADE           mean FDE              best ADE  best FDE  collision rate
      helbing2000  0.50 [0.45, 0.55]  1.00 [0.90, 1.10]  0.250 [0.225, 0.275]     0.512               -
      ADE: mean over all times; FDE: at the end; collision rate: share of paths that touch somebody

    recorded positions in the 90 % region of the predicted ones
      kind         after s              share           log density
      helbing2000      4.8  0.88 [0.78, 0.97]  0.250 [0.225, 0.275]
      log density: mean logarithm of the density of the predicted positions, 1/m^2

    Brier score: mean squared difference of probability and outcome; 0 is best.
    Skill: 1 - Brier score / Brier score of the base rate; 1 is best, 0 is as good as the base rate.
    Terms: Brier score = reliability - resolution + uncertainty + variance - 2 covariance, the last two in bins.
    Brackets: 95 % intervals (bootstrap over persons).
    "#);
}

#[test]
fn svg_has_two_frames_for_each_property() {
    let text = to_svg(&evaluated(["helbing2000", "constant"], "safe")).unwrap().svg(Paper::default());
    for label in [
        "predicted probability of `safe`",
        "predicted probability of `never resolved`",
        "share that happened",
        "predictions",
    ] {
        let count = if label.contains('`') { 1 } else { 2 };
        assert_eq!(text.matches(&format!(">{label}</text>")).count(), count, "{label}");
    }
    // The kind `constant` says 0.5 each time: its one bin, and the outline of its predictions.
    assert!(text.contains("M324.0,"), "{text}");
}

/// A skill over the kind `constant` in words.
#[test]
fn comparisons_follow_the_interval() {
    let said = |interval: Option<[f64; 2]>, value: f64| {
        let mut report = evaluated(["a", "constant"], "safe");
        if let Some(quality) = &mut report.kinds[0].properties[0].quality {
            quality.skill_over_other = Some(Estimate { value, interval });
        }
        let text = to_text(&report);
        text.lines().find_map(|line| line.strip_prefix("  a: ")).unwrap().to_owned()
    };
    assert_eq!(said(Some([0.05, 0.15]), 0.1), "better than constant by 10 % [5, 15] % of the Brier score");
    assert_eq!(said(Some([-0.3, -0.1]), -0.2), "worse than constant by 20 % [10, 30] % of the Brier score");
    assert_eq!(
        said(Some([-0.05, 0.15]), 0.05),
        "not clearly different from constant: 5 % [-5, 15] % of the Brier score"
    );
    assert_eq!(
        said(None, 0.123_45),
        "better than constant by 12.3 % of the Brier score, without an interval"
    );
}

#[test]
fn names_do_not_leave_their_elements() {
    let long = "x".repeat(10_000);
    let report = Evaluated { model: HOSTILE.to_owned(), ..evaluated([HOSTILE, &long], "</svg><script>&") };
    let text = to_svg(&report).unwrap().svg(Paper::default());
    assert!(!text.contains("<b>") && !text.contains("<script>") && text.matches("</svg>").count() == 1);
    assert!(text.contains("&lt;/svg&gt;&lt;script&gt;") && !text.contains(&long), "{text}");
    assert!(to_svg(&Evaluated { kinds: vec![], ..report }).is_err(), "nothing was evaluated");
}
