"""Opens what an address is of."""

from __future__ import annotations

from collections.abc import Callable

from protogen.link.ports.address import PortKind, parse_address
from protogen.link.ports.lasting import LastingPort
from protogen.link.ports.listening import listen
from protogen.link.ports.port import Port
from protogen.link.ports.pseudo_terminal import make_pseudo_terminal
from protogen.link.ports.serial_port import open_serial_port
from protogen.link.ports.settings import LineSettings
from protogen.link.ports.standard_input import StandardInput

_ANY = LineSettings()


async def open_port(text: str, settings: LineSettings = _ANY, speed: float = 1.0) -> Port:
    """Open a port by its address; `speed` is that of a recording.

    Raises PortError with the cause, and what to do about it.
    """
    address = parse_address(text)
    match address.kind:
        case PortKind.STANDARD_INPUT:
            return StandardInput()
        case PortKind.PSEUDO_TERMINAL:
            return make_pseudo_terminal()
        case PortKind.LISTENING:
            return await listen(address)
        case PortKind.RECORDING:
            from protogen.link.ports.recording import open_recording

            return open_recording(text, speed)
        case _:
            return await open_serial_port(address, settings)


async def open_lasting_port(
    text: str, settings: LineSettings, tell: Callable[[str], None], speed: float = 1.0
) -> Port:
    """Open a port that is opened again when it was lost; `tell` takes news for the user.

    What this program makes itself, and what has an end, is never lost. Raises PortError.
    """
    port = await open_port(text, settings, speed)
    if parse_address(text).kind not in (PortKind.SERIAL, PortKind.SOCKET, PortKind.RFC2217):
        return port
    return LastingPort(port, lambda: open_port(text, settings), tell)
