"""What all pages have around them: templates, the style, and what they may run and load."""

from __future__ import annotations

import json
import re
from base64 import b64encode
from functools import cache
from hashlib import sha256
from importlib.resources import files
from typing import Any

from markupsafe import Markup

from protogen.targets.printing import environment

PACKAGE = "protogen.targets.html"
_BREAKS = re.compile(r"\s*\n\s*")
_STYLES = ("page", "frames", "bench", "print")
_COMPARISON_STYLES = ("page", "frames", "bench", "comparison", "print")


def printed(template: str, script: str | None = None, **values: Any) -> str:
    """A page: a template with these values, the style, and a script if it has one."""
    style = _style(_COMPARISON_STYLES if template == "comparison" else _STYLES)
    safe = None if script is None else _without_ends(script)
    found = environment(PACKAGE, autoescape=True).get_template(f"{template}.html.j2")
    text: str = found.render(
        **values,
        style=Markup(style),  # noqa: S704 - ours.
        script=None if safe is None else Markup(safe),  # noqa: S704 - what could end it is out.
        policy=_policy(style, safe),
    )
    return text


def data(value: object) -> Markup:
    """JSON for the inside of a script element, which no text in it ends."""
    text = json.dumps(value, ensure_ascii=True, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c"))  # noqa: S704 - made safe just here.


def _policy(style: str, script: str | None) -> str:
    """What the page may run and load: its own script and style, and nothing else."""
    run = "" if script is None else f" script-src {_hash(script)};"
    return f"default-src 'none';{run} style-src {_hash(style)}; base-uri 'none'; form-action 'none'"


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode('ascii')}'"


def _without_ends(script: str) -> str:
    """The script, of which no text ends its element; in a text, an escape means the same."""
    return script.replace("</", "<\\/").replace("<!--", "<\\!--").replace("<script", "<\\script")


@cache
def _style(names: tuple[str, ...]) -> str:
    folder = files(PACKAGE) / "page"
    text = "".join((folder / f"{name}.css").read_text(encoding="utf-8") for name in names)
    return _BREAKS.sub("", text)
