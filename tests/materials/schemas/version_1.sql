-- The tables as version 0.1 made them; frozen, so that migrations are tested against what users have.

CREATE TABLE material (
    id            INTEGER PRIMARY KEY,
    name          TEXT NOT NULL UNIQUE CHECK (length(name) BETWEEN 1 AND 200),
    key           TEXT NOT NULL,              -- normalised name
    title         TEXT NOT NULL DEFAULT '',
    formula       TEXT NOT NULL DEFAULT '',   -- chemical
    default_label TEXT                        -- NULL: the dataset that came first
) STRICT;
CREATE INDEX material_key ON material (key);

CREATE TABLE alias (
    text        TEXT PRIMARY KEY CHECK (length(text) BETWEEN 1 AND 200),
    key         TEXT NOT NULL,                -- normalised text
    material_id INTEGER NOT NULL REFERENCES material (id) ON DELETE CASCADE
) STRICT;
CREATE INDEX alias_key ON alias (key);
CREATE INDEX alias_material ON alias (material_id);

CREATE TABLE dataset (
    id             INTEGER PRIMARY KEY,
    material_id    INTEGER NOT NULL REFERENCES material (id) ON DELETE CASCADE,
    label          TEXT NOT NULL CHECK (length(label) BETWEEN 1 AND 200),
    source         TEXT NOT NULL DEFAULT '',  -- collection
    source_key     TEXT NOT NULL DEFAULT '',  -- name in the collection
    reference      TEXT NOT NULL DEFAULT '',
    doi            TEXT NOT NULL DEFAULT '',
    licence        TEXT NOT NULL DEFAULT '',
    ray            TEXT NOT NULL DEFAULT '' CHECK (ray IN ('', 'o', 'e')),
    composition    TEXT NOT NULL DEFAULT '',
    note           TEXT NOT NULL DEFAULT '',
    format         TEXT NOT NULL DEFAULT '',  -- of the file it was read from
    file           TEXT NOT NULL DEFAULT '',
    file_sha256    TEXT NOT NULL DEFAULT '' CHECK (length(file_sha256) IN (0, 64)),
    content_sha256 TEXT NOT NULL CHECK (length(content_sha256) = 64),
    temperature_k  REAL CHECK (temperature_k > 0),
    UNIQUE (material_id, label)
) STRICT;
CREATE INDEX dataset_key ON dataset (source_key);

CREATE TABLE series (
    dataset_id  INTEGER NOT NULL REFERENCES dataset (id) ON DELETE CASCADE,
    quantity    TEXT NOT NULL CHECK (quantity IN ('n', 'k')),
    formula     INTEGER NOT NULL CHECK (formula BETWEEN 0 AND 9),      -- 0: a table
    unit        TEXT NOT NULL CHECK (unit IN ('nm', 'um', 'angstrom', 'eV', 'cm-1', 'THz')),
    shortest_nm REAL NOT NULL CHECK (shortest_nm > 0),
    longest_nm  REAL NOT NULL CHECK (longest_nm >= shortest_nm AND longest_nm < 1e300),
    row_count   INTEGER NOT NULL CHECK (row_count >= 1),
    x           BLOB CHECK (x IS NULL OR length(x) = 8 * row_count),   -- NULL: formula, or n's grid
    y           BLOB NOT NULL CHECK (length(y) = 8 * row_count),       -- little-endian doubles
    PRIMARY KEY (dataset_id, quantity),
    CHECK (formula = 0 OR x IS NULL),
    CHECK (formula > 0 OR x IS NOT NULL OR quantity = 'k')
) STRICT;

CREATE TABLE correction (
    dataset_id INTEGER NOT NULL REFERENCES dataset (id) ON DELETE CASCADE,
    position   INTEGER NOT NULL,
    text       TEXT NOT NULL,
    PRIMARY KEY (dataset_id, position)
) STRICT, WITHOUT ROWID;

-- One document per material, rowid = material.id.
CREATE VIRTUAL TABLE material_text USING fts5 (
    name, aliases, title, formula, provenance, tokenize = "unicode61 remove_diacritics 2"
);
