//! Pages of E04xx and W04xx: scenes, people, parameters.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[
    Page {
        code: "E0401",
        title: "a shape has no extent",
        text: "\
A rectangle and a polygon have an area, a circle has a positive radius, a wall a length; the edges of a polygon do not\n\
cross.\n\
\n\
Wrong:\n\
\x20   obstacle bow: polygon (0, 0) (2, 2) (2, 0) (0, 2)\n\
Right:\n\
\x20   obstacle box: polygon (0, 0) (2, 0) (2, 2) (0, 2)",
    },
    Page {
        code: "E0402",
        title: "this is no number of people",
        text: "\
The number of agents is whole and not negative; it may be computed from constants, parameters and areas. A crowd of\n\
zero is legal: `forall` over nobody is true, `min` over nobody is infinite.\n\
\n\
Wrong:\n\
\x20   agents crowd[density * area(hall)]: adult { at = uniform in hall }\n\
Right:\n\
\x20   agents crowd[round(density * area(hall))]: adult { at = uniform in hall }",
    },
    Page {
        code: "E0403",
        title: "near an agent that is declared later",
        text: "\
People are placed in the order of their declarations, so that one can only be placed near somebody else who is\n\
there already. Who comes in by a source is not.\n\
\n\
Wrong:\n\
\x20   agent guard: adult { at = near user within 2 m }\n\
\x20   agent user: adult { at = (1, 2) }\n\
Right:\n\
\x20   agent user: adult { at = (1, 2) }\n\
\x20   agent guard: adult { at = near user within 2 m }",
    },
    Page {
        code: "E0404",
        title: "this is no distribution",
        text: "\
A distribution needs parameters that make sense (a positive mean, a standard deviation that is not negative, a range\n\
that is not empty and holds some probability). Distributions are values of fields; each agent of each trial draws its\n\
own. Only they can be truncated.\n\
\n\
Wrong:\n\
\x20   mass = normal(75 kg, -10 kg) in 45 kg .. 120 kg\n\
Right:\n\
\x20   mass = normal(75 kg, 10 kg) in 45 kg .. 120 kg",
    },
    Page {
        code: "E0405",
        title: "this number is not allowed here",
        text: "\
The number lies outside what the field or parameter can be: a mass that may be negative, a weight above 1, a value\n\
outside the declared range, a division by zero. A normal distribution has two tails: truncate it where a value must be\n\
positive.\n\
\n\
Wrong:\n\
\x20   mass = normal(75 kg, 10 kg)\n\
Right:\n\
\x20   mass = normal(75 kg, 10 kg) in 45 kg .. 120 kg",
    },
    Page {
        code: "E0406",
        title: "these moves make no sense",
        text: "\
Moves belong to one agent, declared once, hold for a finite time and offer at least one option; headings go up from\n\
the first to the last.\n\
\n\
Wrong:\n\
\x20   moves user for 2 s { heading from 60 deg to -60 deg by 15 deg }\n\
Right:\n\
\x20   moves user for 2 s { heading from -60 deg to 60 deg by 15 deg  stop }",
    },
    Page {
        code: "E0408",
        title: "who leaves needs a goal first",
        text: "\
`then leave` takes somebody out of the scene at the last goal of a route; a route that only waits has none.\n\
\n\
Wrong:\n\
\x20   route = wait 2 s then leave\n\
Right:\n\
\x20   route = exit then leave",
    },
    Page {
        code: "E0409",
        title: "nobody can start there",
        text: "\
The center of a body lies inside an obstacle or on a wall, or so near one that less than half of the radius would be\n\
left, or two people start at the same point. Bodies that overlap less are no error: their radii shrink until they\n\
touch, and the report says whose, at what, and how much.\n\
\n\
Wrong:\n\
\x20   obstacle pillar: circle (10, 2) radius 0.3 m\n\
\x20   agent  user: adult { at = (10, 2.1) }\n\
\x20   agents crowd[3]: adult { at = (4, 2) }\n\
Right:\n\
\x20   agent  user: adult { at = (10, 2.6) }\n\
\x20   agents crowd[3]: adult { at = uniform in circle (4, 2) radius 1 m }",
    },
    Page {
        code: "W0401",
        title: "nothing of a file was taken",
        text: "\
The filter after `where` fits no feature of the imported file, so that the import adds nothing.\n\
\n\
Probably wrong:\n\
\x20   import \"hall.geojson\" where source == \"map.pgn\"\n\
Clear:\n\
\x20   import \"hall.geojson\" where source == \"map.png\"",
    },
];
