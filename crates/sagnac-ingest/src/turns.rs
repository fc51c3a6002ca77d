//! Angles that begin anew after each turn.

/// Angle of a turn, arcsec.
pub(crate) const TURN_ARCSEC: f64 = 360.0 * 3600.0;

/// Undoes the restart of an angle after each turn; `turn`: its size in the unit of the angles.
pub(crate) fn unwrap_turns(angles: &mut [f64], turn: f64) {
    let (mut turns, mut before) = (0.0, None::<f64>);
    for angle in angles.iter_mut().filter(|a| a.is_finite()) {
        let raw = *angle;
        let step = before.map_or(0.0, |b| raw - b);
        if step.abs() > 0.5 * turn {
            turns -= (step / turn).round();
        }
        before = Some(raw);
        *angle = raw + turns * turn;
    }
}
