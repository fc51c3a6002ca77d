//! The mismatch of a claimed simulation and a recording: located, named, modelled, and the fit shown to improve.
//!
//! [`explain`] compares a recording with a claim, [`explain_simulation`] with a simulated recording. The way through the
//! files, each of which uses only those above it and `effect`:
//!
//! | step | files |
//! |---|---|
//! | rows on the grid of the claim, rounding, averages | `regular`, `quantization_grid`, `coarse` |
//! | residual in cosine modes, missing samples imputed, round corners set aside | `spectral_data`, `impute`, `corner` |
//! | claim plus effects, fitted: noise by Whittle, means by least squares | `terms`, `noise_fit`, `hypothesis`, `fitted_hypothesis`, `problem`, `law_error`, `discrepancy` |
//! | tests that name no physics, and the number of tests that all searches amount to | `effective_tests`, `departures` |
//! | every effect tried as an addition | `nonlinear_search`, `candidates`, `filtered` |
//! | prediction of blocks that are held out | `heldout`, `prediction` |
//! | the fewest effects that explain the recording, and the probabilities of their names | `select`, `posterior` |
//! | effects on single samples, by their detectors | `flat`, `samples`, `jumps` |
//! | parameters with intervals, contributions and improvements of effects | `estimates`, `contribution`, `improvement` |
//! | status of each column | `columns` |
//! | sizes of effects that would have been noticed | `noticeable_record`, `noticeable` |
//! | causes, equivalents, the augmented claim, figures | `single_cause`, `unnamed`, `experiment`, `alternatives`, `augmented`, `draw`, `figures`, `assemble` |
//! | all of it in order | `engine` |
//! | several recordings of one unit, with the laws that they share | `joint` |
//! | a claim from a simulated recording, and the effects that this recording shows itself | `identify`, `simulation_check`, `simulation_claim` |

mod alternatives;
mod assemble;
mod augmented;
pub mod candidates;
pub mod coarse;
mod columns;
mod contribution;
mod corner;
pub mod departures;
pub mod discrepancy;
pub mod draw;
mod effective_tests;
pub mod engine;
pub mod estimates;
pub(crate) mod experiment;
pub mod figures;
pub mod filtered;
pub mod finding;
pub mod fitted_hypothesis;
pub mod flat;
mod heldout;
pub mod hypothesis;
mod identify;
mod improvement;
pub mod impute;
pub mod joint;
pub mod jumps;
pub mod law_error;
mod named;
pub mod noise_fit;
mod nonlinear_search;
pub mod noticeable;
pub mod noticeable_record;
pub mod options;
pub mod outcome;
mod posterior;
mod prediction;
pub mod problem;
pub mod quantization_grid;
pub mod regular;
pub mod samples;
pub mod select;
mod several;
mod simulation_check;
mod simulation_claim;
mod single_cause;
pub mod spectral_data;
pub mod terms;
mod unnamed;
mod usable;

pub use alternatives::Alternative;
pub use engine::explain;
pub use identify::identify;
pub use options::{Options, Progress};
pub use outcome::Outcome;
pub use simulation_claim::{SimulationClaim, explain_simulation};
