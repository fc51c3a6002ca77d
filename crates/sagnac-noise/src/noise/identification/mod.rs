//! Identification of the noise of a channel: which terms it has, how large they are, and how surely that is known.
//!
//! [`identify`] takes the spectral [`Evidence`](super::evidence::Evidence) of a record and gives an [`Identification`].
//! [`identify_in_range`] does the same over the widest range of frequencies that a model describes. Both work in two
//! steps, which can be taken apart: [`describe`] finds the terms, [`complete`] adds intervals and upper limits, which take
//! most of the time.
//!
//! | step | file |
//! |---|---|
//! | likelihood of band powers | `likelihood` |
//! | fit of N, B, K, Q and R, whose variances enter linearly | [`linear_fit`], `structures`, `profile` |
//! | which terms are claimed, and at what price | `claims`, `options` |
//! | N, B, K, Q and R alone | `standard` |
//! | search for Markov processes, quasi-periodic disturbances and a filter | `joint` |
//! | entrance, range of frequencies, test of the fit | `range`, `misfit` |
//!
//! # Why there are two fits, and a third elsewhere
//! [`linear_fit`] has at most five unknowns and a bounded least-squares step that is solved exactly; every one of its 32
//! structures is fitted for each record. `joint` has times and frequencies besides, whose expected powers must be computed
//! anew at every step: a hundred times slower, so that it is used only where the search has found such a part. Both share
//! the likelihood (`likelihood`), the rules of a claim (`claims`) and the tracing of confidence curves (`profile`); neither
//! has priors. `mismatch::noise_fit` fits a *stated* model: its coefficients carry a prior, its parameters are the
//! logarithms of those of arbitrary effects, and its data are bins that missing samples and a fitted mean have changed. It
//! maximises the same sum over other densities and shares no step of the computation.
//!
//! Source: Whittle, Ark. Mat. 2, 1953; Sykulski et al., Biometrika 106, 2019 (expectation of the transform in place of
//! the density).

pub(crate) mod claims;
mod joint;
mod likelihood;
pub mod linear_fit;
pub mod misfit;
mod options;
pub(crate) mod profile;
mod range;
mod result;
mod standard;
mod structures;

pub use claims::SlowPrices;
pub use joint::Plateau;
pub use misfit::Misfit;
pub use options::{Options, ProcessThresholds, StandardThresholds};
pub use range::{
    RangedIdentification, complete, describe, describe_in_range, identify, identify_in_range, identify_over,
};
pub use result::{Identification, MarkovFound, QuasiPeriodicFound};
