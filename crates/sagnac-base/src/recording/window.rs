//! The evaluated part of a recording: warm-up and declared spans left out, gaps noted.

use super::{SampleBlock, Sink};
use crate::numeric::order::SortByNumber;
use serde::{Deserialize, Serialize};

/// Gaps listed at most.
const LISTED_GAPS: usize = 100;

/// The evaluated part of a recording.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Window {
    /// First time evaluated, s from the start of the recording.
    pub from_s: f64,
    /// Last time evaluated, s from the start of the recording.
    pub to_s: f64,
    /// Time that holds usable samples, s.
    pub usable_s: f64,
    /// Spans left out, with the reason.
    pub excluded: Vec<ExcludedSpan>,
}

/// A span left out of the evaluation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ExcludedSpan {
    /// Start, s from the start of the recording.
    pub from_s: f64,
    /// End, s from the start of the recording.
    pub to_s: f64,
    /// `warm_up`, `declared`, `gap`, `pause`.
    pub reason: String,
}

/// A span of time, its end not included, s from the start of the recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeSpan {
    /// Its start.
    pub from_s: f64,
    /// Its end.
    pub to_s: f64,
}

/// What to evaluate, s from the start of the recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WindowSpec {
    /// Length of the warm-up that is left out.
    pub from_s: f64,
    /// End of the evaluation; `None`: the end of the recording.
    pub to_s: Option<f64>,
    /// Declared spans that are left out.
    pub exclusions: Vec<TimeSpan>,
}

impl WindowSpec {
    /// The declared spans that are not empty.
    fn declared(&self) -> impl Iterator<Item = TimeSpan> + '_ {
        self.exclusions.iter().copied().filter(|s| s.from_s < s.to_s)
    }
}

/// Passes the samples in the evaluated window to another sink, and keeps account of what was left out.
#[derive(Debug)]
pub struct Windowed<S> {
    inner: S,
    spec: WindowSpec,
    interval_s: f64,
    start_s: f64,
    /// Spans left out, in order and without overlap.
    left_out: Vec<TimeSpan>,
    passed: u64,
    first_s: Option<f64>,
    last_s: f64,
    gaps: Vec<ExcludedSpan>,
    end_s: f64,
    /// Grid position after the last sample passed on, while nothing has come between.
    expected: Option<u64>,
    scratch: Vec<Vec<f64>>,
}

impl<S: Sink> Windowed<S> {
    /// A window over a recording that starts at stamp `start_s` with nominal interval `interval_s`, before `inner`.
    pub fn new(inner: S, spec: WindowSpec, start_s: f64, interval_s: f64) -> Windowed<S> {
        let mut spans: Vec<TimeSpan> = spec.declared().collect();
        if spec.from_s > 0.0 {
            spans.push(TimeSpan { from_s: f64::NEG_INFINITY, to_s: spec.from_s });
        }
        if let Some(to) = spec.to_s {
            spans.push(TimeSpan { from_s: to, to_s: f64::INFINITY });
        }
        spans.sort_ascending_by(|a| a.from_s);
        let mut left_out: Vec<TimeSpan> = Vec::new();
        for span in spans {
            match left_out.last_mut() {
                Some(last) if span.from_s <= last.to_s => last.to_s = last.to_s.max(span.to_s),
                _ => left_out.push(span),
            }
        }
        Windowed {
            inner,
            spec,
            interval_s,
            start_s,
            left_out,
            passed: 0,
            first_s: None,
            last_s: 0.0,
            gaps: Vec::new(),
            end_s: 0.0,
            expected: None,
            scratch: Vec::new(),
        }
    }

    /// The sink behind the window.
    pub fn inner(&self) -> &S {
        &self.inner
    }

    /// The sink behind the window, and the account.
    pub fn finish(self) -> (S, Window) {
        let mut excluded = Vec::new();
        let span =
            |from_s: f64, to_s: f64, reason: &str| ExcludedSpan { from_s, to_s, reason: reason.to_owned() };
        if self.spec.from_s > 0.0 {
            excluded.push(span(0.0, self.spec.from_s, "warm_up"));
        }
        excluded.extend(self.spec.declared().map(|s| span(s.from_s, s.to_s, "declared")));
        excluded
            .extend(self.spec.to_s.filter(|to| *to < self.end_s).map(|to| span(to, self.end_s, "declared")));
        excluded.extend(self.gaps);
        excluded.sort_ascending_by(|a| a.from_s);
        let window = Window {
            from_s: self.first_s.unwrap_or(0.0),
            to_s: self.last_s,
            usable_s: self.passed as f64 * self.interval_s,
            excluded,
        };
        (self.inner, window)
    }

    /// Passes samples `from..to` of a sample block on.
    fn pass(&mut self, block: &SampleBlock<'_>, from: usize, to: usize) {
        let first_index = block.first_index + from as u64;
        let continues = self.expected == Some(first_index);
        let time_s = block.time_s + from as f64 * self.interval_s;
        let first_row = block.first_row + from as u64;
        let elapsed = time_s - self.start_s;
        self.first_s.get_or_insert(elapsed);
        self.last_s = elapsed + (to - from) as f64 * self.interval_s;
        self.passed += (to - from) as u64;
        self.expected = Some(block.first_index + to as u64);
        if from == 0 && to == block.len() {
            self.inner.push(&SampleBlock { first_index, first_row, time_s, continues, values: block.values });
            return;
        }
        self.scratch.resize_with(block.values.len(), Vec::new);
        for (part, values) in self.scratch.iter_mut().zip(block.values) {
            part.clear();
            part.extend_from_slice(values.get(from..to).unwrap_or_default());
        }
        self.inner.push(&SampleBlock { first_index, first_row, time_s, continues, values: &self.scratch });
    }

