//! Forecasts of a call, as text and as JSON.

use super::number::counted;
use crate::engine::{Forecast, Outlook};
use serde_json::{Value, json};

/// One line a query, and one for the whole.
pub fn text(outlook: &Outlook) -> String {
    let mut text = String::new();
    for Forecast { query, settings, trials, seconds } in &outlook.queries {
        let trials = counted(rough(*trials), "trial");
        let query = super::one_line(query);
        let under: Vec<String> = settings.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        let under = if under.is_empty() { String::new() } else { format!("   {}", under.join(", ")) };
        text.push_str(&format!("forecast: about {trials}, {}: {query}{under}\n", duration(*seconds)));
    }
    if outlook.queries.len() > 1 {
        text.push_str(&format!(
            "forecast: {} in all; checks and estimates of one scenario share trials\n",
            duration(outlook.seconds)
        ));
    }
    text
}

/// One object, ending with a line end.
pub fn json(outlook: &Outlook) -> String {
    let query = |forecast: &Forecast| {
        let settings: serde_json::Map<String, Value> =
            forecast.settings.iter().map(|(name, value)| (name.clone(), json!(value))).collect();
        json!({
            "query": forecast.query,
            "settings": settings,
            "trials": rough(forecast.trials),
            "seconds": forecast.seconds,
        })
    };
    let queries: Vec<Value> = outlook.queries.iter().map(query).collect();
    format!("{:#}\n", json!({ "schema": 1, "forecast": queries, "seconds": outlook.seconds }))
}

/// Two digits are enough for a forecast.
fn rough(n: u64) -> u64 {
    let mut scale = 1;
    while n / scale >= 100 {
        scale *= 10;
    }
    n.div_ceil(scale) * scale
}

fn duration(seconds: f64) -> String {
    if seconds < 1.0 {
        "less than 1 s".to_owned()
    } else if seconds < 90.0 {
        format!("about {seconds:.0} s")
    } else if seconds < 5400.0 {
        format!("about {:.0} min", seconds / 60.0)
    } else {
        format!("about {:.1} h", seconds / 3600.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_forecast_has_two_digits() {
        assert_eq!([0, 99, 101, 4_238, 52_983].map(rough), [0, 99, 110, 4_300, 53_000]);
        assert_eq!(duration(0.2), "less than 1 s");
        assert_eq!(duration(600.0), "about 10 min");
    }

    #[test]
    fn one_query_needs_no_sum() {
        let one = Forecast {
            query: "estimate\n  P(safe)".to_owned(),
            settings: vec![("density".to_owned(), "0.2".to_owned())],
            trials: 53,
            seconds: 3.2,
        };
        let outlook = Outlook { queries: vec![one.clone()], seconds: 3.2 };
        assert_eq!(
            text(&outlook),
            "forecast: about 53 trials, about 3 s: estimate P(safe)   density = 0.2\n"
        );
        let outlook = Outlook { queries: vec![one.clone(), one], seconds: 6.4 };
        assert_eq!(text(&outlook).lines().count(), 3);
    }
}
