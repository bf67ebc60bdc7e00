//! Our own words about calls and models that are wrong, and what hints advise.

use crate::program::{Place, SMALL};

const PROPERTIES: &str = "check P(F<=1 s contact(user)) >= 0.3\n";

fn place() -> Place {
    Place::new(&[("a.scn", SMALL), ("a.bltl", PROPERTIES)])
}

#[test]
fn options_with_numbers_speak_of_numbers() {
    let place = place();
    for (words, wanted) in [
        ("check a.scn a.bltl --seed -1", "`-1` is not a whole number"),
        ("check a.scn a.bltl --seed 1.5", "`1.5` is not a whole number"),
        ("check a.scn a.bltl -j many", "write a number from 1, or remove the option to use all cores"),
        ("check a.scn a.bltl --shards 0", "must be a whole number from 1 to 4294967295 (got `0`)"),
        ("walk a.scn -n -3", "`-3` is not a whole number"),
        ("simulate a.scn --every x", "`x` is not a whole number"),
        ("gait sample a.gait -n 0", "must be a whole number from 1 to 10000000 (got `0`)"),
        ("gait score a.bvh --folds 1e9", "must be a whole number from 0 (got `1e9`)"),
        ("infer a.csv --fps fast", "write a number a second, above 0 and at most 1e6"),
        ("evaluate a.scn a.bltl --tracks r --speed -", "must be a number (got `-`)"),
        ("path --shape L3 --profiles -2", "a whole number from 0 to 10000"),
    ] {
        let said = place.call(&words.split(' ').collect::<Vec<_>>());
        assert_eq!(said.code, Some(2), "{words}");
        assert!(said.err.contains(wanted), "{words}\n{}", said.err);
        assert!(said.err.contains("error[E0705]: ") && said.err.contains("help: "), "{words}\n{}", said.err);
        for foreign in ["invalid digit", "invalid float", "..=", "use '--"] {
            assert!(!said.err.contains(foreign), "{words}\n{}", said.err);
        }
    }
    let replayed = |seed: &str| {
        place.call(&["simulate", "a.scn", "--seed", seed, "--trial", "1e1", "-n", "2", "--until", "0.1s"]).out
    };
    assert_eq!(replayed("1e3"), replayed("1000"));
    assert_ne!(replayed("1e3"), replayed("1"));
}

#[test]
fn an_option_that_is_misspelt_is_named() {
    let place = place();
    let said = place.call(&["check", "a.scn", "a.bltl", "--sede", "3"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("exists: '--seed'") && !said.err.contains("as a value"), "{}", said.err);
    let said = place.call(&["check", "a.scn", "--wobble"]);
    assert!(said.err.contains("'--wobble'") && !said.err.contains("as a value"), "{}", said.err);
}

#[test]
fn a_launcher_has_a_name() {
    let said = place().call(&["check", "a.scn", "a.bltl", "--launch", ""]);
    assert_eq!(said.code, Some(2), "{}", said.err);
    assert!(said.err.contains("a value is required for '--launch"), "{}", said.err);
}

#[test]
fn a_simulation_is_quiet() {
    let call = ["simulate", "a.scn", "a.bltl", "--keep", "violated", "-n", "2"];
    let (plain, quiet) = (place().call(&call), place().call(&[&call[..], &["-q"]].concat()));
    assert!(!plain.err.is_empty());
    assert_eq!((quiet.err.as_str(), quiet.out), ("", plain.out));
}

#[cfg(unix)]
#[test]
fn a_name_that_is_not_utf8_is_named() {
    use std::os::unix::ffi::OsStrExt as _;
    let name = std::ffi::OsStr::from_bytes(b"b\xe9d.scn");
    for words in [["check", "a.scn"], ["show", "a.scn"], ["fmt", "a.scn"], ["infer", "--anonymous"]] {
        let output = place().command(&words).arg(name).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains("the name `b\u{fffd}d.scn` is not UTF-8"), "{said}");
    }
}

/// The exponent of a number without a unit may change.
#[test]
fn a_power_follows_its_exponent() {
    let scenario = "horizon = 6 steps\nparam b = 0.5\n\
        process p { var n: 0 .. 9 = 0; let h = b ^ n; let g = 2 ^ -n; when n < 9 -> n = n + 1 }\n";
    let properties = "property same = G[0, 6] (abs(p.h - exp(p.n * ln(b))) < 1e-12 & p.h == p.g)\n\
        property last = F[6, 6] (p.h == 1/64)\ncheck P(same) >= 0.9\ncheck P(last) >= 0.9\n";
    let place = crate::program::Place::new(&[("a.scn", scenario), ("a.bltl", properties)]);
    let said = place.call(&["check", "a.scn", "a.bltl", "-q"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "{}", said.out);
}
