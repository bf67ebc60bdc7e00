//! The table of the spellings of other languages: patterns of marks, words and holes, and their replacements.

/// The file that a spelling is looked for in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum In {
    Both,
    Properties,
    Scenario,
}
pub(super) use In::{Both, Properties, Scenario};

/// A spelling: file, language, pattern, replacement. In place of the language may stand a whole title, with `{}` for
/// what was found.
///
/// `$` and a letter is a hole: `$n` a number, `$t` a time, `$w` a name with its members, `$q` a quoted text, `$r` a
/// relation, `$o` a temporal operator, `$p` a weight, `$y` a type, `$l` the rest of the line, `$e` any text with even
/// brackets, `$u` such updates, `$c` such a condition, in which `=` compares; digits tell holes apart. `@` is the place of the error;
/// the text before it is context. A replacement `…` is not read, and one that starts with a blank is advice.
pub(super) type Row = (In, &'static str, &'static str, &'static str);

/// Titles of several rows.
const QUERY: &str = "a query starts with `check` or `estimate`, found `{}`";
const ONE_SET: &str = "a quantifier needs one set, found `{}`";
const MOMENT: &str = "`at` must apply to the whole metric of `E(…)` or `Q(…)`";
const ENDS: &str = "a comma must separate the ends of an interval, found `{}`";
const UPDATE: &str = "an update needs `=`, found `{}`";

/// The forms of other languages.
#[rustfmt::skip]
pub(super) const FORMS: &[Row] = &[
    // Queries.
    (Properties, "PRISM", "P $r $n [ $c ]", "check P($c) $r $n"),
    (Properties, "PRISM", "check P $r $n [ $c ]", "check P($c) $r $n"),
    (Properties, "PRISM", "estimate P = ? [ $c ]", "estimate P($c)"),
    (Properties, "PRISM", "P = ? [ $c ]", "estimate P($c)"),
    (Properties, "PRISM", "Pmax = ? [ $c ]", "estimate P($c)"),
    (Properties, "PRISM", "Pmin = ? [ $c ]", "estimate P($c)"),
    (Properties, "PRISM", "R { $q } = ? [ C <= $n ]", "estimate E(sum<=$n ($q)) in … .. …"),
    (Properties, "PRISM", "R { $q } = ? [ $e ]", "estimate E(sum<=… ($q)) in … .. …"),
    (Properties, "PRISM", "R = ? [ $e ]", "estimate E(sum<=… (…)) in … .. …"),
    (Properties, "PRISM", "S = ? [ $c ]", "estimate E(mean<=10 s (if($c, 1, 0))) in 0 .. 1"),
    (Properties, "UPPAAL", "Pr [ <= $t ] ( < > $e ) $r $n", "check P(F<=$t ($e)) $r $n"),
    (Properties, "UPPAAL", "Pr [ <= $t ] ( [ ] $e ) $r $n", "check P(G<=$t ($e)) $r $n"),
    (Properties, "UPPAAL", "Pr [ <= $t ] ( < > $e )", "estimate P(F<=$t ($e))"),
    (Properties, "UPPAAL", "Pr [ <= $t ] ( [ ] $e )", "estimate P(G<=$t ($e))"),
    (Properties, "UPPAAL", "E [ <= $t ; $n ] ( max : $e )", "estimate E(max<=$t ($e)) in … .. …"),
    (Properties, "UPPAAL", "E [ <= $t ; $n ] ( min : $e )", "estimate E(min<=$t ($e)) in … .. …"),
    (Properties, "UPPAAL", "A [ ] $e", "check P(G ($e)) >= 0.99"),
    (Properties, "UPPAAL", "A < > $e", "check P(F ($e)) >= 0.99"),
    (Properties, "UPPAAL", "E < > $e", "check P(F ($e)) > 0.01"),
    (Properties, "UPPAAL", "E [ ] $e", "check P(G ($e)) > 0.01"),
    (Properties, "UPPAAL", "simulate [ $e1 ] { $e2 }", " `smc simulate` runs trials and writes their states"),
    (Properties, "the threshold must follow `P(…)`, found `{}`", "check P @ $r $n ( $e )", "check P($e) $r $n"),
    (Properties, QUERY, "P ( $e ) $r $n", "check P($e) $r $n"),
    (Properties, QUERY, "P ( $e )", "estimate P($e)"),
    (Properties, QUERY, "maximize P ( $e1 ) over $w in $e2 .. $l", "rank $w in $e2 .. $l by 1 by P($e1)"),
    (Properties, QUERY, "maximise P ( $e1 ) over $w in $e2 .. $l", "rank $w in $e2 .. $l by 1 by P($e1)"),
    (Properties, QUERY, "minimize P ( $e1 ) over $w in $e2 .. $l", "rank $w in $e2 .. $l by 1 by P(!($e1))"),
    (Properties, QUERY, "minimise P ( $e1 ) over $w in $e2 .. $l", "rank $w in $e2 .. $l by 1 by P(!($e1))"),
    (Properties, QUERY, "maximize P ( $e )", " a ranking finds the best option: `rank moves of robot by P($e)`"),
    (Properties, QUERY, "maximise P ( $e )", " a ranking finds the best option: `rank moves of robot by P($e)`"),
    (Properties, QUERY, "assert P ( $e ) $r $n", "check P($e) $r $n"),
    (Properties, QUERY, "probability ( $e )", "estimate P($e)"),
    (Properties, "a probability is asked with `P(…)`, found `{}`", "check @ $w", "check P($w) >= 0.9"),
    (Properties, "a probability is asked with `P(…)`, found `{}`", "estimate @ $w", "estimate P($w)"),
    (Properties, "a mean is asked with `E(…)`, found `{}`", "estimate @ mean ( $e )", "estimate E($e) in … .. …"),
    (Properties, "a number must have a decimal point, found `{}`", "check P ( $e ) $r $n1 @ , $n2", "check P($e) $r $n1.$n2"),
    (Properties, QUERY, "Q ( $e1 , $e2 )", "estimate Q($e1, $e2)"),
    (Properties, QUERY, "E ( $e )", "estimate E($e)"),
    (Properties, "a ranking needs `P(…)`, `E(…)` or `Q(…)`, found `{}`", "rank moves of $w1 by @ $w2", "rank moves of $w1 by P($w2)"),
    // Formulas.
    (Properties, "expected `=`, found `{}`", "property $w @ : $l", "property $w = $l"),
    (Both, "expected a name and `in`, found `{}`", "forall @ $w ( $e ) :", "forall a in $w($e):"),
    (Both, "expected a name and `in`, found `{}`", "exists @ $w ( $e ) :", "exists a in $w($e):"),
    (Both, "expected a name and `in`, found `{}`", "forall @ $w :", "forall a in $w:"),
    (Both, "expected a name and `in`, found `{}`", "exists @ $w :", "exists a in $w:"),
    (Properties, MOMENT, "at end $r", " for a condition write `F[T, T] (…)` with the horizon for T"),
    (Properties, MOMENT, "at $t $r", " for a condition write `F[$t, $t] (…)`"),
    (Properties, "UPPAAL", "= $e1 @ -- > $e2", "= G ($e1 => F ($e2))"),
    (Properties, "LTL", "< > _ [ $t1 , $t2 ]", "F[$t1, $t2]"),
    (Properties, "LTL", "< > [ $t1 , $t2 ]", "F[$t1, $t2]"),
    (Properties, "LTL", "[ ] _ [ $t1 , $t2 ]", "G[$t1, $t2]"),
    (Properties, "LTL", "[ ] [ $t1 , $t2 ]", "G[$t1, $t2]"),
    (Properties, "LTL", "< > $e", "F $e"),
    (Properties, "LTL", "[ ] $e", "G $e"),
    (Properties, "STL", "F_ [ $t1 , $t2 ]", "F[$t1, $t2]"),
    (Properties, "STL", "G_ [ $t1 , $t2 ]", "G[$t1, $t2]"),
    (Properties, "STL", "U_ [ $t1 , $t2 ]", "U[$t1, $t2]"),
    (Properties, "STL", "ev_ [ $t1 , $t2 ]", "F[$t1, $t2]"),
    (Properties, "STL", "alw_ [ $t1 , $t2 ]", "G[$t1, $t2]"),
    (Properties, "STL", "eventually [ $t1 , $t2 ]", "F[$t1, $t2]"),
    (Properties, "STL", "always [ $t1 , $t2 ]", "G[$t1, $t2]"),
    (Properties, "LTL", "eventually $e", "F $e"),
    (Properties, "LTL", "finally $e", "F $e"),
    (Properties, "LTL", "always $e", "G $e"),
    (Properties, "LTL", "globally $e", "G $e"),
    (Properties, "LTL", "until", "U"),
    (Properties, "an interval needs two ends, found `{}`", "$o @ [ $t ]", "$o<=$t"),
    (Properties, ENDS, "$o @ [ $t1 : $t2 ]", "$o[$t1, $t2]"),
    (Properties, ENDS, "$o @ [ $t1 - $t2 ]", "$o[$t1, $t2]"),
    (Properties, "a bound has no brackets, found `{}`", "$o @ <= { $t }", "$o<=$t"),
    (Properties, "a bound has no brackets, found `{}`", "$o @ [ <= $t ]", "$o<=$t"),
    (Properties, "an interval must be in `[` and `]`, found `{}`", "$o @ { $t1 , $t2 }", "$o[$t1, $t2]"),
    (Properties, "a bound has no brackets, found `{}`", "$o @ { <= $t }", "$o<=$t"),
    (Both, "UPPAAL", "forall @ ( $w1 : $w2 )", "forall $w1 in $w2:"),
    (Both, "UPPAAL", "exists @ ( $w1 : $w2 )", "exists $w1 in $w2:"),
    (Both, "the set of all agents is `everyone`, found `{}`", "all agents", "everyone"),
    (Both, ONE_SET, "forall $w1 in $w2 @ , $w3 : $e", "(forall $w1 in $w2: $e) & (forall $w1 in $w3: $e)"),
    (Both, ONE_SET, "exists $w1 in $w2 @ , $w3 : $e", "(exists $w1 in $w2: $e) | (exists $w1 in $w3: $e)"),
    (Both, "Python", "= $e1 @ if $e2 else $e3", "= if($e2, $e1, $e3)"),
    (Both, "MATLAB", "~ =", "!="),
    // Comments.
    (Both, "Python", "# $l", "// $l"),
    (Both, "MATLAB", "% $l", "// $l"),
    // Declarations.
    (Scenario, "PRISM", "dtmc", " remove it: commands without rates make steps"),
    (Scenario, "PRISM", "ctmc", " remove it: commands with rates (`at 1 /s`) run in continuous time"),
    (Scenario, "PRISM", "mdp", " remove it: `choose` draws one of the enabled commands, all equally likely"),
    (Scenario, "PRISM", "module $w", "process $w { … }"),
    (Scenario, "PRISM", "rewards $q", " remove it: a query sums a number, `estimate E(sum<=10 steps (…)) in 0 .. 10`"),
    (Both, "PRISM", "const @ $y $w = $e", "const $w = $e"),
    (Both, "PRISM", "formula $w = $c", "let $w = $c"),
    (Properties, "PRISM", "label $q = $c", "property $q = $c"),
    (Scenario, "PRISM", "label @ $q = $c", "label $q = $c"),
    (Scenario, "PRISM", "$w : [ $e1 .. $e2 ] init $e3", "var $w: $e1 .. $e2 = $e3"),
    (Scenario, "PRISM", "var $w : @ [ $e1 .. $e2 ] init $e3", "var $w: $e1 .. $e2 = $e3"),
    (Scenario, "a range has no brackets, found `{}`", "var $w : @ [ $e1 .. $e2 ]", "var $w: $e1 .. $e2"),
    (Scenario, "PRISM", "[ ] $c -> $u", "when $c -> $u"),
    (Scenario, "PRISM", "[ $w ] $c -> $u", "when $c -> $u"),
    (Scenario, "PRISM", "$p : $u1 @ + $p2 : $u2", "$p: $u1 | $p2: $u2"),
    (Scenario, "PRISM", "( $w1 ' = $e1 ) & ( $w2 ' = $e2 )", "{ $w1 = $e1; $w2 = $e2 }"),
    (Scenario, "PRISM", "( $w ' = $e )", "$w = $e"),
    (Scenario, "UPPAAL", "int [ $e1 , $e2 ] $w = $e3", "var $w: $e1 .. $e2 = $e3"),
    (Scenario, "UPPAAL", "int $w = $e", "var $w: 0 .. 10 = $e"),
    (Scenario, "UPPAAL", "bool $w = $e", "var $w = $e"),
    (Scenario, "UPPAAL", "$y $w = $e", "var $w: real = $e"),
    (Scenario, "UPPAAL", "clock $w", " a process has no clocks: write `when … after 3 s -> …` to wait for a time"),
    (Scenario, UPDATE, "$w @ + = $e", "$w = $w + $e"),
    (Scenario, UPDATE, "$w @ - = $e", "$w = $w - $e"),
    (Scenario, UPDATE, "$w @ + +", "$w = $w + 1"),
    (Scenario, UPDATE, "$w @ --", "$w = $w - 1"),
    (Scenario, "Python", "$w ( @ $w1 = $e1 , $w2 = $e2 )", "$w($e1, $e2)"),
    (Scenario, "Python", "$w ( @ $w1 = $e1 )", "$w($e1)"),
    (Scenario, "Python", "= @ [ $e1 , $e2 ]", "= ($e1, $e2)"),
    (Scenario, "the number of agents must follow their name, found `{}`", "agents @ $n $w : $w2", "agents $w[$n]: $w2"),
    (Scenario, "goals must be joined by `->`, found `{}`", "route = $w1 @ , $w2", "route = $w1 -> $w2"),
    (Scenario, "a number must have a decimal point, found `{}`", "= $n1 @ , $n2", "= $n1.$n2"),
    (Scenario, "a parameter has no type, found `{}`", "param $w @ : $y = $e", "param $w = $e"),
    (Scenario, "expected `..` and the opposite corner, found `{}`", "rect ( $e1 , $e2 ) @ size ( $e3 , $e4 )", "rect ($e1, $e2) .. ($e1 + $e3, $e2 + $e4)"),
    (Scenario, "expected `in`, found `{}`", "uniform @ $w", "uniform in $w"),
    (Scenario, "expected `--` between points, found `{}`", "( $e1 , $e2 ) @ , ( $e3 , $e4 )", "($e1, $e2) -- ($e3, $e4)"),
    (Scenario, "expected `--` between points, found `{}`", "( $e1 , $e2 ) @ -> ( $e3 , $e4 )", "($e1, $e2) -- ($e3, $e4)"),
    (Scenario, "expected points joined by `--`, found `{}`", "wall @ [ ( $e1 , $e2 ) , ( $e3 , $e4 ) ]", "wall ($e1, $e2) -- ($e3, $e4)"),
    (Scenario, "a line has a name, and a wall is `wall`: found `{}`", "line ( $e1 , $e2 ) -- ( $e3 , $e4 )", "wall ($e1, $e2) -- ($e3, $e4)"),
    (Scenario, "a rectangle needs two corners, found `{}`", "rect ( $e1 , $e2 @ , $e3 , $e4 )", "rect ($e1, $e2) .. ($e1 + $e3, $e2 + $e4)"),
    (Scenario, "expected `:` before the shape, found `{}`", "region $w @ = $l", "region $w: $l"),
    (Scenario, "an exit is a region, found `{}`", "exit $w : $l", "region $w: $l"),
    (Scenario, "an agent is declared with `agent`, found `{}`", "robot $w1 : $w2", "agent $w1: $w2 { … }"),
    (Scenario, "an agent is declared with `agent`, found `{}`", "person $w1 : $w2", "agent $w1: $w2 { … }"),
    (Scenario, "an agent is declared with `agent`, found `{}`", "pedestrian $w1 : $w2", "agent $w1: $w2 { … }"),
    (Scenario, "the number of agents stands in brackets, found `{}`", "agents $w : @ $n $w2", "agents $w[$n]: $w2"),
    (Scenario, "a parameter is declared with `param`, found `{}`", "$y $w = $e", "param $w = $e"),
    (Both, "a name has no type, found `{}`", "let $w @ : $y = $e", "let $w = $e"),
    (Scenario, "moves need a time, found `{}`", "moves $w @ { $e }", "moves $w for 2 s { … }"),
    (Scenario, "expected a quoted text, found `{}`", "import @ $w", "import \"$w\""),
];

/// Operators of other languages.
#[rustfmt::skip]
pub(super) const OPERATORS: &[Row] = &[
    (Both, "", "&&", "&"), (Both, "", "and", "&"), (Both, "", "AND", "&"),
    (Both, "", "||", "|"), (Both, "", "or", "|"), (Both, "", "OR", "|"),
    (Both, "", "implies", "=>"), (Both, "", "imply", "=>"), (Both, "", "->", "=>"), (Both, "", "iff", "<=>"),
    (Both, "", "is", "=="), (Both, "", "~", "!"), (Both, "", "not", "!"), (Both, "", "NOT", "!"),
    (Both, "", "**", "^"),
];

/// Other spellings within a hole.
pub(super) const INSIDE: &[Row] = &[
    (Scenario, "", "( $w1 ' = $e1 ) & ( $w2 ' = $e2 )", "{ $w1 = $e1; $w2 = $e2 }"),
    (Scenario, "", "( $w ' = $e )", "$w = $e"),
    (Scenario, "", "+ $p :", "| $p:"),
    (Scenario, "", "$p :", "$p:"),
];
/// Other spellings within a condition of PRISM, where temporal operators bind more loosely than others.
#[rustfmt::skip]
pub(super) const CONDITION: &[Row] = &[
    (Properties, "", "$c1 U <= $t $c2", "($c1) U<=$t ($c2)"),
    (Properties, "", "$c1 U $c2", "($c1) U ($c2)"),
    (Properties, "", "$o <= $t $c", "$o<=$t ($c)"),
    (Properties, "", "$o $c", "$o ($c)"),
    (Properties, "", "$q", "$q"),
    (Both, "", "$w = $n", "$w == $n"),
];

/// Names and functions of other languages; `$a` is the text of the arguments.
pub(super) const WORDS: [(&str, &str); 20] = [
    ("eventually", "F"),
    ("finally", "F"),
    ("ev", "F"),
    ("always", "G"),
    ("globally", "G"),
    ("alw", "G"),
    ("next", "X"),
    ("not", "!(…)"),
    ("NOT", "!(…)"),
    ("True", "true"),
    ("TRUE", "true"),
    ("False", "false"),
    ("FALSE", "false"),
    ("inf", "∞"),
    ("len", "count(a in $a)"),
    ("dist", "distance"),
    ("pos", "position"),
    ("vel", "velocity"),
    ("mod", "modulo"),
    ("log", "ln"),
];
