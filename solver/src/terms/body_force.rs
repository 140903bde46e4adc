use nalgebra::Vector2;

use super::{Pair, Term};
use crate::{
    kernel::Kernel,
    lane::Lane,
    particles::{Common, Rate},
};

/// f of (4): a constant force per mass \[m/s²\].
#[derive(Clone, Copy, Debug)]
pub struct BodyForce(pub Vector2<f64>);

impl<X> Term<X> for BodyForce {
    type Shows = ();
    type Sum = ();

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, _: &Pair<V, K>, _: (), _: (), _: &mut ()) {}

    #[inline(always)]
    fn finish(&self, _: &Common<f64>, _: Self::Shows, _: (), rate: &mut Rate<X>) {
        rate.velocity += self.0;
    }
}
