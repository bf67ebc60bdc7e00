//! Scenarios and property files through the front end: what is understood, and what is refused.

use crate::texts::Front;
use smc::base::geometry::Vec2;
use smc::compile::study::Ask;
use smc::compile::{Files, Request, Study};
use smc::model::{AgentId, Amount, Bool, Move, Num, Position, Who};
use smc::syntax::render::render;

/// Compiles two texts; diagnostics as rendered.
fn compiled(scenario: &str, properties: &str) -> (Option<Study>, String) {
    let read = |requests: Vec<Request>| {
        let mut files = Files::default();
        for request in requests {
            let path = format!("{}/../shared/data/eth-biwi/{}", env!("CARGO_MANIFEST_DIR"), request.path);
            files.provide(request.path, std::fs::read(&path).map_err(|e| e.to_string()));
        }
        files
    };
    let front = Front::of(scenario, properties, read);
    let said = render(&front.said(), &front.sources, false);
    (front.study, said)
}

#[test]
fn the_corridor_is_understood() {
    let (study, found) =
        compiled(include_str!("../models/corridor.scn"), include_str!("../properties/corridor.bltl"));
    let study = study.expect("no error");
    assert_eq!(found, "");
    assert_eq!(study.title, "Corridor with an oncoming crowd");
    // user, two friends, round(0.4 /m^2 * 11 m * 3.4 m) = 15 oncoming
    assert_eq!(study.worlds[0].scenario.agents.len(), 18);
    assert_eq!(study.worlds.len(), 3, "the plain one and two sides of the comparison");
    assert_eq!(study.queries.len(), 8);
    assert_eq!(study.worlds[0].scenario.moves[0].options.len(), 11);
}

/// Somebody alone and two more, with parameters.
const THREE: &str = "scenario \"three\"\nhorizon = 2 s\nstep = 0.1 s\nparam n = 1\nparam m = 1\n\
    scene { region hall: rect (0, 0) .. (10, 10) }\nkind adult: sfm preset helbing2000\n\
    agent me: adult { at = (1, 1); route = hall }\nagents crowd[2]: adult { at = uniform in hall; route = hall }\n";

fn understood(scenario: &str, properties: &str) -> Study {
    let (study, found) = compiled(scenario, properties);
    study.unwrap_or_else(|| panic!("{found}"))
}

fn refused(scenario: &str, properties: &str, code: &str) {
    let (study, found) = compiled(scenario, properties);
    assert!(study.is_none() && found.contains(&format!("error[{code}]")), "{properties}\n{found}");
}

#[test]
fn the_others_are_counted_without_the_one() {
    let asked = |who: &str| understood(THREE, &format!("estimate P({who} in hall)")).worlds[0].atoms.clone();
    for (who, id) in [
        ("others(me)[1]", 1),
        ("others(me)[2]", 2),
        ("others(crowd[1])[1]", 0),
        ("others(crowd[1])[2]", 2),
        ("others(crowd[2])[2]", 1),
    ] {
        let atoms = asked(who);
        assert!(
            matches!(atoms[..], [Bool::In(Who::Agent(AgentId(found)), _)] if found == id),
            "{who}: {atoms:?}"
        );
    }
    refused(THREE, "estimate P(others(me)[3] in hall)", "E0212");
    refused(THREE, "estimate P(forall a in crowd: others(a)[1] in hall)", "E0304");
    // Where each has a formula of its own, it is known who is left out.
    let study = understood(THREE, "estimate P(forall a in crowd: F<=1 s (others(a)[2] in hall))");
    let ids: Vec<u32> = study.worlds[0]
        .atoms
        .iter()
        .map(|atom| if let Bool::In(Who::Agent(id), _) = atom { id.0 } else { panic!("{atom:?}") })
        .collect();
    assert_eq!(ids, [2, 1]);
}

