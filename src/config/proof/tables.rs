//! The tables of a proof file.

use crate::config::procedure::tables::ChannelKeys;
use crate::config::spec::{Kind, Range, TableSpec, Word, optional, quantity, required, with_default};
use crate::config::table::Table;

/// Version of the format.
pub const PROOF_FORMAT: &str = "proof/1";

/// A proof file as a whole.
pub static PROOF_FILE: TableSpec = TableSpec {
    name: "",
    doc: "A proof: what is concealed of a recording, what is known of it from elsewhere, and the rules by which the answer is \
          judged. The file is written before the first run.",
    keys: &[
        required("format", Kind::Format(PROOF_FORMAT), "\"proof/1\"", "Version of the format."),
        required("title", Kind::LocalText, "\"Loop ramp of a closed-loop FOG\"", "Title of the page."),
        required(
            "question",
            Kind::LocalText,
            "\"Is the reset of the ramp found?\"",
            "What is asked, in a sentence or two.",
        ),
        required("recording", Kind::Table(&RECORDING), "", "The recording."),
        optional(
            "channel",
            Kind::Tables(ChannelKeys::SPEC),
            "",
            "The columns that are used, as in a procedure. Default: as they are found by their names.",
        ),
        optional("conceal", Kind::Table(&CONCEAL), "", "What is concealed. Default: nothing."),
        optional(
            "decoy",
            Kind::Tables(&DECOY),
            "",
            "Columns that drive nothing, shown together with what was concealed.",
        ),
        required("claim", Kind::Table(&CLAIM), "", "The claim that the recording is held against."),
        optional("reference", Kind::Tables(&REFERENCE), "", "What is known from elsewhere, one table each."),
        required(
            "rule",
            Kind::Tables(&RULE),
            "",
            "The rules by which the answer is judged, one table each. All must hold.",
        ),
    ],
};

const LENGTH: Kind = quantity("s", Range::NOT_NEGATIVE);

static RECORDING: TableSpec = TableSpec {
    name: "recording",
    doc: "The recording: a file, or a simulation of what is true.",
    keys: &[
        optional("path", Kind::Text, "\"fog/static.csv\"", "File, relative to the folder of data."),
        optional(
            "sha256",
            Kind::Text,
            "\"e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855\"",
            "SHA-256 of the file, required with `path`.",
        ),
        optional(
            "simulated",
            Kind::Text,
            "\"truth.toml\"",
            "In place of `path`: model of what is true, relative to the proof file. Its effects are what is concealed.",
        ),
        optional(
            "duration",
            quantity("s", Range::POSITIVE),
            "\"10 h\"",
            "Length of the simulation, required with `simulated`.",
        ),
        with_default(
            "seed",
            Kind::Number(Range::between(0.0, 9e15)),
            "1",
            "7",
            "Seed of the simulation, and of effects that are added.",
        ),
        optional(
            "rate",
            Kind::Text,
            "\"rate_x\"",
            "Gyro output: id of a channel, or column where no channels are declared.",
        ),
        optional("unit", Kind::Text, "\"nrad/s\"", "Unit of that column where no channels are declared."),
        optional(
            "sample_rate",
            quantity("Hz", Range::POSITIVE),
            "\"100 Hz\"",
            "Sample rate, required without timestamps.",
        ),
        with_default(
            "average",
            Kind::Number(Range::between(1.0, 1e6)),
            "1",
            "10",
            "Consecutive rows of which the mean is taken before anything else; rows around a gap are left out.",
        ),
        optional("from", LENGTH, "\"600 s\"", "Beginning of the part that is used, after the first row."),
        optional("to", LENGTH, "\"3600 s\"", "End of that part."),
    ],
};

static CONCEAL: TableSpec = TableSpec {
    name: "conceal",
    doc: "What is concealed.",
    keys: &[
        optional(
            "columns",
            Kind::Columns(&[]),
            "[\"ramp_counts\"]",
            "Columns that are taken out of the recording, by their names in explanations: `temp_degC` for a temperature, \
             otherwise the id of the channel, or its name if no channels are declared.",
        ),
        optional(
            "effects",
            Kind::Text,
            "\"injected.toml\"",
            "Model whose effects are added to the rate, relative to the proof file; nothing else of it is used.",
        ),
    ],
};

static DECOY: TableSpec = TableSpec {
    name: "decoy",
    doc: "A column that drives nothing: one of the recording, shifted in time and continued from its other end.",
    keys: &[
        required("name", Kind::Text, "\"decoy_1\"", "Name under which it is shown."),
        required("of", Kind::Text, "\"ramp_counts\"", "Column that it is made from."),
        required("shift", quantity("s", Range::POSITIVE), "\"120 s\"", "Shift."),
    ],
};

