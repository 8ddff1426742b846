"""Names of what `make test` leaves out: they exist."""

from __future__ import annotations

from pathlib import Path

import pytest
import selection

TESTS = Path(__file__).resolve().parent


@pytest.mark.parametrize("pattern", [*selection.THINNED, *selection.ONLY, *selection.WITHOUT])
def test_a_file_is_there(pattern: str) -> None:
    assert list(TESTS.glob(pattern))


def test_schemas_that_are_kept_are_there() -> None:
    assert selection.schema_names() > selection.KEPT


@pytest.mark.parametrize(
    ("name", "is_kept"),
    [
        ("test_tables", True),
        ("test_tables[1-True]", True),
        ("test_tables[matty-pc]", True),
        ("test_tables[gcc-rn1]", True),
        ("test_tables[matty_v4-pc]", False),
        ("test_tables[hdlc-station]", False),
        ("test_tables[cobs1-station]", True),
        ("test_tables[hdlc1-station]", False),
    ],
)
def test_a_test_of_another_schema_is_left_out(name: str, is_kept: bool) -> None:
    assert selection.is_of_kept_schema(name) == is_kept
