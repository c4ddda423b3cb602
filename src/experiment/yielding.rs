//! Where a run leaves what its elastic law is good for.

use super::frames::Frames;
use crate::chain::Chain;
use crate::quantity::engineering;

/// Hertz's law is for overlaps far below the bodies' sizes: beyond this share of a particle's length it does not hold (1).
const MAX_OVERLAP_SHARE: f64 = 0.1;

/// A note on overlaps that are no longer small beside the particles, as far as the film's frames show.
pub fn deep(chain: &Chain, film: &Frames) -> Option<String> {
    if chain.is_linear() {
        return None;
    }
    let share = |j: usize| {
        let (contact, forces) = (chain.contacts().get(j)?, film.contact_forces.get(j)?);
        let most = forces.iter().copied().fold(0.0, f64::max);
        let beside = [j.checked_sub(1), Some(j)].into_iter().flatten();
        // A flat-faced body of which only the mass is told has none.
        let lengths = beside.filter_map(|i| chain.bodies().get(i)).map(|body| body.length);
        let lengths = lengths.filter(|length| *length > 0.0);
        let overlap = (most / contact.stiffness).powf(2.0 / 3.0);
        Some((j, overlap / lengths.fold(f64::INFINITY, f64::min)))
    };
    let real = (0..chain.contacts().len()).filter(|j| chain.contacts()[*j].stiffness > 0.0);
    let (j, most) = real.filter_map(share).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (upper, lower) = chain.beside(j);
    (most > MAX_OVERLAP_SHARE).then(|| {
        format!(
            "the overlap between {upper} and {lower} reaches {most:.1} of the smaller one's length: Hertz's law does not hold there, and these results are not those of a real chain"
        )
    })
}

/// A note on contacts that bore more than makes their softer body yield, as far as the film's frames show.
pub fn note(chain: &Chain, film: &Frames) -> Option<String> {
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
    let (upper, lower) = chain.beside(j);
    let exceed = if count == 1 { "contact exceeds" } else { "contacts exceed" };
    Some(format!(
        "{count} {exceed} the yield load of the softer body ({} between {upper} and {lower}; yields at {}): real peaks will be lower",
        engineering(force, "N", 3),
        engineering(limit, "N", 2)
    ))
}
