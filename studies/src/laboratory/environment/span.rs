//! The slow grid of a recording's surroundings.

/// A grid from the first row on, a little longer than the recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Step, s.
    pub step_s: f64,
    /// Number of steps.
    pub length: usize,
    /// Local time of day at the first row, h.
    pub start_hour: f64,
}

impl Span {
    /// A grid of 1 s, or coarser for records longer than 14 h.
    pub fn new(duration_s: f64, start_hour: f64) -> Span {
        let step_s = (duration_s / 50_000.0).ceil().max(1.0);
        Span { step_s, length: (duration_s / step_s).ceil() as usize + 2, start_hour }
    }

    /// Time of a step since the first row, s.
    pub fn time_s(&self, step: usize) -> f64 {
        step as f64 * self.step_s
    }

    /// Local time of day at a step, h.
    pub fn hour(&self, step: usize) -> f64 {
        (self.start_hour + self.time_s(step) / 3600.0) % 24.0
    }

    /// Length, s.
    pub fn duration_s(&self) -> f64 {
        self.time_s(self.length - 1)
    }

    /// A course at instants in s, by straight lines between its steps.
    pub fn at(&self, course: &[f64], time_s: &[f64]) -> Vec<f64> {
        time_s
            .iter()
            .map(|t| {
                let place = (t / self.step_s).clamp(0.0, (self.length - 1) as f64);
                let i = (place as usize).min(self.length - 2);
                let part = place - i as f64;
                course[i] * (1.0 - part) + course[i + 1] * part
            })
            .collect()
    }

    /// Change of a course per minute.
    pub fn per_minute(&self, course: &[f64]) -> Vec<f64> {
        let last = course.len() - 1;
        (0..course.len())
            .map(|i| {
                let (a, b) = (i.saturating_sub(1), (i + 1).min(last));
                (course[b] - course[a]) / ((b - a) as f64 * self.step_s) * 60.0
            })
            .collect()
    }
}
