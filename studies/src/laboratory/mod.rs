//! The laboratory: concealed effects whose physics shares no formula with the engine.
//!
//! Surroundings ([`environment`]) act on a unit ([`unit`]) whose noise is made in time ([`noise`]). [`subjects`] are scenes
//! with effects set into them; [`effect`] makes each as strong as asked, by what an [`oracle`] gains from the truth. A
//! [`case`] is a recording with its claim and its [`truth`]; [`folder`] writes it, [`seal`] keeps the truth apart, [`score`] judges what the engine
//! answered, after the contract of `explain`. The [`catalogue`] fixes which half of the cases is looked at only to report.

pub mod answer;
pub mod bench;
pub mod case;
pub mod catalogue;
pub mod claim;
pub mod command;
pub mod dice;
pub mod effect;
pub mod engine;
pub mod environment;
pub mod folder;
pub mod modes;
pub mod motion;
pub mod noise;
pub mod oracle;
pub mod process;
pub mod real_noise;
pub mod score;
pub mod seal;
pub mod searches;
pub mod study;
pub mod subjects;
pub mod tally;
pub mod truth;
pub mod unit;