#[test]
fn what_a_comparison_sets_at_its_end_holds_on_both_sides() {
    for (query, expected) in [
        ("under n = 2 with n = 3 under m = 4", [vec![("m", "4"), ("n", "2")], vec![("m", "4"), ("n", "3")]]),
        ("under n = m with n = 3 under m = 4", [vec![("m", "4"), ("n", "4")], vec![("m", "4"), ("n", "3")]]),
    ] {
        let study = understood(THREE, &format!("compare P(x(me) > n * m * 1 m) {query}"));
        let Ask::Compare { first, second, .. } = &study.queries[0].ask else { panic!("{query}") };
        for (side, expected) in [first, second].into_iter().zip(expected) {
            let settings = &study.worlds[side.target.world].settings;
            let settings: Vec<_> =
                settings.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
            assert_eq!(settings, expected, "{query}");
        }
    }
    // What is set for both is set for neither alone.
    for query in ["under n = 2 with n = 3 under n = 4", "under n = 2 with m = 3 under n = 4"] {
        refused(THREE, &format!("compare P(x(me) > n * m * 1 m) {query}"), "E0210");
    }
}

#[test]
fn the_sides_of_a_comparison_have_one_range() {
    let query = |high: &str| format!("compare E(x(me) at end) in 0 m .. {high} under n = 4 with n = 1");
    refused(THREE, &query("n * 1 m"), "E0605");
    for high in ["9 m", "m * 1 m"] {
        understood(THREE, &query(high));
    }
}

#[test]
fn numbers_of_people_suffice_for_all_who_may_come() {
    // About 1000 come; more than 1024 do in every fifth trial, more than 2048 in none.
    for (limit, most) in [(100, 2048), (999, 2048), (1000, 2048), (1024, 2048), (3000, 4096)] {
        let text = format!(
            "{THREE}source doors: adult {{ at = uniform in hall; every = exponential(0.1 s); route = hall; limit = {limit} }}"
        )
        .replace("horizon = 2 s", "horizon = 100 s");
        let study = understood(&text, "");
        assert_eq!(study.worlds[0].scenario.sources[0].most, most, "{limit}");
    }
}

#[test]
fn bounds_between_ticks_make_those_of_their_own_world_finer() {
    // All of them together do not fit between the ticks of one horizon.
    let rates = [7, 11, 13, 17, 19];
    let properties: String =
        rates.iter().map(|r| format!("estimate P(F<=(1 s / r) (p.n == 1)) under r = {r}\n")).collect();
    let scenario =
        "horizon = 10 s\nparam r = 1\nprocess p { var n: 0..1 = 0; when n == 0 at 1 /s -> n = 1 }\n";
    let study = understood(scenario, &properties);
    let mut ticks: Vec<(String, u64)> = Vec::new();
    for world in &study.worlds {
        let value = world.settings.first().map_or("1", |(_, value)| value.as_str());
        ticks.push((value.to_owned(), world.scenario.horizon.0));
    }
    let expected: Vec<(String, u64)> =
        [1].iter().chain(&rates).map(|r| (r.to_string(), 1_000_000_000 * r)).collect();
    assert_eq!(ticks, expected);
}

#[test]
fn more_people_than_there_are_numbers_are_refused() {
    let doors = |count: usize| -> String {
        let door = |k: usize| {
            format!(
                "source s{k}: adult {{ at = uniform in hall; every = exponential(0.01 s); route = hall; limit = 1 }}\n"
            )
        };
        THREE.replace("horizon = 2 s", "horizon = 6000 s") + &(0..count).map(door).collect::<String>()
    };
    let study = understood(&doors(4), "");
    let mut taken: Vec<(u32, u32)> = study.worlds[0]
        .scenario
        .sources
        .iter()
        .map(|source| (study.worlds[0].scenario.agents[source.members[0].0 as usize].entity, source.most))
        .collect();
    taken.sort_unstable();
    assert!(taken.iter().all(|(_, most)| *most == 1 << 20), "{taken:?}");
    assert!(taken.windows(2).all(|pair| pair[0].0 + pair[0].1 <= pair[1].0), "{taken:?}");
    refused(&doors(17), "", "E0913");
}

/// In a thread with as much room as the program has.
fn with_room(test: impl FnOnce() + Send + 'static) {
    std::thread::Builder::new().stack_size(256 << 20).spawn(test).unwrap().join().unwrap();
}

