//! A report as one HTML page: no script, no font, no file beside it.

mod chart;
mod histogram;

use super::number::{count, counted, duration};
use super::phrase::{certified, endless, one_line, settings};
use super::text;
use crate::engine::outcome::{CallResult, Interval, QueryResult, Shortfall, Status, Verdict, Witness};
use crate::report::escape::escape;
use chart::{Mark, Tone};
use std::fmt::Write as _;

const STYLE: &str = include_str!("style.css");

/// The page of a run.
pub fn render(run: &CallResult) -> String {
    let title = escape(if run.scenario.is_empty() { "smc" } else { &run.scenario });
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n"
    );
    let _ = writeln!(
        page,
        "<header>\n<h1>{title}</h1>\n<p>seed {}, smc {}, {} in {}</p>\n<p class=\"tally\">{}</p>\n</header>",
        run.seed,
        escape(&run.version),
        counted(run.trials, "trial"),
        duration(run.elapsed_s),
        tally(run)
    );
    for group in text::by_query(&run.results).chunk_by(|a, b| text::same_sweep(a, b)) {
        section(&mut page, group);
    }
    for finding in &run.diagnostics {
        let (class, hint) = (if finding.error { "failure" } else { "warning" }, finding.hint.as_deref());
        let hint = hint.map_or(String::new(), |hint| format!("; {hint}"));
        let _ = writeln!(page, "<p class=\"{class}\">{}{}</p>", escape(&finding.line()), escape(&hint));
    }
    for warning in &run.warnings {
        let _ = writeln!(page, "<p class=\"warning\">{}</p>", escape(warning));
    }
    if run.interrupted {
        page.push_str("<p class=\"warning\">Interrupted: these are the results so far.</p>\n");
    }
    if let Some(failure) = &run.failure {
        let _ =
            writeln!(page, "<p class=\"failure\">Stopped by an error: {}</p>", escape(&failure.message()));
    }
    let _ = writeln!(
        page,
        "<footer>\n<p>All guarantees are about the model.</p>\n<p>replay</p>\n<pre>{}</pre>\n</footer>\n</main>\n</body>\n</html>",
        escape(&run.replay)
    );
    page
}

fn tally(run: &CallResult) -> String {
    let parts: Vec<String> = text::tally(run)
        .into_iter()
        .map(|(n, word, _)| format!("<span class=\"badge {}\">{n} {word}</span>", word.replace(' ', "-")))
        .collect();
    parts.join(" ")
}

/// One query: alone, or under several settings.
fn section(page: &mut String, group: &[&QueryResult]) {
    let Some(first) = group.first() else { return };
    let word =
        group.iter().map(|result| word(result)).max_by_key(|word| severity(word)).unwrap_or("computed");
    let place = if first.asked.file.is_empty() {
        String::new()
    } else {
        format!("{}:{}", first.asked.file, first.asked.line)
    };
    let _ = writeln!(
        page,
        "<section>\n<h2><span class=\"badge {}\">{word}</span> <code>{}</code> <small>{}</small></h2>",
        word.replace(' ', "-"),
        escape(&one_line(&first.asked.text)),
        escape(&place)
    );
    let marks: Vec<Mark> = if group.len() > 1 {
        group.iter().filter_map(|result| mark(result, &settings(result))).collect()
    } else {
        marks(first)
    };
    let theta = |result: &QueryResult| {
        result.method.numbers.iter().find(|(name, _)| name == "theta").map(|(_, value)| *value)
    };
    // A threshold may be a parameter, and is then another in each row.
    let threshold = theta(first).filter(|_| group.iter().all(|result| theta(result) == theta(first)));
    page.push_str(&chart::intervals(&marks, &first.unit, threshold, first.censored));
    if !first.interval.is_empty() && group.iter().all(|result| result.interval == first.interval) {
        let _ = writeln!(page, "<p class=\"faint\">intervals: {}</p>", escape(&first.interval));
    }
    if let Some(ranking) = &first.rank {
        let said = match &ranking.choice {
            None if first.consumed.counts.trials > 0 => "No choice: no trial is resolved.".to_owned(),
            None => "No choice: nothing was sampled.".to_owned(),
            Some(choice) if !first.certifies.is_empty() => format!(
                "Choose <strong>{}</strong>{}.",
                escape(choice),
                if ranking.tied { "; options marked tied have the same certificate" } else { "" }
            ),
            Some(choice) => {
                format!("<strong>{}</strong> is best so far, but nothing is certified.", escape(choice))
            }
        };
        let _ = writeln!(page, "<p>{said}</p>");
    }
    for result in group {
        facts(page, result, group.len() > 1);
    }
    page.push_str("</section>\n");
}

