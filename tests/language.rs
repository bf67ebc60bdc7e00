//! What the grammar accepts, and how it reads it.

use smc::model::parameter::Range;
use smc::model::{Kind, PARAMETERS, Parameter};
use smc::syntax::ast::{
    ExprKind, Item, Leg, PropertyItem, QueryKind, Ranked, SceneItem, ShapeExpr, Value, Values,
};
use smc::syntax::parse::{parse_properties, parse_scenario};
use smc::syntax::print::{format_properties, format_scenario};
use smc::syntax::render::render;
use smc::syntax::source::{Source, SourceId};

fn property_items(text: &str) -> Vec<PropertyItem> {
    let source = Source::new(SourceId(0), "a.bltl", text);
    let (file, said) = parse_properties(&source);
    assert!(said.is_empty(), "{}", render(&said, std::slice::from_ref(&source), false));
    let formatted = format_properties(&source).unwrap();
    let again = parse_properties(&Source::new(SourceId(0), "a.bltl", formatted)).0;
    assert_eq!(again.items.len(), file.items.len());
    file.items
}

fn scenario_items(text: &str) -> Vec<Item> {
    let source = Source::new(SourceId(0), "a.scn", text);
    let (file, said) = parse_scenario(&source);
    assert!(said.is_empty(), "{}", render(&said, std::slice::from_ref(&source), false));
    let formatted = format_scenario(&source).unwrap();
    let again = parse_scenario(&Source::new(SourceId(0), "a.scn", formatted)).0;
    assert_eq!(again.items.len(), file.items.len());
    file.items
}

/// The tree of an expression as nested calls.
fn shape(kind: &ExprKind) -> String {
    match kind {
        ExprKind::Quantity(q) => {
            let unit = q.unit.as_ref().map_or(String::new(), |unit| {
                unit.factors
                    .iter()
                    .fold(String::new(), |all, f| all + &format!(" {}^{}", f.name.name, f.power))
            });
            format!("{}{unit}", q.value)
        }
        ExprKind::Infinity => "∞".to_owned(),
        ExprKind::Broken => "broken".to_owned(),
        ExprKind::Bool(value) => value.to_string(),
        ExprKind::Text(text) => format!("{text:?}"),
        ExprKind::Name(name) => name.clone(),
        ExprKind::Member(of, name) => format!("{}.{}", shape(&of.kind), name.name),
        ExprKind::Index(of, at) => format!("{}[{}]", shape(&of.kind), shape(&at.kind)),
        ExprKind::Call { function, arguments } => {
            let arguments: Vec<_> = arguments.iter().map(|a| shape(&a.kind)).collect();
            format!("{}({})", function.name, arguments.join(", "))
        }
        ExprKind::Point { x, y, unit } => {
            format!("point({}, {}){}", shape(&x.kind), shape(&y.kind), if unit.is_some() { "u" } else { "" })
        }
        ExprKind::Unary(operator, body) => format!("{operator:?}({})", shape(&body.kind)),
        ExprKind::Binary(operator, a, b) => format!("{operator:?}({}, {})", shape(&a.kind), shape(&b.kind)),
        ExprKind::Quantified { quantifier, variable, set, body } => {
            format!("{quantifier:?}[{} in {}]({})", variable.name, shape(&set.kind), shape(&body.kind))
        }
        ExprKind::Temporal(operator, bound, body) => {
            format!("{operator:?}{}({})", bound_shape(bound.as_ref()), shape(&body.kind))
        }
        ExprKind::TemporalPair(operator, bound, a, b) => {
            format!("{operator:?}{}({}, {})", bound_shape(bound.as_ref()), shape(&a.kind), shape(&b.kind))
        }
        ExprKind::Window(fold, bound, body) => {
            format!("{fold:?}{}({})", bound_shape(Some(bound)), shape(&body.kind))
        }
        ExprKind::At(body, moment) => format!("At({}, {moment:?})", shape(&body.kind)),
    }
}