    /// The first sample of a sample block at or after a time.
    fn sample_at(&self, time_s: f64, block: &SampleBlock<'_>) -> usize {
        let ahead = (time_s + self.start_s - block.time_s) / self.interval_s;
        // Times that fall on a sample are meant to fall on it, whatever the last digit says.
        let index = (ahead - 1e-6).ceil();
        if index <= 0.0 { 0 } else { (index as usize).min(block.len()) }
    }

    fn excluded_at(&self, elapsed_s: f64) -> bool {
        self.left_out.iter().any(|s| (s.from_s..s.to_s).contains(&elapsed_s))
    }
}

impl<S: Sink> Sink for Windowed<S> {
    fn push(&mut self, block: &SampleBlock<'_>) {
        let elapsed = block.time_s - self.start_s;
        if !block.continues && self.end_s > 0.0 && self.gaps.len() < LISTED_GAPS {
            let (from_s, to_s) = (self.end_s, elapsed);
            if !(self.excluded_at(from_s) && self.excluded_at(to_s)) {
                self.gaps.push(ExcludedSpan { from_s, to_s, reason: "gap".to_owned() });
            }
        }
        self.end_s = elapsed + block.len() as f64 * self.interval_s;
        let mut at = 0;
        for i in 0..self.left_out.len() {
            let Some(&TimeSpan { from_s: from, to_s: to }) = self.left_out.get(i) else { break };
            let (from, to) = (self.sample_at(from, block), self.sample_at(to, block));
            if from > at {
                self.pass(block, at, from);
            }
            at = at.max(to);
        }
        if at < block.len() {
            self.pass(block, at, block.len());
        }
    }
}

impl<S: Sink + ?Sized> Sink for &mut S {
    fn push(&mut self, block: &SampleBlock<'_>) {
        (**self).push(block);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Keep(Vec<(u64, u64, bool, Vec<f64>)>);

    impl Sink for Keep {
        fn push(&mut self, s: &SampleBlock<'_>) {
            self.0.push((s.first_index, s.first_row, s.continues, s.values[0].clone()));
        }
    }

    fn block(values: &[Vec<f64>], first: u64, continues: bool) -> SampleBlock<'_> {
        SampleBlock {
            first_index: first,
            first_row: first + 1,
            time_s: 100.0 + first as f64 * 0.5,
            continues,
            values,
        }
    }

    fn numbers(from: u64, to: u64) -> Vec<Vec<f64>> {
        vec![(from..to).map(|i| i as f64).collect()]
    }

    #[test]
    fn warm_up_and_declared_spans_are_left_out_sample_by_sample() {
        let spec = WindowSpec {
            from_s: 5.0,
            to_s: Some(40.0),
            exclusions: [(10.0, 12.0), (11.0, 13.0)].map(|(from_s, to_s)| TimeSpan { from_s, to_s }).to_vec(),
        };
        let mut w = Windowed::new(Keep::default(), spec, 100.0, 0.5);
        for k in 0..5 {
            w.push(&block(&numbers(20 * k, 20 * k + 20), 20 * k, k > 0));
        }
        let (kept, window) = w.finish();
        let all: Vec<f64> = kept.0.iter().flat_map(|k| k.3.clone()).collect();
        let expected: Vec<f64> = (0..100u32)
            .map(f64::from)
            .filter(|i| (10.0..80.0).contains(i) && !(20.0..26.0).contains(i))
            .collect();
        assert_eq!(all, expected);
        for k in &kept.0 {
            assert_eq!((k.0 as f64, k.1), (k.3[0], k.0 + 1));
        }
        assert_eq!(kept.0.iter().map(|k| k.2).collect::<Vec<_>>(), [false, false, true, true]);
        assert_eq!((window.from_s, window.to_s, window.usable_s), (5.0, 40.0, 32.0));
        let reasons: Vec<(&str, f64, f64)> =
            window.excluded.iter().map(|e| (e.reason.as_str(), e.from_s, e.to_s)).collect();
        assert_eq!(
            reasons,
            [
                ("warm_up", 0.0, 5.0),
                ("declared", 10.0, 12.0),
                ("declared", 11.0, 13.0),
                ("declared", 40.0, 50.0)
            ]
        );
    }

    #[test]
    fn gaps_are_noted_and_break_the_samples() {
        let mut w = Windowed::new(Keep::default(), WindowSpec::default(), 100.0, 0.5);
        w.push(&block(&numbers(0, 10), 0, false));
        w.push(&block(&numbers(14, 20), 14, false));
        let (kept, window) = w.finish();
        assert_eq!(kept.0.iter().map(|k| k.2).collect::<Vec<_>>(), [false, false]);
        assert_eq!(window.excluded, [ExcludedSpan { from_s: 5.0, to_s: 7.0, reason: "gap".to_owned() }]);
        assert_eq!(window.usable_s, 8.0);
    }
}
