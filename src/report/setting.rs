//! Values of parameters as they are written, each number apart from its unit.

use serde_json::{Map, Value, json};

/// `0.8 m` is 0.8 and `m`; what begins with no number is `None`, and the whole text.
pub(super) fn parts(value: &str) -> (Option<f64>, &str) {
    let (digits, unit) = value.split_once(' ').unwrap_or((value, ""));
    digits.parse().map_or((None, value), |number| (Some(number), unit))
}

/// `{ "width": { "value": 0.8, "unit": "m" } }`
pub(super) fn object(settings: &[(String, String)]) -> Value {
    let one = |(name, text): &(String, String)| {
        let (number, unit) = parts(text);
        let value = number.map_or_else(|| json!(unit), super::json::number);
        (name.clone(), json!({ "value": value, "unit": if number.is_some() { unit } else { "" } }))
    };
    Value::Object(settings.iter().map(one).collect::<Map<_, _>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_apart_from_their_units() {
        assert_eq!(parts("0.2 /m^2"), (Some(0.2), "/m^2"));
        assert_eq!(parts("3"), (Some(3.0), ""));
        assert_eq!(parts("true"), (None, "true"));
        let settings = [("n".to_owned(), "8".to_owned()), ("gap".to_owned(), "80 cm".to_owned())];
        assert_eq!(
            object(&settings),
            json!({ "n": { "value": 8, "unit": "" }, "gap": { "value": 80, "unit": "cm" } })
        );
    }
}
