//! Inferred traces and groups as data and as pictures: `smc infer`.

mod csv;
mod json;
mod page;
mod svg;

pub use csv::to_csv;
pub use json::to_json;
pub use page::to_page;
pub use svg::to_svg;

use crate::data::tracks::Velocity;
use crate::perception::{Inference, Inferring};

/// What was inferred from a file, and how.
#[derive(Clone, Copy, Debug)]
pub struct InferredFile<'a> {
    /// Name of the file.
    pub file: &'a str,
    /// Which velocities were used.
    pub velocity: Velocity,
    /// Name of the model of motion.
    pub motion: &'a str,
    /// The preset or kind whose parameters people have in it, if it has parameters.
    pub kind: Option<&'a str>,
    /// Name of the scenario whose barriers people avoid in it.
    pub scene: Option<&'a str>,
    /// Options of the inference.
    pub options: &'a Inferring,
    /// Its result.
    pub inference: &'a Inference,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::tracks::{Batch, read_observations};
    use crate::perception::{ConstantVelocity, infer};

    #[test]
    fn all_formats_hold_the_same_points() {
        let text = "{\"t\":0,\"seen\":[{\"x\":0,\"y\":0,\"id\":4},{\"x\":0.5,\"y\":0}]}\n{\"t\":0.4,\"seen\":[{\"x\":0.10049,\"y\":0,\"id\":4}]}\n";
        let batches: Vec<Batch> = read_observations(text).unwrap();
        let options = Inferring::default();
        let inference = infer(&batches, &options, &mut ConstantVelocity).unwrap();
        let report = InferredFile {
            file: "a.jsonl",
            velocity: Velocity::Seen,
            motion: "social-force",
            kind: Some("helbing2000"),
            scene: None,
            options: &options,
            inference: &inference,
        };
        let json: serde_json::Value = serde_json::from_str(&to_json(&report)).unwrap();
        assert_eq!(json["velocity"], "seen");
        let parameters = &json["parameters"];
        assert_eq!((&parameters["kind"], &parameters["scene"]), (&"helbing2000".into(), &().into()));
        assert_eq!(json["intervals"], serde_json::json!([[0.0, 0.4]]));
        assert_eq!(json["traces"][0]["people"], serde_json::json!([4]));
        assert_eq!(json["traces"][0]["points"][0], serde_json::json!([0.0, 0.0, 0.0, null, null]));
        assert_eq!(json["traces"][0]["points"][1], serde_json::json!([0.4, 0.1, 0.0, 0.251, 0.0]));
        assert_eq!(json["groups"][0]["born"], "appear");
        assert_eq!(json["score"]["tracks"]["unsplit"], 1);
        let csv = to_csv(&inference);
        assert_eq!(csv.lines().count(), 4);
        assert_eq!(csv.lines().nth(1), Some("0,1,1,0,0,,,4"));
        assert_eq!(csv.lines().nth(3), Some("0.4,1,1,0.1,0,0.251,0,4"));
        let svg = to_svg(&report);
        assert_eq!(svg.matches("<polyline").count(), 2);
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
    }
}
