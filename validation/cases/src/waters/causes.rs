//! Causes why water is outside its bounds.

use touchstone_base::gate::Cause;

/// Images behind a ghost wall with the opposite velocity.
pub static NO_SLIP_IMAGES: Cause = Cause::new(
    "Ghost particles carry the opposite velocity along their wall, which the continuity equation (3) takes \
     for changes of density where particles are disordered.",
    "Ghosts along which water slips, as in `ghosts-slip`, or walls that extrapolate the pressure, as in \
     `modern`.",
);

/// No force holds a particle in the plane of a ghost wall.
pub static PRESSED_THROUGH: Cause = Cause::new(
    "A particle that is pressed into the plane of a ghost wall feels equal forces from both sides and may \
     cross it.",
    "Walls of particles, as in `modern`, or ghosts along which water slips, which put it back.",
);

/// Effects of artificial viscosity other than damping noise.
pub static VISCOSITY: Cause = Cause::new(
    "Artificial viscosity, which is proportional to spacing and sound speed, takes energy from the water and \
     slows its front.",
    "Finer spacing, or less artificial viscosity together with density diffusion, as in `modern`.",
);

/// The equations are not the experiment.
pub static TWO_DIMENSIONS: Cause = Cause::new(
    "Water in two dimensions, released at once and without friction and air, runs faster than in the \
     experiment, in a thinner layer.",
    "A computation in three dimensions with the moving wall of the experiment, friction and air.",
);

/// A reference whose steps are of first order.
pub static UNCERTAIN_REFERENCE: Cause = Cause::new(
    "Where a thin jet has just arrived, the impulse by volume of fluid falls with its time step, by 11 % \
     with half of it.",
    "A reference whose steps are of second order.",
);

/// Walls without friction.
pub static FREE_SLIP: Cause = Cause::new(
    "Water slips along its walls without friction, and runs ahead of codes and experiments whose walls drag \
     it.",
    "Friction at the walls, with a boundary layer that is resolved or modelled.",
);

/// Sound of an impact.
pub static RINGS: Cause = Cause::new(
    "The impact leaves sound: a quarter wave across a layer of 0.28 H, at 12.5 √(g/H), which a doubled sound \
     speed removes.",
    "An acoustic damper with h/dx 2 and more sound speed, as in `damped`.",
);

/// A kernel of 50 neighbours.
pub static WIDE_KERNEL: Cause = Cause::new(
    "A kernel of 2 spacings smooths the density over more of the column, whose surface is then less sharp.",
    "Finer spacing.",
);

/// An acoustic damper where few particles touch a wall.
pub static DAMPED_SPLASH: Cause = Cause::unexplained(
    "Perhaps the acoustic damper acts on drops inside a wall by a force that changes faster than its \
     impulse is sampled.",
    "A wall that continues the divergence of the water.",
);

/// Sums over too few neighbours.
pub static SHORT_KERNEL: Cause = Cause::new(
    "The strain moves rows of particles two initial spacings apart, and a smoothing length of 1.5 spacings \
     is too short for accurate sums there.",
    "A smoothing length of 2.5 initial spacings, as in `modern`.",
);

/// Noise of the density that nothing smooths.
pub static NOISY_DENSITY: Cause = Cause::new(
    "The density that follows the continuity equation (3) becomes noisy where rows of particles shear, and \
     its pressure shakes the particles.",
    "Density diffusion, as in `modern`.",
);

/// A mirror does not include gravity.
pub static MIRRORED_PRESSURE: Cause = Cause::new(
    "Ghost particles mirror the pressure of the water at the bottom, where it should keep rising, so the \
     lowest row has too much pressure.",
    "Walls that extrapolate the pressure with the weight of the water, as in `modern`.",
);
