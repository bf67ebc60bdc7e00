//! Pages of E02xx: names, kinds and calls.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[
    Page {
        code: "E0201",
        title: "unknown name",
        text: "\
Nothing of this name is declared. A name may be used before it is declared, in the scenario and in every property file\n\
that is checked with it; names of one property file are not seen in another. The nearest known name is the hint.\n\
\n\
Wrong:\n\
\x20   property p = G<=2 s (distance(usr, friend) > 1 m)\n\
Right:\n\
\x20   property p = G<=2 s (distance(user, friend) > 1 m)",
    },
    Page {
        code: "E0202",
        title: "a name is declared or set twice",
        text: "\
Agents, groups, regions, constants, functions and properties share one space of names, and a property file may not\n\
take a name of the scenario. A field, a setting or a parameter is set once. The other mark shows the first place.\n\
\n\
Wrong:\n\
\x20   kind adult: sfm preset helbing2000 { mass = 75 kg  mass = 80 kg }\n\
Right:\n\
\x20   kind adult: sfm preset helbing2000 { mass = 80 kg }",
    },
    Page {
        code: "E0203",
        title: "unknown function",
        text: "\
There is neither a built-in function nor a `let` with arguments, nor a distribution, of this name.\n\
\n\
Wrong:\n\
\x20   property p = G<=2 s (distanse(user, friend) > 1 m)\n\
Right:\n\
\x20   property p = G<=2 s (distance(user, friend) > 1 m)",
    },
    Page {
        code: "E0204",
        title: "wrong number of arguments",
        text: "\
A function takes exactly the arguments that it declares; distributions take their usual parameters, by mean and\n\
standard deviation.\n\
\n\
Wrong:\n\
\x20   mass = normal(75 kg) in 45 kg .. 120 kg\n\
Right:\n\
\x20   mass = normal(75 kg, 10 kg) in 45 kg .. 120 kg",
    },
    Page {
        code: "E0205",
        title: "a name is defined by itself, or not known yet",
        text: "\
To know the value one would have to know it already: constants, functions, properties, regions or kinds form a circle,\n\
which the mark shows. Numbers of agents and parameters are fixed before there are agents, so that they cannot depend\n\
on them.\n\
\n\
Wrong:\n\
\x20   const A = 2 * B\n\
\x20   const B = A + 1 m\n\
Right:\n\
\x20   const A = 2 * B\n\
\x20   const B = 1 m",
    },
    Page {
        code: "E0206",
        title: "a name stands for something else",
        text: "\
The name is known, but what it stands for does not fit here: a region where a kind belongs, a kind where a number\n\
belongs, a member of a group that is simulated as one body.\n\
\n\
Wrong:\n\
\x20   agent user: hall { at = (1, 2) }\n\
Right:\n\
\x20   agent user: adult { at = (1, 2) }",
    },
    Page {
        code: "E0207",
        title: "unknown field or setting",
        text: "\
Kinds, agents and groups have a fixed list of fields, and a scenario sets `horizon` and `step`. The nearest one is the\n\
hint; docs/language.md lists them with their units.\n\
\n\
Wrong:\n\
\x20   kind adult: sfm preset helbing2000 { masss = 75 kg }\n\
Right:\n\
\x20   kind adult: sfm preset helbing2000 { mass = 75 kg }",
    },
    Page {
        code: "E0208",
        title: "unknown kind or preset",
        text: "\
A kind starts from `sfm`, the social force model, or from another kind; a preset is a published set of parameters,\n\
known by name.\n\
\n\
Wrong:\n\
\x20   kind adult: sfm preset helbing2001 { }\n\
Right:\n\
\x20   kind adult: sfm preset helbing2000 { }",
    },
    Page {
        code: "E0209",
        title: "something is missing",
        text: "\
A kind in use needs a value for every parameter of the model, its own, one of the kind it starts from, or one of a\n\
preset; nothing is assumed in silence. An agent needs a place to start from.\n\
\n\
Wrong:\n\
\x20   kind bare: sfm { mass = 75 kg }\n\
\x20   agent user: bare { }\n\
Right:\n\
\x20   kind bare: sfm preset helbing2000 { mass = 75 kg }\n\
\x20   agent user: bare { at = (1, 2) }",
    },
    Page {
        code: "E0210",
        title: "this cannot be set",
        text: "\
`--set`, `under` and sweeps change values that are declared with `param`, each once. A sweep has a first value, a last\n\
value and a step.\n\
\n\
Wrong:\n\
\x20   smc check model.scn prop.bltl --set density=0.2..0.8\n\
Right:\n\
\x20   smc check model.scn prop.bltl --set 'density=0.2..0.8 by 0.2'",
    },
    Page {
        code: "E0211",
        title: "an expression grows beyond reason",
        text: "\
Functions and properties are written out where they are used, with what they are given, and quantifiers over formulas\n\
once for every agent. Nested in one another that can grow beyond any machine. Quantify over states rather than over\n\
formulas, and do not nest calls of functions that repeat what they are given, as `let f(v) = v + v` does.\n\
\n\
Wrong:\n\
\x20   property p = forall a in crowd: forall b in crowd: forall c in crowd: F<=1 s (…)\n\
Right:\n\
\x20   property p = F<=1 s (forall a in crowd: forall b in crowd: …)",
    },
    Page {
        code: "E0212",
        title: "no such member",
        text: "\
Members of a set are counted from 1 to its size.\n\
\n\
Wrong:\n\
\x20   agents crowd[3]: adult { at = uniform in hall }\n\
\x20   property p = G<=2 s !contact(crowd[0])\n\
Right:\n\
\x20   property p = G<=2 s !contact(crowd[1])",
    },
    Page {
        code: "W0201",
        title: "a name means something else, too",
        text: "\
A name that is built in (`time`, `everyone`, `pi`, functions) may be declared; then it stands for what was declared. A\n\
scenario may call something `F`, which in property files is an operator: no formula there can name it.\n\
\n\
Probably wrong:\n\
\x20   param time = 3\n\
Clear:\n\
\x20   param patience = 3",
    },
];