fn bound_shape(bound: Option<&smc::syntax::ast::Bound>) -> String {
    match bound {
        None => String::new(),
        Some(smc::syntax::ast::Bound::AtMost(end)) => format!("<={}", shape(&end.kind)),
        Some(smc::syntax::ast::Bound::Interval(a, b)) => format!("[{}, {}]", shape(&a.kind), shape(&b.kind)),
    }
}

fn read(text: &str) -> String {
    let source = Source::new(SourceId(0), "a.bltl", format!("property p_ = {text}"));
    let (file, said) = parse_properties(&source);
    assert!(
        said.iter().all(|d| d.code.is_of("W")),
        "{}",
        render(&said, std::slice::from_ref(&source), false)
    );
    match &file.items[..] {
        [PropertyItem::Property { formula, .. }] => shape(&formula.kind),
        other => panic!("{text}: {other:?}"),
    }
}

#[test]
fn precedence() {
    for (text, tree) in [
        ("a <=> b => c | d & e", "Iff(a, Implies(b, Or(c, And(d, e))))"),
        ("a => b => c", "Implies(a, Implies(b, c))"),
        ("a & b & c", "And(And(a, b), c)"),
        ("a & b U c & d", "And(And(a, Until(b, c)), d)"),
        ("a U b U c", "Until(a, Until(b, c))"),
        ("!a U b", "Until(Not(a), b)"),
        ("!a > b", "Not(Greater(a, b))"),
        ("F a in b", "Finally(In(a, b))"),
        ("G<=2 s a => b", "Implies(Globally<=2 s^1(a), b)"),
        ("forall a in s: p & q => r", "Forall[a in s](Implies(And(p, q), r))"),
        ("p & forall a in s: q | r", "And(p, Forall[a in s](Or(q, r)))"),
        ("a + b * c - d", "Minus(Plus(a, Times(b, c)), d)"),
        ("-a ^ 2 * b", "Times(Minus(Power(a, 2)), b)"),
        ("a ^ b ^ c", "Power(a, Power(b, c))"),
        ("min<=2 s x ^ 2 + 1", "Plus(Min<=2 s^1(Power(x, 2)), 1)"),
        ("F G X !p", "Finally(Globally(Next(Not(p))))"),
        ("a / b / c", "Over(Over(a, b), c)"),
        ("(a | b) & c", "And(Or(a, b), c)"),
    ] {
        assert_eq!(read(text), tree, "{text}");
    }
}

#[test]
fn units_belong_to_the_number_before_them() {
    for (text, tree) in [
        ("x > 0.2 /s * infected", "Greater(x, Times(0.2 s^-1, infected))"),
        ("x > 1 / s", "Greater(x, Over(1, s))"),
        ("x > 1/2", "Greater(x, Over(1, 2))"),
        ("x > 2.4e5 kg/(m s)", "Greater(x, 240000 kg^1 m^-1 s^-1)"),
        ("x > 3 kg/(m * s)", "Greater(x, 3 kg^1 m^-1 s^-1)"),
        ("x > 3 N*m", "Greater(x, 3 N^1 m^1)"),
        ("x > 3 N * m", "Greater(x, Times(3 N^1, m))"),
        ("x > 3 m /s", "Greater(x, 3 m^1 s^-1)"),
        ("x > 3 m/s/s", "Greater(x, 3 m^1 s^-1 s^-1)"),
        ("x > 3m^2", "Greater(x, 3 m^2)"),
        ("x > 3 s^-1", "Greater(x, 3 s^-1)"),
        ("x > 95 %", "Greater(x, 95 %^1)"),
        ("x > 3 m ^ 2", "Greater(x, Power(3 m^1, 2))"),
        ("x == (1, 2) m/s", "Equal(x, point(1, 2)u)"),
        ("F<=5 s.n == 3", "Finally<=5(Equal(s.n, 3))"),
        ("F<=5 p", "Finally<=5(p)"),
        ("F<=5 min(a, b) > 2", "Finally<=5(Greater(min(a, b), 2))"),
    ] {
        assert_eq!(read(text), tree, "{text}");
    }
}

#[test]
fn juxtaposed_units_are_a_product_only_in_parentheses() {
    let source = Source::new(SourceId(0), "a.bltl", "property p = x > 3 kg m");
    assert_eq!(parse_properties(&source).1.len(), 1);
}

