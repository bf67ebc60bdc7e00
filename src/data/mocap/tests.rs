//! Takes made for the tests: a walker on a circle to the left of radius 3 m (BVH), one who walks straight ahead on legs of two
//! bones (ASF/AMC), and one who stands, makes four steps and stands (CSV). Steps are 0.6 m and 0.5 s.

use super::*;
use crate::data::tracks::LineError;
use proptest::prelude::*;

const BVH: &str = include_str!("../../../tests/cases/mocap/circle.bvh");
const ASF: &str = include_str!("../../../tests/cases/mocap/walker.asf");
const AMC: &str = include_str!("../../../tests/cases/mocap/walker_01.amc");
const CSV: &str = include_str!("../../../tests/cases/mocap/clips.csv");

fn amc_layout() -> Layout {
    Layout { fps: Some(30.0), ..Layout::named("cmu-asfamc").unwrap() }
}

fn said(errors: &[LineError]) -> Vec<String> {
    errors.iter().map(ToString::to_string).collect()
}

fn bvh(text: &str) -> Result<Vec<Take>, Vec<String>> {
    read_takes("circle.bvh", text, None, None, &[]).map_err(|errors| said(&errors))
}

fn csv(text: &str) -> Result<Vec<Take>, Vec<String>> {
    read_takes("clips.csv", text, None, None, &[]).map_err(|errors| said(&errors))
}

fn amc(text: &str) -> Result<Vec<Take>, Vec<String>> {
    let asf = Asf::read(ASF).unwrap();
    read_takes("x/walker_01.amc", text, Some(&asf), Some(&amc_layout()), &[]).map_err(|errors| said(&errors))
}

#[test]
fn each_format_gives_the_places_that_were_written() {
    let take = &bvh(BVH).unwrap()[0];
    assert_eq!((take.name.as_str(), take.subject.as_str(), take.root.len()), ("circle", "", 120));
    assert!((take.fps - 30.0).abs() < 1e-3);
    for (k, root) in take.root.iter().enumerate() {
        let (t, sway) = (k as f64 / 30.0, 0.02 * (std::f64::consts::TAU * k as f64 / 30.0).sin());
        let angle = (1.2 * t - 0.36) / 3.0;
        // The circle bends to the left: its center is at (0, 3).
        let place = [(3.0 - sway) * angle.sin(), 3.0 - (3.0 - sway) * angle.cos()];
        assert!((root.x - place[0]).abs() < 1e-5 && (root.y - place[1]).abs() < 1e-5, "{k}");
        for (foot, radius) in take.feet.iter().zip([2.9, 3.1]) {
            let [x, y, height] = foot.ankle[k];
            assert!((x.hypot(y - 3.0) - radius).abs() < 1e-5, "{k}");
            assert!((0.0799..0.21).contains(&height));
            // The foot points along the circle.
            let [u, v, _] = foot.toe[k];
            assert!(((u - x) * x + (v - y) * (y - 3.0)).abs() < 1e-5, "{k}");
            assert!(((u - x) * (3.0 - y) + (v - y) * x) > 0.11 * radius, "{k}");
        }
    }
    let take = &amc(AMC).unwrap()[0];
    assert_eq!((take.name.as_str(), take.root.len(), take.fps), ("walker_01", 120, 30.0));
    for (k, root) in take.root.iter().enumerate() {
        // Ahead is z in the file, which is -y on the floor plane.
        assert!(root.x.abs() < 1e-6 && (root.y - 0.36 + 1.2 * k as f64 / 30.0).abs() < 1e-5, "{k}");
        for (foot, side) in take.feet.iter().zip([0.1, -0.1]) {
            assert!((foot.ankle[k][0] - side).abs() < 1e-5, "{k}");
            assert!((foot.ankle[k][1] - foot.toe[k][1] - 0.12).abs() < 1e-5, "{k}");
            assert!((foot.ankle[k][2] - foot.toe[k][2] - 0.05).abs() < 1e-5, "{k}");
        }
    }
    let takes = csv(CSV).unwrap();
    let named: Vec<_> = takes.iter().map(|take| (take.name.as_str(), take.root.len())).collect();
    assert_eq!(named, [("stand", 130), ("walk", 90)]);
    assert_eq!(takes[0].feet[1].toe[0], [0.12, -0.1, 0.11 - 0.08]);
}

