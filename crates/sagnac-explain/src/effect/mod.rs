//! The catalogue of physics that a simulation can leave out: one file an effect.
//!
//! An effect consists of parameters, a description and a forward model, which simulation, fitting and the effects of a claim
//! share. Its description for readers (physical cause, signature, the experiment
//! that would confirm it, source) stands under `effect.<kind>` of the locale tables, not here.
//!
//! | file | contents |
//! |---|---|
//! | `model` | [`Effect`], the description of an effect; [`Model`], the three classes |
//! | `mean`, `spectral`; `Samples` in `model` | the trait of each class |
//! | `param`, `domain`, `drivers` | parameters and their values; where an effect shows; the recorded columns |
//! | `sizing` | the size of an effect, and the places where it is asked for |
//! | `shared` | physics and searches that several effects use |
//! | `kinds` | one file an effect, and [`EFFECTS`], the list of them |

#[macro_use]
mod macros;

mod column;
mod detection;
mod domain;
mod drivers;
mod kinds;
mod mean;
mod model;
mod param;
mod response_law;
mod shared;
mod sizing;
mod spectral;

pub use column::{COLUMN_TEXT, Column, OtherColumn};
pub use detection::{
    Background, Detection, FlatResidual, Jumps, Knot, Law, LevelLaw, OutlierDetector, Outliers, Pulses,
    Reported, Rounding, RowDetector, Rows, RowsFound,
};
pub use domain::{Domain, Place};
pub use drivers::{ClaimedMean, Drivers, Earth, OtherDriver, StatedLine, Temperature, averages};
pub use kinds::{EFFECTS, any_column_driver, find, parameter};
pub use mean::{Nuisance, Regressors, Resolution, SearchContext, Starts, StatePrior, Unmodelled};
pub use model::{ClaimedByCourse, Effect, Family, Later, Model, UNKNOWN, plausible, stateable};
pub use model::{Detector, JumpDetector, Level, LevelDetector, MeanModel, Samples, Spectrum};
pub use param::{Param, Value, Values, list, number, text};
pub use response_law::ResponseLaw;
pub use shared::low_pass::LowPass;
pub use sizing::{Sizing, SpectralSizing};
pub use spectral::{ModeBin, SpectralContext, SpectrumAct};
