//! Pages of E08xx and W08xx: what happens while trials run.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[
    Page {
        code: "E0801",
        title: "people cannot be placed",
        text: "\
People who start in the same shape, or near the same person, need more room than there is; obstacles count, and bodies\n\
that are thrown and then pushed apart jam at about 84 % of an area. What bodies cover beyond the rim of their shape\n\
may be filled, and fewer than twenty in a shape are refused only if they take more than all there is. Or even the\n\
smallest body that can be drawn is too large for the place: a corridor that is narrower, a distance at which two\n\
bodies overlap. This is said before the first trial; what only bad luck makes impossible leaves its trial unresolved.\n\
\n\
Wrong:\n\
\x20   region hall: rect (0, 0) .. (10, 4)\n\
\x20   agents crowd[400]: adult { at = uniform in hall }\n\
\x20   agent  guard: adult { at = near crowd[1] within 0.1 m }\n\
Right:\n\
\x20   agents crowd[40]: adult { at = uniform in hall }\n\
\x20   agent  guard: adult { at = near crowd[1] within 1 m }",
    },
    Page {
        code: "E0802",
        title: "splitting is refused",
        text: "\
The estimate of splitting contradicts the plain trials beside it, or the robustness never rose before the event came.\n\
Splitting sees only the ways to the event on which the robustness rises by and by; what comes out of the blue (a fault, a\n\
jump, an arrival) it misses, and its interval with it. The report holds what the plain trials say.\n\
\n\
Wrong:\n\
\x20   estimate P(G<=60 s (clearance(user) > 0 m)) by splitting()\n\
Right:\n\
\x20   estimate P(F<=60 s (clearance(user) <= 0 m)) by splitting()\n\
\x20   estimate P(F<=60 s (clearance(user) <= 0 m & !sensor.failed)) by splitting()",
    },
    Page {
        code: "W0801",
        title: "the step is too long for the forces",
        text: "\
Bodies that touch push each other apart with a force that changes fast. A step of more than 2 / sqrt(n A / (m B)) lets\n\
them swing farther and farther apart, until trials diverge; n is how many bodies and barriers can touch one body at\n\
once, at most 6, and with a second social term A2 / B2 is added to A / B. A step of more than a tenth of `tau` is too\n\
coarse for the way back to the driving speed. Of a distribution counts the value that one draw in 740 goes beyond.\n\
What behaviours change does not count.\n\
\n\
Probably wrong:\n\
\x20   step = 0.1 s\n\
\x20   kind adult: sfm preset helbing2000\n\
Clear:\n\
\x20   step = 0.025 s\n\
\x20   kind adult: sfm preset helbing2000",
    },
];
