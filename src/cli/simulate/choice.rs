//! Which trials `--keep` means: those in which the formula of a check is false, or true.

use std::str::FromStr;

/// `violated`, `violated=NAME`, `satisfied`, `satisfied=NAME`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::cli) struct Keep {
    /// Whether the formula is true in the trials that are kept.
    pub(super) truth: bool,
    /// The check, by the name of its property or its number.
    pub(super) name: Option<String>,
}

impl FromStr for Keep {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (word, name) = text.split_once('=').map_or((text, None), |(word, name)| (word, Some(name)));
        let truth = match word {
            "violated" => false,
            "satisfied" => true,
            _ => return Err("write `violated`, `satisfied`, or with a check `violated=NAME`".to_owned()),
        };
        if name.is_some_and(str::is_empty) {
            return Err(format!("the name of the check is missing: write `{word}=NAME`"));
        }
        Ok(Self { truth, name: name.map(str::to_owned) })
    }
}

impl Keep {
    /// How the option calls it.
    pub(super) fn word(&self) -> &'static str {
        if self.truth { "satisfied" } else { "violated" }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_and_perhaps_a_name_are_read() {
        let of = |text: &str| text.parse::<Keep>();
        assert_eq!(of("violated"), Ok(Keep { truth: false, name: None }));
        assert_eq!(of("satisfied=a=b"), Ok(Keep { truth: true, name: Some("a=b".to_owned()) }));
        assert!(of("violated=").unwrap_err().contains("`violated=NAME`"));
        assert!(of("broken").unwrap_err().contains("`satisfied`"));
    }
}
