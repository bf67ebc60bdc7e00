//! Pages of E09xx: processes.

use super::Page;

/// The pages.
pub(super) const PAGES: &[Page] = &[
    Page {
        code: "E0901",
        title: "two commands of a process are enabled at once",
        text: "\
In some state that a trial can reach two guards of one process hold, and nothing says which command fires. Make the\n\
guards exclude each other, or write `choose`: then each enabled command is as likely as the others.\n\
\n\
Wrong:\n\
\x20   process p { var n: 0 .. 3 = 0  when n == 0 -> n = 1  when n < 2 -> n = 2 }\n\
Right:\n\
\x20   process p { var n: 0 .. 3 = 0  when n == 0 -> n = 1  when n == 1 -> n = 2 }\n\
\x20   process p { choose  var n: 0 .. 3 = 0  when n == 0 -> n = 1  when n < 2 -> n = 2 }",
    },
    Page {
        code: "E0902",
        title: "the probabilities of a command do not sum to 1",
        text: "\
The branches of a command are all that can happen when it fires: their probabilities are not negative and sum to 1,\n\
in every state in which the command is enabled.\n\
\n\
Wrong:\n\
\x20   when s == 0 -> 1/2: s = 1 | 1/3: s = 2\n\
Right:\n\
\x20   when s == 0 -> 1/2: s = 1 | 1/2: s = 2",
    },
    Page {
        code: "E0903",
        title: "a variable leaves its range",
        text: "\
A variable `lo .. hi` holds the whole numbers from lo to hi. An update would give it another value in some state that\n\
a trial can reach, or it starts with one. A guard can keep it inside, or the range can be wider.\n\
\n\
Wrong:\n\
\x20   process p { var n: 0 .. 5 = 0  when true -> n = n + 1 }\n\
Right:\n\
\x20   process p { var n: 0 .. 5 = 0  when n < 5 -> n = n + 1 }",
    },
    Page {
        code: "E0904",
        title: "a rate is no rate",
        text: "\
A rate is a finite number of events per second, not negative, in every state in which its command is enabled. A rate\n\
of 0 disables the command, as a guard does.\n\
\n\
Wrong:\n\
\x20   process p { var n: 0 .. 9 = 0  when n < 9 at (5 - 2 * n) * 1 /s -> n = n + 1 }\n\
Right:\n\
\x20   process p { var n: 0 .. 9 = 0  when n < 3 at (5 - 2 * n) * 1 /s -> n = n + 1 }",
    },
    Page {
        code: "E0905",
        title: "commands with and without times are mixed",
        text: "\
A command without a rate fires at a step; one with `at` a rate or `after` a distribution fires at its own time. The\n\
commands of one process are of one sort, and a scenario without a `step` has no steps to fire at.\n\
\n\
Wrong:\n\
\x20   process p { var n: 0 .. 5 = 0  when n < 5 at 1 /s -> n = n + 1  when n == 5 -> n = 0 }\n\
Right:\n\
\x20   process p { var n: 0 .. 5 = 0  when n < 5 at 1 /s -> n = n + 1  when n == 5 at 2 /s -> n = 0 }",
    },
    Page {
        code: "E0906",
        title: "a delay can be negative",
        text: "\
A command with `after` waits for a drawn time, and nobody can wait a negative one. Cut the distribution off, or take one\n\
that has no negative part.\n\
\n\
Wrong:\n\
\x20   when up after normal(5 s, 2 s) -> up = false\n\
Right:\n\
\x20   when up after normal(5 s, 2 s) in 0 s .. 20 s -> up = false\n\
\x20   when up after gamma(5 s, 2 s) -> up = false",
    },
    Page {
        code: "E0907",
        title: "time does not go on",
        text: "\
Jump follows jump at one instant, a hundred thousand of them: a delay of zero that its own firing enables again. The error\n\
names the trial and the process.\n\
\n\
Wrong:\n\
\x20   when true after 0 s -> n = 1 - n\n\
Right:\n\
\x20   when true after 0.1 s -> n = 1 - n",
    },
    Page {
        code: "E0911",
        title: "a state changes what belongs to the body",
        text: "\
A state of a behaviour changes how an agent walks while it lasts: speed, tau, A, B, lambda, A2, B2, lambda2, noise,\n\
attention and route. Mass, radius and the constants of contact belong to the body.\n\
\n\
Wrong:\n\
\x20   behaviour hurry { state running { mass = 60 kg  speed = 2 m/s } }\n\
Right:\n\
\x20   behaviour hurry { state running { speed = 2 m/s } }",
    },
    Page {
        code: "E0912",
        title: "a behaviour is attached twice",
        text: "\
An agent has a behaviour at most once, with one set of arguments.\n\
\n\
Wrong:\n\
\x20   agent user: adult with heedful(0.8), heedful(0.5) { … }\n\
Right:\n\
\x20   agent user: adult with heedful(0.8), phone { … }",
    },
    Page {
        code: "E0913",
        title: "more people would come than there is room for",
        text: "\
Without `limit` a place is kept for everyone who may come by a source up to the horizon: so many that they suffice in all\n\
but one of a thousand million trials, up to 20,000. With `limit` places are used again by those who come after somebody has\n\
left; about a million people may come by it in a trial, by all sources together about 16 million.\n\
\n\
Wrong:\n\
\x20   horizon = 24 h\n\
\x20   source doors: adult { at = (0, 2)  every = exponential(2 s)  route = exit }\n\
Right:\n\
\x20   horizon = 24 h\n\
\x20   source doors: adult { at = (0, 2)  every = exponential(2 s)  route = exit  limit = 80 }",
    },
    Page {
        code: "E0914",
        title: "a state makes its agent one who cannot move",
        text: "\
A state of a behaviour computes a parameter while a trial runs, and its value is one with which nobody can move: a\n\
negative speed, a relaxation time of zero. The error names the trial and the value.\n\
\n\
Wrong:\n\
\x20   state wary { speed = speed - 1 m/s }\n\
Right:\n\
\x20   state wary { speed = max(0 m/s, speed - 1 m/s) }",
    },
];
