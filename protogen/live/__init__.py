"""What the targets print, used at once: Python imported from memory, C that fills rows."""

from __future__ import annotations

from protogen.live.codec import kept_module, module_of

__all__ = ["kept_module", "module_of"]
