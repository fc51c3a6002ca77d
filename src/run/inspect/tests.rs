//! Judgements on simulated recordings.
