//! The tables of a procedure that declare site and instruments.

use crate::config::spec::{Kind, Range, TableSpec, optional, quantity, required, with_default};

const HALF_TURN: Range = Range::between(-360.0, 360.0);
const RIGHT_ANGLE: Range = Range::between(-90.0, 90.0);
const SMALL_ANGLE: Range = Range::between(0.0, 90.0);

pub(crate) static SITE: TableSpec = TableSpec {
    name: "site",
    doc: "Where the unit stands and where its input axis points: the Earth rate along the axis follows from it. \
          Uncertainties are standard uncertainties (k = 1).",
    keys: &[
        required("latitude", quantity("deg", RIGHT_ANGLE), "\"55.98 deg\"", "Latitude, positive north."),
        with_default(
            "latitude_uncertainty",
            quantity("deg", SMALL_ANGLE),
            "\"0 deg\"",
            "\"1 arcsec\"",
            "Its uncertainty.",
        ),
        optional(
            "heading",
            quantity("deg", HALF_TURN),
            "\"90 deg\"",
            "Heading of the input axis from true north, positive to the east. Needed unless the axis is vertical.",
        ),
        with_default(
            "heading_uncertainty",
            quantity("deg", Range::between(0.0, 360.0)),
            "\"0 deg\"",
            "\"1 arcmin\"",
            "Its uncertainty.",
        ),
        required(
            "elevation",
            quantity("deg", RIGHT_ANGLE),
            "\"90 deg\"",
            "Elevation of the input axis above the horizon; 90 deg is up.",
        ),
        with_default(
            "elevation_uncertainty",
            quantity("deg", SMALL_ANGLE),
            "\"0 deg\"",
            "\"30 arcsec\"",
            "Its uncertainty: the tilt of the axis.",
        ),
        optional(
            "axis",
            Kind::Tables(&AXIS),
            "",
            "Orientation of single channels that differ from the above.",
        ),
    ],
};

static AXIS: TableSpec = TableSpec {
    name: "site.axis",
    doc: "Orientation of the input axis of one channel.",
    keys: &[
        required("channel", Kind::Id, "\"x\"", "Channel with the role `rate` or `angle_increment`."),
        optional(
            "heading",
            quantity("deg", HALF_TURN),
            "\"0 deg\"",
            "Heading from true north, positive to the east. Needed unless the axis is vertical.",
        ),
        with_default(
            "heading_uncertainty",
            quantity("deg", Range::between(0.0, 360.0)),
            "\"0 deg\"",
            "\"1 arcmin\"",
            "Its uncertainty.",
        ),
        required("elevation", quantity("deg", RIGHT_ANGLE), "\"0 deg\"", "Elevation above the horizon."),
        with_default(
            "elevation_uncertainty",
            quantity("deg", SMALL_ANGLE),
            "\"0 deg\"",
            "\"30 arcsec\"",
            "Its uncertainty.",
        ),
    ],
};

pub(crate) static INSTRUMENT: TableSpec = TableSpec {
    name: "instrument",
    doc: "An instrument and the validity of its calibration. A calibration that has expired on the day of \
          the test is a condition not met.",
    keys: &[
        required("name", Kind::LocalText, "\"chamber thermometer\"", "What it is."),
        optional("serial", Kind::Text, "\"T-0412\"", "Serial number."),
        optional("calibration_due", Kind::Date, "2030-12-31", "Last day on which the calibration is valid."),
        with_default(
            "required",
            Kind::Flag,
            "true",
            "true",
            "Whether an expired calibration makes the test invalid; otherwise it is a remark.",
        ),
    ],
};
