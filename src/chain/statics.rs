//! The static state of a chain, contact by contact: what each bears, and its overlap in closed
//! form.

use super::{
    Body, ChainError, ChainSpec, Contact, Elasticity, End, Law, LinearisedContacts, hertz,
};

/// Constant force on each body from effects and end forces, the magnet's excepted, downward
/// positive (N).
pub fn loads(spec: &ChainSpec, bodies: &[Body]) -> Vec<f64> {
    let gravity = spec.effects.gravity.map_or(0.0, |gravity| gravity.acceleration);
    let mut loads: Vec<f64> = bodies.iter().map(|body| body.mass * gravity).collect();
    // Below a striker the end force has no face of its own to press on: it pulls on particle 1.
    if let (End::Force(force), true, Some(load)) =
        (spec.top, spec.striker.is_some(), loads.get_mut(1))
    {
        *load += force;
    }
    loads
}

/// Contact `j`, between bodies `j - 1` and `j`, under the static force `bears` (N).
pub fn contact(
    spec: &ChainSpec,
    bodies: &[Body],
    j: usize,
    bears: f64,
) -> Result<Contact, ChainError> {
    fn side(body: &Body) -> (Elasticity, f64, &str) {
        (body.elasticity, body.curvature, &body.name)
    }
    let wall = |end: &End, name: &'static str| match end {
        End::Wall(elasticity) => Some((*elasticity, 0.0, name)),
        End::Free | End::Force(_) => None,
    };
    let upper = match j.checked_sub(1) {
        Some(above) => bodies.get(above).map(side),
        None => wall(&spec.top, "the top wall"),
    };
    let lower = bodies.get(j).map(side).or_else(|| wall(&spec.bottom, "the bottom wall"));
    let (Some(upper), Some(lower)) = (upper, lower) else {
        return open_end(spec, bodies, j, bears);
    };
    let stiffness = hertz::stiffness((upper.0, upper.1), (lower.0, lower.1));
    if !stiffness.is_finite() {
        return Err(ChainError::FlatOnFlat {
            upper: upper.2.to_owned(),
            lower: lower.2.to_owned(),
        });
    }
    if bears < 0.0 {
        return Err(ChainError::Pulling { body: lower.2.to_owned(), force: bears });
    }
    let law = match spec.effects.linearised_contacts {
        Some(LinearisedContacts) if bears == 0.0 => {
            return Err(ChainError::NothingToLinearise { body: lower.2.to_owned() });
        }
        Some(LinearisedContacts) => Law::Linearised,
        None => Law::Hertz,
    };
    let static_overlap = hertz::overlap(stiffness, bears);
    let yields = |body: Option<&Body>| body.and_then(|body| body.yield_strength);
    let strengths = [yields(j.checked_sub(1).and_then(|i| bodies.get(i))), yields(bodies.get(j))];
    let softest = strengths.into_iter().flatten().reduce(f64::min);
    let yield_force = softest
        .map(|strength| hertz::first_yield((upper.0, upper.1), (lower.0, lower.1), strength));
    let loss = spec.effects.loss_between(short(upper.2), short(lower.2));
    if loss.is_some() && law == Law::Linearised {
        return Err(ChainError::LinearisedWithLoss { body: lower.2.to_owned() });
    }
    let [above, below] = &spec.effects.supports;
    let beside = if j == 0 { Some(above) } else { (j == bodies.len()).then_some(below) };
    let stack = beside.and_then(|support| support.drive()?.stiffness);
    let compliance = stack.map_or(0.0, |stiffness| 1.0 / stiffness);
    let static_force = bears;
    Ok(Contact { stiffness, static_force, static_overlap, law, loss, yield_force, compliance })
}

/// A body's name as losses know it: to them a wall is a wall.
fn short(name: &str) -> &str {
    if name.ends_with(" wall") { "wall" } else { name }
}

/// The place of a contact where nothing stands; at the bottom the loads must have cancelled.
fn open_end(
    spec: &ChainSpec,
    bodies: &[Body],
    j: usize,
    bears: f64,
) -> Result<Contact, ChainError> {
    if j == bodies.len() {
        let support = if let End::Force(force) = spec.bottom { force } else { 0.0 };
        let rest = bears - support;
        if rest.abs() > 1e-12 * (bears.abs() + support.abs()) {
            return Err(ChainError::Unbalanced { net_force: rest });
        }
    }
    // An end force presses on the outermost face without giving: a plate next to it feels it.
    Ok(Contact { static_force: bears, ..Contact::OPEN })
}
