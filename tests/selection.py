"""Selection of tests that `make test` runs; the others are marked `slow`.

Many files try the same on all schemas, machines or seeds, which takes most of the time. The
selection has some of each, so that a fault in any module still shows. `make test-all` has all.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = (
    "schemas",
    "schemas/dialects",
    "tests/framings",
    "tests/c_schemas",
    "tests/stuffed_schemas",
    "tests/form_schemas",
)
KEPT = {"matty", "rn1", "cobs", "sync_length_crc"}
"""Schemas that stand for the others: stuffed, of 7-bit bytes, encoded, with a start in the data."""

THINNED = (
    "test_c_*.py",
    "test_capture*.py",
    "test_convert*.py",
    "test_fast_*.py",
    "test_frame_plan.py",
    "test_json_lines.py",
    "test_live_streams.py",
    "test_native*.py",
    "test_printer.py",
    "test_recovery.py",
    "test_round_trips.py",
    "test_runtime_decoder.py",
    "test_struct_sizes.py",
    "test_typescript_browser.py",
    "test_typescript_streams.py",
)
"""Files of which only the tests of the kept schemas are selected, and those of no schema."""

ONLY = {
    "test_breaking_pairs.py": r"300|\[enum,",
    "test_bench_python.py": r"\[0-|in_order|reference",
    "test_c_bounded.py": r"^$",
    "test_c_bounded_forms.py": r"^$",
    "test_c_contracts.py": r"^$",
    "test_c_fuzz.py": r"^$",
    "test_c_proof.py": r"^$",
    "test_c_schemas.py": r"\[0\]",
    "test_ci.py": "TestCommands",
    "test_evolution_random.py": r"^$",
    "test_html_page.py": r"is_one_file|anchor|markup|blanks|hostile|titles|texts_to_copy|counted",
    "test_html_hostile.py": "markup|policies",
    "test_html_keyboard.py": "encode_by_keys",
    "test_html_recordings.py": r"\[(a raw recording|a log|hex)\]|many",
    "test_html_scale.py": r"\[(matty|rn1|cobs|sync_length_crc)\]|thousand",
    "test_import_mavlink_c.py": "minimal",
    "test_import_mavlink_published.py": r"all_files.*\[2|is_named|small_dialects|left_out_are_read",
    "test_import_mavlink_random.py": r"\[[01]-",
    "test_import_sbp_published.py": r"^$",
    "test_line_pace.py": "TestTap",
    "test_link_requests.py": "by_order|lazy",
    "test_lower_bounds.py": "has_a_lower_bound",
}
"""Regular expressions over names of tests: only these are selected of a file."""

WITHOUT = {
    "test_breaking.py": r"can_be_told.*\[(?!field-)",
    "test_breaking_renames.py": r"\[(an|the|a) ",
    "test_cli_diff.py": r"explains_each.*\[(?!field-scale)|links|attributes|submodule|others_were",
    "test_cli_json_schema.py": "check_takes|of_shape",
    "test_cli_explain.py": "another_seed|refusals",
    "test_cli_process.py": "need_no_locale",
    "test_cli_size.py": r"\[cortex-m0\]",
    "test_convert_parquet.py": "many_groups",
    "test_convert_resume.py": "killed|does_not_grow",
    "test_library.py": r"(there_and_back|any_folder|as_fmt_does)\[(?!ld19|sbus|vesc)",
    "test_c_counters.py": r"behind_escapes\[(?!1\]|7\])",
    "test_c_crcs.py": "bit by bit|machines of bytes",
    "test_c_decoder.py": r"single_header|a_selection.*\[(?!2)",
    "test_c_in_place.py": r"\[(plain|short_cobs)\]",
    "test_c_in_place_varied.py": r"beside_the_frame\[(plain|short_cobs)|clang\+\+",
    "test_c_lint.py": r"clang_tidy|vectors|misra.*(rn1|cobs|sync)|warns\[.*single",
    "test_c_machines.py": r"gives_the_same\[(?!rn1)",
    "test_c_packages.py": "cmake",
    "test_convert_fleet.py": "fleet|killed|scheduler|this_machine|numpy",
    "test_docs.py": r"shows\[(docs/(howto|reference|background)|bench)",
    "test_cpp.py": r"python_finds\[(?!matty|rn1)",
    "test_evolution_claims.py": r"another_unit_is.*\[(?!m\])",
    "test_fast_engine.py": "TestRuns|runs_of_one_message.*pc",
    "test_json_lines.py": "two_processes",
    "test_layout.py": "in_any_style",
    "test_library_feetech.py": "to_all",
    "test_library_mavlink1.py": "both_make",
    "test_library_mavlink2.py": "other_sizes",
    "test_library_msp.py": "does_not_send|is_lost",
    "test_library_sbp.py": "is_lost",
    "test_library_srec.py": "small_letters",
    "test_library_ubx.py": "both_make",
    "test_library_xbee1.py": "both_make|is_lost",
    "test_library_xbee2.py": "is_lost",
    "test_library_xmodem.py": "both_make",
    "test_live_cache.py": "without_a_folder",
    "test_lock.py": "against_a_lock",
    "test_markdown.py": "pages_of_all",
    "test_merging.py": "each_merge",
    "test_native.py": (
        "two_processes|builds_ahead|odd_frames|random_schemas|many_shapes|cut_off|ziglang"
        "|byte_behind|where_they_stay"
    ),
    "test_packaging.py": "TestWheel",
    "test_passes_hostile.py": "work_grows",
    "test_passes_promises.py": "uherobot",
    "test_passes_robust.py": "of_a_base",
    "test_printer.py": r"of_events\[(?!rn1)|are_exact.*-(?!i4)..\]",
    "test_project_record.py": "hundred",
    "test_python_corners.py": "thousands",
    "test_python_target.py": "strangers",
    "test_runtime_decoder.py": r"whatever_the_bytes.*length|is_recovered.*-[234]\]",
    "test_schema_fuzzing.py": "codec_works|every_shape",
    "test_schema_recovery.py": r"no_consequences\[(?!rn1|matty)",
    "test_struct_sizes.py": "random",
    "test_told.py": "c_finds.*-messages",
    "test_typescript.py": "compile|resolves|expect",
    "test_typescript_streams.py": (
        r"of_the_(fuzzer|library).*\[(?!matty|rn1|cobs|sync_length|ld19|sbus|vesc"
        "|last_elements|regions|sized_arrays|terminated|answers|lengths|modes)"
    ),
    "test_web_serial.py": "keys_suffice",
}
"""Regular expressions over names of tests: all but these are selected of a file."""


def is_slow(item: pytest.Item) -> bool:
    """True if `make test` leaves a test out."""
    file = item.path.name
    if is_thinned(file) and not is_of_kept_schema(item.name):
        return True
    only, without = ONLY.get(file, ""), WITHOUT.get(file)
    if without is not None and re.search(without, item.nodeid):
        return True
    return not re.search(only, item.nodeid)


@cache
def is_thinned(file: str) -> bool:
    """True if `make test` tries only the kept schemas in a file."""
    return any(fnmatch(file, pattern) for pattern in THINNED)


def is_of_kept_schema(name: str) -> bool:
    """True if a test is about no schema, or about one of those that are kept."""
    _, _, parameters = name.partition("[")
    names = parameters.rstrip("]").split("-")
    numbered = [name.rstrip("0123456789") for name in names]  # as pytest numbers equal ones: cobs0
    schemas = schema_names().intersection((*names, *numbered))
    return not schemas or bool(schemas & KEPT)


@cache
def schema_names() -> frozenset[str]:
    """Names of all schemas that tests go through."""
    return frozenset(path.stem for folder in FOLDERS for path in (ROOT / folder).glob("*.yaml"))


def mark(items: Iterable[pytest.Item]) -> None:
    """Mark the tests that `make test` leaves out."""
    for item in items:
        if is_slow(item):
            item.add_marker("slow")
