//! Any text as a recording or a geometry: never a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use smc::data::geometry::{Placement, open_doors, plan, read_dxf, read_geojson, read_osm, read_wkt};
use smc::base::geometry::Vec2;
use smc::data::tracks::{Format, Reading, Velocity, read_batch, read_eth_biwi, read_groups};
use smc::perception::{ConstantVelocity, Inferring, infer};

fuzz_target!(|text: &str| {
    let _ = read_eth_biwi(text);
    let _ = read_groups(text);
    let _ = read_batch(text);
    let named = Some("id,frame,x/cm,y/cm".to_owned());
    for format in Format::all() {
        for (frames_per_second, columns) in [(None, None), (Some(25.0), None), (Some(25.0), named.clone())] {
            let reading = Reading { frames_per_second, columns, ..Reading::default() };
            let _ = format.read(text, &reading);
            if let Ok(batches) = format.read_batches(text, &reading, Velocity::Seen) {
                let _ = infer(&batches, &Inferring::default(), &mut ConstantVelocity);
            }
        }
    }
    let drawing = read_dxf(text, None, &mut |_, _| true).map(|drawing| drawing.features);
    let osm = read_osm(text, &mut |_, _| true);
    for features in [read_geojson(text), read_wkt(text), osm, drawing] {
        for walkable in [false, true] {
            let Ok(mut features) = features.clone() else { continue };
            let _ = Placement::Plane { unit: 1.0, origin: Vec2::zeros(), is_stated: false }.place(&mut features);
            let Ok(plan) = plan(&features, (1.0, 1e-3), walkable) else { continue };
            let mut walls: Vec<_> = plan.barriers.into_iter().filter_map(|(_, form)| match form {
                smc::data::geometry::Form::Wall(pieces) => Some(pieces),
                smc::data::geometry::Form::Solid(_) => None,
            }).collect();
            let _ = open_doors(&mut walls.iter_mut().collect::<Vec<_>>(), &plan.doors);
        }
    }
});
