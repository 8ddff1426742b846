"""Flash of small linked programs on an ATmega328P is what is recorded: none grows unseen."""

import re
import sys
from pathlib import Path

import pytest
from tooling import require_tool

ROOT = Path(__file__).parent.parent
sys.path.append(str(ROOT / "benchmarks"))

from c_costs import sizes  # noqa: E402
from c_costs.protocols import FOLDER  # noqa: E402
from c_costs.toolchains import AVR, ORDINARY  # noqa: E402


def test_flash_is_what_is_recorded(tmp_path):
    require_tool("avr-gcc")
    require_tool("avr-size")
    record = sizes.recorded()
    compiler = AVR[ORDINARY].version()
    if compiler != record.compiler:
        pytest.skip(f"sizes are recorded for {record.compiler}, and this is {compiler}")
    measured = sizes.measured(tmp_path)
    assert changes(record.flash, measured.flash) == [], (
        f"look at why; to record what is meant, run `{sizes.COMMAND}`"
    )


def changes(recorded, measured):
    """Each size that is another now, in words."""
    return [
        f"{name} {'grew' if flash > recorded.get(name, 0) else 'shrank'}: "
        f"{recorded.get(name)} to {flash} bytes"
        for name, flash in measured.items()
        if flash != recorded.get(name)
    ]


def test_a_size_that_grew_is_told():
    assert changes({"rover": 300, "matty": 200}, {"rover": 302, "matty": 200}) == [
        "rover grew: 300 to 302 bytes"
    ]


def test_every_protocol_that_is_recorded_has_a_size():
    assert set(sizes.recorded().flash) == set(sizes.RECORDED)


def test_the_rover_that_is_measured_is_that_of_the_readme():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    block = re.search(r"```yaml\n(.*?)```", readme, re.DOTALL)
    assert block is not None
    assert (FOLDER / "rover.yaml").read_text(encoding="utf-8") == block[1]
