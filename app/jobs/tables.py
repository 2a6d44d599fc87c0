"""The tables of the ledger: as statements use them, and as databases came to have them."""

from __future__ import annotations

from sqlalchemy import BigInteger, Column, Double, MetaData, Table, Text

TABLES = MetaData()

VERSION = Table("ledger_version", TABLES, Column("version", BigInteger, nullable=False))

WORK = Table(
    "work",
    TABLES,
    Column("key", Text, primary_key=True),
    Column("process", Text, nullable=False),
    Column("cells", BigInteger, nullable=False),
    Column("block_cells", BigInteger, nullable=False),
    Column("blocks", BigInteger, nullable=False),
    Column("bytes", BigInteger, nullable=False),
    Column("done", BigInteger, nullable=False),
    Column("seconds", Double, nullable=False),
    Column("created", Double, nullable=False),
    Column("began", Double),
    Column("done_then", BigInteger),
    Column("owner", Text),
    Column("lease", Double, nullable=False),
    Column("price", Double, nullable=False),
)

JOBS = Table(
    "jobs",
    TABLES,
    Column("id", Text, primary_key=True),
    Column("key", Text, nullable=False),
    Column("process", Text, nullable=False),
    Column("state", Text, nullable=False),
    Column("cells", BigInteger, nullable=False),
    Column("blocks", BigInteger, nullable=False),
    Column("created", Double, nullable=False),
    Column("started", Double),
    Column("finished", Double),
    Column("seconds", Double),
    Column("problem", Text),
    Column("owner", Text, nullable=False),
    Column("shared", BigInteger, nullable=False),
    Column("gone", BigInteger, nullable=False),
    Column("done_at_end", BigInteger),
)

KEYS = Table(
    "keys",
    TABLES,
    Column("id", Text, primary_key=True),
    Column("name", Text, nullable=False),
    Column("hash", Text, nullable=False),
    Column("role", Text, nullable=False),
    Column("requests", BigInteger),
    Column("jobs", BigInteger),
    Column("cells", BigInteger),
    Column("bytes", BigInteger),
    Column("created", Double, nullable=False),
    Column("ends", Double),
    Column("withdrawn", Double),
)

OWNED_STUDIES = Table(
    "holdings",
    TABLES,
    Column("owner", Text, primary_key=True),
    Column("key", Text, primary_key=True),
    Column("bytes", BigInteger, nullable=False),
    Column("result", BigInteger, nullable=False),
    Column("shared", BigInteger, nullable=False),
    Column("used", Double, nullable=False),
)

SIZES = Table(  # of all files of each study
    "sizes",
    TABLES,
    Column("key", Text, primary_key=True),
    Column("bytes", BigInteger, nullable=False),
)

AUDIT = Table(
    "audit",
    TABLES,
    Column("id", Text, primary_key=True),
    Column("time", Double, nullable=False),
    Column("name", Text, nullable=False),
    Column("action", Text, nullable=False),
    Column("object", Text, nullable=False),
)

# The words that databases have for the same thing.
WORDS = {
    "sqlite": {"whole": "INTEGER", "real": "REAL", "strict": "STRICT"},
    "postgresql": {"whole": "BIGINT", "real": "DOUBLE PRECISION", "strict": ""},
}

# What leads from each version of the tables to the next, from none to version 1 to begin with. A
# change of the tables is one more entry here and the same columns above; entries that stand here
# are never changed, because there are databases that have been through them.
UPGRADES: tuple[tuple[str, ...], ...] = (
    (  # IF NOT EXISTS: files from before versions were kept have these.
        """
        CREATE TABLE IF NOT EXISTS work (
            key TEXT PRIMARY KEY,
            process TEXT NOT NULL,
            cells {whole} NOT NULL,
            block_cells {whole} NOT NULL,
            blocks {whole} NOT NULL,
            bytes {whole} NOT NULL,
            done {whole} NOT NULL DEFAULT 0,
            seconds {real} NOT NULL DEFAULT 0,
            created {real} NOT NULL,
            began {real},
            done_then {whole},
            owner TEXT,
            lease {real} NOT NULL DEFAULT 0
        ) {strict}
        """,
        """
        CREATE TABLE IF NOT EXISTS jobs (
            id TEXT PRIMARY KEY,
            key TEXT NOT NULL,
            process TEXT NOT NULL,
            state TEXT NOT NULL,
            cells {whole} NOT NULL,
            blocks {whole} NOT NULL,
            created {real} NOT NULL,
            started {real},
            finished {real},
            seconds {real},
            problem TEXT
        ) {strict}
        """,
        "CREATE INDEX IF NOT EXISTS jobs_by_key ON jobs (key)",
        "CREATE INDEX IF NOT EXISTS jobs_by_time ON jobs (created)",
        "CREATE INDEX IF NOT EXISTS jobs_by_state ON jobs (state)",
    ),
    (  # Keys, what belongs to whom, and who did what. What was there belongs to nobody.
        """
        CREATE TABLE keys (
            id TEXT PRIMARY KEY,
            name TEXT NOT NULL,
            hash TEXT NOT NULL,
            role TEXT NOT NULL,
            requests {whole},
            jobs {whole},
            cells {whole},
            bytes {whole},
            created {real} NOT NULL,
            ends {real},
            withdrawn {real}
        ) {strict}
        """,
        """
        CREATE TABLE holdings (
            owner TEXT NOT NULL,
            key TEXT NOT NULL,
            bytes {whole} NOT NULL,
            result {whole} NOT NULL,
            shared {whole} NOT NULL,
            used {real} NOT NULL,
            PRIMARY KEY (owner, key)
        ) {strict}
        """,
        """
        CREATE TABLE audit (
            id TEXT PRIMARY KEY,
            time {real} NOT NULL,
            name TEXT NOT NULL,
            action TEXT NOT NULL,
            object TEXT NOT NULL
        ) {strict}
        """,
        "ALTER TABLE jobs ADD COLUMN owner TEXT NOT NULL DEFAULT ''",
        "ALTER TABLE jobs ADD COLUMN shared {whole} NOT NULL DEFAULT 0",
        "ALTER TABLE jobs ADD COLUMN gone {whole} NOT NULL DEFAULT 0",
        "CREATE INDEX jobs_by_owner ON jobs (owner)",
        "CREATE INDEX holdings_by_key ON holdings (key)",
        "CREATE INDEX audit_by_time ON audit (time)",
    ),
    ("ALTER TABLE jobs ADD COLUMN done_at_end {whole}",),  # blocks, of what failed or was dismissed
    (
        """
        CREATE TABLE prices (
            id TEXT PRIMARY KEY,
            name TEXT NOT NULL,
            stated {real} NOT NULL,
            took {real} NOT NULL,
            finished {real} NOT NULL
        ) {strict}
        """,
        "CREATE INDEX prices_by_name ON prices (name, finished)",
    ),
    ("DROP TABLE prices", "ALTER TABLE work ADD COLUMN price {real} NOT NULL DEFAULT 0"),
    (  # Lists of jobs page by the time of entry and the identifier.
        "DROP INDEX jobs_by_time",
        "CREATE INDEX jobs_by_time ON jobs (created, id)",
        "DROP INDEX jobs_by_state",
        "CREATE INDEX jobs_by_state ON jobs (state, created, id)",
        "DROP INDEX jobs_by_owner",
        "CREATE INDEX jobs_by_owner ON jobs (owner, state)",
    ),
    ("CREATE TABLE sizes (key TEXT PRIMARY KEY, bytes {whole} NOT NULL) {strict}",),
)
