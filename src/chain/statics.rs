//! The static state of a chain, contact by contact: what each bears, and its overlap in closed
//! form.

use super::geometry::{self, Face};
use super::{
    Body, ChainError, ChainSpec, Contact, ContactLoss, End, Law, LinearisedContacts, LossSpec,
    YieldLaw, hertz,
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
    fn side(body: &Body) -> (Face, &str) {
        (Face::of(body), &body.name)
    }
    let wall = |end: &End, name: &'static str| match end {
        End::Wall(elasticity) => Some((Face::flat(*elasticity), name)),
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
    let ((above, upper), (below, lower)) = (upper, lower);
    let names = (short(upper), short(lower));
    let measured = spec.effects.contact_law.as_ref().map(|law| law.of(names.0, names.1));
    let (stiffness, radius) = geometry::stiffness(above, below);
    let stiffness = measured.map_or(stiffness, |(_, stiffness)| stiffness);
    if !stiffness.is_finite() {
        let (upper, lower) = (upper.to_owned(), lower.to_owned());
        return Err(if geometry::is_line(above, below) {
            ChainError::Line { upper, lower }
        } else {
            ChainError::FlatOnFlat { upper, lower }
        });
    }
    if bears < 0.0 {
        return Err(ChainError::Pulling { body: lower.to_owned(), force: bears });
    }
    let law = match spec.effects.linearised_contacts {
        Some(LinearisedContacts) if bears == 0.0 => {
            return Err(ChainError::NothingToLinearise { body: lower.to_owned() });
        }
        Some(LinearisedContacts) => Law::Linearised,
        None => measured.map_or(Law::Hertz, |(exponent, _)| Law::Power(exponent)),
    };
    let yields = |body: Option<&Body>| body.and_then(|body| body.yield_strength);
    let strengths = [yields(j.checked_sub(1).and_then(|i| bodies.get(i))), yields(bodies.get(j))];
    let softest = strengths.into_iter().flatten().reduce(f64::min);
    let reduced_modulus = geometry::reduced_modulus(above, below);
    let yield_force = softest.map(|strength| hertz::first_yield(reduced_modulus, radius, strength));
    let inverse = |body: Option<&Body>| body.map_or(0.0, |body| 1.0 / body.mass);
    let mobility = inverse(j.checked_sub(1).and_then(|i| bodies.get(i))) + inverse(bodies.get(j));
    let pair = (stiffness, 1.0 / mobility);
    let loss = spec.effects.loss_between(names.0, names.1, pair);
    if measured.is_some() {
        only_for_hertz(spec, names, loss)?;
    }
    if loss.is_some() && law == Law::Linearised {
        return Err(ChainError::LinearisedWithLoss { body: lower.to_owned() });
    }
    if spec.effects.plasticity.is_some() && law == Law::Linearised {
        return Err(ChainError::LinearisedWithLoss { body: lower.to_owned() });
    }
    let [top, bottom] = &spec.effects.supports;
    let beside = if j == 0 { Some(top) } else { (j == bodies.len()).then_some(bottom) };
    let stack = beside.and_then(|support| support.drive()?.stiffness);
    let compliance = stack.map_or(0.0, |stiffness| 1.0 / stiffness);
    let yields = spec.effects.plasticity.zip(softest).filter(|_| compliance == 0.0);
    let plastic = yields.map(|(plasticity, strength)| {
        let pressure = hertz::YIELD_PRESSURE_FACTOR * strength;
        YieldLaw::new(plasticity.model, stiffness, (reduced_modulus, radius), pressure)
    });
    let yield_force = yield_force.filter(|_| measured.is_none());
    let static_force = bears;
    let open = Contact { stiffness, static_force, law, loss, ..Contact::OPEN };
    let static_overlap = match &plastic {
        Some(law) => law.overlap_of(bears),
        None => open.overlap_under(bears),
    };
    Ok(Contact { static_overlap, yield_force, plastic, compliance, ..open })
}

/// Refuses what is made for Hertz's exponent where a contact has another law.
fn only_for_hertz(
    spec: &ChainSpec,
    (upper, lower): (&str, &str),
    loss: Option<ContactLoss>,
) -> Result<(), ChainError> {
    let effects = &spec.effects;
    let follows = |loss: &LossSpec| loss.between(upper, lower).1.is_some();
    let what = if effects.linearised_contacts.is_some() {
        "effects.linearised_contacts"
    } else if effects.plasticity.is_some() {
        "effects.plasticity"
    } else if loss.is_some_and(|loss| loss.relaxation > 0.0) {
        "effects.kuwabara_kono"
    } else if effects.losses.iter().flatten().any(follows) {
        "a loss by its restitution"
    } else {
        return Ok(());
    };
    let (upper, lower) = (upper.to_owned(), lower.to_owned());
    Err(ChainError::OnlyForHertz { upper, lower, what })
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
