"""The algorithms of the CRC RevEng catalogue up to 64 bits: names, aliases and Rocksoft parameters.

Transcribed from Greg Cook's "Catalogue of parametrised CRC algorithms"
(https://reveng.sourceforge.io/crc-catalogue/all.htm) as of CRC RevEng 3.0.6: 113 algorithms, of
which CRC-82/DARC is wider than 64 bits and left out.

The table is crc_catalogue.csv: a row says all of an algorithm, numbers as hex digits.
"""

# Why a table and not a library. Of the candidates, crccheck 1.3.1 (MIT, pure Python, 2.6 ms to
# import) holds all 112 algorithms with the same parameters, but of the catalogue's 74 aliases it
# lacks CRC-16, CRC-16/BLUETOOTH and CRC-32/NVME and spells X-CRC-12 differently; it gives its names
# only in a private attribute, and it has no type annotations. anycrc 2.1.0 (Zlib) has every alias,
# but is a C extension and spells the names its own way. What is wanted from either is one table,
# so it stands here, without a dependency for everyone who compiles a schema. The tests hold every
# row and every check value against both libraries.

import csv
from collections.abc import Iterator
from pathlib import Path


def catalogue_rows() -> Iterator[dict[str, str]]:
    """The rows of the table by the names of its columns, in the catalogue's order."""
    with Path(__file__).with_name("crc_catalogue.csv").open(encoding="ascii", newline="") as table:
        yield from csv.DictReader(table)
