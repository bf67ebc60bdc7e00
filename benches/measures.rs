//! What measures of pedestrian dynamics cost in one state of a trial, beside the step that leads to it.
//! `cargo bench --bench measures`

#![allow(clippy::disallowed_methods, reason = "this measures time")]

use smc::Model;
use smc::base::random::TrialKey;
use smc::kernel::{Code, Program, Readings, Run};
use smc::model::{AgentId, Field, LineId, Num, RegionId, Who};
use std::io::Write as _;
use std::sync::Arc;
use std::time::Instant;

/// People in a hall of 10 m by 10 m, all of it measured.
fn hall(people: usize) -> String {
    format!(
        "horizon = 60 s\nstep = 0.02 s\nscene {{ wall (0, 0) -- (10, 0) -- (10, 10) -- (0, 10) -- (0, 0)\n\
         region hall: rect (0, 0) .. (10, 10); line door: (5, 0) -- (5, 10) }}\n\
         kind person: sfm preset helbing2000 {{ noise = 0.1 m/s; radius = 0.2 m }}\n\
         agents crowd[{people}]: person {{ at = uniform in rect (0.3, 0.3) .. (9.7, 9.7); route = (9, 5) -> (1, 5) }}\n"
    )
}

/// Best time of a reading of a number over some states, and of a step, us.
fn times(text: &str, number: &Num, counted: bool) -> (f64, f64) {
    let model = Model::parse(text).unwrap_or_else(|errors| panic!("{errors}"));
    let mut scenario = model.scenario().as_ref().clone();
    if counted {
        scenario.scene.counted.insert(LineId(0));
        scenario.scene.timed.insert(RegionId(0));
    }
    let code = Code::compile(&scenario, &[], std::slice::from_ref(number));
    let program = Program::new(Arc::new(scenario));
    let key = TrialKey { seed: 1, index: 0, branch: 0 };
    let (mut run, _) = Run::of(&program, key.into()).unwrap_or_else(|_| panic!("no start"));
    let mut readings = Readings::default();
    let (mut read, mut step) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..20 {
        let started = Instant::now();
        for _ in 0..20 {
            run.advance();
        }
        step = step.min(started.elapsed().as_secs_f64() * 1e6 / 20.0);
        let started = Instant::now();
        for _ in 0..20 {
            run.read(&code, None, &mut readings);
        }
        read = read.min(started.elapsed().as_secs_f64() * 1e6 / 20.0);
    }
    (read, step)
}

fn main() {
    let mut out = std::io::stdout().lock();
    let user = Who::Agent(AgentId(0));
    for people in [50, 200] {
        let text = hall(people);
        let measures = [
            ("voronoi_density", Num::Voronoi(RegionId(0)), false),
            ("crossings", Num::Crossings(LineId(0), None), true),
            ("dwell", Num::Of(Field::Dwell(RegionId(0)), user), true),
        ];
        for (name, number, counted) in measures {
            let (read, step) = times(&text, &number, counted);
            let _ = writeln!(out, "{people} agents: {name} {read:.1} us, a step of the trial {step:.1} us");
        }
    }
}
