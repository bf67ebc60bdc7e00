//! The formatter: what it keeps, and that a second run changes nothing.

use proptest::prelude::*;
use smc::syntax::parse::{parse_properties, parse_scenario};
use smc::syntax::print::{format_properties, format_scenario};
use smc::syntax::source::{Source, SourceId};

fn format(name: &str, text: &str) -> String {
    let source = Source::new(SourceId(0), name, text);
    if name.ends_with(".scn") { format_scenario(&source) } else { format_properties(&source) }.unwrap()
}

/// The tree without places, as text.
fn tree(name: &str, text: &str) -> String {
    let source = Source::new(SourceId(0), name, text);
    let tree = if name.ends_with(".scn") {
        format!("{:?}", parse_scenario(&source).0)
    } else {
        format!("{:?}", parse_properties(&source).0)
    };
    let mut plain = String::with_capacity(tree.len());
    let mut rest = tree.as_str();
    while let Some(at) = rest.find("Span {") {
        plain.push_str(&rest[..at]);
        rest = &rest[at..];
        rest = &rest[rest.find("end: ").unwrap()..];
        rest = &rest[rest.find('}').unwrap() + 1..];
    }
    plain + rest
}

fn comments(text: &str) -> Vec<&str> {
    text.lines().filter_map(|line| line.find("//").map(|at| line[at..].trim_end())).collect()
}

#[test]
fn examples_keep_tree_and_comments_and_settle_at_once() {
    insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::glob!("languages/*", |path| {
            let name = path.file_name().unwrap().to_str().unwrap();
            let text = std::fs::read_to_string(path).unwrap();
            let once = format(name, &text);
            assert_eq!(tree(name, &once), tree(name, &text), "{name}");
            assert_eq!(comments(&once), comments(&text), "{name}");
            assert_eq!(format(name, &once), once, "{name}");
            // With more blanks and empty lines it is the same tree.
            let wide = text.replace('\n', "\n\n   ");
            let wide = format(name, &wide);
            assert_eq!(tree(name, &wide), tree(name, &text), "{name}");
            assert_eq!(format(name, &wide), wide, "{name}");
            insta::assert_snapshot!("formatter", once);
        });
    });
}

#[test]
fn shipped_files_are_formatted() {
    let mut count = 0;
    for folder in ["models", "properties"] {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap();
            if name.ends_with(".scn") || name.ends_with(".bltl") {
                let text = std::fs::read_to_string(&path).unwrap();
                assert!(format(name, &text) == text, "`smc fmt` changes {name}");
                count += 1;
            }
        }
    }
    assert!(count > 20, "{count}");
}

#[test]
fn comments_may_stand_between_any_two_words() {
    let mut tried = 0;
    for entry in std::fs::read_dir("tests/languages").unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let plain = tree(name, &text);
        let gaps: Vec<usize> = text.match_indices([' ', '{', '}']).map(|(at, _)| at).collect();
        // Every fourth gap.
        for (k, &at) in gaps.iter().step_by(4).enumerate() {
            let comment = ["\n// one\n", " // one\n  // two\n", " /* one */ "][k % 3];
            let commented = format!("{}{comment}{}", &text[..at], &text[at..]);
            // In a text, a comment, or before a unit it is none.
            let source = Source::new(SourceId(0), name, commented.as_str());
            let formatted =
                if name.ends_with(".scn") { format_scenario(&source) } else { format_properties(&source) };
            if formatted.is_err() || tree(name, &commented) != plain {
                continue;
            }
            tried += 1;
            let once = format(name, &commented);
            assert_eq!(tree(name, &once), plain, "{name}:\n{commented}\n{once}");
            assert_eq!(format(name, &once), once, "{name}:\n{commented}");
            assert_eq!(once.matches("one").count(), commented.matches("one").count(), "{once}");
        }
    }
    assert!(tried > 200, "{tried}");
}

/// Random formulas as tokens; `~` is the blank between a number and its unit, where no comment may stand.
fn formula() -> impl Strategy<Value = Vec<String>> {
    let leaf = proptest::sample::select(vec![
        "a",
        "x . y",
        "p [ 1 ]",
        "1.5~m/s",
        "2~m ^ 2",
        "2~m^2",
        "95~%",
        "#4",
        "1 / 2",
        "1 / s",
        "1~/s",
        "true",
        "( 1 , 2 ) m",
        "f ( a , b )",
        "count ( a in S : p )",
        "min ( g ( a ) for a in S )",
        "- 3",
        "- - 3",
        "1e3~kg/(m~s)",
    ])
    .prop_map(move |text: &str| text.split(' ').map(|token| token.replace('~', " ")).collect::<Vec<_>>());
    leaf.prop_recursive(5, 40, 2, move |inner| {
        let infix = proptest::sample::select(vec![
            "&",
            "|",
            "=>",
            "<=>",
            "U",
            "U<=2 s",
            "R[1 s, 2 s]",
            "W",
            "+",
            "-",
            "*",
            "/",
            "∧",
            "⇒",
        ]);
        let prefix = proptest::sample::select(vec![
            "!",
            "¬",
            "- ",
            "F",
            "G<=10 s",
            "X<=#3",
            "F[0 s, 5 s]",
            "F<=T",
            "G<=∞",
            "forall a in S:",
            "min<=2 s",
            "mean[0 s, 1 s]",
        ]);
        prop_oneof![
            (prefix, inner.clone()).prop_map(move |(prefix, body)| {
                let mut tokens = vec![prefix.trim().to_owned(), "(".to_owned()];
                tokens.extend(body);
                tokens.push(")".to_owned());
                tokens
            }),
            (inner.clone(), infix, inner).prop_map(|(left, infix, right)| {
                let mut tokens = vec!["(".to_owned()];
                tokens.extend(left);
                tokens.extend([")".to_owned(), infix.to_owned(), "(".to_owned()]);
                tokens.extend(right);
                tokens.push(")".to_owned());
                tokens
            }),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_formulas_keep_their_tree(
        tokens in formula(),
        gaps in proptest::collection::vec(proptest::sample::select(vec![" ", " ", "  ", "\n", " /* c */ ", " // c\n"]), 1..20),
    ) {
        let mut text = "property p =".to_owned();
        for (k, token) in tokens.iter().enumerate() {
            text.push_str(gaps[k % gaps.len()]);
            text.push_str(token);
        }
        let (_, said) = parse_properties(&Source::new(SourceId(0), "r.bltl", text.as_str()));
        prop_assert!(said.iter().all(|d| d.code.is_of("W")), "{text}\n{said:?}");
        let once = format("r.bltl", &text);
        prop_assert_eq!(tree("r.bltl", &once), tree("r.bltl", &text), "{}\n{}", text, once);
        for comment in ["/* c */", "// c"] {
            let times = |text: &str| text.matches(comment).count();
            prop_assert_eq!(times(&once), times(&text), "{}\n{}", text, once);
        }
        prop_assert_eq!(format("r.bltl", &once), once);
    }
}
