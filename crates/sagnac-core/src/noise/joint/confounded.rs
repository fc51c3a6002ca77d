//! Whether quantisation or a filter can be told from what else bends the spectrum near its upper end.

use super::search::all_free;
use super::{ExtraThresholds, Free, Joint, JointPoint, Kind, Shape, Variable, parameter_covariance};

/// Place of quantisation among the variances.
pub(super) const QUANTIZATION: usize = 3;
/// Growth of the uncertainty of N by letting a part in from which the two count as confounded: a superfluous part then
/// displaces N by several of the deviations it would have without.
const CONFOUNDED: f64 = 2.0;

/// What quantisation costs at a maximum.
///
/// Beside a short Markov process it rises where the process falls, and the white level between them can be nearly
/// anything: N would be wrong by far more than its interval said if chance alone brought it in.
pub(super) fn quantization_price(
    joint: &Joint<'_>,
    point: &JointPoint,
    ramp: bool,
    thresholds: &ExtraThresholds,
) -> f64 {
    if confounds_white(joint, point, ramp) {
        thresholds.quantization_confounded
    } else {
        thresholds.quantization
    }
}

/// True when N is several times less certain with quantisation free than with it held, or stands beside a Markov
/// process: there the likelihood may have two tops, with quantisation and without, each of which knows its own N well.
fn confounds_white(joint: &Joint<'_>, point: &JointPoint, ramp: bool) -> bool {
    if point.shape.damped.iter().any(|(kind, _)| *kind == Kind::Markov) {
        return true;
    }
    let mut free = all_free(&point.shape, ramp, true);
    let mut sigma = |quantization: bool| {
        free.variance[QUANTIZATION] = quantization;
        sigma_of_white(joint, point, &free)
    };
    match (sigma(true), sigma(false)) {
        (Some(with), Some(without)) => with > CONFOUNDED * without,
        // Where N has vanished, quantisation stands in its place.
        _ => point.variance.get(QUANTIZATION).is_some_and(|v| *v > 0.0) && !point.shape.is_plain(),
    }
}

/// What a filter costs at a maximum. Beside a short Markov process it falls where the process does, and the white level
/// under the process is then told by the filter alone.
pub(super) fn filter_price(
    joint: &Joint<'_>,
    point: &JointPoint,
    ramp: bool,
    thresholds: &ExtraThresholds,
) -> f64 {
    let sigma = |shape: Shape| {
        let mut free = all_free(&shape, ramp, true);
        free.variance[QUANTIZATION] = point.variance.get(QUANTIZATION).is_some_and(|v| *v > 0.0);
        sigma_of_white(joint, &JointPoint { shape, ..point.clone() }, &free)
    };
    let without = Shape { filter: None, ..point.shape.clone() };
    match (sigma(point.shape.clone()), sigma(without)) {
        (Some(with), Some(without)) if with > CONFOUNDED * without => thresholds.filter_confounded,
        _ => thresholds.filter,
    }
}

fn sigma_of_white(joint: &Joint<'_>, point: &JointPoint, free: &Free) -> Option<f64> {
    let (variables, covariance) = parameter_covariance(joint, point, free);
    let at = variables.iter().position(|v| *v == Variable::Variance(0))?;
    Some(covariance.get(at)?.get(at)?.max(0.0).sqrt())
}
