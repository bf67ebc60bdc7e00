//! Pages of E06xx: queries and procedures.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[
    Page {
        code: "E0601",
        title: "this threshold cannot be tested",
        text: "\
A probability is compared with a number strictly between 0 and 1: no number of trials proves that something is certain\n\
or impossible. A level of a quantile lies there too, and a threshold of an expectation inside the range of its metric.\n\
\n\
Wrong:\n\
\x20   check P(safe) >= 1\n\
Right:\n\
\x20   check P(safe) >= 0.999",
    },
    Page {
        code: "E0602",
        title: "the indifference region leaves (0, 1)",
        text: "\
A sequential ratio test tells the threshold plus the indifference from the threshold minus it; both must be\n\
probabilities strictly between 0 and 1. The default test needs no such region.\n\
\n\
Wrong:\n\
\x20   check P(safe) >= 0.99 by sprt(indifference = 0.02)\n\
Right:\n\
\x20   check P(safe) >= 0.99 by sprt(indifference = 0.005)\n\
\x20   check P(safe) >= 0.99",
    },
    Page {
        code: "E0603",
        title: "no such procedure here",
        text: "\
Each kind of query has procedures of its own. For a check: sprt, sprt2, plan, eprocess, three_way. For an estimate of\n\
a probability: okamoto, massart, spending, clopper_pearson, fixed, gbas, splitting, fixed_effort; of an expectation:\n\
okamoto, fixed; of a quantile: fixed, dkw. For a ranking: betting, one_challenger, okamoto. Without `by` the default is used.\n\
\n\
Wrong:\n\
\x20   estimate P(safe) by sprt(indifference = 0.01)\n\
Right:\n\
\x20   estimate P(safe) by okamoto(epsilon = 0.01, delta = 0.05)",
    },
    Page {
        code: "E0604",
        title: "wrong arguments of a procedure",
        text: "\
An argument is unknown, missing, given twice or outside its range. Probabilities of error lie between 0 and 0.5 and\n\
confidences between 50 % and 100 %: who errs as often as not says nothing. The half width of an interval is at most half of\n\
what the measure ranges over, numbers of trials are whole and positive.\n\
\n\
Wrong:\n\
\x20   estimate P(safe) within 0.01 confidence 95\n\
Right:\n\
\x20   estimate P(safe) within 0.01 confidence 95 %",
    },
    Page {
        code: "E0605",
        title: "an expectation needs a range",
        text: "\
Without a range no finite number of trials guarantees anything about a mean. Values outside are clipped to the range,\n\
and the report counts them. Only expectations have one. Of a comparison both sides have the same.\n\
\n\
Wrong:\n\
\x20   estimate E(min<=10 s (clearance(user)))\n\
Right:\n\
\x20   estimate E(min<=10 s (clearance(user))) in -0.5 m .. 20 m",
    },
    Page {
        code: "E0606",
        title: "there is nothing to rank",
        text: "\
`rank moves of` needs an agent for which the scenario declares moves.\n\
\n\
Wrong:\n\
\x20   agent user: adult { at = (1, 2) }\n\
\x20   rank moves of user by P(safe)\n\
Right:\n\
\x20   agent user: adult { at = (1, 2) }\n\
\x20   moves user for 2 s { heading from -60 deg to 60 deg by 15 deg  stop }\n\
\x20   rank moves of user by P(safe)",
    },
    Page {
        code: "E0607",
        title: "this clause or measure does not belong here",
        text: "\
A check has no `within`; a quantile takes a number of trials, not a width; quantiles are neither compared nor ranked\n\
by.\n\
\n\
Wrong:\n\
\x20   check P(safe) >= 0.9 within 0.01\n\
Right:\n\
\x20   check P(safe) >= 0.9 by sprt(indifference = 0.01)",
    },
    Page {
        code: "E0610",
        title: "this has no robustness",
        text: "\
Robustness is how far comparisons are from changing. `<`, `<=`, `>`, `>=`, contacts and regions have a margin; `==`,\n\
`!=` and truth values of processes say only yes or no, and sums and means over time are not compared state by state.\n\
A formula needs something with a margin in it.\n\
\n\
Wrong:\n\
\x20   estimate E(robustness(F<=9 steps (die.s == 7))) in -1 .. 1\n\
Right:\n\
\x20   estimate E(robustness(F<=9 steps (die.s >= 7))) in -7 .. 1",
    },
    Page {
        code: "E0611",
        title: "this mixes units in a robustness",
        text: "\
The robustness of `a & b` is the smaller of two margins, so that all margins need one unit. Divide by what matters of\n\
each, and they become pure numbers.\n\
\n\
Wrong:\n\
\x20   estimate E(robustness(G<=5 s (speed(user) < 2 m/s & clearance(user) > 0.5 m))) in -1 m .. 1 m\n\
Right:\n\
\x20   estimate E(robustness(G<=5 s (speed(user) / 1 m/s < 2 & clearance(user) / 0.5 m > 1))) in -1 .. 1",
    },
    Page {
        code: "W0601",
        title: "this query leaves its family",
        text: "\
With `family confidence` all queries of a file hold jointly, at all points of a sweep, each with an equal share of the\n\
error. A query that states\n\
errors of its own is held to those, and the joint statement is about the others only.\n\
\n\
Probably wrong:\n\
\x20   family confidence 95 %\n\
\x20   estimate P(safe) within 0.01 confidence 99 %\n\
Clear:\n\
\x20   family confidence 95 %\n\
\x20   estimate P(safe) within 0.01",
    },
    Page {
        code: "W0602",
        title: "nothing is asked",
        text: "\
The property files declare names, and no query asks about them: no trial is run, and no check can fail. Files of names\n\
alone are fine beside a file that asks.\n\
\n\
Probably wrong:\n\
\x20   property safe = G<=5 s (clearance(user) > 0 m)\n\
Clear:\n\
\x20   property safe = G<=5 s (clearance(user) > 0 m)\n\
\x20   check P(safe) >= 0.9",
    },
];