#[test]
fn temporal_operators_and_their_bounds() {
    for (text, tree) in [
        ("F<=10 s p", "Finally<=10 s^1(p)"),
        ("F<=40 steps p", "Finally<=40 steps^1(p)"),
        ("F<=#40 p", "Finally<=40 steps^1(p)"),
        ("F<=T p", "Finally<=T(p)"),
        ("F<=T (p)", "Finally<=T(p)"),
        ("F<=(2 * T) p", "Finally<=Times(2, T)(p)"),
        ("F≤∞ p", "Finally<=∞(p)"),
        ("G[2 s, 5 s] p", "Globally[2 s^1, 5 s^1](p)"),
        ("G[#2, ∞] p", "Globally[2 steps^1, ∞](p)"),
        ("X<=#3 p", "Next<=3 steps^1(p)"),
        ("p U<=2 s q", "Until<=2 s^1(p, q)"),
        ("p R[0 s, 1 s] q", "Release[0 s^1, 1 s^1](p, q)"),
        ("p W q", "WeakUntil(p, q)"),
        ("¬p ∧ q ∨ r ⇒ x ≥ 3", "Implies(Or(And(Not(p), q), r), AtLeast(x, 3))"),
        ("mean[1 s, 2 s] (x) < 3", "Less(Mean[1 s^1, 2 s^1](x), 3)"),
        ("sum<=#4 x > 1", "Greater(Sum<=4 steps^1(x), 1)"),
        ("min(gap(a) for a in others(user)) > 0", "Greater(Fold(Min)[a in others(user)](gap(a)), 0)"),
        ("mean(speed(a) for a in c) > 0", "Greater(Fold(Mean)[a in c](speed(a)), 0)"),
        ("count(a in c: a in west) >= 10", "AtLeast(Count[a in c](In(a, west)), 10)"),
        ("count(a in c) >= 10", "AtLeast(Count[a in c](true), 10)"),
        ("exists a in people: a in goal", "Exists[a in people](In(a, goal))"),
        ("people[1] in goal", "In(people[1], goal)"),
        ("q[i + 1].n == 2", "Equal(q[Plus(i, 1)].n, 2)"),
    ] {
        assert_eq!(read(text), tree, "{text}");
    }
}

#[test]
fn queries_and_clauses() {
    let items = property_items(
        "family confidence 95 %\n\
         let f(a, b) = a - b; const T = 10 s\n\
         check P(safe) >= 0.5 by sprt(alpha = 0.01, beta = 0.01) under d = 0.2 /m^2, e = true\n\
         check E(x at end) in 0 m .. 3 m < 2 m confidence 99 % within 0.1 m\n\
         estimate P(a), E(b at 5 s) in 0 .. 5, Q(0.5, time_until(p)) confidence 95 % by default_one\n\
         compare P(safe) under d = 1, e = 2 with d = 2, e = 1 within 0.1\n\
         rank moves of people[1] by E(x) in 0 .. 1 within 0.02 confidence 95 %\n\
         rank a in 1 m .. 3 m by 0.5 m, b in 1, f(2, 1), c in P .. E by log 2 by P(x) by okamoto(epsilon = 0.1)",
    );
    assert_eq!(items.len(), 9);
    let queries: Vec<_> = items
        .iter()
        .filter_map(|item| if let PropertyItem::Query(query) = item { Some(query) } else { None })
        .collect();
    assert_eq!(queries.len(), 6);
    assert_eq!(queries[0].clauses.under.len(), 2);
    assert_eq!(queries[0].clauses.by.as_ref().unwrap().arguments.len(), 2);
    assert!(queries[1].clauses.within.is_some() && queries[1].clauses.confidence.is_some());
    assert!(matches!(&queries[2].kind, QueryKind::Estimate(measures) if measures.len() == 3));
    assert!(
        matches!(&queries[3].kind, QueryKind::Compare { first, second, .. } if first.len() == 2 && second.len() == 2)
    );
    assert!(
        matches!(&queries[4].kind, QueryKind::Rank { of: Ranked { moves, .. }, .. } if moves[0].0.name == "moves")
    );
    let QueryKind::Rank { of: Ranked { values: list, .. }, .. } = &queries[5].kind else {
        panic!("{:?}", queries[5])
    };
    let names: Vec<&str> = list.iter().map(|(name, _)| name.name.as_str()).collect();
    assert_eq!(names, ["a", "b", "c"]);
    assert!(matches!(&list[0].1, Values::Range { log: false, .. }));
    assert!(matches!(&list[1].1, Values::List(values) if values.len() == 2));
    assert!(matches!(&list[2].1, Values::Range { log: true, .. }));
    assert!(queries[5].clauses.by.is_some());
}

