//! Pages of E05xx and W05xx: time, bounds, horizon.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[
    Page {
        code: "E0501",
        title: "this is no multiple of the step",
        text: "\
The model is seen at 0, step, 2 step and so on; a bound between two states would be rounded in silence, which changes\n\
the question. The hint names the two nearest legal times.\n\
\n\
Wrong:\n\
\x20   step = 0.02 s\n\
\x20   property p = F<=0.05 s contact(user)\n\
Right:\n\
\x20   property p = F<=0.06 s contact(user)",
    },
    Page {
        code: "E0502",
        title: "the horizon is too short",
        text: "\
The formula looks further ahead than a trial lasts. Nested bounds add up: `F<=3 s G<=2 s p` needs 5 s. An operator\n\
without a bound asks at every state up to the horizon, so that a bounded one inside it would look beyond.\n\
\n\
Wrong:\n\
\x20   horizon = 4 s\n\
\x20   property p = G (contact(user) => F<=1 s !contact(user))\n\
Right:\n\
\x20   property p = G<=3 s (contact(user) => F<=1 s !contact(user))",
    },
    Page {
        code: "E0503",
        title: "this is no time bound",
        text: "\
A bound is a time or a number of steps, not negative, and where it is needed finite; an interval ends after it starts.\n\
`X` takes the time of its one state and no interval.\n\
A bare number is legal only where the model has steps without a length.\n\
\n\
Wrong:\n\
\x20   property p = F<=5 contact(user)\n\
Right:\n\
\x20   property p = F<=5 s contact(user)\n\
\x20   property p = F<=#5 contact(user)",
    },
    Page {
        code: "E0504",
        title: "a formula over time cannot stand here",
        text: "\
Conditions of agents, folds over sets at one state and the scenario itself look at one state. Operators over time\n\
stand in properties and metrics, around such conditions. A count of formulas over time is compared with a number.\n\
\n\
Wrong:\n\
\x20   property p = F<=2 s (count(a in crowd: G<=1 s contact(a)) > count(a in crowd: contact(a)))\n\
Right:\n\
\x20   property p = F<=2 s (count(a in crowd: contact(a)) > 2)\n\
\x20   property q = count(a in crowd: G<=1 s contact(a)) > 2",
    },
    Page {
        code: "E0505",
        title: "the scenario needs a clock",
        text: "\
A scenario sets a step and a horizon; both are positive and exact.\n\
\n\
Wrong:\n\
\x20   scenario \"Hall\"\n\
Right:\n\
\x20   scenario \"Hall\"\n\
\x20   horizon = 30 s\n\
\x20   step = 0.02 s",
    },
    Page {
        code: "E0507",
        title: "there is no next state",
        text: "\
In a scenario in continuous time the state between two jumps lasts; there is no next one. Ask for an interval instead.\n\
\n\
Wrong:\n\
\x20   property p = X (queue.n > 3)\n\
Right:\n\
\x20   property p = F[0 s, 1 s] (queue.n > 3)",
    },
    Page {
        code: "E0508",
        title: "this has no meaning in continuous time",
        text: "\
A scenario of processes with rates alone has no steps: its state lasts from one jump to the next. There are no states to\n\
add up, `time` goes on while the state stays, and a time or a time average that moves with a window can only be compared\n\
with a constant.\n\
\n\
Wrong:\n\
\x20   estimate E(sum<=10 s (queue.n)) in 0 .. 50\n\
\x20   property late = F (queue.n > 3 & time > 5 s)\n\
Right:\n\
\x20   estimate E(mean<=10 s (queue.n)) in 0 .. 5\n\
\x20   property late = F[5 s, 10 s] (queue.n > 3)",
    },
    Page {
        code: "E0509",
        title: "this formula has to remember or to add up too much",
        text: "\
A window inside another one keeps the states for which its answer is still open. With long windows and short steps\n\
these are many, in each trial. A `sum<=∞` or `mean<=∞` ranges up to the horizon; asked at each state, all of\n\
them end in the last one and are added up there: of more than 2^31 additions give it a bound, `mean<=10 s (queue.n)`.\n\
\n\
Wrong:\n\
\x20   horizon = 3 h\n\
\x20   step = 1 ms\n\
\x20   property p = G<=2 h (F<=1 h (queue.n == 0))\n\
Right:\n\
\x20   horizon = 3 h\n\
\x20   step = 1 s\n\
\x20   property p = G<=2 h (F<=1 h (queue.n == 0))",
    },
    Page {
        code: "W0501",
        title: "this is always the same",
        text: "\
The formula is true, or false, whatever happens in a trial. That is often a slip: an unknown bound, a set without\n\
members, a comparison with itself.\n\
\n\
Probably wrong:\n\
\x20   property p = G<=2 s (1 m < 2 m)\n\
Clear:\n\
\x20   property p = G<=2 s (distance(user, friend) < 2 m)",
    },
    Page {
        code: "W0502",
        title: "this is read in the first state",
        text: "\
A number of one state has a value in every state; asked about a trace it is read in the first. Say which state is\n\
meant, or join them.\n\
\n\
Probably wrong:\n\
\x20   estimate E(speed(user)) in 0 m/s .. 3 m/s\n\
Clear:\n\
\x20   estimate E(speed(user) at end) in 0 m/s .. 3 m/s\n\
\x20   estimate E(max<=10 s (speed(user))) in 0 m/s .. 3 m/s\n\
\n\
A formula without a temporal operator is read in the first state, too.\n\
\n\
Probably wrong:\n\
\x20   check P(clearance(user) > 0.3 m) >= 0.9\n\
Clear:\n\
\x20   check P(G<=10 s (clearance(user) > 0.3 m)) >= 0.9",
    },
    Page {
        code: "W0503",
        title: "a real number is compared for equality",
        text: "\
Variables of processes without a range are floating-point numbers: 0.1 added three times is not 0.3. A comparison with\n\
`==` or `!=` is then decided by rounding.\n\
\n\
Probably wrong:\n\
\x20   process tank { var level = 0  when level < 1 -> level = level + 0.1 }\n\
\x20   property full = F<=20 s (tank.level == 1)\n\
Clear:\n\
\x20   process tank { var level = 0  when level < 1 -> level = level + 0.1 }\n\
\x20   property full = F<=20 s (tank.level > 0.95)",
    },
];
