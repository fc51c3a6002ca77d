//! `laboratory.toml`: what a calibration certificate says beside the result: the laboratory, its customer, the persons
//! responsible, and the languages.

use super::diagnostics::Problems;
use super::read_tables::checked;
use super::reader::Reader;
use super::section::{Entry, Section};
use super::spec::{KeySpec, Kind, TableSpec, Word, optional, required, with_default};
use super::text_file::{self, Wording};
use crate::i18n::{Lang, LocalText, Note};
use std::path::Path;

/// What is said of a file that cannot be read at all.
const WORDING: Wording =
    Wording { unreadable: "laboratory_file.unreadable", folder: "laboratory_file.folder" };

/// Version of the format.
pub const LABORATORY_FORMAT: &str = "laboratory/1";

/// The file as a whole.
pub static LABORATORY_FILE: TableSpec = TableSpec {
    name: "",
    doc: "What a calibration certificate says beside the result: who made it, for whom, where.",
    keys: &[
        required("format", Kind::Format(LABORATORY_FORMAT), "\"laboratory/1\"", "Version of the format."),
        with_default(
            "languages",
            Kind::Choices(LANGUAGES),
            "[\"en\"]",
            "[\"en\", \"ru\"]",
            "Languages of the certificate: every name and sentence stands in each of them.",
        ),
        optional(
            "binding_languages",
            Kind::Choices(LANGUAGES),
            "[\"en\"]",
            "Which of them are binding. Default: all.",
        ),
        with_default(
            "place",
            Kind::Choice(PLACES),
            "\"laboratory\"",
            "\"customer\"",
            "Where the unit was tested.",
        ),
        required("laboratory", Kind::Table(&LABORATORY), "", "The laboratory."),
        optional("customer", Kind::Table(&CUSTOMER), "", "The customer. A certificate needs one."),
        optional(
            "person",
            Kind::Tables(&PERSON),
            "",
            "The persons responsible, one table each. A certificate needs at least one.",
        ),
    ],
};

const LANGUAGES: &[Word] = &[("en", "English"), ("ru", "Russian")];

const PLACES: &[Word] =
    &[("laboratory", "in the laboratory"), ("customer", "at the customer's"), ("other", "somewhere else")];

static LABORATORY: TableSpec = TableSpec { name: "laboratory", doc: "The laboratory.", keys: CONTACT };

static CUSTOMER: TableSpec = TableSpec { name: "customer", doc: "The customer.", keys: CONTACT };

const CONTACT: &[KeySpec] = &[
    required("name", Kind::LocalText, "\"Gyro Test Laboratory\"", "Name."),
    optional("street", Kind::Text, "\"Ring Road\"", "Street."),
    optional("number", Kind::Text, "\"7a\"", "Number of the house."),
    optional("postcode", Kind::Text, "\"10115\"", "Postcode."),
    required("city", Kind::Text, "\"Berlin\"", "City."),
    optional("state", Kind::Text, "\"Berlin\"", "State or region."),
    required("country", Kind::Text, "\"DE\"", "Country, by its two letters of ISO 3166-1."),
    optional("email", Kind::Text, "\"test@example.org\"", "E-mail address."),
    optional("phone", Kind::Text, "\"+49 30 1234567\"", "Telephone number."),
];

static PERSON: TableSpec = TableSpec {
    name: "person",
    doc: "A person responsible for the certificate.",
    keys: &[
        required("name", Kind::LocalText, "\"A. Ivanova\"", "Name."),
        optional("role", Kind::Text, "\"head of the laboratory\"", "What the person answers for."),
        with_default("main_signer", Kind::Flag, "false", "true", "True for the one who signs first."),
    ],
};

/// What a certificate says beside the result.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Laboratory {
    /// The laboratory.
    pub contact: Contact,
    /// Its customer.
    pub customer: Option<Contact>,
    /// The persons responsible.
    pub persons: Vec<Person>,
    /// Where the unit was tested.
    pub place: Place,
    /// Languages of the certificate, each once.
    pub languages: Vec<Lang>,
    /// Those that are binding.
    pub binding_languages: Vec<Lang>,
}

