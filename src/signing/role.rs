//! What a signature stands for.

use serde::{Deserialize, Serialize};

/// What a signer did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Made the test.
    Tested,
    /// Checked the result.
    Reviewed,
    /// Released the unit, or decided on it otherwise.
    Approved,
}

impl Role {
    /// Every role.
    pub const ALL: [Role; 3] = [Role::Tested, Role::Reviewed, Role::Approved];

    /// The word of a role in files and on the command line.
    pub fn id(self) -> &'static str {
        match self {
            Role::Tested => "tested",
            Role::Reviewed => "reviewed",
            Role::Approved => "approved",
        }
    }

    /// The role of a word.
    pub fn of(word: &str) -> Option<Role> {
        Role::ALL.into_iter().find(|role| role.id() == word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_lead_back() {
        for role in Role::ALL {
            assert_eq!(Role::of(role.id()), Some(role));
            assert_eq!(serde_json::to_value(role).unwrap(), role.id());
        }
    }
}