fn severity(word: &str) -> u8 {
    match word {
        "violated" => 3,
        "undecided" => 2,
        "satisfied" | "incomplete" | "not begun" => 1,
        _ => 0,
    }
}

fn word(result: &QueryResult) -> &'static str {
    let computed = result.shortfall().map_or("computed", Shortfall::name);
    result.verdict.map_or(computed, Verdict::name)
}

/// The lines of one result under its chart.
fn facts(page: &mut String, result: &QueryResult, swept: bool) {
    let with = settings(result);
    let head = if swept { format!("<strong>{}</strong>: ", escape(&with)) } else { String::new() };
    let statement = certified(result);
    if !statement.is_empty() {
        let _ = writeln!(page, "<p class=\"certified\">{head}{}</p>", escape(&statement));
    }
    if let Some(given) = &result.asked.given {
        let _ = writeln!(page, "<p>Given: {}.</p>", escape(given));
    }
    let _ = writeln!(page, "<p class=\"faint\">{head}{}</p>", escape(&text::trials(result)));
    if let Some(histogram) = result.distribution.as_ref().and_then(|d| d.histogram.as_ref()) {
        page.push_str(&histogram::bars(histogram, &result.unit, endless(result)));
    }
    for warning in &result.warnings {
        let _ = writeln!(page, "<p class=\"warning\">{head}{}</p>", escape(warning));
    }
    for Witness { shows, value, trial, time, unit, what, command, .. } in &result.witnesses {
        let _ = writeln!(
            page,
            "<p>{} in trial {}, {} {}: <code>{}</code></p>\n<pre>{}</pre>",
            text::shown(*shows, result.of.is_some()),
            count(*trial),
            if value.is_some() { "at" } else { "decided at" },
            text::moment(*time, unit),
            escape(what),
            escape(command)
        );
    }
}

/// The rows of the chart of one result.
fn marks(result: &QueryResult) -> Vec<Mark> {
    if let Some(ranking) = &result.rank {
        let tone = |status| match status {
            Status::Chosen => Tone::Good,
            Status::Tied => Tone::Plain,
            Status::Beaten => Tone::Faint,
            Status::Open => Tone::Caution,
        };
        let row = |o: &crate::engine::outcome::RankedOption| {
            let note = format!("{}, {}", o.status.name(), counted(o.counts.trials, "trial"));
            labelled(result, &o.label, o.value, tone(o.status), &note)
        };
        return ranking.options.iter().map(row).collect();
    }
    if let Some(sides) = &result.compare {
        let row =
            |side: &crate::engine::outcome::Side, tone| labelled(result, &side.label, side.value, tone, "");
        return vec![
            row(&sides.first, Tone::Plain),
            row(&sides.second, Tone::Plain),
            row(&sides.difference, Tone::Good),
        ];
    }
    mark(result, "").into_iter().collect()
}

fn mark(result: &QueryResult, label: &str) -> Option<Mark> {
    let value = Interval { estimate: result.estimate?, low: result.low, high: result.high };
    let tone = match result.verdict {
        Some(Verdict::Satisfied) => Tone::Good,
        Some(Verdict::Violated) => Tone::Bad,
        Some(Verdict::Undecided) => Tone::Caution,
        None => Tone::Plain,
    };
    Some(labelled(result, label, value, tone, ""))
}

fn labelled(result: &QueryResult, label: &str, value: Interval, tone: Tone, note: &str) -> Mark {
    let (estimate, interval) = text::printed(result, &value);
    let note = if note.is_empty() { String::new() } else { format!(" ({note})") };
    Mark { label: label.to_owned(), value, tone, said: format!("{estimate}  {interval}{note}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_gets_out_of_its_element() {
        assert_eq!(escape("<a href='x'>&\u{0}\""), "&lt;a href=&#39;x&#39;&gt;&amp; &quot;");
        let run = CallResult { scenario: "</title><script>".into(), ..CallResult::default() };
        assert!(!render(&run).contains("<script>"));
    }
}
