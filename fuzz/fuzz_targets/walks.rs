//! Any text as motion capture, a learned gait or a set of walks: never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use smc::data::mocap::{Asf, Layout, read_take_table, read_takes};
use smc::data::walks::read_walks;
use smc::gait::model::LearnedGait;
use smc::gait::steps::{Contact, cut};

fuzz_target!(|text: &str| {
    let _ = LearnedGait::from_json(text);
    let _ = read_walks(text);
    let _ = read_take_table(text);
    let skeleton = Asf::read(text).ok();
    for (name, layout) in Layout::presets() {
        let file = if name == "csv" { "a.csv" } else if name == "cmu-asfamc" { "a.amc" } else { "a.bvh" };
        for take in read_takes(file, text, skeleton.as_ref(), Some(&layout), &[]).unwrap_or_default() {
            for contact in [Contact::Rest, Contact::Adaptive] {
                let _ = cut(&take, contact);
            }
        }
    }
});
