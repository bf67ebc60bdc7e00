//! Where the files of a call come from: from the disk, where those that were opened may be kept; or from another process
//! that has opened them, so that both compile the same even where a file changes in between.

use super::inputs::load_from;
use super::values::Model;
use crate::base::bytes::{Decoder, Encoder, Malformed};
use crate::data::tracks::Velocity;
use crate::library::Inputs;
use std::collections::VecDeque;

/// A file that was opened, by the name under which it was asked for: its bytes, or why there are none.
type Opened = (String, Result<Vec<u8>, String>);

/// The source of files.
#[derive(Clone, Debug)]
pub(super) enum FileCache {
    /// From the disk.
    Files,
    /// From the disk; what was opened is kept, in this order.
    Kept(Vec<Opened>),
    /// From a process that opened them in the same order.
    Handed(VecDeque<Opened>),
}

impl FileCache {
    /// Opens a file.
    pub(super) fn open(
        &mut self,
        name: &str,
        from_disk: impl FnOnce() -> Result<Vec<u8>, String>,
    ) -> Result<Vec<u8>, String> {
        match self {
            Self::Files => from_disk(),
            Self::Kept(opened) => {
                let contents = from_disk();
                opened.push((name.to_owned(), contents.clone()));
                contents
            }
            Self::Handed(opened) => match opened.pop_front() {
                Some((known, contents)) if known == name => contents,
                _ => Err(format!("`{name}` was not sent by the main process")),
            },
        }
    }
}

/// What a call names and what was opened for it, as bytes for another process.
pub(super) fn pack(model: &Model, properties: &[String], cache: &FileCache) -> Vec<u8> {
    let mut to = Encoder::default();
    to.text(&model.scenario);
    to.text(model.velocity.map_or("", Velocity::name));
    for list in [properties, &model.set] {
        to.whole(list.len() as u64);
        for text in list {
            to.text(text);
        }
    }
    let FileCache::Kept(opened) = cache else { return to.finish() };
    for (name, contents) in opened {
        to.text(name);
        match contents {
            Ok(bytes) => {
                to.byte(0);
                to.bytes(bytes);
            }
            Err(reason) => {
                to.byte(1);
                to.text(reason);
            }
        }
    }
    to.finish()
}

/// Compiles what another process has packed.
pub(super) fn unpack(bytes: &[u8]) -> Result<Inputs, Malformed> {
    let mut from = Decoder::new(bytes);
    let scenario = from.text()?.to_owned();
    let velocity = Velocity::from_name(from.text()?);
    let mut list =
        || (0..from.count()?).map(|_| from.text().map(str::to_owned)).collect::<Result<Vec<_>, _>>();
    let (properties, set) = (list()?, list()?);
    let mut opened = VecDeque::new();
    while from.end().is_err() {
        let name = from.text()?.to_owned();
        let contents = match from.byte()? {
            0 => Ok(from.bytes()?.to_vec()),
            1 => Err(from.text()?.to_owned()),
            _ => return Err(Malformed("invalid state of a file")),
        };
        opened.push_back((name, contents));
    }
    let model = Model { scenario, set, data: Vec::new(), velocity };
    Ok(load_from(FileCache::Handed(opened), &model, &properties).inputs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SCENARIO: &str = "horizon = 1 s\nstep = 0.1 s\nparam n = 2\n\
        scene { import \"walls.wkt\" }\nkind adult: sfm preset helbing2000 { }\n\
        agent user: adult { at = (0, 0)  route = (5, 0) }\n";

    fn packed() -> Vec<u8> {
        let model = Model {
            scenario: "-".to_owned(),
            set: vec!["n=3".to_owned()],
            data: Vec::new(),
            velocity: Some(Velocity::Seen),
        };
        let opened = vec![
            ("-".to_owned(), Ok(SCENARIO.as_bytes().to_vec())),
            ("a.bltl".to_owned(), Ok(b"estimate P(F<=1 s (travelled(user) > 1 m))".to_vec())),
            ("walls.wkt".to_owned(), Ok(b"LINESTRING (-1 2, 6 2)".to_vec())),
        ];
        pack(&model, &["a.bltl".to_owned()], &FileCache::Kept(opened))
    }

    #[test]
    fn what_was_packed_is_compiled_without_a_file() {
        let inputs = unpack(&packed()).unwrap();
        let found =
            inputs.study.map(|study| (study.queries.len(), study.worlds[0].scenario.scene.barriers.len()));
        assert_eq!(found, Some((1, 1)), "{:?}", inputs.diagnostics);
    }

    #[test]
    fn a_file_that_was_not_handed_over_is_missed() {
        let mut cache = FileCache::Handed(VecDeque::from([("a".to_owned(), Ok(vec![1]))]));
        assert_eq!(cache.open("a", || Err("from the disk".to_owned())), Ok(vec![1]));
        assert_eq!(
            cache.open("b", || Err("from the disk".to_owned())),
            Err("`b` was not sent by the main process".to_owned())
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn any_bytes_are_compiled_or_refused(bytes: Vec<u8>, at: prop::sample::Index, to: u8) {
            let _ = unpack(&bytes);
            let mut packed = packed();
            let at = at.index(packed.len());
            packed[at] = to;
            let _ = unpack(&packed);
        }
    }
}