#[test]
fn rotations_follow_the_order_of_the_formats() {
    // Z by 90 degrees, then X by 90 in the turned frame: y goes to z, and z stays.
    let text = "HIERARCHY ROOT hip { OFFSET 1 2 3 CHANNELS 5 Yposition Xposition Zrotation Xrotation Yrotation\n\
                JOINT lFoot { OFFSET 0 1 0 End Site { OFFSET 0 0 1 } }\n\
                JOINT rFoot { OFFSET 0 1 0 End Site { OFFSET 0 0 1 } } }\n\
                MOTION\nFrames: 3\nFrame Time: 0.1\n0 0 0 0 0\n20 10 90 90 0\n20 10 90 90 0\n";
    let layout = Layout { unit: 1.0, up: Up::Z, ..Layout::named("cmu-bvh").unwrap() };
    let read = |layout: &Layout| read_takes("a.bvh", text, None, Some(layout), &[]).unwrap().remove(0);
    let near =
        |a: [f64; 3], b: [f64; 3]| assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?}");
    near(read(&layout).feet[0].ankle[0], [11.0, 22.0, 4.0]);
    near(read(&layout).feet[0].toe[0], [12.0, 22.0, 4.0]);
    let replacing = Layout { replace_offsets: true, skip: 0, ..layout };
    near(read(&replacing).feet[1].toe[2], [11.0, 20.0, 1.0]);
    // A bone along x whose axis is turned by 90 degrees around z turns around y: x goes to -z, which is down on x and -z.
    let asf = ":root\norder TX TY TZ RX RY RZ\n:bonedata\nbegin\nname a\ndirection 1 0 0\nlength 2\naxis 0 0 90 XYZ\n\
               dof rx\nend\nbegin\nname b\ndirection 1 0 0\nlength 3\naxis 0 0 0 XYZ\nend\n:hierarchy\nroot a\na b\n";
    let motion = "1\nroot 0 0 0 0 0 0\na 90\n2\nroot 5 0 0 0 90 0\na 0\n";
    let [a, b] = ["a", "b"].map(str::to_owned);
    let (left, right) = ([a.clone(), b.clone()], [a, b]);
    let layout = Layout { unit: 1.0, left, right, ..amc_layout() };
    let take =
        read_takes("a.amc", motion, Some(&Asf::read(asf).unwrap()), Some(&layout), &[]).unwrap().remove(0);
    near(take.feet[0].ankle[0], [0.0, 2.0, 0.0]);
    near(take.feet[0].toe[0], [0.0, 5.0, 0.0]);
    near(take.feet[0].toe[1], [5.0, 5.0, 0.0]);
}

