//! The codes of errors and warnings. Each has a page in `docs/errors/`, which `smc explain` prints.
//!
//! `E01xx` syntax, `E02xx` names, `E03xx` units, `E04xx` scenes, `E05xx` time, `E06xx` queries, `E07xx` input,
//! `E08xx` while running, `E09xx` processes; `W` instead of `E` is a warning. A code never changes its meaning.

use std::fmt;
use std::str::FromStr;

macro_rules! codes {
    ($($code:ident)*) => {
        /// The code of an error or a warning.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[allow(missing_docs, reason = "each code has its page")]
        pub enum Code { $($code),* }

        impl Code {
            /// All codes, in the order in which `smc explain` lists them.
            pub const ALL: &[Self] = &[$(Self::$code),*];

            /// The code as it is written, such as `E0101`.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$code => stringify!($code)),* }
            }

            /// The page of the code, in Markdown: a line `# E0101: title`, a few sentences, a wrong and a right
            /// example.
            pub const fn page(self) -> &'static str {
                match self {
                    $(Self::$code => {
                        include_str!(concat!("../../docs/errors/", stringify!($code), ".md"))
                    })*
                }
            }
        }
    };
}

codes! {
    E0101 E0102 E0103 E0104 E0105 E0106 E0107 E0108 E0109 E0110 E0111 E0112 E0113 E0114 E0115 E0116
    E0117 E0118 E0119 E0120 E0121 E0122 E0124 E0130 W0101 W0102 W0103
    E0201 E0202 E0203 E0204 E0205 E0206 E0207 E0208 E0209 E0210 E0211 E0212 E0213 W0201
    E0302 E0303 E0304 E0305
    E0401 E0402 E0403 E0404 E0405 E0406 E0408 E0409 E0410 E0411 E0412 W0401
    E0501 E0502 E0503 E0504 E0505 E0507 E0508 E0509 W0501 W0502 W0503
    E0601 E0602 E0603 E0604 E0605 E0606 E0607 E0608 E0609 E0610 E0611 E0612 W0601 W0602
    E0701 E0702 E0703 E0704 E0705 E0706 E0707 E0708 E0709 E0710 E0711 E0712 E0713 E0714 E0715 E0720 E0721 E0722 E0723 E0724
    E0725 E0726 E0727 E0728 E0729 E0730
    W0701 W0702 W0703 W0704 W0705 W0706 W0720 W0721 W0722 W0723
    E0801 E0802 E0803 W0801 W0802 W0803 W0804
    E0901 E0902 E0903 E0904 E0905 E0906 E0907 E0911 E0912 E0913 E0914 E0915 E0916 E0920 E0921 E0922 E0923
}

impl Code {
    /// Whether the code begins with these letters, such as `E03` for errors of units.
    pub fn is_of(self, range: &str) -> bool {
        self.name().starts_with(range)
    }

    /// The error in one line: the title of the page.
    pub fn title(self) -> &'static str {
        let head = self.page().lines().next().unwrap_or_default();
        head.split_once(": ").map_or(head, |(_, title)| title)
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Code {
    type Err = ();

    /// Reads a code in upper or lower case.
    fn from_str(text: &str) -> Result<Self, ()> {
        Self::ALL.iter().copied().find(|code| code.name().eq_ignore_ascii_case(text.trim())).ok_or(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_read_as_it_is_written() {
        assert_eq!("e0101".parse(), Ok(Code::E0101));
        assert_eq!("E9999".parse::<Code>(), Err(()));
        assert!(Code::ALL.iter().all(|code| code.to_string().parse() == Ok(*code)));
    }
}
