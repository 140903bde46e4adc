//! Body force, f of (4): dvᵢ/dt += f.

use super::{Common, Kernel, Lane, Pair, Rate, Term, Vector2};

/// f of (4): a constant force per mass \[m/s²\].
#[derive(Clone, Copy, Debug)]
pub struct BodyForce(pub Vector2<f64>);

impl<X> Term<X> for BodyForce {
    type Derived = ();
    type Sum = ();

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, _: &Pair<V, K>, _: &mut ()) {}

    #[inline(always)]
    fn finish(&self, _: &Common, _: Self::Derived, _: (), rate: &mut Rate<X>) {
        rate.velocity += self.0;
    }
}