#[test]
fn a_table_of_takes_chooses_clips_and_gives_them_unique_names() {
    let rows = read_take_table(
        "clip,file,fps,subject,note\nwalk,clips.csv,30,7,\"a, b\"\nwalk,b/clips.csv,,8,\n,c/walk.bvh,120,,\n,d.bvh,,,\n",
    )
    .unwrap();
    let names: Vec<&str> = rows.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(names, ["clips.csv:walk", "b/clips.csv:walk", "c/walk.bvh", "d"]);
    let takes = read_takes("clips.csv", CSV, None, None, &rows[..1]).unwrap();
    assert_eq!((takes.len(), takes[0].subject.as_str(), takes[0].root.len()), (1, "7", 90));
    let other = TakeRow { clip: "run".to_owned(), fps: Some(60.0), ..rows[0].clone() };
    let faster = TakeRow { fps: Some(60.0), ..rows[0].clone() };
    let errors = read_takes("clips.csv", CSV, None, None, &[other, faster]).unwrap_err();
    assert_eq!(
        said(&errors),
        [
            "the file has no clip `run` (line 2 of the table); it has `stand`, `walk`",
            "the file has 30.00 frames per second, but 60 are stated"
        ]
    );
    let wrong = read_take_table("file,clip,subject,fps\na.bvh,,,x\n,,,\na.bvh,,,30\nb.bvh,,\n").unwrap_err();
    assert_eq!(
        said(&wrong),
        [
            "line 2, column 9: `x` is not a number",
            "line 3: the row has no file",
            "line 4: the row names the same take as line 2",
            "line 5: the row has 3 fields, but the header has 4"
        ]
    );
    let lacking = read_take_table("file,rate\n").unwrap_err();
    assert_eq!(
        said(&lacking),
        ["line 1: the header lacks clip, subject, fps; its columns are `file`, `rate`"]
    );
}

#[test]
fn faults_have_their_places() {
    let first = |read: Result<Vec<Take>, Vec<String>>| read.unwrap_err().remove(0);
    let has = |text: &str, part: &str| assert!(text.contains(part), "{part}\n{text}");
    // Cut in the middle of a line.
    has(&first(bvh(&BVH[..BVH.len() - 30])), "line 148: a frame needs 18 numbers (got");
    has(&first(csv(&CSV[..CSV.len() - 30])), "line 221: the row has 13 fields, but the header has 17");
    has(&first(amc(&AMC[..AMC.len() - 20])), "frame 120 lacks `rtoes`");
    // Cut between lines.
    let shorter = &BVH[..BVH.trim_end().rfind('\n').unwrap()];
    assert_eq!(first(bvh(shorter)), "line 26: `Frames:` says 121 frames, but there are 120");
    has(&first(bvh(&BVH[..200])), "the file has no line `MOTION`");
    // NaN and text where numbers are expected.
    has(
        &first(bvh(&BVH.replacen("0 90 0", "0 NaN 0", 1))),
        "line 28, column 3: `NaN` is not a finite number",
    );
    has(&first(csv(&CSV.replacen(",0.9000,", ",up,", 1))), "line 2, column 21: `up` is not a number");
    has(&first(amc(&AMC.replacen("ltibia ", "ltibia x", 1))), "is not a number");
    has(
        &first(amc(&AMC.replacen("ltibia ", "tibia ", 1))),
        "line 7, column 1: the skeleton has no bone `tibia`",
    );
    has(&first(amc(&AMC.replacen("\n4\n", "\n5\n", 1))), "frame 5 follows frame 3");
    // Joints, feet and columns that lack.
    has(&first(bvh(&BVH.replace("lFoot", "leftFoot"))), "no layout fits the skeleton");
    let layout = Layout::named("cmu-bvh").unwrap();
    let errors = read_takes("a.bvh", &BVH.replace("lFoot", "foot"), None, Some(&layout), &[]).unwrap_err();
    assert_eq!(
        errors[0].message,
        "the skeleton has no joint `lFoot`, `lFoot.end`; its joints are `hip`, `foot`, `foot.end`, `rFoot`, `rFoot.end`"
    );
    let errors = read_takes("a.bvh", &BVH.replace("Foot", "Hand"), None, Some(&layout), &[]).unwrap_err();
    has(&errors[0].message, "the skeleton has no feet: it lacks `lFoot`");
    has(
        &first(csv(&CSV.replacen("hip_z", "hip", 1))),
        "line 1: the header lacks hip_z; its columns are `clip`",
    );
    has(&first(csv(&CSV.replacen("clip,t", "clip,time", 1))), "the header lacks frame or t");
    // Rates.
    has(
        &first(csv(&CSV.replacen("clip,t", "clip,frame", 1))),
        "line 3, column 7: frame 0.0333 follows 0 in its clip",
    );
    let line = |clip: &str, t: f64| format!("{clip},{t},{}\n", ["0"; 15].join(","));
    let header = CSV.lines().next().unwrap();
    let mixed = format!("{header}\n{}{}{}{}", line("a", 0.0), line("a", 0.1), line("b", 0.0), line("b", 0.2));
    has(&first(csv(&mixed)), "clips `a` and `b` have 10.00 and 5.00 frames per second; list them in a table");
    let uneven = format!("{header}\n{}{}{}", line("a", 0.0), line("a", 0.1), line("a", 0.4));
    has(&first(csv(&uneven)), "line 3: this frame is 0.1000 s after the one before it");
    let frames = format!("{}\n{}{}", header.replace(",t,", ",frame,"), line("a", 0.0), line("a", 1.0));
    has(&first(csv(&frames)), "the file has no frame rate");
    // Too deep.
    let deep = format!("HIERARCHY ROOT a {{ {} MOTION\nMOTION\n", "JOINT b { ".repeat(500));
    has(&first(bvh(&deep)), "joints are nested more than 100 deep");
    let circle = ASF.replacen("rtibia rtoes", "rtibia rtoes\nltibia lhipjoint", 1);
    let errors = read_takes("a.amc", AMC, Some(&Asf::read(&circle).unwrap()), None, &[]).unwrap_err();
    has(&errors[0].message, "form a circle");
    // Far away, and too short.
    has(&first(bvh(&BVH.replacen("Frames: 121", "Frames: 1", 1)[..1200])), "a frame needs");
    let far = first(csv(&CSV.replacen(",0.9000,", ",9e6,", 1)));
    has(&far, "line 2: clip `stand`: a coordinate must lie between -1e6 m and 1e6 m");
    has(&first(csv(&format!("{header}\n{}", line("a", 0.0)))), "the file has no frame rate");
    has(&first(csv(header)), "the file has no frames");
    has(&read_takes("a.txt", "", None, None, &[]).unwrap_err()[0].message, "no known extension");
    has(&Asf::read(AMC).unwrap_err().message, "the file has no bones");
}

