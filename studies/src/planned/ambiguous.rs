//! Pairs and triples of explanations that one recording cannot tell apart.

use super::physics::Truth;

/// Explanations of one cause with the model that they were found against.
pub struct Ambiguous {
    /// What is confused.
    pub name: &'static str,
    /// The model.
    pub model: &'static str,
    /// The explanations as `alternatives.toml` has them.
    pub alternatives: &'static str,
    /// What each of them is, in the same order.
    pub truths: &'static [Truth],
    /// Noise of the recordings: N, B, K.
    pub noise: [f64; 3],
    /// Longest test, h.
    pub budget_h: f64,
}

/// Model of a gyro of 0.002 deg/√h with a small random walk, with a thermometer.
const WITH_THERMOMETER: &str = "[recording]\ncase = \"planned\"\nsample_rate_hz = 0.2\n\
    columns = [\"time_s\", \"rate_deg_h\", \"temp_degC\"]\n\
    [noise]\nN_deg_rt_h = 0.002\nB_deg_h = 0.001\nK_deg_h_rt_h = 0.0005\n[bias]\nvalue_deg_h = 1.0\n\
    [temperature]\ncoefficient_deg_h_per_degC = 0.01\nreference_degC = 20.0\n\
    [uncertainty]\nN_rel = 0.02\nB_rel = 0.1\nK_rel = 0.2\nbias_deg_h = 0.1\ntemperature_coefficient_deg_h_per_degC = 1e-5\n";

/// The same on a table.
const ON_TABLE: &str = "[recording]\ncase = \"planned\"\nsample_rate_hz = 0.2\n\
    columns = [\"time_s\", \"rate_deg_h\", \"table_rate_deg_s\"]\n\
    [noise]\nN_deg_rt_h = 0.002\nB_deg_h = 0.001\nK_deg_h_rt_h = 0.0005\n[bias]\nvalue_deg_h = 1.0\n\
    [scale_factor]\nerror_ppm = 5.0\n\
    [uncertainty]\nN_rel = 0.02\nB_rel = 0.1\nK_rel = 0.2\nbias_deg_h = 0.1\nscale_factor_ppm = 0.01\n";

/// The same where the heading matters.
const BY_HEADING: &str = "[recording]\ncase = \"planned\"\nsample_rate_hz = 0.2\n\
    columns = [\"time_s\", \"rate_deg_h\", \"table_angle_deg\"]\n\
    [noise]\nN_deg_rt_h = 0.002\nB_deg_h = 0.001\nK_deg_h_rt_h = 0.0005\n[bias]\nvalue_deg_h = 1.0\n\
    [earth]\nlatitude_deg = 55.98\nazimuth_deg = 80.0\n\
    [uncertainty]\nN_rel = 0.02\nB_rel = 0.1\nK_rel = 0.2\nbias_deg_h = 0.1\n";

/// Alone, at rest.
const AT_REST: &str = "[recording]\ncase = \"planned\"\nsample_rate_hz = 0.05\n\
    columns = [\"time_s\", \"rate_deg_h\"]\n\
    [noise]\nN_deg_rt_h = 0.002\nB_deg_h = 0.001\nK_deg_h_rt_h = 0.0005\n[bias]\nvalue_deg_h = 1.0\n\
    [uncertainty]\nN_rel = 0.02\nB_rel = 0.1\nK_rel = 0.2\nbias_deg_h = 0.1\n";

/// Noise of the models.
const NOISE: [f64; 3] = [0.002, 0.001, 0.0005];

