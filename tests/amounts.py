"""Amounts of what is tried on every message, sender or schema: here, and not beside the tests.

Each is a share of the examples of the profile of Hypothesis, which `conftest.py` sets, and no less
than what a quick run needs. What is tried on hundreds needs few of each: others of its kind are
tried as well, and boundaries, which are not drawn, are all tried.
"""

from __future__ import annotations

import os

from hypothesis import settings

EXAMPLES = settings().max_examples
THOROUGH = os.environ.get("HYPOTHESIS_PROFILE") == "thorough"


def share(of: int, least: int) -> int:
    """That part of the profile's examples, but so many at least."""
    return max(least, EXAMPLES // of)


OF_A_MESSAGE = share(4, 8)
"""Examples of each of some 430 messages."""
OF_A_SENDER = share(2, 10)
"""Examples of each of some 80 senders, of what is tried in one engine."""
OF_TWO_ENGINES = share(4, 8)
"""Examples of each of some 130 senders, of what is compared between engines."""
STREAMS = share(6, 6)
"""Seeded streams of each sender, of some 60 pieces."""
STREAMS_OF_TWO_ENGINES = share(8, 5)
"""The same, where they are compared between engines."""
LIBRARY_SAMPLES = share(1, 400)
"""Samples of each schema of the library that all engines take. Each goes through the slow reference
twice, once byte by byte; with its peer, each is compared over 500 frames and more."""
SCHEMAS_IN_C = 200 if THOROUGH else 7
"""Seeds of random schemas that are compiled to C, each for some twenty."""
SCHEMAS_IN_PYTHON = EXAMPLES if THOROUGH else 200
"""Random schemas whose Python codecs are tried."""
SCHEMAS_EDITED = 40 if THOROUGH else 3
"""Seeds of random schemas that are edited, each for some hundred edits that compile."""
FRAMES_ON_A_PAGE = 100
"""Frames of each schema that its page takes apart."""
EDITED_ON_A_PAGE = 6
"""Messages of each endpoint whose values are edited on its page; others with each
`PROTOGEN_EDIT_TURN`, and all with `PROTOGEN_EDIT_ALL`."""
