use super::{Common, In, Kernel, Lane, News, Pair, Rate, Term, Vector2};

/// A term for which the images behind walls along which the fluid slips ([`crate::SlipGhosts`]) have the
/// velocity of those behind no-slip walls ([`crate::Ghosts`]). Each column carries the difference of the two
/// \[m/s\], which is 0 for particles.
#[derive(Clone, Copy, Debug)]
pub struct NoSlipImages<T>(pub T);

impl<X, T: Term<X>> Term<X> for NoSlipImages<T> {
    type Derived = (T::Derived, Vector2<f64>);
    type Sum = T::Sum;

    fn prepare(&mut self, max_speed: f64) {
        self.0.prepare(max_speed);
    }
    #[inline(always)]
    fn derived(&self, own: &Common, extra: &X) -> Self::Derived {
        const { assert!(!T::NORMALISES, "moments are not passed on") };
        (self.0.derived(own, extra), Vector2::zeros())
    }
    #[inline(always)]
    fn tell(derived: &mut Self::Derived, news: News) {
        match news {
            News::NoSlip(difference) => derived.1 += difference,
            _ => T::tell(&mut derived.0, news),
        }
    }
    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Self::Derived>, sum: &mut In<T::Sum, V>) {
        let [own, other] = pair.derived;
        self.0.pair(&Pair { v: pair.v - other.1, ..pair.with([own.0, other.0]) }, sum);
    }
    #[inline(always)]
    fn finish(&self, own: &Common, derived: Self::Derived, sum: T::Sum, rate: &mut Rate<X>) {
        self.0.finish(own, derived.0, sum, rate);
    }
    #[inline(always)]
    fn place(&self, position: Vector2<f64>, rate: &mut Rate<X>) {
        self.0.place(position, rate);
    }
}
