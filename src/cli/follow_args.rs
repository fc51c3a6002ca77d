//! Options of following a recording that is being written.

use super::length::{self, Length};
use clap::Args;

/// Following a recording that is being written.
#[derive(Debug, Args)]
pub struct FollowArgs {
    /// Follow a recording that is still being written; report when it stands still, the test is decided, or on Ctrl-C
    #[arg(long, conflicts_with_all = ["each", "join"])]
    pub follow: bool,
    /// Time between two looks at the recording
    #[arg(long, value_name = "LENGTH", requires = "follow", default_value = "10s", value_parser = length::above_zero)]
    pub poll: Length,
    /// Time without change after which the recording is complete
    #[arg(long, value_name = "LENGTH", requires = "follow", default_value = "60s", value_parser = length::above_zero)]
    pub still: Length,
}

impl Default for FollowArgs {
    fn default() -> FollowArgs {
        FollowArgs { follow: false, poll: Length { seconds: 10.0 }, still: Length { seconds: 60.0 } }
    }
}
