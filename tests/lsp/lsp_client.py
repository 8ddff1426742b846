"""A small client of the Language Server Protocol over standard input and output."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Sequence
from types import TracebackType
from typing import Any, Self

Message = dict[str, Any]
Position = dict[str, int]


class LspClient:
    """Starts a server, asks it, and answers what it asks: only for its settings."""

    def __init__(self, command: Sequence[str], settings: Message) -> None:
        self._settings = settings
        self._last_id = 0
        self._server = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.request("initialize", processId=None, rootUri=None, capabilities=_CAPABILITIES)
        self.notify("initialized")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._server.kill()
        self._server.communicate()

    def request(self, method: str, **params: Any) -> Any:
        """Send a request and return its result."""
        self._last_id += 1
        self._send(id=self._last_id, method=method, params=params)
        while True:
            message = self._next()
            if message.get("id") == self._last_id and "method" not in message:
                assert "error" not in message, message
                return message["result"]

    def notify(self, method: str, **params: Any) -> None:
        """Send a notification, which has no answer."""
        self._send(method=method, params=params)

    def open(self, uri: str, text: str) -> list[Message]:
        """Open a document and return its diagnostics."""
        document = {"uri": uri, "languageId": "yaml", "version": 1, "text": text}
        self.notify("textDocument/didOpen", textDocument=document)
        while True:
            message = self._next()
            told = message.get("method") == "textDocument/publishDiagnostics"
            if told and message["params"]["uri"] == uri:  # Not those of one opened before.
                return list(message["params"]["diagnostics"])

    def completions(self, uri: str, position: Position) -> list[str]:
        """Return the labels that the server offers at a place."""
        params = {"textDocument": {"uri": uri}, "position": position}
        result = self.request("textDocument/completion", **params)
        return [item["label"] for item in result["items"]]

    def hover(self, uri: str, position: Position) -> str:
        """Return the text that the server shows for a place."""
        params = {"textDocument": {"uri": uri}, "position": position}
        return str(self.request("textDocument/hover", **params)["contents"]["value"])

    def _next(self) -> Message:
        """Read a message; what the server asks is answered on the way."""
        message = self._receive()
        if "method" in message and "id" in message:
            items = message["params"].get("items", [])
            answer = [self._settings.get(item.get("section")) for item in items]
            self._send(id=message["id"], result=answer)
        return message

    def _send(self, **message: Any) -> None:
        assert self._server.stdin is not None
        content = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self._server.stdin.write(b"Content-Length: %d\r\n\r\n%b" % (len(content), content))
        self._server.stdin.flush()

    def _receive(self) -> Message:
        assert self._server.stdout is not None
        size = None
        while (line := self._server.stdout.readline()).strip():
            name, _, value = line.partition(b":")
            if name.lower() == b"content-length":
                size = int(value)
        assert size is not None, "the language server has ended"
        message: Message = json.loads(self._server.stdout.read(size))
        return message


_CAPABILITIES: Message = {
    "workspace": {"configuration": True, "didChangeConfiguration": {"dynamicRegistration": True}},
    "textDocument": {"hover": {"contentFormat": ["markdown"]}},
}
