//! Another unit on the ordinate: the same quantity in it, or σ(τ)·√τ in the unit of a random walk.

use crate::figure::{Figure, Layer, Panel, Scale};
use crate::i18n::{Note, note};
use crate::units::Unit;

/// Shows the panels of a figure in a unit, as far as they can be: values over a time in s also multiplied by its root.
///
/// # Errors
/// A note where no panel can.
pub fn in_unit(figure: &mut Figure, to: &Unit) -> Result<(), Note> {
    let mut changed = false;
    for panel in &mut figure.panels {
        changed |= panel_in_unit(panel, to).is_some();
    }
    if changed {
        return Ok(());
    }
    let units: Vec<&str> =
        figure.panels.iter().map(|p| p.y.unit.as_str()).filter(|u| !u.is_empty()).collect();
    Err(note!("figure_paper.no_unit", unit = to.text(), known = units.join(", ")))
}

fn panel_in_unit(panel: &mut Panel, to: &Unit) -> Option<()> {
    let from = Unit::parse(&panel.y.unit).ok()?;
    if let Ok(factor) = from.factor_to(to) {
        map(panel, &|_, y| y * factor);
        panel.y.range = panel.y.range.map(|(low, high)| (low * factor, high * factor));
    } else {
        let root = Unit::parse("sqrt(s)").ok()?;
        let factor = from.times(&root)?.factor_to(to).ok()?;
        let is_over_time = panel.x.unit == "s" && panel.x.scale == Scale::Log;
        let has_levels =
            panel.layers.iter().any(|l| matches!(l, Layer::Horizontal { .. } | Layer::Bars { .. }));
        if !is_over_time || has_levels {
            return None;
        }
        map(panel, &|x, y| y * x.sqrt() * factor);
        panel.y.range = None;
        panel.y.label = "figure_paper.axis_times_root".into();
    }
    to.text().clone_into(&mut panel.y.unit);
    Some(())
}

/// Maps the ordinates of all layers.
fn map(panel: &mut Panel, of: &dyn Fn(f64, f64) -> f64) {
    for layer in &mut panel.layers {
        match layer {
            Layer::Line { points, .. } | Layer::Points { points, .. } => {
                points.iter_mut().for_each(|p| p.1 = of(p.0, p.1));
            }
            Layer::Band { points, .. } => {
                points.iter_mut().for_each(|p| (p.1, p.2) = (of(p.0, p.1), of(p.0, p.2)));
            }
            Layer::Bars { bars, .. } => bars.iter_mut().for_each(|b| b.2 = of(b.0, b.2)),
            Layer::Horizontal { at, .. } => *at = of(0.0, *at),
            Layer::Label { at, .. } => at.1 = of(at.0, at.1),
            Layer::Span { .. } => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Axis, Style};

    fn figure() -> Figure {
        let axis =
            |unit: &str| Axis { label: "a".into(), unit: unit.to_owned(), scale: Scale::Log, range: None };
        // White noise of N = 0.003 deg/√h: σ = N/√τ, τ in h.
        let points = [36.0, 3600.0].map(|tau: f64| (tau, 0.003 / (tau / 3600.0).sqrt())).to_vec();
        let layers = vec![Layer::Line { points, style: Style::Data, legend: String::new() }];
        let panels = vec![Panel { x: axis("s"), y: axis("deg/h"), layers }];
        Figure { id: "f".into(), title: "t".into(), channel: String::new(), panels, remarks: vec![] }
    }

    fn drawn(unit: &str) -> Vec<f64> {
        let mut figure = figure();
        in_unit(&mut figure, &Unit::parse(unit).unwrap()).unwrap();
        assert_eq!(figure.panels[0].y.unit, unit);
        match &figure.panels[0].layers[0] {
            Layer::Line { points, .. } => points.iter().map(|p| p.1).collect(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_same_quantity_is_converted() {
        let [short, long] = drawn("deg/s")[..] else { panic!() };
        assert!((short * 3600.0 - 0.03).abs() < 1e-15 && (long * 3600.0 - 0.003).abs() < 1e-15);
    }

    #[test]
    fn angle_random_walk_is_level_in_its_own_unit() {
        for n in drawn("deg/sqrt(h)") {
            assert!((n / 0.003 - 1.0).abs() < 1e-12, "{n}");
        }
    }

    #[test]
    fn what_measures_something_else_is_refused() {
        let refused = in_unit(&mut figure(), &Unit::parse("degC").unwrap()).unwrap_err();
        assert_eq!(refused.id, "figure_paper.no_unit");
    }
}
