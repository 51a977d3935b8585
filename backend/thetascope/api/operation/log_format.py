"""Log lines: as readable text, or each as one JSON object for programs that collect logs."""

import json
import logging
import sys
import time
from contextvars import ContextVar
from typing import Any

from thetascope.settings import Settings

request_id: ContextVar[str | None] = ContextVar("request_id", default=None)
"""The id of the request that is being answered; None outside of requests."""
_LIMIT = 2000
"""Characters of a field in a line: a client chooses addresses and headers."""


class _Fields(logging.Filter):
    """Adds the id of the present request to a record, and its fields if it has none."""

    def filter(self, record: logging.LogRecord) -> bool:
        fields: dict[str, Any] = dict(getattr(record, "fields", {}))
        if (id := request_id.get()) is not None:
            fields["request"] = id
        record.fields = fields
        return True


class JsonLines(logging.Formatter):
    """Writes a record as one line of JSON: time, level, logger, message, fields, and the traceback if there is one."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the line."""
        seconds = time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(record.created))
        line = {"time": f"{seconds}.{int(record.msecs):03d}Z", "level": record.levelname.lower(), "logger": record.name}
        if message := record.getMessage():
            line["message"] = message
        line |= getattr(record, "fields", {})
        if record.exc_info:
            line["traceback"] = self.formatException(record.exc_info)
        return json.dumps({name: _short(value) for name, value in line.items()}, ensure_ascii=False)


class TextLines(logging.Formatter):
    """Writes a record as one line of text; only tracebacks take more lines."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the line. Characters that would begin another line, or command a terminal, are escaped."""
        fields = [f"{name}={_printable(value)}" for name, value in getattr(record, "fields", {}).items()]
        message = _printable(record.getMessage())
        moment = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(record.created))
        name = record.name.removeprefix("thetascope.")
        line = " ".join(part for part in (moment, record.levelname.lower(), name + ":", message, *fields) if part)
        return f"{line}\n{self.formatException(record.exc_info)}" if record.exc_info else line


def _short(value: object) -> object:
    return value[:_LIMIT] + "…" if isinstance(value, str) and len(value) > _LIMIT else value


def _printable(value: object) -> str:
    text = str(_short(value) if isinstance(value, str) else value)
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def install(settings: Settings) -> None:
    """Send all log lines to standard error in the form of the settings; called once per process."""
    handler = logging.StreamHandler(sys.stderr)
    handler.addFilter(_Fields())
    handler.setFormatter(JsonLines() if settings.log == "json" else TextLines())
    logging.basicConfig(handlers=[handler], level=logging.WARNING, force=True)
    logging.getLogger("thetascope.audit").setLevel(logging.INFO)
    logging.getLogger("thetascope.requests").setLevel(logging.INFO if settings.log_requests else logging.WARNING)
