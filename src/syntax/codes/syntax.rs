//! Codes and pages of E01xx and W01xx: what the parser says.

use super::Page;

/// Something else should stand here.
pub(in crate::syntax) const UNEXPECTED: &str = "E0101";
/// A bracket or block is not closed.
pub(in crate::syntax) const UNCLOSED: &str = "E0102";
/// A bracket closes nothing.
pub(in crate::syntax) const STRAY: &str = "E0103";
/// A comment never ends.
pub(in crate::syntax) const COMMENT: &str = "E0104";
/// A quoted text does not end on its line.
pub(in crate::syntax) const TEXT: &str = "E0105";
/// Nesting is too deep.
pub(in crate::syntax) const TOO_DEEP: &str = "E0106";
/// The file cannot be read as text.
pub(in crate::syntax) const ENCODING: &str = "E0107";
/// The file is empty.
pub(in crate::syntax) const EMPTY: &str = "E0108";
/// Comparisons do not chain.
pub(in crate::syntax) const CHAIN: &str = "E0109";
/// A number does not fit.
pub(in crate::syntax) const NUMBER: &str = "E0110";
/// A clause stands twice.
pub(in crate::syntax) const TWICE: &str = "E0111";
/// `=` and `==` are different.
pub(in crate::syntax) const EQUALS: &str = "E0112";
/// Unknown unit.
pub(in crate::syntax) const UNIT: &str = "E0113";
/// An operator of another language.
pub(in crate::syntax) const OPERATOR: &str = "E0114";
/// A bound took the name for its unit.
pub(in crate::syntax) const BOUND_TOOK_NAME: &str = "E0115";
/// A branch has no weight.
pub(in crate::syntax) const WEIGHT: &str = "E0116";
/// Unknown escape.
pub(in crate::syntax) const ESCAPE: &str = "E0117";
/// A field in the wrong place.
pub(in crate::syntax) const FIELD_PLACE: &str = "E0118";
/// A bound is written with `<=`.
pub(in crate::syntax) const BOUND: &str = "E0119";
/// An expression joins too many parts.
pub(in crate::syntax) const TOO_LONG: &str = "E0120";
/// A character that is not used.
pub(in crate::syntax) const CHARACTER: &str = "E0121";
/// This function does not fold over a set.
pub(in crate::syntax) const NO_FOLD: &str = "E0122";
/// Several levels of a quantile where one fits.
pub(in crate::syntax) const SEVERAL_LEVELS: &str = "E0124";
/// The syntax of another language.
pub(in crate::syntax) const FOREIGN: &str = "E0130";
/// A temporal operator binds tighter than `=>`.
pub(in crate::syntax) const OPEN_IMPLICATION: &str = "W0101";
/// A power of a whole quantity.
pub(in crate::syntax) const POWER_OF_QUANTITY: &str = "W0102";
/// A name equals a unit.
pub(in crate::syntax) const NAME_IS_UNIT: &str = "W0103";

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[
    Page {
        code: UNEXPECTED,
        title: "something else should stand here",
        text: "\
The text does not follow the grammar at the marked place; the message says what could stand there. Everything up to the next\n\
declaration or line of the block is skipped, so that one mistake gives one error.\n\
\n\
Wrong:\n\
\x20   property safe = G<=10 s (gap > )\n\
Right:\n\
\x20   property safe = G<=10 s (gap > 0.1 m)",
    },
    Page {
        code: UNCLOSED,
        title: "a bracket or block is not closed",
        text: "\
A block opened with `{`, or a bracket, runs into the next declaration or the end of the file. The other mark shows how far.\n\
\n\
Wrong:\n\
\x20   kind adult: sfm preset helbing2000 { mass = 75 kg\n\
\x20   agent user: adult { at = (1, 2) }\n\
Right:\n\
\x20   kind adult: sfm preset helbing2000 { mass = 75 kg }\n\
\x20   agent user: adult { at = (1, 2) }",
    },
    Page {
        code: STRAY,
        title: "a bracket closes nothing",
        text: "\
A closing bracket has no opening one before it.\n\
\n\
Wrong:\n\
\x20   property p = (a & b))\n\
Right:\n\
\x20   property p = (a & b)",
    },
    Page {
        code: COMMENT,
        title: "a comment never ends",
        text: "\
A comment that starts with `/*` ends with `*/`; without it the rest of the file would be comment.\n\
\n\
Wrong:\n\
\x20   /* the scene\n\
\x20   scene { }\n\
Right:\n\
\x20   /* the scene */\n\
\x20   scene { }",
    },
    Page {
        code: TEXT,
        title: "a quoted text does not end on its line",
        text: "\
Quoted texts stand on one line. A quote inside one is written `\\\"`.\n\
\n\
Wrong:\n\
\x20   scenario \"Corridor\n\
Right:\n\
\x20   scenario \"Corridor\"",
    },
    Page {
        code: TOO_DEEP,
        title: "nesting is too deep",
        text: "\
Brackets and prefix operators (`!`, `-`, `F`, `G`, `X`, `forall`, `exists`) may nest up to 256 deep.\n\
\n\
Wrong:\n\
\x20   property p = ((((… 300 of them …))))\n\
Right:\n\
\x20   let inner = …\n\
\x20   property p = (inner)",
    },
    Page {
        code: ENCODING,
        title: "the file cannot be read as text",
        text: "\
Files are UTF-8 and below 4 GiB. The message names the first byte that is not UTF-8 with its line and column.\n\
\n\
Wrong:\n\
\x20   a file saved as Latin-1 or UTF-16\n\
Right:\n\
\x20   the same file saved as UTF-8",
    },
    Page {
        code: EMPTY,
        title: "the file is empty",
        text: "\
There is nothing but blanks, or comments, in the file. A scenario needs at least a horizon, a property file at least a property\n\
or query.\n\
\n\
Wrong:\n\
\x20   (nothing)\n\
Right:\n\
\x20   scenario \"Die\"\n\
\x20   horizon = 20 steps",
    },
    Page {
        code: CHAIN,
        title: "comparisons do not chain",
        text: "\
`a < b < c` would compare a truth value with a number.\n\
\n\
Wrong:\n\
\x20   property p = G<=1 s (0 m < gap < 1 m)\n\
Right:\n\
\x20   property p = G<=1 s (0 m < gap & gap < 1 m)",
    },
    Page {
        code: NUMBER,
        title: "a number does not fit",
        text: "\
Numbers are kept exactly, as quotients of whole numbers of about 37 digits; powers of units are small whole numbers.\n\
\n\
Wrong:\n\
\x20   mass = 1e999 kg\n\
Right:\n\
\x20   mass = 75 kg",
    },
    Page {
        code: TWICE,
        title: "a clause stands twice",
        text: "\
Each of `within`, `confidence`, `by` and `under` may stand once in a query.\n\
\n\
Wrong:\n\
\x20   estimate P(safe) within 0.01 within 0.02\n\
Right:\n\
\x20   estimate P(safe) within 0.01",
    },
    Page {
        code: EQUALS,
        title: "`=` and `==` are different",
        text: "\
`=` sets a name, `==` compares two values.\n\
\n\
Wrong:\n\
\x20   property six = F<=5 steps (die.s = 7)\n\
Right:\n\
\x20   property six = F<=5 steps (die.s == 7)",
    },
    Page {
        code: UNIT,
        title: "unknown unit",
        text: "\
A name right after a number is its unit. Known are m, cm, mm, km, s, ms, min, h, kg, g, N, kN, deg, rad, Hz, %, step\n\
and steps, with powers (`m^2`), quotients (`m/s`, `1 /s`, `kg/(m s)`) and products (`N*m`). Ranges of whole numbers have none.\n\
\n\
Wrong:\n\
\x20   speed = 1.3 metres/s\n\
Right:\n\
\x20   speed = 1.3 m/s",
    },
    Page {
        code: OPERATOR,
        title: "an operator of another language",
        text: "\
Truth values are joined by `!`, `&`, `|`, `=>` and `<=>` (or `¬ ∧ ∨ ⇒ ⇔`); powers are written `^`.\n\
\n\
Wrong:\n\
\x20   property p = safe && arrives\n\
Right:\n\
\x20   property p = safe & arrives",
    },
    Page {
        code: BOUND_TOOK_NAME,
        title: "a bound took the name for its unit",
        text: "\
A unit belongs to the number before it, so that `F<=0 s == 3` bounds by zero seconds and then lacks a formula.\n\
\n\
Wrong:\n\
\x20   property p = F<=0 s == 3\n\
Right:\n\
\x20   property p = F<=#0 s == 3\n\
\x20   property p = F<=#0 (s == 3)",
    },
    Page {
        code: WEIGHT,
        title: "a branch has no weight",
        text: "\
Where a command or choice has two or more branches, each needs its weight. The `|` between branches binds looser than any update.\n\
\n\
Wrong:\n\
\x20   when s == 0 -> s = 1 | s = 2\n\
Right:\n\
\x20   when s == 0 -> 1/2: s = 1 | 1/2: s = 2",
    },
    Page {
        code: ESCAPE,
        title: "unknown escape",
        text: "\
Inside a quoted text the backslash stands before a quote, a backslash, `n` (new line) or `t` (tab).\n\
\n\
Wrong:\n\
\x20   scenario \"C:\\data\"\n\
Right:\n\
\x20   scenario \"C:\\\\data\"",
    },
    Page {
        code: FIELD_PLACE,
        title: "a field in the wrong place",
        text: "\
A process holds variables and commands, no fields. In a state of a behaviour fields stand before the transitions.\n\
\n\
Wrong:\n\
\x20   state looking { after 2 s -> attentive; speed = 1 m/s }\n\
Right:\n\
\x20   state looking { speed = 1 m/s; after 2 s -> attentive }",
    },
    Page {
        code: BOUND,
        title: "a bound is written with `<=`",
        text: "\
A temporal operator is bounded by `<=` and a time, or by an interval with both ends included.\n\
\n\
Wrong:\n\
\x20   property p = F<5 s arrives\n\
Right:\n\
\x20   property p = F<=5 s arrives\n\
\x20   property p = F[1 s, 5 s] arrives",
    },
    Page {
        code: TOO_LONG,
        title: "an expression joins too many parts",
        text: "\
A tree of an expression may be 512 high, chains of operators included.\n\
\n\
Wrong:\n\
\x20   property p = a1 & a2 & … & a600\n\
Right:\n\
\x20   let first = a1 & … & a300\n\
\x20   let second = a301 & … & a600\n\
\x20   property p = first & second",
    },
    Page {
        code: CHARACTER,
        title: "a character that is not used",
        text: "\
The character looks like one of the language but is another, such as a typographic quote or dash.\n\
\n\
Wrong:\n\
\x20   scenario “Corridor”\n\
Right:\n\
\x20   scenario \"Corridor\"",
    },
    Page {
        code: NO_FOLD,
        title: "this function does not fold over a set",
        text: "\
`min`, `max`, `sum` and `mean` take `… for a in S`; a count is written `count(a in S: …)`.\n\
\n\
Wrong:\n\
\x20   let n = product(speed(a) for a in crowd)\n\
Right:\n\
\x20   let n = sum(speed(a) for a in crowd)",
    },
    Page {
        code: SEVERAL_LEVELS,
        title: "only one level fits here",
        text: "\
Several quantiles of a metric are estimated at once, jointly; a check, a comparison or a ranking is about one.\n\
\n\
Wrong:\n\
\x20   check Q(0.5, 0.9, time_until(user in exit)) <= 20 s\n\
Right:\n\
\x20   check Q(0.9, time_until(user in exit)) <= 20 s\n\
\x20   estimate Q(0.5, 0.9, time_until(user in exit))",
    },
    Page {
        code: FOREIGN,
        title: "the syntax of another language",
        text: "\
The text is known from PRISM, UPPAAL, a logic tool or Python. The hint writes it in this language, with the names of the file.\n\
A time without a unit becomes one in seconds; a number of steps is written `#15` or `15 steps`.\n\
\n\
Wrong:\n\
\x20   Pr[<=15](<> user in exit)\n\
Right:\n\
\x20   estimate P(F<=15 s (user in exit))",
    },
    Page {
        code: OPEN_IMPLICATION,
        title: "a temporal operator binds tighter than `=>`",
        text: "\
`G<=2 s a => b` reads `(G<=2 s a) => b`. If the implication is to hold at every state, it needs parentheses.\n\
\n\
Probably wrong:\n\
\x20   property p = G<=2 s user in exit => slow\n\
Clear:\n\
\x20   property p = G<=2 s (user in exit => slow)",
    },
    Page {
        code: POWER_OF_QUANTITY,
        title: "a power of a whole quantity",
        text: "\
`2 m ^ 2` is the square of two metres, four square metres; `2 m^2` is two square metres.\n\
\n\
Probably wrong:\n\
\x20   let a = 2 m ^ 2\n\
Clear:\n\
\x20   let a = 2 m^2\n\
\x20   let a = (2 m) ^ 2",
    },
    Page {
        code: NAME_IS_UNIT,
        title: "a name equals a unit",
        text: "\
After a number the name would be read as the unit, never as the name.\n\
\n\
Probably wrong:\n\
\x20   const s = 3 m\n\
\x20   let far = 2 s\n\
Clear:\n\
\x20   const side = 3 m\n\
\x20   let far = 2 * side",
    },
];