static CLAIM: TableSpec = TableSpec {
    name: "claim",
    doc: "The claim: a model, or what the program itself identifies from a part of what is shown or from another output.",
    keys: &[
        optional(
            "model",
            Kind::Text,
            "\"claim.toml\"",
            "Model, relative to the proof file. Default: identified.",
        ),
        optional(
            "from",
            LENGTH,
            "\"0 s\"",
            "Beginning of the part from which it is identified, after the first row of the recording.",
        ),
        optional("to", LENGTH, "\"600 s\"", "End of that part."),
        optional("rate", Kind::Text, "\"rate_y\"", "Another output that it is identified from."),
    ],
};

static REFERENCE: TableSpec = TableSpec {
    name: "reference",
    doc: "What is known from elsewhere.",
    keys: &[
        required("id", Kind::Id, "\"reset_frequency\"", "Id by which rules name it."),
        required("what", Kind::LocalText, "\"Frequency of the resets\"", "What it is."),
        optional("low", Kind::Number(Range::ANY), "4.166", "Low end of the interval."),
        optional("high", Kind::Number(Range::ANY), "4.176", "High end of the interval."),
        optional("unit", Kind::UnitText, "\"Hz\"", "Unit of the interval."),
        required("source", Kind::LocalText, "\"README of the recording\"", "Where it comes from."),
    ],
};

/// Explanations that a rule can speak of.
pub const SHOWN: &[Word] = &[
    ("concealed", "the explanation of what is shown while something is concealed"),
    ("unveiled", "the explanation with the concealed columns shown among the decoys"),
];

/// What a rule asks for.
pub const ASKS: &[Word] = &[
    ("verdict", "the verdict is one of `verdicts`"),
    ("name", "an effect is one of `kinds`, or has one of them among its equivalents"),
    ("not_name", "no effect is one of `kinds`"),
    ("follow", "an effect follows one of `columns`"),
    ("not_follow", "no effect follows any of `columns`"),
    ("parameter", "`parameter` of an effect of `kinds` lies in the interval of `reference`"),
    ("locate", "an effect is located in `domain` within `low` to `high`"),
    ("course", "the inferred course correlates with one of `columns`, by size at least `at_least`"),
    ("improve", "the mean square of the held-out residual falls by the share `at_least`"),
    ("recover", "of the mean square of what was added, the share `at_least` is in the inferred course"),
];

/// Domains of a location.
pub const DOMAINS: &[Word] = &[
    ("time", "s"),
    ("frequency", "Hz"),
    ("lag", "s"),
    ("temperature", "°C"),
    ("temperature_rate", "°C/min"),
    ("input_rate", "deg/s"),
    ("outer_rate", "deg/s"),
    ("angle", "deg"),
    ("amplitude", "deg/h"),
    ("timestamps", "s"),
    ("supply", "V"),
    ("driver", "unit of the column"),
];

/// Verdicts of an explanation.
pub const VERDICTS: &[Word] = &[
    ("consistent", "the recording is an ordinary draw of the claim"),
    ("mismatch", "named effects account for the difference"),
    ("unknown-mismatch", "some of it has no name"),
];

static RULE: TableSpec = TableSpec {
    name: "rule",
    doc: "A rule.",
    keys: &[
        with_default(
            "when",
            Kind::Choice(SHOWN),
            "\"concealed\"",
            "\"unveiled\"",
            "Which explanation it speaks of.",
        ),
        required("must", Kind::Choice(ASKS), "\"name\"", "What must hold."),
        optional("verdicts", Kind::Choices(VERDICTS), "[\"mismatch\"]", "Verdicts."),
        optional(
            "kinds",
            Kind::Effects,
            "[\"comb\"]",
            "Effects by their ids (`sagnac effects`), or `unknown`.",
        ),
        optional(
            "columns",
            Kind::Columns(&[]),
            "[\"ramp_counts\"]",
            "Columns by their names as they are shown.",
        ),
        optional("parameter", Kind::Text, "\"frequency_hz\"", "Parameter of an effect."),
        optional("reference", Kind::Text, "\"reset_frequency\"", "Id of a reference."),
        optional(
            "domain",
            Kind::Choice(DOMAINS),
            "\"frequency\"",
            "Domain of a location, as in explain.json.",
        ),
        optional("low", Kind::Number(Range::ANY), "600", "Low end of a location."),
        optional("high", Kind::Number(Range::ANY), "900", "High end of a location."),
        optional("at_least", Kind::Number(Range::SHARE), "0.9", "Share or correlation."),
    ],
};