#[test]
fn functions_through_hundreds_of_others_are_too_deep_only_for_who_calls_them() {
    with_room(|| {
        let chain: String = (1..=900).rev().map(|k| format!("let f{k}(a) = f{}(a) + 1 m\n", k - 1)).collect();
        let scenario = format!("{THREE}{chain}let f0(a) = distance(a, me)\n");
        understood(&scenario, "estimate P(f5(crowd[1]) > 6 m)");
        refused(&scenario, "estimate P(f900(crowd[1]) > 6 m)", "E0211");
        let circle = scenario.replace("let f0(a) = distance(a, me)", "let f0(a) = f3(a)");
        refused(&circle, "", "E0205");
    });
}

#[test]
fn what_functions_repeat_grows_only_within_reason() {
    fn nested(times: usize, before: &str, inner: &str, after: &str) -> String {
        format!("{}{inner}{}", before.repeat(times), after.repeat(times))
    }
    with_room(|| {
        let double = |times| {
            format!("let f(v) = v + v\nestimate P({} > 1 m/s)", nested(times, "f(", "speed(me)", ")"))
        };
        let long = |times| {
            let sum = " + 1 m/s".repeat(500);
            format!("let f(v) = v{sum}\nestimate P({} > 1 m/s)", nested(times, "f(", "speed(me)", ")"))
        };
        let norm =
            |times| format!("estimate P({} > 1 m/s)", nested(times, "norm((", "speed(me)", ", 1 m/s))"));
        let distance = |times| {
            let far = nested(times, "distance((1 m, 1 m) * ", "(x(me) / 1 m)", ", me) / 1 m");
            format!("estimate P({far} > 1)")
        };
        let constants = |times| {
            let all: String = (1..=times).map(|k| format!("let c{k} = c{} + c{}\n", k - 1, k - 1)).collect();
            format!("let c0 = speed(me)\n{all}estimate P(c{times} > 1 m/s)")
        };
        for (text, code) in
            [(double(12), ""), (long(7), ""), (norm(8), ""), (distance(8), ""), (constants(8), "")]
                .into_iter()
                .chain(
                    [double(27), long(100), norm(40), distance(40), constants(40)]
                        .map(|text| (text, "E0211")),
                )
        {
            let (study, found) = compiled(THREE, &text);
            let start: String = text.chars().take(40).collect();
            if code.is_empty() {
                assert!(study.is_some(), "{start}\n{found}");
            } else {
                assert_eq!(found.matches("error[").count(), 1, "{start}\n{found}");
                assert!(found.contains("error[E0211]"), "{start}\n{found}");
            }
        }
    });
}

#[test]
fn headings_without_number_are_refused() {
    for to in ["1e30", "1000000000000000000000", "1001"] {
        let moves = format!("{THREE}moves me for 1 s {{ heading from 0 deg to {to} deg by 1 deg }}");
        let (study, found) = compiled(&moves, "");
        assert!(study.is_none() && found.contains("the moves have more than 1000 options"), "{to}\n{found}");
    }
}

#[test]
fn after_many_unknown_names_nobody_guesses_what_they_mean() {
    let properties: String = (0..150u8)
        .map(|k| {
            let (a, b) = (char::from(b'a' + k / 26), char::from(b'a' + k % 26));
            format!("property p{k} = crowd{a}{b} in hall\n")
        })
        .collect();
    let (study, found) = compiled(THREE, &properties);
    assert!(study.is_none());
    assert_eq!(found.matches("error[E0201]").count(), 150, "{found}");
    assert_eq!(found.matches("did you mean `crowd`?").count(), 100, "{found}");
}