fn damaged(text: &str, cut: usize, changes: &[(usize, u8)]) -> String {
    let mut bytes = text.as_bytes().to_vec();
    bytes.truncate(cut % (bytes.len() + 1));
    for &(at, byte) in changes {
        let at = at % bytes.len().max(1);
        if let Some(old) = bytes.get_mut(at) {
            *old = byte;
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]
    #[test]
    fn damaged_files_stop_no_reader(
        cut in prop_oneof![Just(usize::MAX / 2), any::<usize>()],
        near in any::<usize>(),
        changes in prop::collection::vec((any::<usize>(), prop_oneof![any::<u8>(), prop::sample::select(b"{}:.,-e9\n ".to_vec())]), 0..6),
    ) {
        // The heads of the files are short: half of the changes go there.
        let near = near % 2 == 0;
        let changes: Vec<_> = changes.iter().map(|&(at, byte)| (if near { at % 900 } else { at }, byte)).collect();
        let whole = |text: &str| if cut == usize::MAX / 2 { text.len() } else { cut };
        for text in [BVH, AMC, CSV] {
            let text = damaged(text, whole(text), &changes);
            let lines = text.lines().count();
            for read in [bvh, amc, csv] {
                if let Ok(takes) = read(&text) {
                    for take in takes {
                        let n = take.root.len();
                        prop_assert!(n >= 2 && take.root.iter().all(|p| p.x.is_finite() && p.y.is_finite()));
                        prop_assert!(take.feet.iter().all(|foot| foot.ankle.len() == n && foot.toe.len() == n));
                    }
                }
            }
            if let Err(errors) = read_take_table(&text) {
                prop_assert!(errors.iter().all(|error| error.line <= lines + 1));
            }
        }
        if let Ok(asf) = Asf::read(&damaged(ASF, whole(ASF), &changes)) {
            let _ = read_takes("a.amc", AMC, Some(&asf), None, &[]);
        }
    }
}
