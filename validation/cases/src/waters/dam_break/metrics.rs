//! Metrics of a collapsing column.

use touchstone_base::record::{MetricKey, MetricName};

use crate::waters::water::ledger::{self};

/// Distance of curves from an experiment's.
pub struct Distance {
    /// As released.
    pub rms: MetricKey,
    /// After the best shift of the clock.
    pub rms_shifted: MetricKey,
    /// The shift.
    pub shift: MetricKey,
}

impl Distance {
    /// The metrics with their formulas, of the distance of curves in these words.
    pub fn named(self, curves: &str) -> [MetricName; 3] {
        let shifted = self.rms_shifted.of(String::from(self.shift));
        [self.rms.of(curves), shifted, self.shift.into()]
    }

    /// The metrics of the distance.
    pub fn metrics(self) -> [MetricKey; 3] {
        [self.rms, self.rms_shifted, self.shift]
    }
}

const fn distance([rms, rms_shifted, shift]: [&'static str; 3]) -> Distance {
    let formula = "rms distance of {} over the points of the experiment";
    let formula_shifted = "the same with the clock of the computation put forward by {}";
    let formula_shift = "that shift, of the least rms, in the experiment's unit of time";
    Distance {
        rms: MetricKey::new(rms, "-", formula),
        rms_shifted: MetricKey::new(rms_shifted, "-", formula_shifted),
        shift: MetricKey::new(shift, "-", formula_shift),
    }
}

/// Metrics of the front.
pub const FRONT: Distance = distance(["front_rms", "front_rms_shifted", "front_shift"]);
/// Metrics of the residual height.
pub const HEIGHT: Distance = distance(["height_rms", "height_rms_shifted", "height_shift"]);
/// Metrics of the levels.
pub const LEVELS: Distance = distance(["levels_rms", "levels_rms_shifted", "levels_shift"]);

touchstone_base::metrics! {
    all ALL;
    REACHED = "reached" ["-"] "time at which the run ended over that at which it was to end";
    OUTSIDE = "outside" ["1"]
        "most particles more than dx/2 behind bottom and sides at any time, without those that left over \
         the rim";
    OUTSIDE_END = "outside_end" ["1"] "those at the end";
    SPILLED = "spilled" ["-"] "share of the particles that left the tank over the rim of its walls";
    MACH = "mach" ["-"] "largest speed of a particle/c0, without those that left over the rim";
    MOMENTUM_GAP = "momentum_gap" ["-"]
        "max |change of momentum - impulse of walls and gravity|/(M (g H)^(1/2))";
    MASS_ERROR = "mass_error" ["-"]
        "|mass of the water at the end/that at the start - 1|, of all particles, lost ones too";
    Z = "z" ["-"]
        "Z = front from the back wall/a at T = t (2g/a)^(1/2), front = x of the foremost particle below H/4, \
         plus a, minus this x at the start";
    FRONT_BACK = "front_back" ["-"]
        "most by which the front is behind where it has been, in a, until it is at the far wall";
    FRONT_AWAY = "front_away" ["-"]
        "front minus the front of the same model by volume of fluid: in a at T = t (2g/a)^(1/2), in the tank \
         in H at t (g/H)^(1/2)";
    HEIGHT_AWAY = "height_away" ["-"]
        "rms distance of the residual height/H from that of the same model by volume of fluid";
    RELEASED = "released" ["-"]
        "height of the centre of mass above the floor at the start/(H/2) - 1";
    POTENTIAL_AWAY = "potential_away" ["-"]
        "rms distance of the potential energy 2 sum m (y - b)/(H sum m) of all particles from that of the \
         same model by volume of fluid, until t (g/H)^(1/2) = 1.8, in the tank 3; b is half a spacing below \
         the lowest particle at the start";
    ARRIVAL = "arrival" ["-"]
        "t (g/H)^(1/2) at which P1 first exceeds 0.1 rho g H; pressures are aligned by it";
    PEAK = "peak_P1" ["-"] "largest pressure on P1/(rho g H), means over 0.01 (H/g)^(1/2)";
}

/// A metric of each of four probes or sensors.
const fn four(formula: &'static str, [a, b, c, d]: [&'static str; 4]) -> [MetricKey; 4] {
    [
        MetricKey::new(a, "-", formula),
        MetricKey::new(b, "-", formula),
        MetricKey::new(c, "-", formula),
        MetricKey::new(d, "-", formula),
    ]
}

/// Distance of each level from the reference with the same model.
pub const LEVEL_AWAY: [MetricKey; 4] = four(
    "rms distance of the level/H from that of the same model by volume of fluid, until t (g/H)^(1/2) = 5.5",
    ["H1_away", "H2_away", "H3_away", "H4_away"],
);
/// Impulse on each sensor over the impulse in the reference with the same model.
pub const IMPULSE_AWAY: [MetricKey; 4] = four(
    "impulse from the arrival at P1 on, for that many (H/g)^(1/2), over that of the same model by volume of \
     fluid, minus 1",
    ["impulse_P1_away", "impulse_P2_away", "impulse_P3_away", "impulse_P4_away"],
);
/// Distance of the history of the pressure on each sensor from the reference with the same model.
pub const PRESSURE_AWAY: [MetricKey; 4] = four(
    "rms distance of the pressure/(rho g H) from that of the same model by volume of fluid, both means over \
     0.01 (H/g)^(1/2), from 0.1 to 2.5 (H/g)^(1/2) after the arrival at P1",
    ["P1_away", "P2_away", "P3_away", "P4_away"],
);
/// Ringing of the pressure on each sensor.
pub const RINGING: [MetricKey; 4] = four(
    "rms of the pressure/(rho g H) minus its mean over 0.5 (H/g)^(1/2), of means over 0.01 (H/g)^(1/2), for \
     t (g/H)^(1/2) from 3.2 to 5.8",
    ["P1_ringing", "P2_ringing", "P3_ringing", "P4_ringing"],
);
/// Impulse on each sensor, at the end of its window.
pub const IMPULSE: [MetricKey; 4] = four(
    "impulse from the arrival at P1 on, for that many (H/g)^(1/2), over the measured one, minus 1",
    ["impulse_P1", "impulse_P2", "impulse_P3", "impulse_P4"],
);

/// Every metric of the case, with the open parts of formulas.
pub fn every() -> Vec<MetricName> {
    let column = "M g H/2, the potential energy of the column";
    let mut all: Vec<MetricName> = ALL.iter().copied().map(MetricName::from).collect();
    all.extend(ledger::METRICS.map(|metric| metric.of(column)));
    for (distance, what) in [
        (FRONT, "Z at equal T, or of x of the tip from the gate/H,"),
        (HEIGHT, "the depth at 0.2 a over H at equal t (g/a)^(1/2)"),
        (LEVELS, "all four levels/H"),
    ] {
        all.extend(distance.named(what));
    }
    let of_probes = [LEVEL_AWAY, IMPULSE_AWAY, PRESSURE_AWAY, RINGING, IMPULSE].concat();
    all.extend(of_probes.into_iter().map(MetricName::from));
    all
}