/// Every case.
pub static AMBIGUOUS: &[Ambiguous] = &[
    Ambiguous {
        name: "temp_linear or rate_ramp",
        model: WITH_THERMOMETER,
        alternatives: "format = \"alternatives/1\"\n\
            [[alternative]]\ncause = 1\nchosen = true\n[[alternative.effect]]\nkind = \"temp_linear\"\n\
            [alternative.effect.parameters]\ncoefficient_deg_h_per_degC = 0.0115\n\
            [[alternative]]\ncause = 1\n[[alternative.effect]]\nkind = \"rate_ramp\"\n\
            [alternative.effect.parameters]\nslope_deg_h_per_h = 0.03\n",
        truths: &[Truth::Linear { extra: 0.0015 }, Truth::Drift { slope: 0.03 }],
        noise: NOISE,
        budget_h: 8.0,
    },
    Ambiguous {
        name: "temp_rate or temp_hysteresis",
        model: WITH_THERMOMETER,
        alternatives: "format = \"alternatives/1\"\n\
            [[alternative]]\ncause = 1\nchosen = true\n[[alternative.effect]]\nkind = \"temp_rate\"\n\
            [alternative.effect.parameters]\ncoefficient_deg_h_per_degC_per_min = 0.08\n\
            [[alternative]]\ncause = 1\n[[alternative.effect]]\nkind = \"temp_hysteresis\"\n\
            [alternative.effect.parameters]\nloop_width_deg_h = 0.08\nplay_degC = 3.0\nfirst_state = 0.0\nsense = 1.0\n",
        truths: &[Truth::Rate { per_degc_min: 0.08 }, Truth::Hysteresis { width: 0.08, play: 3.0 }],
        noise: NOISE,
        budget_h: 12.0,
    },
    Ambiguous {
        name: "thermal_lag or temp_rate",
        model: WITH_THERMOMETER,
        alternatives: "format = \"alternatives/1\"\n\
            [[alternative]]\ncause = 1\nchosen = true\n[[alternative.effect]]\nkind = \"thermal_lag\"\n\
            [alternative.effect.parameters]\ntime_constant_s = 900.0\n\
            [[alternative]]\ncause = 1\n[[alternative.effect]]\nkind = \"temp_rate\"\n\
            [alternative.effect.parameters]\ncoefficient_deg_h_per_degC_per_min = -0.15\n",
        truths: &[Truth::Lag { coefficient: 0.01, time_s: 900.0 }, Truth::Rate { per_degc_min: -0.15 }],
        noise: NOISE,
        budget_h: 12.0,
    },
    Ambiguous {
        name: "bias_step or heading_change",
        model: BY_HEADING,
        alternatives: "format = \"alternatives/1\"\n\
            [[alternative]]\ncause = 1\nchosen = true\n[[alternative.effect]]\nkind = \"bias_step\"\n\
            [alternative.effect.parameters]\nstep_deg_h = 0.06\ntime_s = 1800.0\n\
            [[alternative]]\ncause = 1\n[[alternative.effect]]\nkind = \"heading_change\"\n\
            [alternative.effect.parameters]\nstep_deg_h = 0.06\ntime_s = 1800.0\n",
        truths: &[Truth::Settled, Truth::Turned { latitude_deg: 55.98, azimuth_deg: 80.0, step: 0.06 }],
        noise: NOISE,
        budget_h: 6.0,
    },
    Ambiguous {
        name: "sf_error or sf_nonlinearity",
        model: ON_TABLE,
        alternatives: "format = \"alternatives/1\"\n\
            [[alternative]]\ncause = 1\nchosen = true\n[[alternative.effect]]\nkind = \"sf_error\"\n\
            [alternative.effect.parameters]\nerror_ppm = 1.2\n\
            [[alternative]]\ncause = 1\n[[alternative.effect]]\nkind = \"sf_nonlinearity\"\n\
            [alternative.effect.parameters]\ncubic_ppm_at_max = 1.2\nlargest_rate_deg_s = 30.0\n",
        truths: &[Truth::Scale { ppm: 1.2 }, Truth::Cubic { ppm: 1.2, at: 30.0 }],
        noise: NOISE,
        budget_h: 6.0,
    },
    Ambiguous {
        name: "excess_rrw, unobserved_driver or markov_long",
        model: AT_REST,
        alternatives: "format = \"alternatives/1\"\n\
            [[alternative]]\ncause = 1\nchosen = true\n[[alternative.effect]]\nkind = \"excess_rrw\"\n\
            [alternative.effect.parameters]\nK_deg_h_rt_h = 0.03\n\
            [[alternative]]\ncause = 1\n[[alternative.effect]]\nkind = \"markov_long\"\n\
            [alternative.effect.parameters]\ncorrelation_time_s = 1500.0\nsigma_deg_h = 0.02\n\
            [[alternative]]\ncause = 1\n[[alternative.effect]]\nkind = \"unobserved_driver\"\n\
            [alternative.effect.parameters]\n\
            knots_time_s = [0.0, 1800.0, 3600.0, 5400.0, 7200.0, 9000.0, 10800.0, 12600.0, 14400.0, 16200.0]\n\
            knots_deg_h = [0.0, 0.03, 0.05, 0.04, 0.0, -0.04, -0.05, -0.03, 0.01, 0.04]\n",
        truths: &[
            Truth::Walk { k: 0.03 },
            Truth::Markov { sigma: 0.02, time_s: 1500.0 },
            Truth::Driver { sigma: 0.0356, time_s: 2200.0 },
        ],
        noise: NOISE,
        budget_h: 48.0,
    },
];
