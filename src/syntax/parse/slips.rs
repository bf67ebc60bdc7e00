//! Common slips, each with its own words.

use super::builder::{Builder, Pair};
use super::failure::Fault;
use super::grammar::Rule;
use super::{lexeme, nouns};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

impl Builder<'_> {
    /// The diagnostic of a known slip.
    pub(super) fn slip(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        self.slip_of_point(fault)
            .or_else(|| self.slip_of_form(fault))
            .or_else(|| self.slip_in_text(fault))
            .or_else(|| self.slip_of_bound(fault))
            .or_else(|| self.slip_of_unit_in_bound(fault))
            .or_else(|| self.slip_of_initial(fault))
            .or_else(|| self.slip_of_whole_range(fault))
            .or_else(|| self.slip_of_bindings(fault))
            .or_else(|| self.slip_of_equals(fault))
            .or_else(|| self.slip_of_operator(fault))
            .or_else(|| self.slip_of_if(fault))
            .or_else(|| self.slip_of_range(fault))
            .or_else(|| self.slip_of_quantifier(fault))
            .or_else(|| self.slip_of_sides(fault))
            .or_else(|| self.slip_of_with(fault))
            .or_else(|| self.slip_of_time(fault))
            .or_else(|| self.slip_of_unit(fault))
            .or_else(|| self.slip_of_process(fault))
    }

    fn slip_in_text(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let place = self.place(fault.at, fault.found);
        if lexeme::is_open_text(fault.found) {
            return Some(error!(E0105, place, "the quoted text does not end on its line";
                    hint: "close it with `\"`; a quote inside is written `\\\"`"));
        }
        // `3 % 2`, but not a number where the next line starts.
        let before = self.text[..fault.at].trim_end_matches(' ');
        if fault.found.starts_with(|c: char| c.is_ascii_digit()) && before.ends_with('%') {
            return Some(percent(self.at(before.len() - 1..before.len())));
        }
        let plain = match fault.found {
            "“" | "”" | "„" | "‘" | "’" | "'" => "\"",
            "–" | "−" | "—" => "-",
            "×" | "·" => "*",
            "÷" => "/",
            "→" => "->",
            "…" => "..",
            "²" => "^2",
            "³" => "^3",
            "%" if fault.after_value() => {
                return Some(percent(place));
            }
            _ => return None,
        };
        Some(error!(E0121, place, "unexpected {}", self.quote(fault.found); hint: "write `{plain}`"))
    }

    /// `speed == 1 m/s` where a field is set: the grammar takes it as it is meant.
    pub(super) fn report_unequal(&mut self, file: &Pair<'_>) {
        for pair in file.clone().into_inner().flatten().filter(|pair| pair.as_rule() == Rule::t_unequal) {
            let error = unequal(self.span(&pair), "=", pair.as_str());
            self.say(error);
        }
    }

    fn slip_of_equals(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let place = self.place(fault.at, fault.found);
        if fault.expected.contains(&Rule::relation) && matches!(fault.found, "=" | "==" | "=>" | "!=") {
            let title = format!("expected `>=`, `>`, `<=` or `<`, found `{}`", fault.found);
            let hint = match fault.found {
                "=>" => "write `>=`; `=>` is an implication",
                _ => "a test can only decide on which side of a number a probability is",
            };
            return Some(error!(E0112, place, "{title}"; hint: "{hint}"));
        }
        if fault.found == ":=" && !fault.expected.contains(&Rule::t_assign) {
            return Some(
                error!(E0112, place, "`:=` is not an operator"; hint: "`=` sets a value, `==` compares"),
            );
        }
        if matches!(fault.found, "==" | ":=" | "===")
            && let Some((_, word)) = lexeme::word_before(&self.text, fault.at)
            && let Some(wanted) = unsigned(word)
        {
            let title = format!("expected {wanted}, found `{}`", fault.found);
            return Some(error!(E0101, place, "{title}"));
        }
        if fault.found == "==="
            || matches!(fault.found, "==" | ":=") && fault.expected.contains(&Rule::t_assign)
        {
            let wanted = if fault.found == "===" { "==" } else { "=" };
            return Some(unequal(place, wanted, fault.found));
        }
        if fault.found != "=" || !fault.after_value() {
            return None;
        }
        if let Some((start, word)) = lexeme::word_before(&self.text, fault.at)
            && self.text[..start].trim_end_matches(' ').ends_with('\n')
        {
            let place = self.at(start..start + word.len());
            return Some(error!(E0101, place, "expected a number, a name or `(`, found `{word} =`";
                    hint: "the value before it is missing or ends in an operator"));
        }
        if let Some((start, word)) = lexeme::word_before(&self.text, fault.at)
            && let Some((_, word)) = word.rsplit_once('.')
            && self.follows_arrow(start)
        {
            let error = error!(E0101, place, "a process can set only its own variables");
            return Some(error.hint(format!(
                "set `{word}` in the process that declares it, in a command that reads this process"
            )));
        }
        Some(error!(E0112, place, "expected an operator, found `=`"; hint: "`=` sets a value, `==` compares"))
    }

    /// `const = 3`: a declaration without its name may read as a setting.
    pub(super) fn slip_of_name(&self) -> Option<Diagnostic> {
        let word = lexeme::first(&self.text);
        let rest = self.text[word.len()..].trim_start();
        let is_set = rest.starts_with('=') && !rest.starts_with("==");
        let wanted = unsigned(word).filter(|_| is_set && !self.in_properties)?;
        let at = self.text.len() - rest.len();
        let title = format!("expected {wanted}, found `=`");
        Some(error!(E0101, self.at(at..at + 1), "{title}"))
    }

    /// `horizon = 5.`
    fn slip_of_point(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let before = self.text[..fault.at].trim_end();
        let number = before.strip_suffix('.')?;
        let digits = number.len() - number.trim_end_matches(|c: char| c.is_ascii_digit()).len();
        let written = &number[number.len() - digits..];
        let is_name = number[..number.len() - digits].ends_with(lexeme::continues_name);
        if digits == 0 || is_name {
            return None;
        }
        let place = self.at(number.len()..before.len());
        let error = error!(E0101, place, "a number cannot end in a point");
        Some(error.hint(format!("write `{written}`, or `{written}.0`")))
    }

    /// `if a then b`
    fn slip_of_if(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let (at, word) = lexeme::word_before(&self.text, fault.at)?;
        if word != "if" || !fault.after_value() {
            return None;
        }
        let error = error!(E0114, self.at(at..at + 2), "`if` must be written as a function");
        Some(error.hint("write `if(condition, then, otherwise)`; for formulas `(a => b) & (!a => c)`"))
    }

    /// `check E(m) >= 1.5 in 0 .. 2`
    fn slip_of_range(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        if fault.found != "in" || !self.in_properties || !fault.after_value() {
            return None;
        }
        let place = self.place(fault.at, fault.found);
        let error = error!(E0101, place, "a range must follow its metric");
        Some(error.hint("write for example `check E(m) in 0 .. 2 >= 1.5`; a probability has no range"))
    }

    /// `foral a in crowd: …`
    fn slip_of_quantifier(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let ranges =
            self.behind(fault).strip_prefix("in").is_some_and(|set| !set.starts_with(lexeme::starts_name));
        if !ranges || !fault.found.starts_with(lexeme::starts_name) {
            return None;
        }
        let (at, word) = lexeme::word_before(&self.text, fault.at)?;
        let meant = nouns::nearest(word, ["forall", "exists"].into_iter())?;
        let place = self.at(at..at + word.len());
        let error = error!(E0101, place, "unknown quantifier `{word}`");
        Some(error.hint(format!("did you mean `{meant}`?")))
    }

    /// `compare P(p) under n = 2 within 0.1`
    fn slip_of_sides(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let expects = |rule| fault.expected.contains(&rule);
        let lacks = if expects(Rule::kw_with) {
            "with"
        } else if expects(Rule::kw_under) && !fault.takes_clauses() {
            "under"
        } else {
            return None;
        };
        let ends = matches!(fault.found, "" | ";" | "with");
        let goes_on = [Rule::clause, Rule::property_item]
            .into_iter()
            .any(|rule| nouns::words(rule).contains(&fault.found));
        if !ends && !goes_on {
            return None;
        }
        let compared = &self.text[..fault.at];
        let set = compared.rsplit_once("under").map(|(_, set)| lexeme::first(set.trim_start()));
        let name = set.filter(|name| name.starts_with(lexeme::starts_name)).unwrap_or("n");
        let title = format!("expected `{lacks}`, found {}", self.quote(fault.found));
        let error = error!(E0101, self.place(fault.at, fault.found), "{title}");
        Some(error.hint(format!("write two sides: `compare P(…) under {name} = … with {name} = …`")))
    }

    /// `estimate P(p) with n = 3`
    fn slip_of_with(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        if fault.found != "with" || !fault.takes_clauses() {
            return None;
        }
        let place = self.place(fault.at, fault.found);
        let error = error!(E0101, place, "`with` is allowed only between the sides of a `compare`");
        Some(error.hint("to set parameters of a query write `under n = …`"))
    }

    /// `under n = 1 and m = 2`, `under n = 1 & m = 2`
    fn slip_of_bindings(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let compares = fault.expected.contains(&Rule::kw_with);
        if !fault.expected.contains(&Rule::t_comma) || !(compares || fault.takes_clauses()) {
            return None;
        }
        let (at, joined) = if fault.found == "=" {
            // The operator was taken, and the name after it.
            let (name, _) = lexeme::word_before(&self.text, fault.at)?;
            let before = self.text[..name].trim_end();
            let joined = before.chars().next_back().filter(|c| matches!(c, '&' | '∧'))?;
            let at = before.len() - joined.len_utf8();
            (at, &before[at..])
        } else {
            let after = self.behind(fault);
            let name = lexeme::first(after);
            let sets = after[name.len()..].trim_start();
            let is_set = name.starts_with(lexeme::starts_name)
                && sets.starts_with('=')
                && !sets.starts_with("==")
                && !sets.starts_with("=>");
            if !is_set || !matches!(fault.found, "and" | "AND" | "&&") {
                return None;
            }
            (fault.at, fault.found)
        };
        let title = format!("`{joined}` cannot join the values of parameters");
        let hint = if compares {
            "write `,` between values of one side, and `with` before the other side"
        } else {
            "write `,`"
        };
        Some(error!(E0114, self.at(at..at + joined.len()), "{title}"; hint: "{hint}"))
    }

    /// `process p { n = 3 }`
    fn slip_of_process(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let expects = fault.expected.iter().any(|rule| matches!(rule, Rule::process_item | Rule::EOI));
        let rest = self.behind(fault);
        let sets = rest.starts_with('=') && !rest.starts_with("==") && !rest.starts_with("=>");
        if fault.rule != Rule::line_of_process
            || !expects
            || !sets
            || !fault.found.starts_with(lexeme::starts_name)
        {
            return None;
        }
        let place = self.place(fault.at, fault.found);
        if self.follows_arrow(fault.at) {
            let error = error!(E0101, place, "several updates need braces");
            return Some(error.hint("write for example `-> { a = 1; b = 2 }`"));
        }
        Some(error!(E0118, place, "a process has no fields";
                hint: "write `var {} = …` or `let {} = …`", fault.found, fault.found))
    }
}

/// `n % 2`
fn percent(place: Span) -> Diagnostic {
    error!(E0121, place, "`%` is the unit percent, not an operator";
        hint: "for a remainder write `modulo(n, 2)`; for a percentage write `95 %`")
}

/// One sign of equality for another.
fn unequal(place: Span, wanted: &str, found: &str) -> Diagnostic {
    error!(E0112, place, "expected `{wanted}`, found `{found}`"; hint: "`=` sets a value, `==` compares")
}

/// What is wanted after a word that is followed by no sign of equality.
pub(super) fn unsigned(word: &str) -> Option<&'static str> {
    Some(match word {
        "horizon" | "step" => return None,
        "scenario" => "a text",
        "scene" => "`{`",
        "after" | "when" => "a number, a name or `(`",
        _ if nouns::words(Rule::item).contains(&word) => "a name",
        _ => return None,
    })
}
