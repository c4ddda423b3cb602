//! Sections II and III: the bench's own numbers, and Fig. 3, the dispersion relation.

use super::claims::{Claim, Expected};
use super::record::nothing;
use super::verdict::ClaimResult;
use super::{Arrangement, Figure, IntermediateResults, PaperError};
use crate::analysis::dispersion::DiatomicChain;
use crate::measurement::metadata::cell_and_force;
use crate::scene::{Scene, Site};

/// A scene whose contacts all bear the magnet's force as printed, without any weight.
const PRELOADED_SCENE: &str = "linear-300-cells";
/// A particle of it with neighbours on either side.
const PARTICLE: usize = 5;

/// The linear chain of `scene` around `particle` and the static force there (N).
pub(super) fn cell(scene: &Scene, particle: usize) -> Result<(DiatomicChain, f64), PaperError> {
    let cell = cell_and_force(scene, Site::Particle(particle));
    cell.ok_or_else(|| nothing(scene, "cell of two masses under a preload"))
}

/// Fig. 3 and what belongs to it. The force that `f2` as printed stands for is found from it, since
/// that has the most digits.
pub(super) fn figure_3(
    claims: &[Claim],
    found: &mut IntermediateResults,
) -> Result<(), PaperError> {
    let scene = Scene::load(PRELOADED_SCENE)?;
    let (chain, force) = cell(&scene, PARTICLE)?;
    let printed = |item: &str| match claims.iter().find(|claim| claim.item == item)?.expected {
        Expected::Printed { value, .. } => Some(value),
        Expected::AtLeast(_) | Expected::AtMost(_) => None,
    };
    let top = printed("gap_top").ok_or_else(|| nothing(&scene, "printed f2"))?;
    // f goes with F^(1/6).
    let other = force * (top / chain.gap_top()).powi(6);
    let meant = chain.pressed(force, other);
    let overlap = |chain: &DiatomicChain, force: f64| 1.5 * force / chain.stiffness;
    let with = format!("F0 = {force} N, as printed");
    let under =
        format!("F0 = {other:.4} N, from f2 as printed, which print rounds to {other:.2} N");
    let doubled = chain.pressed(force, 2.0 * force);
    found.answers.extend([
        ClaimResult::to("static_overlap")
            .plain(&with, overlap(&chain, force))
            .or(&under, overlap(&meant, other)),
        ClaimResult::to("gap_bottom")
            .plain(&with, chain.gap_bottom())
            .or(&under, meant.gap_bottom()),
        ClaimResult::to("gap_top")
            .plain(&with, chain.gap_top())
            .or(&under, meant.gap_top())
            .note("overlap and f1 are the test of that force, this one made it"),
        ClaimResult::to("gap_exponent")
            .plain("doubled preload", (doubled.gap_bottom() / chain.gap_bottom()).log2()),
    ]);
    found.figures.push(Figure {
        number: 3,
        title: "Dispersion relation of the linear chain".to_owned(),
        arrangement: Arrangement::Dispersion,
        chain,
        signals: Vec::new(),
        parts: Vec::new(),
        run: None,
    });
    Ok(())
}

/// Masses of section II.
pub(super) fn bench(answers: &mut Vec<ClaimResult>) -> Result<(), PaperError> {
    let scene = Scene::load("magnet-0.61g")?;
    let (chain, _) = cell(&scene, 2)?;
    let cell_mass = chain.light_mass + chain.heavy_mass;
    let plain = "from the masses as printed";
    answers.push(ClaimResult::to("cell_mass").plain(plain, cell_mass));
    for striker in ["2.75g", "17.81g"] {
        let scene = Scene::load(format!("magnet-{striker}"))?;
        let mass = scene.chain.bodies().first().map_or(f64::NAN, |body| body.mass);
        let item = format!("striker_{striker}_in_cells");
        answers.push(ClaimResult::to(&item).plain(plain, mass / cell_mass));
    }
    let body = scene.chain.bodies().get(scene.chain.body_of(27));
    let body = body.ok_or_else(|| nothing(&scene, "particle 27"))?;
    let kind = body.name.replace('_', " ");
    answers.push(
        ClaimResult::to("host_of_sensor_27")
            .plain("the ferromagnetic sphere is particle 1", body.mass)
            .note(format!("it is a {kind}, as section II and Figs 8 and 9 have it")),
    );
    Ok(())
}
