//! One run of a channel flow: measurements and their times.

use std::ops::ControlFlow;

use touchstone_base::record::Status;
use touchstone_harness::prelude::*;
use touchstone_harness::snapshot::Snapshot;

use super::{
    ChannelSetup,
    measure::{self, MODE},
    setup::DECISIVE,
};

impl Problem for ChannelSetup {
    type Extra = ();
    type Simulation = dyn Stepper<()>;
    /// Time and amplitude of the pressure mode after every step, if requested.
    type Watch = Vec<[f64; 2]>;

    fn method(&self) -> &Method {
        &self.method
    }

    fn brief(&self) -> Brief {
        let (s, Medium { eos, h, dx, .. }) = (&self.settings, self.medium);
        let c0 = eos.sound_speed;
        let own = [("V [m/s]", self.v), ("c0/V", c0 / self.v), ("c0 h/nu", c0 * h / s.nu)];
        let particles = s.rows as f64 * self.columns as f64;
        let mut brief = Brief::new(self.medium, self.rules, particles, DECISIVE)
            .numbers(&self.rules.numbers([s.h_over_dx, dx]))
            .numbers(&own);
        brief.numbers.push(("columns", self.columns.into()));
        Brief { least_steps: s.least_steps, ..brief }
    }

    fn times(&self) -> Vec<f64> {
        self.settings.compared().iter().map(|tau| self.time(*tau)).collect()
    }

    fn scene(&self) -> Result<Parts, RunError> {
        Ok(self.parts())
    }

    fn watch(&self, _: &Snapshot, _: &Snapshot) -> Self::Watch {
        Vec::new()
    }

    fn calls(&self, calls: Calls<Self>, _: OptionalOutput) -> Calls<Self> {
        calls
            .when(self.settings.watch_mode, |calls| {
                calls.after_step("pressure mode", |setup, mode, now| {
                    mode.extend(measure::pressure_mode(setup, now).map(|p| [now.time(), p]));
                    ControlFlow::Continue(())
                })
            })
            .at("profiles and errors", |setup, _, now, k, record| {
                let tau = setup.settings.compared()[k];
                measure::compare(setup, &now.moving(), tau, record);
            })
    }

    fn measure(&self, mode: Self::Watch, end: &Snapshot, record: &mut Record) {
        if record.status == Status::Completed {
            measure::at_the_end(self, end, record);
        }
        if self.settings.watch_mode {
            let last = measure::last_of_mode(self, &mode, end.time());
            record.profiles.extend(last.map(|last| (MODE.into(), last)));
        }
    }
}