/// An organisation and its address.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Contact {
    /// Name.
    pub name: LocalText,
    /// Street.
    pub street: Option<String>,
    /// Number of the house.
    pub number: Option<String>,
    /// Postcode.
    pub postcode: Option<String>,
    /// City.
    pub city: String,
    /// State or region.
    pub state: Option<String>,
    /// Country: two capital letters of ISO 3166-1.
    pub country: String,
    /// E-mail address.
    pub email: Option<String>,
    /// Telephone number.
    pub phone: Option<String>,
}

/// A person responsible for a certificate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Person {
    /// Name.
    pub name: LocalText,
    /// What the person answers for.
    pub role: Option<String>,
    /// True for the one who signs first.
    pub main_signer: bool,
}

/// Where a unit was tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Place {
    /// In the laboratory.
    #[default]
    Laboratory,
    /// At the customer's.
    Customer,
    /// Somewhere else.
    Other,
}

impl Place {
    /// Every place.
    pub const ALL: [Place; 3] = [Place::Laboratory, Place::Customer, Place::Other];

    /// Its word in the file, which is also that of a certificate.
    pub fn id(self) -> &'static str {
        match self {
            Place::Laboratory => "laboratory",
            Place::Customer => "customer",
            Place::Other => "other",
        }
    }
}

/// Reads the file of a laboratory.
///
/// # Errors
/// Every problem of the file, each with its place.
pub fn load(path: &Path) -> Result<Laboratory, Problems> {
    parse(&path.display().to_string(), &text_file::bytes(path, &WORDING)?)
}

/// Reads the file of a laboratory from its bytes; `name` stands in diagnostics.
///
/// # Errors
/// Every problem of the text.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Laboratory, Problems> {
    let (laboratory, problems) = checked(&text_file::source(name, bytes)?, &LABORATORY_FILE, build);
    laboratory.ok_or(problems)
}

fn build(root: &Section, reader: &mut Reader<'_>) -> Laboratory {
    let place = root.word("place").unwrap_or_default();
    let used = languages(root, "languages", reader);
    let binding = languages(root, "binding_languages", reader);
    if let Some(lang) = binding.iter().find(|lang| !used.contains(lang)) {
        let message = Note::new("laboratory_file.not_used").with("code", lang.code());
        let help = Note::new("laboratory_file.help.not_used");
        reader.error(&root.span_of("binding_languages"), message, Some(help));
    }
    Laboratory {
        contact: root.table("laboratory").map(|s| contact(s, reader)).unwrap_or_default(),
        customer: root.table("customer").map(|s| contact(s, reader)),
        persons: root.tables("person").iter().map(person).collect(),
        place: Place::ALL.into_iter().find(|p| p.id() == place).unwrap_or_default(),
        binding_languages: if binding.is_empty() { used.clone() } else { binding },
        languages: used,
    }
}

/// The languages of a list, each once.
fn languages(root: &Section, key: &str, reader: &mut Reader<'_>) -> Vec<Lang> {
    let Some(Entry::Words(words)) = root.entry(key) else { return vec![] };
    if words.is_empty() {
        reader.error(&root.span_of(key), Note::new("keyed.empty").with("key", key), None);
    }
    let mut found = vec![];
    for lang in words.iter().filter_map(|code| Lang::from_code(code)) {
        if !found.contains(&lang) {
            found.push(lang);
        }
    }
    found
}

