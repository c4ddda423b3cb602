//! Where a run leaves what its elastic law is good for.

use super::film::Film;
use crate::chain::Chain;
use crate::quantity::engineering;

/// A note on contacts that bore more than makes their softer body yield, as far as the film's frames show.
pub fn note(chain: &Chain, film: &Film) -> Option<String> {
    let mut worst: Option<(f64, f64, usize)> = None;
    let mut count = 0;
    for (j, (contact, forces)) in chain.contacts().iter().zip(&film.contact_forces).enumerate() {
        let Some(limit) = contact.yield_force else { continue };
        let most = forces.iter().copied().fold(0.0, f64::max);
        if most > limit {
            count += 1;
            if worst.is_none_or(|(force, other, _)| most / limit > force / other) {
                worst = Some((most, limit, j));
            }
        }
    }
    let (force, limit, j) = worst?;
    let name = |i: Option<usize>| {
        i.and_then(|i| chain.bodies().get(i)).map_or("the wall", |body| body.name.as_str())
    };
    Some(format!(
        "{count} contacts bear more than makes their softer body yield, the one between {} and {} at least {} where {} would do (Hertz's peak pressure above 1.6 yield strengths, Johnson 1985, slow loading): real amplitudes are lower",
        name(j.checked_sub(1)),
        name(Some(j)),
        engineering(force, "N", 3),
        engineering(limit, "N", 2)
    ))
}
