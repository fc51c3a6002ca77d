//! `laboratory.toml`: what a calibration certificate says beside the result: the laboratory, its customer, the persons
//! responsible, and the languages.

use super::diagnostics::Problems;
use super::read_tables::checked;
use super::reader::Reader;
use super::section::{Entry, Section};
use super::spec::{TableSpec, Word};
use super::table::{Table, words};
use super::text_file::{self, Wording};
use crate::i18n::{Lang, LocalText, note};
use std::path::Path;

/// Messages for a file that cannot be read at all.
const READ_MESSAGES: Wording =
    Wording { unreadable: "laboratory_file.unreadable", folder: "laboratory_file.folder" };

/// The file as a whole.
pub static LABORATORY_FILE: TableSpec = *LaboratoryTables::SPEC;

/// What a calibration certificate says beside the result: who made it, for whom, where.
#[derive(Table)]
#[table("", format = "laboratory/1")]
struct LaboratoryTables {
    /// Languages of the certificate: every name and sentence stands in each of them.
    #[key(default = ["en"], example = ["en", "ru"])]
    languages: Vec<Lang>,
    /// Which of them are binding. Default: all.
    #[key(example = ["en"])]
    binding_languages: Vec<Lang>,
    /// Where the unit was tested.
    #[key(default = "laboratory", example = "customer")]
    place: Place,
    /// The laboratory.
    laboratory: LaboratoryKeys,
    /// The customer. A certificate needs one.
    customer: Option<CustomerKeys>,
    /// The persons responsible, one table each. A certificate needs at least one.
    #[key(name = "person")]
    persons: Vec<Person>,
}

const CERTIFICATE_LANGUAGES: &[Word] = &[("en", "English"), ("ru", "Russian")];

const TEST_PLACES: &[Word] =
    &[("laboratory", "in the laboratory"), ("customer", "at the customer's"), ("other", "somewhere else")];

words!(Lang, CERTIFICATE_LANGUAGES, Lang::from_code);
words!(Place, TEST_PLACES, |word: &str| Place::ALL.into_iter().find(|place| place.id() == word));

/// The laboratory.
#[derive(Table)]
#[table("laboratory")]
struct LaboratoryKeys {
    #[key(flatten)]
    contact: Contact,
    #[key(section)]
    section: Section,
}

/// The customer.
#[derive(Table)]
#[table("customer")]
struct CustomerKeys {
    #[key(flatten)]
    contact: Contact,
    #[key(section)]
    section: Section,
}

/// Contents of a certificate beside the result.
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
#[derive(Debug, Clone, PartialEq, Table)]
pub struct Contact {
    /// Name.
    #[key(example = "Gyro Test Laboratory")]
    pub name: LocalText,
    /// Street.
    #[key(example = "Ring Road")]
    pub street: Option<String>,
    /// Number of the house.
    #[key(example = "7a")]
    pub number: Option<String>,
    /// Postcode.
    #[key(example = "10115")]
    pub postcode: Option<String>,
    /// City.
    #[key(example = "Berlin")]
    pub city: String,
    /// State or region.
    #[key(example = "Berlin")]
    pub state: Option<String>,
    /// Country, by its two letters of ISO 3166-1.
    #[key(example = "DE")]
    pub country: String,
    /// E-mail address.
    #[key(example = "test@example.org")]
    pub email: Option<String>,
    /// Telephone number.
    #[key(example = "+49 30 1234567")]
    pub phone: Option<String>,
}

/// A person responsible for the certificate.
#[derive(Debug, Clone, PartialEq, Table)]
#[table("person")]
pub struct Person {
    /// Name.
    #[key(example = "A. Ivanova")]
    pub name: LocalText,
    /// What the person answers for.
    #[key(example = "head of the laboratory")]
    pub role: Option<String>,
    /// True for the one who signs first.
    #[key(default = false, example = true)]
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
    parse(&path.display().to_string(), &text_file::bytes(path, &READ_MESSAGES)?)
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
    let tables = LaboratoryTables::read(root);
    let used = each_once(tables.languages, "languages", root, reader);
    let binding = each_once(tables.binding_languages, "binding_languages", root, reader);
    if let Some(lang) = binding.iter().find(|lang| !used.contains(lang)) {
        let message = note!("laboratory_file.not_used", code = lang.code());
        let help = note!("laboratory_file.help.not_used");
        reader.error(&root.span_of("binding_languages"), message, Some(help));
    }
    check_country(&tables.laboratory.contact, &tables.laboratory.section, reader);
    if let Some(customer) = &tables.customer {
        check_country(&customer.contact, &customer.section, reader);
    }
    Laboratory {
        contact: tables.laboratory.contact,
        customer: tables.customer.map(|customer| customer.contact),
        persons: tables.persons,
        place: tables.place,
        binding_languages: if binding.is_empty() { used.clone() } else { binding },
        languages: used,
    }
}

/// The languages of a list, each once.
fn each_once(list: Vec<Lang>, key: &str, section: &Section, reader: &mut Reader<'_>) -> Vec<Lang> {
    if matches!(section.entry(key), Some(Entry::Words(words)) if words.is_empty()) {
        reader.error(&section.span_of(key), note!("keyed.empty", key), None);
    }
    let mut found = vec![];
    for lang in list {
        if !found.contains(&lang) {
            found.push(lang);
        }
    }
    found
}

/// Reports a country that is no code of ISO 3166-1.
fn check_country(contact: &Contact, section: &Section, reader: &mut Reader<'_>) {
    let country = contact.country.as_str();
    let is_code = country.len() == 2 && country.bytes().all(|b| b.is_ascii_uppercase());
    if !country.is_empty() && !is_code {
        let message = note!("laboratory_file.country", given = country);
        let help = note!("laboratory_file.help.country");
        let at = reader.source.inside_quotes(&section.span_of("country"));
        reader.error(&at, message, Some(help));
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
        assert!(CERTIFICATE_LANGUAGES.iter().map(|w| w.0).eq(Lang::ALL.iter().map(|l| l.code())));
        assert!(TEST_PLACES.iter().map(|w| w.0).eq(Place::ALL.iter().map(|p| p.id())));
    }
}
