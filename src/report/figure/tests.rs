//! Figures of small files.

use super::*;
use serde_json::json;

fn drawn(figure: Figure, file: &Value, only: Option<&str>) -> String {
    draw(figure, file, only).unwrap().svg(crate::report::svg::picture::Paper::default())
}

fn sweep() -> Value {
    let result = |width: f64, estimate: f64| {
        json!({
            "index": 0, "name": "</svg><script>", "query": "estimate P(\"a\" < b) // </script>", "unit": "",
            "settings": { "width": { "value": width, "unit": "m" } }, "method": { "name": "calibrated" },
            "estimate": estimate, "low": estimate - 0.05, "high": estimate + 0.05,
        })
    };
    json!({ "schema": 3, "results": [result(1.2, 0.8), result(0.8, 0.3), result(1.0, 0.6)] })
}

#[test]
fn names_do_not_break_out() {
    let svg = drawn(Figure::Sweep, &sweep(), None);
    assert!(!svg.contains("<script>") && svg.contains("&lt;/script&gt;"), "{svg}");
    insta::assert_snapshot!("sweep", svg);
}

#[test]
fn what_cannot_be_drawn_is_said_with_a_hint() {
    let wrong = |figure, file: &Value, only| draw(figure, file, only).err().unwrap();
    let mut several = sweep();
    let mut others = several["results"].as_array().unwrap().clone();
    for other in &mut others {
        other["index"] = json!(1);
        other["name"] = json!("b");
    }
    several["results"].as_array_mut().unwrap().extend(others);
    let old = json!({ "schema": 2, "results": [] });
    let said = [
        wrong(Figure::Sweep, &old, None),
        wrong(Figure::Sweep, &json!([1]), None),
        wrong(Figure::Sweep, &several, None),
        wrong(Figure::Sweep, &several, Some("c")),
        wrong(Figure::Ranking, &several, None),
        wrong(Figure::Distribution, &several, None),
        wrong(Figure::Evidence, &several, None),
        wrong(Figure::Calibration, &several, None),
    ];
    insta::assert_snapshot!(
        "flaws",
        said.map(|flaw| format!("{}\n  {}\n", flaw.message, flaw.hint)).concat()
    );
    assert!(
        draw(Figure::Sweep, &several, Some("b")).is_ok() && draw(Figure::Sweep, &several, Some("0")).is_ok()
    );
}

#[test]
fn rankings_distributions_evidence_and_calibration() {
    let option = |name: &str, estimate: f64, status: &str| json!({ "option": name, "estimate": estimate, "low": estimate - 0.1, "high": null, "status": status });
    let snapshot = |trials: u64, ratio: f64| {
        json!({
            "trials": trials, "estimate": 0.7, "low": 0.7 - 0.5 / trials as f64, "high": 0.9,
            "above": ratio, "below": -ratio,
        })
    };
    let standing = |trials: u64, open: bool| json!({ "trials": 2 * trials, "options": [{ "trials": trials, "open": true }, { "trials": trials, "open": open }] });
    let file = json!({
        "schema": 3,
        "results": [
            {
                "index": 0, "name": "rank", "query": "rank moves", "unit": "", "method": {},
                "options": [option("left", 0.9, "chosen"), option("right", 0.4, "beaten")],
                "evidence": { "options": ["right", "left"], "snapshots": [standing(32, true), standing(64, false)] },
            },
            {
                "index": 1, "name": "check", "query": "check P >= 0.6", "unit": "", "method": { "theta": 0.6 },
                "evidence": {
                    "thresholds": { "above": 3.0, "below": 4.6 },
                    "snapshots": [snapshot(1, 0.1), snapshot(8, 1.0), snapshot(48, 3.1)],
                },
            },
            {
                "index": 2, "name": "time", "query": "estimate Q(0.5, time_until(p))", "unit": "s", "method": {},
                "distribution": {
                    "quantiles": [{ "level": 0.5, "estimate": 2, "low": 1, "high": 3 }], "band": 0.2,
                    "empirical": [{ "value": 1, "share": 0.2 }, { "value": 2, "share": 0.6 }, { "value": null, "share": 1 }],
                },
            },
        ],
    });
    let evaluated = json!({
        "schema": 1, "recording": "hotel",
        "kinds": [{ "name": "adult", "properties": [{ "name": "near", "bins": [
            { "mean": 0.1, "share": 0.0 }, { "mean": 0.8, "share": 0.7 },
        ] }] }],
    });
    let drawn = [
        drawn(Figure::Ranking, &file, None),
        drawn(Figure::Evidence, &file, Some("rank")),
        drawn(Figure::Evidence, &file, Some("check")),
        drawn(Figure::Distribution, &file, None),
        drawn(Figure::Calibration, &evaluated, None),
    ];
    assert!(drawn.iter().all(|svg| !svg.contains("NaN") && !svg.contains("inf")), "{drawn:?}");
    insta::assert_snapshot!("figures", drawn.concat());
}
