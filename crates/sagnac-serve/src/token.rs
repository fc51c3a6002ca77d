//! The secret of a server: whoever has it may order tests and read results. It is made anew at each start.

use std::fmt;
use subtle::ConstantTimeEq;

/// Length of the secret, bytes.
const SECRET_BYTES: usize = 32;

/// The secret, as text of 64 hexadecimal digits. It is never part of a message.
#[derive(Clone)]
pub struct Token(String);

impl Token {
    /// A new secret from the random numbers of the system.
    ///
    /// # Errors
    /// A system without random numbers.
    pub fn new() -> Result<Token, getrandom::Error> {
        random_name(SECRET_BYTES).map(Token)
    }

    /// The text, to be shown to the user who started the server.
    pub fn reveal(&self) -> &str {
        &self.0
    }

    /// True for the same text. The time that it takes depends on the length of the given text alone.
    pub fn is(&self, given: &str) -> bool {
        self.0.as_bytes().ct_eq(given.as_bytes()).into()
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token(…)")
    }
}

/// Random hexadecimal digits, two for each byte.
///
/// # Errors
/// A system without random numbers.
pub fn random_name(bytes: usize) -> Result<String, getrandom::Error> {
    let mut random = vec![0; bytes];
    getrandom::fill(&mut random)?;
    Ok(random.iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_secret_has_256_bits_is_new_each_time_and_never_printed() {
        let (one, other) = (Token::new().unwrap(), Token::new().unwrap());
        assert_eq!(one.reveal().len(), 64);
        assert!(
            one.is(one.reveal()) && !one.is(other.reveal()) && !one.is("") && !one.is(&one.reveal()[1..])
        );
        assert!(!format!("{one:?}").contains(one.reveal()));
    }
}