#[test]
fn states_of_many_processes_are_walked_as_far_as_they_fit() {
    // 2^17 joint states of a thousand variables would be a gigabyte.
    let wide = "horizon = 100000 steps\n\
        process coin[17] { var n: 0..1 = 0; when true -> 1/2: n = 0 | 1/2: n = 1 }\n\
        process still[983] { var k: 0..1 = 0; when k == 0 -> k = 1 }\n";
    understood(wide, "estimate P(F<=3 coin[1].n == 1)");
    // Fewer are walked to where it goes wrong.
    let wrong = "horizon = 10 steps\n\
        process coin[2] { var n: 0..1 = 0; when true -> 1/2: n = 0 | 1/2: n = 1 }\n\
        process still[900] { var k: 0..1 = 0; when k == 0 -> k = 1 }\n\
        process late { var n: 0..5 = 0; when true -> n = n + 1 }\n";
    refused(wrong, "", "E0903");
    // How far depends on what there is to compute in a state.
    let sum = |copies: usize| {
        format!(
            "horizon = 100000 steps\nprocess p[{copies}] {{ var n: 0 .. 1000 = 0; let all = sum(q.n for q in p)\n\
             when all >= 0 -> n = n + 1 }}\n"
        )
    };
    understood(&sum(300), "");
    refused(&sum(30), "", "E0903");
}

#[test]
fn many_copies_of_many_processes_are_understood() {
    let one = |k| format!("process p{k}[1000] {{ var n: 0 .. 1 = 0; when n == 0 -> n = 1 }}\n");
    understood(&format!("horizon = 10 steps\n{}", (0..40).map(one).collect::<String>()), "");
}

#[test]
fn what_never_changes_may_be_a_constant() {
    let properties = "const way = (distance(hall, (12, 3)), 1 m)\nconst base = position((1, 1))\n\
        const size = if(distance(hall, (12, 3)) > 1 m, 1, 2)\nconst inside = (3, 3) in hall\n\
        const far = distance(hall, (12, 3)) > 1 m\n\
        estimate P(F<=1 s (distance(me, way) < 1 m & distance(me, base) < size * 1 m & inside & far))\n";
    understood(THREE, properties);
    // In a fold it is the same for each.
    understood(
        THREE,
        &format!("{properties}estimate P(sum(size for a in crowd) > 1 & count(a in crowd: far) > 1)\n"),
    );
    for changing in
        ["if(me in hall, 1, 2)", "(radius(me), 1 m)", "me in hall", "centroid(crowd) in hall", "x(me) > 1 m"]
    {
        refused(THREE, &format!("const c = {changing}\n"), "E0304");
    }
}

#[test]
fn names_of_a_process_are_known_before_it_where_they_do_not_change() {
    let scenario = "horizon = 10 steps\nprocess a { var n: 0 .. 5 = b.k; when n < 5 -> n = n + 1 }\n\
        process b { let k = 2; var m: 0 .. 5 = 1 }\n";
    let study = understood(scenario, "");
    assert_eq!(study.worlds[0].scenario.processes.variables[0].initial, 2.0);
    // A constant is meant where a variable takes its first value from one of its name.
    let scenario =
        "horizon = 10 steps\nconst n = 3\nprocess a { var n: 0 .. 5 = n; when n < 5 -> n = n + 1 }\n";
    assert_eq!(understood(scenario, "").worlds[0].scenario.processes.variables[0].initial, 3.0);
}