fn contact(section: &Section, reader: &mut Reader<'_>) -> Contact {
    let country = section.text("country").unwrap_or_default();
    let is_code = country.len() == 2 && country.bytes().all(|b| b.is_ascii_uppercase());
    if !country.is_empty() && !is_code {
        let message = Note::new("laboratory_file.country").with("given", country.as_str());
        let help = Note::new("laboratory_file.help.country");
        let at = reader.source.inside_quotes(&section.span_of("country"));
        reader.error(&at, message, Some(help));
    }
    Contact {
        name: section.local_text("name").unwrap_or_default(),
        street: section.text("street"),
        number: section.text("number"),
        postcode: section.text("postcode"),
        city: section.text("city").unwrap_or_default(),
        state: section.text("state"),
        country,
        email: section.text("email"),
        phone: section.text("phone"),
    }
}

fn person(section: &Section) -> Person {
    Person {
        name: section.local_text("name").unwrap_or_default(),
        role: section.text("role"),
        main_signer: section.flag("main_signer"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"format = "laboratory/1"
languages = ["en", "ru", "en"]
binding_languages = ["ru"]
place = "customer"

[laboratory]
name = { en = "Gyro Test Laboratory", ru = "Лаборатория испытаний гироскопов" }
street = "Ring Road"
number = "7a"
postcode = "10115"
city = "Berlin"
country = "DE"
email = "test@example.org"

[customer]
name = "O'Neil & Sons"
city = "Cork"
country = "IE"

[[person]]
name = "A. Ivanova"
role = "head of the laboratory"
main_signer = true

[[person]]
name = "B. Petrov"
"#;

    fn said(text: &str) -> String {
        parse("laboratory.toml", text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn a_file_is_read_as_it_says() {
        let read = parse("laboratory.toml", TEXT.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((read.languages, read.binding_languages), (vec![Lang::En, Lang::Ru], vec![Lang::Ru]));
        assert_eq!(read.contact.name.in_language("ru"), "Лаборатория испытаний гироскопов");
        assert_eq!((read.contact.number.as_deref(), read.contact.phone), (Some("7a"), None));
        let customer = read.customer.unwrap();
        assert_eq!((customer.name.text(), customer.country.as_str()), ("O'Neil & Sons", "IE"));
        let signers: Vec<bool> = read.persons.iter().map(|p| p.main_signer).collect();
        assert_eq!(
            (signers, read.persons[0].role.as_deref()),
            (vec![true, false], Some("head of the laboratory"))
        );
        assert_eq!(read.place, Place::Customer);
    }

    #[test]
    fn what_may_be_left_out_has_its_default() {
        let text = "format = \"laboratory/1\"\n[laboratory]\nname = \"L\"\ncity = \"C\"\ncountry = \"FR\"\n";
        let read = parse("laboratory.toml", text.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((read.languages, read.binding_languages), (vec![Lang::En], vec![Lang::En]));
        assert_eq!((read.place, read.customer, read.persons.len()), (Place::Laboratory, None, 0));
    }

    #[test]
    fn problems_have_their_places() {
        let country = said(&TEXT.replace("\"DE\"", "\"Germany\""));
        assert!(country.contains("laboratory.toml:12:12") && country.contains("Germany"), "{country}");
        let key = said(&TEXT.replace("postcode", "postcod"));
        assert!(key.contains("laboratory.toml:10:1") && key.contains("`postcode`"), "{key}");
        let binding = said(&TEXT.replace("[\"en\", \"ru\", \"en\"]", "[\"en\"]"));
        assert!(binding.contains("laboratory.toml:3:21"), "{binding}");
        let none = said(&TEXT.replace("[\"en\", \"ru\", \"en\"]", "[]"));
        assert!(none.contains("laboratory.toml:2:13"), "{none}");
        let missing = said("format = \"laboratory/1\"\n");
        assert!(missing.contains("[laboratory]"), "{missing}");
    }

    #[test]
    fn every_language_and_place_has_its_word() {
        assert!(LANGUAGES.iter().map(|w| w.0).eq(Lang::ALL.iter().map(|l| l.code())));
        assert!(PLACES.iter().map(|w| w.0).eq(Place::ALL.iter().map(|p| p.id())));
    }
}
