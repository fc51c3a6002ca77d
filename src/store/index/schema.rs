//! The tables of the index. An index of an earlier version is made anew from the folders, which hold all of it.

/// Marks a database as the index of a store: `SAGN` in ASCII.
pub(super) const APPLICATION_ID: i64 = 0x5341_474E;

/// Version of the tables; an empty database has version 0.
pub(super) const SCHEMA_VERSION: i64 = 2;

/// The tables. `placed_at` is the moment by which attempts are put in order: that of the evaluation, but for an attempt whose
/// clock stood before that of one that came before it.
pub(super) const TABLE_STATEMENTS: &str = "
CREATE TABLE result (
    id INTEGER PRIMARY KEY,
    address TEXT NOT NULL UNIQUE,
    serial TEXT NOT NULL,
    serial_key TEXT NOT NULL,
    model TEXT NOT NULL,
    lot TEXT NOT NULL,
    build_date TEXT,
    reference INTEGER NOT NULL,
    attributes TEXT NOT NULL,
    procedure TEXT NOT NULL,
    revision TEXT NOT NULL,
    procedure_sha256 TEXT NOT NULL,
    limits TEXT NOT NULL,
    limits_sha256 TEXT NOT NULL,
    station TEXT NOT NULL,
    operator TEXT NOT NULL,
    evaluated_at TEXT NOT NULL,
    placed_at TEXT NOT NULL,
    attempt INTEGER NOT NULL,
    verdict TEXT NOT NULL,
    result_sha256 TEXT NOT NULL
);
CREATE INDEX result_unit ON result (serial_key, procedure, placed_at, attempt, evaluated_at, address);
CREATE INDEX result_lot ON result (lot, placed_at);
CREATE INDEX result_model ON result (model, procedure, placed_at);
CREATE INDEX result_time ON result (placed_at, attempt, evaluated_at, address);

CREATE TABLE measurand (
    result INTEGER NOT NULL REFERENCES result (id) ON DELETE CASCADE,
    position INTEGER NOT NULL,
    measurand TEXT NOT NULL,
    channel TEXT NOT NULL,
    phase TEXT,
    unit TEXT NOT NULL,
    value REAL,
    low REAL,
    high REAL,
    coverage REAL,
    upper_limit REAL,
    upper_coverage REAL,
    limit_min REAL,
    limit_max REAL,
    verdict TEXT NOT NULL,
    PRIMARY KEY (result, position)
) WITHOUT ROWID;

CREATE TABLE reason (
    result INTEGER NOT NULL REFERENCES result (id) ON DELETE CASCADE,
    position INTEGER NOT NULL,
    kind TEXT NOT NULL,
    name TEXT NOT NULL,
    PRIMARY KEY (result, position)
) WITHOUT ROWID;

CREATE TABLE recording (
    result INTEGER NOT NULL REFERENCES result (id) ON DELETE CASCADE,
    position INTEGER NOT NULL,
    path TEXT NOT NULL,
    sha256 TEXT NOT NULL,
    bytes INTEGER NOT NULL,
    PRIMARY KEY (result, position)
) WITHOUT ROWID;
CREATE INDEX recording_hash ON recording (sha256);

CREATE TABLE earlier (
    result INTEGER NOT NULL REFERENCES result (id) ON DELETE CASCADE,
    position INTEGER NOT NULL,
    address TEXT NOT NULL,
    PRIMARY KEY (result, position)
) WITHOUT ROWID;

CREATE TABLE correction (
    statement TEXT PRIMARY KEY,
    superseded TEXT NOT NULL,
    by TEXT NOT NULL,
    reason TEXT NOT NULL,
    operator TEXT NOT NULL,
    stated_at TEXT NOT NULL
) WITHOUT ROWID;
CREATE INDEX correction_superseded ON correction (superseded);

CREATE TABLE place (
    statement TEXT PRIMARY KEY,
    sha256 TEXT NOT NULL,
    path TEXT NOT NULL,
    stated_at TEXT NOT NULL
) WITHOUT ROWID;
CREATE INDEX place_hash ON place (sha256);
";