#[test]
fn scenes_and_values() {
    let items = scenario_items(
        "scene {\n\
           point door: (3, 4)\n\
           wall (0, 0) -- (1, 0) m -- door\n\
           obstacle polygon (0, 0) (9, 0) (9, 9) hole (1, 1) (2, 1) (2, 2) hole (4, 4) (5, 4) (5, 5)\n\
           line exit: (9, 1) -- door\n\
           import \"hall.geojson\" where source == \"map.png\" & !(layer != 3)\n\
         }\n\
         agents a[3]: adult { at = near user within 2 m; route = door -> wait exponential(3 s) in 1 s .. 9 s -> exit then leave }\n\
         agent b: adult with phone, heedful(0.8) { at = uniform in circle (1, 2) radius 1.5 m; route = exit then leave }\n\
         agent c: adult from hotel at 6.8 s id 3 with phone\n\
         group friends[2]: adult as particle with phone { route = (1, 2) }",
    );
    let Item::Scene(scene) = &items[0] else { panic!("{items:?}") };
    assert!(matches!(&scene[0], SceneItem::Point { name, .. } if name.name == "door"));
    assert!(matches!(&scene[1], SceneItem::Wall { points, .. } if points.len() == 3));
    assert!(
        matches!(&scene[2], SceneItem::Obstacle { shape: ShapeExpr::Polygon { holes, .. }, .. } if holes.len() == 2)
    );
    assert!(matches!(&scene[3], SceneItem::Line { name, .. } if name.name == "exit"));
    assert!(matches!(&scene[4], SceneItem::Import { filter: Some(_), .. }));
    let Item::Agents(agents) = &items[1] else { panic!("{items:?}") };
    assert!(matches!(&agents.body[0].value, Value::Near { .. }));
    let Value::Route(route) = &agents.body[1].value else { panic!("{agents:?}") };
    assert!(route.then_leave.is_some() && route.legs.len() == 3);
    assert!(matches!(&route.legs[1], Leg::Wait(value) if matches!(**value, Value::Truncated { .. })));
    let Item::Agents(agents) = &items[2] else { panic!("{items:?}") };
    assert_eq!(agents.with.len(), 2);
    assert!(matches!(&agents.body[0].value, Value::UniformIn(ShapeExpr::Circle { .. })));
    assert!(matches!(&items[3], Item::Agents(a) if a.recorded.is_some() && a.with.len() == 1));
    assert!(
        matches!(&items[4], Item::Group(g) if g.particle.is_some() && matches!(g.body[0].value, Value::Plain(_)))
    );
}

#[test]
fn processes() {
    let items = scenario_items(
        "process q[3] {\n\
           var n: 0 .. 5 = 0; var on: bool = n > 0 & true; var x: real = 1 m / 2\n\
           let busy = n > 0 | on; label full = n == 5; choose\n\
           when busy & n < 5 at 1 /s -> 1: { n = n + 1; on = (n > 2 | on) } | 2: { }\n\
           when full after uniform(1 s, 2 s) in 1 s .. 3 s -> n = 0\n\
           when true -> 1 - 1/3: n = 1 | 1/3: { n = 2, on = false }\n\
         }",
    );
    let Item::Process(process) = &items[0] else { panic!("{items:?}") };
    assert_eq!(process.items.len(), 9);
}

