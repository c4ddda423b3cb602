//! How fast a pulse travels from sensor to sensor.
//!
//! Speed `v = d/(t2 - t1)`, `(u_v/v)^2 = (u_d/d)^2 + (u_1^2 + u_2^2)/(t2 - t1)^2`: distance and
//! arrivals independent of each other. Propagation: JCGM 100:2008, Eq. (10). Valid for
//! uncertainties far below the values.

use crate::quantity::Uncertain;

/// Speed over `distance` (m) between two arrivals (s), in m/s; none where the second is not later
/// or earlier than the first.
pub fn speed(distance: Uncertain, from: Uncertain, to: Uncertain) -> Option<Uncertain> {
    let time = to.value - from.value;
    let of_time = from.u.hypot(to.u);
    speed_over(distance, Uncertain::normal(time, of_time))
}

/// Speed over `distance` (m) in a time (s) measured at one go, such as by cross-correlation.
pub fn speed_over(distance: Uncertain, time: Uncertain) -> Option<Uncertain> {
    let value = distance.value / time.value;
    let relative = (distance.u / distance.value).hypot(time.u / time.value);
    let found = Uncertain::normal(value, (value * relative).abs());
    (found.value.is_finite() && found.u.is_finite()).then_some(found)
}
