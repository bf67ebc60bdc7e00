//! Forecasts of a call, as text and as JSON.

use super::number::{count, counted};
use super::setting;
use crate::engine::{CallForecast, Forecast};
use serde_json::{Value, json};

/// One line a query, and one for the whole.
pub fn text(total: &CallForecast) -> String {
    let mut text = String::new();
    for forecast in &total.queries {
        let Forecast { query, settings, trials, .. } = forecast;
        let (least, most) = (least(trials.least), rough(trials.most));
        let trials = if trials.least == trials.most {
            format!("about {}", counted(most, "trial"))
        } else {
            format!("{} to {}", count(least), counted(most, "trial"))
        };
        let query = super::phrase::one_line(query);
        let under = super::phrase::listed(settings);
        let under = if under.is_empty() { under } else { format!("   {under}") };
        let time = between(forecast.seconds_between());
        text += &format!("forecast: {trials}, {time}: {query}{under}\n");
    }
    if total.queries.len() > 1 {
        let time = between(total.between);
        text += &format!("forecast: {time} in total; checks and estimates of one scenario share trials\n");
    }
    text
}

/// One object, ending with a line end.
pub fn json(total: &CallForecast) -> String {
    let query = |forecast: &Forecast| {
        json!({
            "query": forecast.query,
            "settings": setting::object(&forecast.settings),
            "trials": rough(forecast.trials.likely),
            "least": least(forecast.trials.least),
            "most": rough(forecast.trials.most),
            "seconds": forecast.seconds,
        })
    };
    let queries: Vec<Value> = total.queries.iter().map(query).collect();
    format!("{:#}\n", json!({ "schema": 2, "forecast": queries, "seconds": total.seconds }))
}

/// Two digits are enough for a forecast: the last place that counts.
fn place(n: u64) -> u64 {
    let mut scale = 1;
    while n / scale >= 100 {
        scale *= 10;
    }
    scale
}

fn rough(n: u64) -> u64 {
    n.div_ceil(place(n)) * place(n)
}

/// The lower end of a range, rounded outward.
fn least(n: u64) -> u64 {
    n / place(n) * place(n)
}

/// A range of durations.
fn between((low, high): (f64, f64)) -> String {
    let (low, high) = (duration(low), duration(high));
    match (low == high, low.strip_prefix("about ")) {
        (true, _) => high,
        (false, Some(low)) => format!("{low} to {}", high.trim_start_matches("about ")),
        (false, None) => format!("at most {high}"),
    }
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
    use crate::engine::Likely;

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
            trials: Likely { least: 20, likely: 53, most: 2_000 },
            seconds: 3.2,
        };
        let total = CallForecast { queries: vec![one.clone()], ..CallForecast::default() };
        assert_eq!(
            text(&total),
            "forecast: 20 to 2,000 trials, 1 s to 2 min: estimate P(safe)   density = 0.2\n"
        );
        let known = Forecast { trials: Likely::exactly(53), ..one.clone() };
        let total = CallForecast { queries: vec![known], ..CallForecast::default() };
        assert_eq!(text(&total), "forecast: about 53 trials, about 3 s: estimate P(safe)   density = 0.2\n");
        let total = CallForecast { queries: vec![one.clone(), one], ..CallForecast::default() };
        assert_eq!(text(&total).lines().count(), 3);
    }
}