#[test]
fn what_is_known_now_is_computed_now() {
    let scenario = "scenario \"k\"\nhorizon = 2 s\nstep = 0.1 s\nconst k = modulo(7, 2)\nconst j = if(k > 0, 2, 3)\n\
        scene { point base: (1, 1); region hall: circle (base * 2 - (1, 0)) radius norm((3, 4)) }\n\
        kind adult: sfm preset helbing2000\n\
        agent me: adult { at = base + (1, 0); route = hall }\n\
        agent far: adult { at = (base + (7, 3)) / 2; route = hall }\n\
        agents crowd[j]: adult { at = uniform in hall; route = hall }\n\
        agents more[distance(base, (4, 5)) / 1 m]: adult { at = uniform in hall; route = hall }\n\
        moves me for 1 s { heading atan2(1, 1) }\n";
    let study = understood(scenario, "");
    let scenario = &study.worlds[0].scenario;
    let places: Vec<&Position> = scenario.agents.iter().take(2).map(|agent| &agent.start.position).collect();
    assert_eq!(places, [&Position::Point(Vec2::new(2.0, 1.0)), &Position::Point(Vec2::new(4.0, 2.0))]);
    assert_eq!(scenario.agents.len(), 2 + 2 + 5);
    assert_eq!(
        scenario.scene.regions[0].shape,
        smc::base::geometry::Shape::Circle { centre: Vec2::new(1.0, 2.0), radius: 5.0 }
    );
    let (_, Move::Heading(angle)) = scenario.moves[0].options[1] else { panic!("{:?}", scenario.moves) };
    assert!((angle - std::f64::consts::FRAC_PI_4).abs() < 1e-15, "{angle}");
    for (wrong, code) in [
        ("const z = modulo(1, 0)", "E0405"),
        ("scene { point a: ((1, 1) + (1 s, 1 s)) }", "E0303"),
        ("scene { point a: ((1, 1) / 0) }", "E0405"),
        (
            "scene { point a: ((1e30, 1) * (1e30 * 1e30 * 1e30 * 1e30 * 1e30) * (1e30 * 1e30 * 1e30 * 1e30 * 1e30)) }",
            "E0405",
        ),
    ] {
        let scenario = format!(
            "scenario \"k\"\nhorizon = 2 s\nstep = 0.1 s\n{wrong}\nkind adult: sfm preset helbing2000\nagent me: adult {{ at = (1, 1) }}\n"
        );
        refused(&scenario, "estimate P(x(me) > 1 m)", code);
    }
}

#[test]
fn a_behaviour_may_be_called_as_a_coordinate() {
    let scenario = THREE.replace(
        "agents crowd[2]: adult {",
        "behaviour x { state one { after 0.3 s -> two }; state two { } }\nagents crowd[2]: adult with x {",
    );
    for formula in ["crowd[1].x == two", "exists a in crowd: a.x == two", "position(crowd[1]).x > 1 m"] {
        understood(&scenario, &format!("estimate P(F<=1 s ({formula}))"));
    }
}

#[test]
fn what_is_wrong_with_a_procedure_is_said_beside_a_wrong_formula() {
    let both = |query: &str, codes: [&str; 2]| {
        let (_, found) = compiled(THREE, query);
        assert!(codes.iter().all(|code| found.contains(&format!("error[{code}]"))), "{query}\n{found}");
    };
    both("check P(nobody in hall) >= 0.5 by nosuch(alpha = 0.1)", ["E0201", "E0603"]);
    both("estimate P(nobody in hall) confidence 10 %", ["E0201", "E0604"]);
    both("rank moves of somebody by P(F<=1 s (speed(me) > 1 s))", ["E0201", "E0303"]);
}

#[test]
fn what_is_checked_though_nobody_uses_it_refuses_nothing_sound() {
    // Names that stand for something else than the function of that name, in files, processes and behaviours.
    let head = THREE.replace("agent me: adult {", "agent me: adult with b {");
    for more in [
        // An expression of the name of a built-in function hides it nowhere.
        "let heading = 3 s\nlet f(a) = heading(a) < 1 rad\nbehaviour b { state s { after 1 s -> s } }\n",
        "process p {\n var n: 0 .. 5 = 0\n let area(k) = k * 2\n let f(k) = area(k) < 3\n when f(n) -> n = n\n}\n\
         behaviour b { state s { after 1 s -> s } }\n",
        "let distance(a, b) = 3\n\
         behaviour b { let near(a) = distance(self, a) < 4; state s { when near(me) -> t }; state t { } }\n",
        // A variable of a process has the name of a behaviour.
        "process desk { var b: 0 .. 5 = 0; when b < 5 -> b = b + 1 }\nlet long(d) = d.b == 5\n\
         behaviour b { state s { when contact(self) -> t }; state t { } }\n",
        // What conditions say hides no parameter of who has the behaviour.
        "scene { region A: rect (0, 0) .. (2, 2) }\n\
         behaviour b { let there = self in A; let at(x) = x in A; state s { when there & at(self) -> t }; state t { } }\n",
        // Nobody has it, and what it says of itself is sound.
        "agents nobody[0]: adult with c { at = uniform in hall }\n\
         behaviour c { let busy = self.c == on; state on { when busy -> off }; state off { } }\n\
         behaviour b { state s { after 1 s -> s } }\n",
        // A process has a function of the name that another function calls.
        "let f(x) = x\nprocess p { let f(x) = g(x); var n: 0 .. 3 = 0; when f(n) < 2 -> n = n }\nlet g(x) = f(x)\n\
         behaviour b { state s { after 1 s -> s } }\n",
        // Names without arguments may be called.
        "let now() = 2 s\nprocess p { var n: 0 .. 3 = 0; let top() = n + 1; when top() < 3 -> n = top() }\n\
         behaviour b { let t() = now(); state s { after t() -> s } }\n",
    ] {
        let scenario = format!("{head}{more}");
        let (study, found) =
            compiled(&scenario, "estimate P(F<=1 s (forall a in crowd: F<=0.5 s (speed(a) > 0.1 m/s)))\n");
        assert!(study.is_some() && !found.contains("error["), "{scenario}\n{found}");
    }
}

