//! Drawings that are read once: an editor checks a scenario at each key, and its plan may have hundreds of megabytes. A reader of
//! drawings asks of each feature whether it is selected, so the questions are kept, and asked again in the place of the file; while
//! the answers are the same, so is the drawing.

use crate::base::digest::Digest;
use crate::data::geometry::{Drawing, GeometryError, PropertyValue, Select};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// A drawing, or what is wrong with its file.
type Read = Result<Drawing, Vec<GeometryError>>;

/// A path, and the bits of the unit of its coordinates.
type Key = (String, Option<u64>);

/// A file that was read.
#[derive(Debug)]
struct Known {
    print: Digest,
    /// The features: name and properties.
    asked: Vec<(String, Vec<(String, PropertyValue)>)>,
    /// Which of them were selected.
    answers: Vec<bool>,
    drawing: Read,
}

/// Drawings that were read before, by their paths and the units of their coordinates.
#[derive(Clone, Debug, Default)]
pub struct Drawings {
    known: Arc<Mutex<BTreeMap<Key, Known>>>,
    /// The digests of the files as they are now.
    pub prints: BTreeMap<String, Digest>,
}

impl Drawings {
    /// A drawing: by `read`, unless it was read before.
    pub(crate) fn read(
        &self,
        (path, unit): (&str, Option<f64>),
        select: &mut Select<'_>,
        read: impl FnOnce(&mut Select<'_>) -> Read,
    ) -> Read {
        let Some(print) = self.prints.get(path).copied() else { return read(select) };
        let mut all = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (path.to_owned(), unit.map(f64::to_bits));
        if let Some(known) = all.get_mut(&key).filter(|known| known.print == print) {
            let answers: Vec<bool> =
                known.asked.iter().map(|(name, properties)| select(name, properties)).collect();
            if answers != known.answers {
                let mut next = answers.iter().copied();
                known.drawing = read(&mut |_, _| next.next().unwrap_or(false));
                known.answers = answers;
            }
            return known.drawing.clone();
        }
        let (mut asked, mut answers) = (Vec::new(), Vec::new());
        let drawing = read(&mut |name, properties| {
            asked.push((name.to_owned(), properties.to_vec()));
            answers.push(select(name, properties));
            answers.last() == Some(&true)
        });
        all.insert(key, Known { print, asked, answers, drawing: drawing.clone() });
        drawing
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::geometry::{Format, read};
    use std::cell::Cell;

    #[test]
    fn a_file_is_read_again_only_if_it_or_the_selection_changed() {
        let text = |b: &str| {
            format!(
                r#"{{"type":"FeatureCollection","features":[
            {{"type":"Feature","properties":{{"name":"a"}},"geometry":{{"type":"LineString","coordinates":[[0,0],[1,1]]}}}},
            {{"type":"Feature","properties":{{"name":"{b}"}},"geometry":{{"type":"LineString","coordinates":[[0,0],[1,2]]}}}}]}}"#
            )
        };
        let (mut drawings, times) = (Drawings::default(), Cell::new(0));
        let mut names = |text: &str, selected: &[&str]| {
            drawings.prints.insert("plan".to_owned(), Digest::of(text.as_bytes()));
            let mut asked = 0;
            let mut select = |name: &str, _: &[(String, PropertyValue)]| {
                asked += 1;
                selected.contains(&name)
            };
            let found = drawings.read(("plan", None), &mut select, |select| {
                times.set(times.get() + 1);
                read(Format::GeoJson, text, None, select)
            });
            let names = found.unwrap().features.into_iter().map(|one| one.name).collect::<Vec<_>>().join(" ");
            format!("{names}, {asked} asked, read {} times", times.get())
        };
        assert_eq!(names(&text("b"), &["a", "b"]), "a b, 2 asked, read 1 times");
        assert_eq!(names(&text("b"), &["a", "b"]), "a b, 2 asked, read 1 times");
        assert_eq!(names(&text("b"), &["b"]), "b, 2 asked, read 2 times");
        assert_eq!(names(&text("b"), &["b"]), "b, 2 asked, read 2 times");
        assert_eq!(names(&text("c"), &["b"]), ", 2 asked, read 3 times");
    }
}
