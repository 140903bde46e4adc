//! Total Lagrangian SPH of elastic solids in plane strain, whose forces derive from stored energies.
//!
//! Neighbours, volumes and moments belong to the reference configuration X and are computed once. With the
//! displacement u = x − X, uₐᵦ = u_b − u_a, Xₐᵦ = X_b − X_a and the weight g = V_a V_b F(|Xₐᵦ|) of a pair, F
//! = −W'/r,
//!
//! | Quantity | Definition |
//! |---|---|
//! | moments | M_a = Σ_b g Xₐᵦ ⊗ Xₐᵦ \[m²\], L_a = M_a⁻¹ |
//! | displacement gradient | H_a = F_a − 1 = (Σ_b g uₐᵦ ⊗ Xₐᵦ) L_a, exact for linear fields |
//! | residual of a pair | Eₐᵦ = uₐᵦ − H_a Xₐᵦ, 0 for a linear field |
//! | stored energy | U = Σ_a V_a w(F_a) + ¼ c Σ_a Σ_b g \|Eₐᵦ\|² \[J/m\] |
//! | force | f_a = −∂U/∂x_a = Σ_b g ((B_a + B_b) Xₐᵦ + c uₐᵦ), B = V P L − ½ c H |
//!
//! with the first Piola-Kirchhoff stress P = ∂w/∂F. The gradient is from Bonet & Lok (1999) and Rabczuk,
//! Belytschko & Xiao (2004). The second part of U resists hourglass modes, which deform no particle, as in
//! Ganzenmüller (2015), but with the weight g in place of W/|X|² and along the whole residual. With this
//! weight H_a is the least-squares fit to the neighbours, so the derivative of the second part by H_a is 0,
//! and the force has no further term. U changes neither with a translation nor with a rotation, so the forces
//! conserve linear and angular momentum exactly at every state, and the leapfrog keeps both to round-off.
//! There is no dissipation.
//!
//! The modulus of the second part is c = 8/3 χ μ/G₁ with G₁ = Σ_b V F X². On a lattice, with q(k) the symbol
//! of the gradient, s(k) = Σ V F (1 − cos k·X) and m₄ = Σ V F X⁴, a shear wave has
//! ρ ω² = μ q² + c (s − G₁ q²/2), where q² = k² − m₄ k⁴/(3 G₁) and s − G₁ q²/2 = m₄ k⁴/8: with χ = 1 the two
//! errors of fourth order cancel along the axes, whatever the kernel.
//!
//! Reading order: [`law`] (stored energies), [`mod@reference`], [`body`] (deformations and forces), [`load`]
//! (weight and contact), [`solid`] (the scene and its steps).

pub mod body;
pub mod law;
pub mod load;
pub mod reference;
pub mod solid;

pub use law::{Energies, Hencky, Law, Moduli, SaintVenantKirchhoff};
pub use load::{BetweenFaces, Load, Weight, contact_stiffness};
pub use solid::{Solid, SolidScene};
