//! Metrics of the rings.

use touchstone_base::record::MetricKey;

touchstone_base::metrics! {
    all ALL;
    RESTITUTION = "restitution" ["-"]
        "velocity of the centre of mass at the end/V, of rings that have touched and parted";
    PIECES_MOST = "pieces_most" ["1"] "most connected pieces at any time";
    HOLES_LEAST = "holes_least" ["1"]
        "least number of holes of a ring at any time, discs of 0.75 dx; 1 is whole, 0 is cut through or \
        pressed flat";
    TORN_AT = "torn_at" ["L/c0"]
        "first sample at which a ring has no hole or more than one piece; absent if none, and of bodies \
        whose neighbours stay, which are only pressed flat or stretched";
    VOLUME_LEAST = "volume_least" ["-"]
        "least volume of a particle at any time/at the start, the determinant of the deformation gradient; \
         not above 0 where a body is turned inside out";
    STRETCH_MOST = "stretch_most" ["dx"]
        "largest distance at any time of particles that were within 1.2 dx at the start";
    WIDTH_MIN = "width_min" ["L"] "least extent of a ring along the line of flight";
    HEIGHT_MAX = "height_max" ["L"] "largest extent of a ring across it";
    ENERGY_LOST = "energy_lost" ["-"] "1 - (kinetic + strain energy) at the end/at the start";
    ENERGY_GAINED = "energy_gained" ["-"] "largest total energy at any time/at the start - 1";
    PHASES = "phases" ["1"] "phases of contact, at least 5 L/c0 apart";
    MOMENTUM = "momentum" ["-"] "|sum m v| at the end/momentum of one ring, exactly 0";
    IMPULSE = "impulse" ["rho c0 L^2"] "mass of a ring times the change of its velocity in this phase";
    T_IMPULSE_1 = "t_impulse_1" ["L/c0"] "when this share (in %) of the phase's impulse has passed";
    T_IMPULSE_99 = "t_impulse_99" ["L/c0"] "when this share (in %) of the phase's impulse has passed";
    IMPULSE_ERROR = "impulse_error" ["-"] "impulse of the phase/finite elements - 1";
    CONTACT_BEGIN_ERROR = "contact_begin_error" ["L/c0"]
        "when 1 % of the phase's impulse has passed, minus this time of finite elements";
    CONTACT_END_ERROR = "contact_end_error" ["L/c0"]
        "when 99 % of the phase's impulse has passed, minus this time of finite elements";
    RESTITUTION_ERROR = "restitution_error" ["-"] "restitution/finite elements - 1";
    WIDTH_MIN_ERROR = "width_min_error" ["-"] "width_min/finite elements - 1";
    HEIGHT_MAX_ERROR = "height_max_error" ["-"] "height_max/finite elements - 1";
    X_C_WORST = "x_c_worst" ["L"] "x_c minus x_c of finite elements, when this is largest in magnitude";
    X_C_RMS = "x_c_rms" ["L"] "rms over the run of x_c - finite elements";
    V_C_RMS = "v_c_rms" ["c0"] "rms over the run of v_c - finite elements";
    WIDTH_RMS = "width_rms" ["L"] "rms over the run of width - finite elements";
    HEIGHT_RMS = "height_rms" ["L"] "rms over the run of height - finite elements";
    HISTORIES = "histories" ["-"] "the largest of x_c_rms, width_rms and height_rms/outer diameter";
}

/// Metrics that need the phases of contact, which begin and end between two steps; extremes of every step;
/// and energies, which need the stress.
pub const STEPWISE: &[MetricKey] = &[
    RESTITUTION,
    RESTITUTION_ERROR,
    IMPULSE,
    IMPULSE_ERROR,
    T_IMPULSE_1,
    T_IMPULSE_99,
    CONTACT_BEGIN_ERROR,
    CONTACT_END_ERROR,
    STRETCH_MOST,
    ENERGY_GAINED,
];

/// Distances of path and extents of a ring over time from finite elements.
pub const OF_HISTORIES: [MetricKey; 6] =
    [X_C_WORST, X_C_RMS, V_C_RMS, WIDTH_RMS, HEIGHT_RMS, HISTORIES];
/// Least and largest extents.
pub const OF_EXTENTS: [MetricKey; 4] = [WIDTH_MIN, WIDTH_MIN_ERROR, HEIGHT_MAX, HEIGHT_MAX_ERROR];

/// Numbers that finite elements have too, and the distance from these.
pub const COMPARED: [(MetricKey, MetricKey); 3] = [
    (RESTITUTION, RESTITUTION_ERROR),
    (WIDTH_MIN, WIDTH_MIN_ERROR),
    (HEIGHT_MAX, HEIGHT_MAX_ERROR),
];

/// Distances of the histories of place, velocity, width and height.
pub const RMS: [MetricKey; 4] = [X_C_RMS, V_C_RMS, WIDTH_RMS, HEIGHT_RMS];

/// The mark of the metrics of a phase of contact, counted from 0.
pub fn phase(k: usize) -> String {
    format!("phase{}", k + 1)
}