/// Ends in another unit are the same number, though doubles may differ in their last place.
#[test]
fn defaults_at_the_ends_of_their_ranges_are_legal() {
    for (range, value) in [
        ("0.7 m in 70 cm .. 1 m", 0.7),
        ("70 cm in 0 m .. 0.7 m", 0.7),
        ("0.07 m in 7 cm .. 7 cm", 0.07),
        ("-0.3 m in -30 cm .. 0 m", -0.3),
    ] {
        let more = format!("param w = {range}\nagent wide: adult {{ at = (5 m + w, 1 m) }}\n");
        let study = understood(&format!("{THREE}{more}"), "estimate P(F<=1 s (speed(me) > 1 m/s))\n");
        let agents = &study.worlds[0].scenario.agents;
        let wide = agents.iter().find(|agent| agent.name == "wide").expect(range);
        assert_eq!(wide.start.position, Position::Point(Vec2::new(5.0 + value, 1.0)), "{range}");
    }
    // Nothing is left out without a word.
    for more in
        ["param w = 0.7 m in 71 cm .. 1 m", "param w = 0.7 kg in 70 cm .. 1 m", "const z = 5 kg / (m * s)"]
    {
        let (study, found) = compiled(&format!("{THREE}{more}\n"), "");
        assert!(study.is_none() && found.contains("error["), "{more}\n{found}");
    }
}

#[test]
fn names_of_a_behaviour_hide_the_own_parameters() {
    let behaviour = "behaviour b { let speed = 0.25 m/s; state s { speed = speed } }\n";
    let scenario = THREE.replace("agent me: adult {", "agent me: adult with b {") + behaviour;
    let study = understood(&scenario, "estimate P(F<=1 s (speed(me) > 1 m/s))\n");
    let conduct = &study.worlds[0].scenario.behaviours.attached[0].conduct;
    let Amount::Computed(value) = &conduct.states[0].changes[0].1 else { panic!("{conduct:?}") };
    assert_eq!(*value, Num::Constant(0.25));
}

#[test]
fn doubled_functions_with_an_unknown_name_take_no_time() {
    let chain = |last: &str, join: &str| {
        let mut text = format!("let f0(x) = {last}\n");
        for k in 1..60 {
            let call = format!("f{}(x)", k - 1);
            text += &format!("let f{k}(x) = {}\n", join.replace('@', &call));
        }
        text + "check P(F<=1 s (f59(1 m) > 1 m)) >= 0.5\n"
    };
    for (last, join) in
        [("x", "g(@, @)"), ("x + y", "@ + @"), ("q(x)", "min(@, @)"), ("x + y", "if(@ > @, @, @)")]
    {
        let (study, found) = compiled(THREE, &chain(last, join));
        assert!(study.is_none(), "{join}");
        assert!(!found.contains("E0211") && found.matches("error[").count() <= 60, "{join}\n{found}");
    }
}
