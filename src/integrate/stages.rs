//! Weighted sums of stages: what explicit methods do beside their forces.

/// Terms of a weighted sum: stage and weight (1).
pub type Row = &'static [(usize, f64)];

/// Terms that are added in one pass.
const AT_ONCE: usize = 4;

/// `out = sum of weight * of(stage)`, added up in the order of the terms.
pub fn add_up<'a>(weights: Row, of: impl Fn(usize) -> &'a [f64], out: &mut [f64]) {
    out.fill(0.0);
    let (passes, rest) = weights.as_chunks::<AT_ONCE>();
    for pass in passes {
        let [a, b, c, d] = pass.map(|(stage, _)| of(stage));
        let [wa, wb, wc, wd] = pass.map(|(_, weight)| weight);
        for ((sum, (a, b)), (c, d)) in out.iter_mut().zip(a.iter().zip(b)).zip(c.iter().zip(d)) {
            *sum = *sum + wa * a + wb * b + wc * c + wd * d;
        }
    }
    for (stage, weight) in rest {
        for (sum, value) in out.iter_mut().zip(of(*stage)) {
            *sum += weight * value;
        }
    }
}
