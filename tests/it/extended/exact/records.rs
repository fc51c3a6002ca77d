//! Hard records: values that spoil sums taken carelessly.

use crate::support::synthetic::white;

/// A record: unbroken stretches with the grid index of their first samples, in order of time.
pub struct Record {
    pub name: &'static str,
    pub stretches: Vec<(u64, Vec<f64>)>,
}

impl Record {
    fn whole(name: &'static str, samples: Vec<f64>) -> Record {
        Record { name, stretches: vec![(0, samples)] }
    }

    /// Samples of it, gaps left out.
    pub fn samples(&self) -> impl Iterator<Item = f64> + '_ {
        self.stretches.iter().flat_map(|s| s.1.iter().copied())
    }

    /// Largest distance between two samples.
    pub fn range(&self) -> f64 {
        let least = self.samples().fold(f64::INFINITY, f64::min);
        let greatest = self.samples().fold(f64::NEG_INFINITY, f64::max);
        greatest - least
    }
}

fn noise(count: u64, offset: f64, scale: f64) -> Vec<f64> {
    (0..count).map(|i| offset + scale * white(3, i)).collect()
}

/// A record broken by gaps of one sample at given places.
fn broken(name: &'static str, samples: Vec<f64>, holes: &[usize]) -> Record {
    let mut stretches = vec![];
    let mut from = 0;
    for hole in holes.iter().copied().chain([samples.len()]) {
        let part = &samples[from.min(hole)..hole];
        if !part.is_empty() {
            stretches.push((from as u64, part.to_vec()));
        }
        from = hole + 1;
    }
    Record { name, stretches }
}

/// Every hard record with values that a recording may hold. Noise has the standard deviation 1 unless said otherwise.
pub fn hard_records() -> Vec<Record> {
    let around = |every: usize, to: usize| -> Vec<usize> {
        let mut holes: Vec<usize> = (1..=to / every).flat_map(|k| [k * every - 1, k * every + 1]).collect();
        holes.dedup();
        holes
    };
    let with = |mut samples: Vec<f64>, changes: &[(usize, f64)]| {
        changes.iter().for_each(|(i, v)| samples[*i] = *v);
        samples
    };
    let alternating = |scale: f64| (0..3000).map(|i| if i % 2 == 0 { scale } else { -scale }).collect();
    vec![
        Record::whole("noise alone", noise(4096, 0.0, 1.0)),
        Record::whole("offset 1e9 times the noise", noise(4096, 1e9, 1.0)),
        Record::whole("offset 1e15 times the noise", noise(4096, 1e15, 1.0)),
        Record::whole("offset -1e9, noise 1e-3", noise(4096, -1e9, 1e-3)),
        broken("one-sample gaps", noise(6000, 12.5, 1.0), &[1, 64, 99, 1000, 1001, 1002, 4095, 5998]),
        broken("gaps about every 1024", noise(5200, 1e9, 1.0), &around(1024, 5200)),
        broken("gaps about every 4096", noise(20_000, 12.5, 1.0), &around(4096, 20_000)),
        broken("gaps about every 8192", noise(20_000, 12.5, 1.0), &around(8192, 20_000)),
        Record::whole("length 2^12 - 1", noise(4095, 1e6, 1.0)),
        Record::whole("length 2^12 + 1", noise(4097, 1e6, 1.0)),
        Record::whole("length 2^13 + 1", noise(8193, 1e6, 1.0)),
        Record::whole("one spike of 1e60", with(noise(4096, 12.5, 1.0), &[(2000, 1e60)])),
        Record::whole("noise of 1e-20, spike of 1e60", with(noise(4096, 0.0, 1e-20), &[(2000, 1e60)])),
        Record::whole("first sample 1e12", with(noise(4096, 12.5, 1.0), &[(0, 1e12)])),
        Record::whole("first block 1e9 off", {
            let mut y = noise(12_000, 12.5, 1.0);
            y[..4096].iter_mut().for_each(|v| *v += 1e9);
            y
        }),
        Record::whole("alternating +-1e60", alternating(1e60)),
        Record::whole("alternating +-1", alternating(1.0)),
        Record::whole(
            "ramp of 1e9 a sample",
            (0..9000).map(|i| 1e9 * f64::from(i) + white(5, i as u64)).collect(),
        ),
        Record::whole("whole numbers up to 2^53", {
            (0..4096u64).map(|i| (i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64).collect()
        }),
        Record::whole("noise of 1e60", noise(4096, 0.0, 1e59)),
        Record::whole("noise of 1e-58", noise(4096, 0.0, 1e-58)),
        Record::whole("noise of 1e-40 about 1e-30", noise(4096, 1e-30, 1e-40)),
        Record::whole("constant 0.1", vec![0.1; 3000]),
        Record::whole("constant 1e60", vec![1e60; 3000]),
        Record::whole("two samples", vec![12.5, 13.5]),
        Record::whole("one sample", vec![12.5]),
    ]
}
