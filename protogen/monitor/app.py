"""The monitor as a full-screen program: table, plot, log, and a line to type in."""

from __future__ import annotations

import time
from collections import deque
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from rich.text import Text
from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import DataTable, Footer, Input, RichLog, Sparkline, Static

from protogen.cli.wire.event_lines import EventLines, json_line
from protogen.errors import UserError
from protogen.monitor.fields import FieldPath, FilterError, value_at
from protogen.monitor.filters import Filter, field_path, parse_filter
from protogen.monitor.rows import COLUMNS, cells_of, fields_of, line_status

if TYPE_CHECKING:
    from protogen.monitor.session import Logged, Session

_DRAWN = 0.2
"""Seconds from one drawing to the next."""
_SHOWN_AT_ONCE = 200
"""Events that are added to the log in one drawing; of more, the newest."""
_LOG_LINES = 2000
"""Lines that the log holds."""
_PLOTTED = 240
"""Values of a field that a plot shows."""
_HELP = {
    "filter": "which events the log shows: state, state.battery_v < 11, drive or invalid",
    "search": "a word to find in the log",
    "plot": "a field to plot: state.battery_v",
    "send": "a message to send: drive left=500 right=-500",
    "save": "a file for the log, as lines of JSON",
}


class MonitorApp(App[None]):
    """Watches a line until it is told to end."""

    CSS = """
    #status { height: 1; background: $primary; color: $text; }
    DataTable { height: 1fr; min-height: 4; }
    #detail { height: auto; max-height: 12; display: none; border-top: solid $primary; }
    #plot { height: 5; display: none; }
    #log { height: 8; border-top: solid $primary; }
    #typed { height: 3; display: none; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("space", "pause", "pause"),
        Binding("d", "detail", "details"),
        Binding("f", "type('filter')", "filter"),
        Binding("slash", "type('search')", "search", key_display="/"),
        Binding("p", "type('plot')", "plot"),
        Binding("s", "type('send')", "send"),
        Binding("w", "type('save')", "save"),
        Binding("escape", "leave", "back", show=False),
        Binding("q", "quit", "quit"),
        Binding("ctrl+c", "quit", show=False, priority=True),
    ]
    ENABLE_COMMAND_PALETTE = False

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self._lines = EventLines(session.codec.protocol, show_sender=len(session.codec.senders) > 1)
        self._filter = Filter()
        self._search = ""
        self._shown = 0
        self._rows: dict[tuple[str, str], list[Text]] = {}
        self._typing = ""
        self._is_paused = False
        self._plotted: tuple[str, FieldPath] | None = None
        self._plot_name = ""
        self._plot: deque[float] = deque(maxlen=_PLOTTED)
        self._seconds: float | None = None

    def filter_by(self, kept: Filter) -> None:
        """Have the log show the events that a filter keeps."""
        self._filter = kept

    def end_after(self, seconds: float) -> None:
        """End by itself."""
        self._seconds = seconds

    def compose(self) -> ComposeResult:
        """The parts of the screen, from top to bottom."""
        yield Static(id="status", markup=False)
        yield DataTable(cursor_type="row", zebra_stripes=True)
        yield Static(id="detail", markup=False)
        yield Static(id="plot_title", markup=False)
        yield Sparkline([], id="plot", summary_function=lambda values: values[-1])
        yield RichLog(id="log", max_lines=_LOG_LINES, wrap=False, markup=False, auto_scroll=True)
        yield Input(id="typed")
        yield Footer()

    def on_mount(self) -> None:
        """Begin to draw."""
        self.title = self._session.codec.protocol.name
        table = self.query_one(DataTable)
        for name, width in COLUMNS:
            table.add_column(name, key=name, width=width)
        self.query_one("#plot_title").display = False
        table.focus()
        self.set_interval(_DRAWN, self._draw)
        if self._seconds is not None:
            self.set_timer(self._seconds, self.exit)

    # --- drawing ----------------------------------------------------------------------------------

    def _draw(self) -> None:
        now = time.time_ns()
        session = self._session
        with session.lock:
            kinds = list(session.statistics.messages.items())
            rows = {key: cells_of(session.codec.protocol, item, now) for key, item in kinds}
            status = line_status(session, now, is_paused=self._is_paused)
        news = session.since(self._shown)
        self.query_one("#status", Static).update(status)
        if self._is_paused:
            return
        self._draw_table(rows)
        self._draw_detail()
        missing = news[0].number - self._shown if news else 0
        self._shown = news[-1].number + 1 if news else self._shown
        self._draw_log(news, missing)
        self._draw_plot(news)

    def _draw_table(self, rows: dict[tuple[str, str], list[Text]]) -> None:
        """Update the cells that differ: most of a table stays as it is."""
        table = self.query_one(DataTable)
        for key, cells in rows.items():
            name = " ".join(key)
            before = self._rows.get(key)
            if before is None:
                table.add_row(*cells, key=name)
            for (column, _), cell, old in zip(COLUMNS, cells, before or cells, strict=True):
                if cell != old:
                    table.update_cell(name, column, cell)
            self._rows[key] = cells

    def _draw_detail(self) -> None:
        """All fields of the message that is chosen, each in a line."""
        detail = self.query_one("#detail", Static)
        table = self.query_one(DataTable)
        if not detail.display or not table.row_count:
            return
        key = list(self._rows)[table.cursor_row]
        with self._session.lock:
            item = self._session.statistics.messages[key]
            text = fields_of(self._session.codec.protocol, item)
        detail.update(text)

    def _draw_log(self, news: list[Logged], missing: int) -> None:
        """Add to the log what the filter keeps; `missing` events in front are kept no longer."""
        kept = [item for item in news if self._keeps(item)]
        missing += max(0, len(kept) - _SHOWN_AT_ONCE)
        if missing:
            note = Text(f"{missing:,} events are not shown", style="dim")
            self.query_one("#log", RichLog).write(note)
        self._add_lines(kept[-_SHOWN_AT_ONCE:])

    def _add_lines(self, items: list[Logged]) -> None:
        log = self.query_one("#log", RichLog)
        for item in items:
            log.write(self._text(item))

    def _keeps(self, item: Logged) -> bool:
        if item.event is None:
            return True
        return self._filter.keeps(item.event) and (
            not self._search or self._search in self._text(item).plain
        )

    def _text(self, item: Logged) -> Text:
        when = time.strftime("%H:%M:%S", time.localtime(item.when // 10**9))
        lead = f"{when}.{item.when // 10**6 % 1000:03} "
        if item.event is None:
            return Text.assemble((lead, "dim"), (item.note, "bold yellow"))
        return Text.assemble((lead, "dim"), *self._lines.segments(item.event))

    def _draw_plot(self, news: list[Logged]) -> None:
        if self._plotted is None:
            return
        message, path = self._plotted
        for item in news:
            event = item.event
            if event is not None and event.kind == "message" and message == event.message.NAME:
                value = value_at(event.message, path)
                if isinstance(value, int | float) and isfinite(value):
                    self._plot.append(float(value))
        if self._plot:
            self.query_one("#plot", Sparkline).data = list(self._plot)
            text = f"{self._plot_name}: {self._plot[-1]:g}"
            bounds = f"  from {min(self._plot):g} to {max(self._plot):g}"
            self.query_one("#plot_title", Static).update(text + bounds)

    # --- keys -------------------------------------------------------------------------------------

    def action_pause(self) -> None:
        """Stop or go on drawing; what comes meanwhile is counted, and shown later."""
        self._is_paused = not self._is_paused

    def action_detail(self) -> None:
        """Show or hide all fields of the message that is chosen in the table."""
        detail = self.query_one("#detail")
        detail.display = not detail.display

    def action_type(self, what: str) -> None:
        """Ask for a filter, a field, a message or a file."""
        self._typing = what
        typed = self.query_one("#typed", Input)
        typed.placeholder = _HELP[what]
        typed.value = ""
        typed.display = True
        typed.focus()

    def action_leave(self) -> None:
        """Close the line to type in."""
        self.query_one("#typed", Input).display = False
        self.query_one(DataTable).focus()

    def on_input_submitted(self, submitted: Input.Submitted) -> None:
        """Do what was typed, or say what is wrong with it."""
        try:
            self._do(submitted.value.strip())
        except (UserError, ValueError) as error:
            hint = getattr(error, "hint", None)
            self.notify(f"{error}\n{hint}" if hint else str(error), severity="error", markup=False)
            return
        self.action_leave()

    def _do(self, text: str) -> None:
        match self._typing:
            case "filter":
                self._filter = parse_filter(text, self._session.codec.module)
                self._show_log_again()
            case "search":
                self._search = text
                self._show_log_again()
            case "plot":
                self._choose_plot(text)
            case "send":
                self._send(text)
            case "save":
                self._save(text)

    def _show_log_again(self) -> None:
        log = self.query_one("#log", RichLog)
        log.clear()
        with self._session.lock:
            old = [item for item in self._session.log if item.number < self._shown]
        self._add_lines([item for item in old if self._keeps(item)][-_LOG_LINES:])

    def _choose_plot(self, text: str) -> None:
        plotted = field_path(text, self._session.codec.module) if text else None
        if plotted is not None and not plotted[1]:
            raise FilterError(f"`{text}` names no field", f"write {text}.FIELD")
        self._plotted, self._plot_name = plotted, text
        self._plot.clear()
        self.query_one("#plot", Sparkline).data = []
        self.query_one("#plot_title", Static).update(f"{text}: no value yet")
        for name in ("#plot", "#plot_title"):
            self.query_one(name).display = self._plotted is not None
        with self._session.lock:
            known = list(self._session.log)
        self._draw_plot(known)

    def _send(self, text: str) -> None:
        from protogen.monitor.sending import frame_of

        frame = frame_of(self._session.codec, text)
        self._session.send(frame)
        self.notify(f"sent {frame.hex(' ').upper()}", markup=False)

    def _save(self, text: str) -> None:
        if not text:
            raise UserError("no file is named", "write its name, such as log.jsonl")
        path = Path(text).expanduser()
        with self._session.lock:
            kept = [item for item in self._session.log if item.event is not None]
        try:
            with path.open("x", encoding="utf-8") as file:
                file.writelines(f"{json_line(item.event, t_ns=item.when)}\n" for item in kept)
        except OSError as error:
            raise UserError(f"{path}: {error.strerror}") from None
        self.notify(f"{len(kept):,} events in {path}", markup=False)
