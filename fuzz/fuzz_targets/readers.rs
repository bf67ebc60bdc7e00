//! Any text as a recording or a geometry: never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use smc::data::geometry::{read_geojson, read_wkt};
use smc::data::tracks::{read_eth_biwi, read_groups};

fuzz_target!(|text: &str| {
    let _ = read_eth_biwi(text);
    let _ = read_groups(text);
    let _ = read_geojson(text);
    let _ = read_wkt(text);
});
