//! Pages of E03xx: units, dimensions and types.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[
    Page {
        code: "E0302",
        title: "a unit is out of range",
        text: "\
Powers of units are small whole numbers. Products and powers of expressions must keep within them.\n\
\n\
Wrong:\n\
\x20   let huge = (1 m) ^ 60 * (1 m) ^ 60 * (1 m) ^ 60\n\
Right:\n\
\x20   let area = (1 m) ^ 2",
    },
    Page {
        code: "E0303",
        title: "dimensions do not fit",
        text: "\
Sums, differences and comparisons need the same dimension on both sides, and every field, bound and argument has its\n\
own. A pure number is not a length: write the unit.\n\
\n\
Wrong:\n\
\x20   property p = G<=2 s (distance(user, friend) > 1)\n\
Right:\n\
\x20   property p = G<=2 s (distance(user, friend) > 1 m)",
    },
    Page {
        code: "E0304",
        title: "this must be known before a trial starts",
        text: "\
Numbers of agents, sizes, thresholds and ends of ranges are fixed before a trial starts; they cannot depend on what\n\
happens in it. The start of a trial is no exception.\n\
\n\
Wrong:\n\
\x20   check P(safe) >= speed(user) / (1 m/s)\n\
Right:\n\
\x20   check P(safe) >= 0.9",
    },
    Page {
        code: "E0305",
        title: "something of another type belongs here",
        text: "\
A condition, a number, an agent, a set, a place or a vector is needed, and something else stands here. A number\n\
becomes a condition by a comparison, a set becomes one agent by a member or a quantifier.\n\
\n\
Wrong:\n\
\x20   property p = G<=2 s (speed(user) & contact(crowd))\n\
Right:\n\
\x20   property p = G<=2 s (speed(user) > 0 m/s & (exists a in crowd: contact(a)))",
    },
];
