//! Pages of E07xx, W07xx and E092x: files.

use super::Page;

/// The pages, by code.
pub(super) const PAGES: &[Page] = &[
    Page {
        code: "E0701",
        title: "a file cannot be read",
        text: "\
The file is not there, is a directory or may not be read. Files that a scenario names are looked for beside it, then\n\
under each `--data` directory. Standard input can be read once. An input has 256 MB at most.\n\
\n\
Wrong:\n\
\x20   tracks hotel = eth_biwi \"obsmat.txt\"\n\
Right:\n\
\x20   tracks hotel = eth_biwi \"seq_hotel/obsmat.txt\"\n\
\x20   smc check hotel.scn hotel.bltl --data ../shared/data/eth-biwi",
    },
    Page {
        code: "E0702",
        title: "a recording cannot be read",
        text: "\
The format is unknown, or lines of the file are not what the format asks for. The message gives the numbers of the\n\
lines.\n\
\n\
Wrong:\n\
\x20   tracks hotel = biwi \"seq_hotel/obsmat.txt\"\n\
Right:\n\
\x20   tracks hotel = eth_biwi \"seq_hotel/obsmat.txt\"",
    },
    Page {
        code: "E0703",
        title: "nobody of that kind in the recording",
        text: "\
At the given time the recording holds nobody, not the person asked for, or several where one is needed. The hint names\n\
the nearest time with people, or those who are there.\n\
\n\
Wrong:\n\
\x20   agent user: adult from hotel at 646.8 s\n\
Right:\n\
\x20   agent user: adult from hotel at 646.8 s id 367\n\
\x20   agents others: adult from hotel at 646.8 s except 367",
    },
    Page {
        code: "E0704",
        title: "geometry cannot be read",
        text: "\
An imported file is GeoJSON or WKT, in text; rings are closed and do not cross themselves. The message says what is\n\
wrong with the first features.\n\
\n\
Wrong:\n\
\x20   import \"floor.dxf\"\n\
Right:\n\
\x20   import \"floor.geojson\"\n\
\x20   import \"floor.wkt\"",
    },
    Page {
        code: "E0705",
        title: "the call is wrong",
        text: "\
An option names what the files do not hold, or has a value that means nothing. `smc help` and `smc help check` list the\n\
options.\n\
\n\
Wrong:\n\
\x20   smc check corridor.scn corridor.bltl --only nobody\n\
\x20   smc simulate corridor.scn --until 900\n\
Right:\n\
\x20   smc check corridor.scn corridor.bltl --only safe\n\
\x20   smc simulate corridor.scn --until 9",
    },
    Page {
        code: "E0706",
        title: "a file cannot be written",
        text: "\
The folder is not there, may not be written, or is full; or standard output was closed in a way that is no end.\n\
\n\
Wrong:\n\
\x20   smc check corridor.scn corridor.bltl --report /nowhere/report.html\n\
Right:\n\
\x20   smc check corridor.scn corridor.bltl --report report.html",
    },
    Page {
        code: "E0707",
        title: "these are no outcomes",
        text: "\
`smc drift` reads one outcome a line, 0 or 1, true or false, or a column of a table. The message gives the line.\n\
\n\
Wrong:\n\
\x20   trial,safe\n\
\x20   0,maybe\n\
Right:\n\
\x20   trial,safe\n\
\x20   0,true",
    },
    Page {
        code: "E0710",
        title: "a coordinate is too large",
        text: "\
Coordinates lie between -1e6 m and 1e6 m. Numbers have about 16 digits, so that far from the origin the small steps of\n\
people would be lost in rounding. This holds for starts, shapes, walls, points and goals, and for imports (E0704) and\n\
recordings (E0702). Coordinates of maps are often that large: subtract a common origin from all of them.\n\
\n\
Wrong:\n\
\x20   agent user: adult { at = (691608, 5334762) }\n\
Right:\n\
\x20   agent user: adult { at = (108, 262) }",
    },
    Page {
        code: "W0701",
        title: "a person was recorded inside or close to a barrier",
        text: "\
The center of a recorded person lies inside an obstacle or on a wall, or so near one that less than half of the radius\n\
would be left. The agent starts beside it, at the nearest place found where the largest radius of its kind touches no\n\
barrier. Recorded positions are those of heads, and outlines of obstacles are rarely exact.\n\
\n\
Probably wrong:\n\
\x20   tracks hotel = eth_biwi \"seq_hotel/obsmat.txt\"\n\
\x20   obstacle bench: rect (0, 0) .. (4, 3)\n\
\x20   agent user: adult from hotel at 646.8 s id 367\n\
Clear:\n\
\x20   tracks hotel = eth_biwi \"seq_hotel/obsmat.txt\"\n\
\x20   obstacle bench: rect (0, 0) .. (0.8, 2.5)\n\
\x20   agent user: adult from hotel at 646.8 s id 367",
    },
    Page {
        code: "W0702",
        title: "walls of a file nearly meet",
        text: "\
Ends of walls miss another wall or an obstacle by less than 5 cm, or a wall lies beside another one, as where the two sides\n\
of a thin wall are drawn. Such walls do not touch, so that each pushes for itself: twice as hard as one. With `snap` ends\n\
that near to each other are joined, ends near another wall are moved onto it, and pieces along a longer one are merged.\n\
\n\
Probably wrong:\n\
\x20   import \"building.geojson\"\n\
Clear:\n\
\x20   import \"building.geojson\" { snap = 5 cm }",
    },
    Page {
        code: "E0920",
        title: "an output would overwrite an input",
        text: "\
A file that the call reads is also named as the file that it writes. Nothing is written. Two names stand for one file\n\
where links lead to it.\n\
\n\
Wrong:\n\
\x20   smc simulate corridor.scn -o corridor.scn\n\
Right:\n\
\x20   smc simulate corridor.scn -o corridor.csv",
    },
    Page {
        code: "E0921",
        title: "time was up before the first trial",
        text: "\
The time of `--timeout` is for the whole call: reading, compiling and preparing are parts of it. Nothing was sampled, so\n\
nothing is known. The exit code is that of a check which time leaves undecided.\n\
\n\
Wrong:\n\
\x20   smc check city.scn evacuation.bltl --timeout 50ms\n\
Right:\n\
\x20   smc check city.scn evacuation.bltl --timeout 1min",
    },
    Page {
        code: "E0922",
        title: "the call was interrupted before the first trial",
        text: "\
A signal ended the call while it was reading, compiling or preparing. Nothing was sampled, so nothing is known. A signal\n\
while trials run is gentle: what is known so far is printed.\n\
\n\
Wrong:\n\
\x20   smc check city.scn evacuation.bltl & kill -INT $!\n\
Right:\n\
\x20   smc check city.scn evacuation.bltl --timeout 1min",
    },
    Page {
        code: "E0923",
        title: "this takes more memory than there may be",
        text: "\
Splitting keeps all paths of all runs: `replicas` times `runs`, about 400 bytes each, 2 GB at most. `E` and `Q` keep one\n\
value for each trial, since their distribution is reported: 8 bytes each, 2.1 GB at most for all queries that share trials.\n\
\n\
Wrong:\n\
\x20   estimate P(arrives) by splitting(replicas = 1000000, runs = 1000)\n\
Right:\n\
\x20   estimate P(arrives) by splitting(replicas = 1000, runs = 20)",
    },
];