#[test]
fn names_that_are_words_elsewhere() {
    let items = scenario_items(
        "const F = 2 N\nconst X = 3\nparam U = F * X\nkind k: sfm { state = 1; when = 2; in = 3; step = 4; kind = 5 }\n\
         process p { var G: 0 .. 3 = 0\n when G <= X & F > 2 N -> G = X - 1 }",
    );
    assert_eq!(items.len(), 5);
}

#[test]
fn items_end_with_their_lines() {
    for (count, text) in [
        (3, "horizon = 30 s\nstep = 0.02 s; const a = 1"),
        (1, "horizon = 30 s"),
        // An operator or mark at either end of a line, a bracket that is open, and a word that only continues.
        (1, "horizon =\n\n  // thirty\n  30 s"),
        (2, "const a = 1 +\n2\nconst b = a\n- 1"),
        (1, "let a = max(1,\n2\n)"),
        (1, "let a = user in\nhall"),
        (1, "agent a: k from t\nat 3 s\nid 4\nwith b"),
        (1, "kind k: sfm\n\n{\nradius = 0.3 m\nby = 3 }"),
        (2, "moves a\nfor 2 s { stop }\nconst by = 3"),
        (2, "scene {\nwall (0, 0) -- (1, 1)\n-- (2, 2)\nobstacle circle (1, 1)\nradius 2 m }\nlet b = 3"),
        (1, "process p {\nvar n = 1\nwhen n == 1 ->\nn = 2\nwhen n == 2 -> 1/2:\nn = 3 | 1/2:\nn = 4 }"),
        (1, "process p {\nvar n = 1\nwhen n == 1\nat 2 /s -> 1/2: { n = 2; n = 3 }\n| 1/2: n = 3 }"),
    ] {
        assert_eq!(scenario_items(text).len(), count, "{text}");
    }
    for (count, text) in [
        (
            2,
            "property a = F<=2 s p\nU q\ncheck P(a)\n>= 0.5\nconfidence 95 %\nby sprt(alpha = 0.1,\nbeta = 0.1)",
        ),
        (1, "property a = G<=2 s\n(p & q)"),
        (1, "compare P(a)\nunder n = 1\nwith n = 2\nwithin 0.1"),
        (2, "estimate P(a),\nP(b); estimate P(c)"),
    ] {
        assert_eq!(property_items(text).len(), count, "{text}");
    }
    for text in ["horizon = 3 s step = 1 s", "kind k: sfm { mass = 80 kg radius = 0.3 m }"] {
        let (_, said) = parse_scenario(&Source::new(SourceId(0), "a.scn", text));
        assert_eq!(said.len(), 1, "{text}");
        assert!(
            said[0].hint.as_ref().is_some_and(|hint| hint.starts_with("write `;`")),
            "{text}: {:?}",
            said[0]
        );
    }
}

#[test]
fn the_manual_has_the_table_of_parameters() {
    let root = env!("CARGO_MANIFEST_DIR");
    let read = |path: &str| std::fs::read_to_string(format!("{root}/{path}")).unwrap();
    let manual = read("docs/walkers.md");
    let cell = |text: &str| if text.is_empty() { " ".to_owned() } else { format!(" {text} ") };
    for kind in [Kind::Sfm, Kind::Cfs] {
        let mut table =
            "| field | unit | range | unless set | meaning |\n| --- | --- | --- | --- | --- |\n".to_owned();
        for row in PARAMETERS.iter().filter(|row| row.kinds.contains(&kind)) {
            let range = match row.range {
                Range::Positive => "above 0",
                Range::NotNegative => "0 or above",
                Range::Share => "0 to 1",
                Range::Pieces => "2 to 64",
            };
            let default = row.default.map_or(String::new(), |value| value.to_string());
            let cells =
                [format!("`{}`", row.name), row.parameter.unit(), range.into(), default, row.meaning.into()];
            table += &format!("|{}|\n", cells.map(|text| cell(&text)).join("|"));
        }
        assert!(manual.contains(&table), "docs/walkers.md should have\n{table}");
    }
    let changeable = Parameter::changeable().map(Parameter::name).collect::<Vec<_>>().join(", ");
    for page in [manual, read("docs/errors/E0911.md")] {
        let words = page.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains(&changeable), "the list is {changeable}");
    }
}
