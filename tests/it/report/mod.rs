//! Reports: what they say, in which language, and how they look in a browser.

pub mod browser;
mod explain_fixture;
mod explained;
mod fixture;
mod language;
mod locale;
mod print;
mod protocol;
mod render;
mod russian;
mod sentences;
mod words;
