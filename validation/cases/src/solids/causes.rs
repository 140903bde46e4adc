//! Causes why elastic bodies are outside their bounds.

use touchstone_base::gate::Cause;

/// Sums miss neighbours at free faces.
pub static FREE_FACES: Cause = Cause::new(
    "Velocity gradients are not corrected where neighbours are missing, so free faces of an elastic body are \
     too soft and mistake rotation for strain.",
    "Corrected gradients at free faces, or the total Lagrangian form of the variant `lagrangian`.",
);

/// Bodies act on each other before they touch.
pub static SOFT_CONTACT: Cause = Cause::new(
    "Bodies push each other as soon as their kernels overlap, so contact begins before they touch and yields \
     like a spring.",
    "A law of contact between the surfaces of bodies, or finer spacing.",
);

/// Short waves are slow.
pub static DISPERSION: Cause = Cause::new(
    "Waves of a few spacings are slower than long ones, so a front leaves waves behind, which keep a share \
     of the energy.",
    "Finer spacing, or viscosity that acts in shocks alone.",
);

/// Folds of few spacings.
pub static FOLDS: Cause = Cause::new(
    "Where a thin ring folds, its curvature changes within a few spacings, and the resistance to hourglass \
     modes makes it too stiff.",
    "More particles through the thickness.",
);

/// Creases of few particles.
pub static CREASES: Cause = Cause::new(
    "Fast rings fold until the inner face of the fold creases, and the strain of a crease grows as the \
     spacing falls.",
    "Contact of a body with itself, which would close a crease; untried.",
);

/// Bodies that touch are one.
pub static ONE_LATTICE: Cause = Cause::new(
    "Two bodies on one lattice are one body to the equations, so their contact can pull as well as push.",
    "A law of contact between bodies, which pushes and does not pull.",
);

/// Effects of artificial viscosity other than damping shocks.
pub static VISCOSITY: Cause = Cause::new(
    "Artificial viscosity, which is proportional to the spacing, takes energy from motion and shifts and \
     widens the front of a wave.",
    "Viscosity that acts in shocks alone, a Riemann solver with reconstruction, or finer spacing.",
);

/// Artificial stress is not elastic.
pub static STRESS_ADDS_ENERGY: Cause = Cause::new(
    "Artificial stress weakens tension and stores no energy for it, so it adds energy to a body that bends.",
    "The variant `lagrangian`, which needs no artificial stress.",
);

/// Artificial stress does not hold everything.
pub static TEARING: Cause = Cause::new(
    "Artificial stress delays the tensile instability without removing it, so rubber tears at high speeds \
     or fine spacing.",
    "The variant `lagrangian`, which has no tensile instability.",
);

/// Known in part alone.
pub static SHARED_IMPULSE: Cause = Cause::unexplained(
    "The two phases of contact share the impulse differently from finite elements; artificial viscosity \
     explains a part alone.",
    "Unknown: XSPH, softness in bending and softness of the contact do not explain it.",
);

/// Layers that cannot keep their volume.
pub static LOCKING: Cause = Cause::new(
    "An even number of layers cannot keep the volume of every layer of a bent plate, so nearly \
     incompressible plates are too stiff.",
    "An odd number of layers, finer spacing, or a pressure that is taken over several particles.",
);
