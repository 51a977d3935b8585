"""The results of a study as files: the study, and a Parquet file for each block.

A block's name holds the SHA-256 of its bytes. A block that two processes write has the same bytes, and so one file; a
damaged one counts as absent and is computed again. So nothing is lost or counted twice, whoever is killed when.
"""

import hashlib
import io
import re
from collections.abc import Container, Iterator
from pathlib import Path

import polars as pl

from thetascope.messages import Message
from thetascope.runs.results.engine_version import engine_version
from thetascope.runs.specs.refusals import Refusal
from thetascope.studies.places import files_at
from thetascope_schemas.service.study.study import Study
from thetascope_schemas.texts.local_text import ALL

_DOCUMENT = "study.json"
_VERSION = "version.txt"
_BLOCKS = "blocks"
_NAME = re.compile(r"(\d{7})-([0-9a-f]{16})\.parquet")
_OF_DETECTOR, _OF_LANES, _MOST = 16, 64, 4096
_BLOCK_COUNT = 100_000
"""Blocks of a study, above which they grow: a folder of more files is slow to list."""


def document_of(study: Study) -> bytes:
    """Return a complete study as the document that is kept and sent to workers."""
    return study.model_dump_json(context={"language": ALL}).encode()


def block_size(study: Study) -> int:
    """Return the number of runs in a block: part of what a block is, so the same for everybody who computes it."""
    fewest = _OF_DETECTOR if "detection" in study.measures else _OF_LANES
    return min(_MOST, max(fewest, -(-study.runs // _BLOCK_COUNT)))


class Kept:
    """The files of one study. Raises Refusal where the folder holds another study."""

    def __init__(self, study: Study, place: str | Path) -> None:
        self.study, self._files = study, files_at(place)
        self.size = block_size(study)
        self.blocks = -(-study.runs // self.size)
        document = document_of(study)
        if _DOCUMENT in self._files.names(""):
            if Study.model_validate_json(self._files.read(_DOCUMENT)).study_hash() != study.study_hash():
                raise Refusal(Message("study.other", place=str(place)))
        else:
            self._files.write(_VERSION, engine_version().encode())
            self._files.write(_DOCUMENT, document)
        self._names: dict[int, str] = {}
        for name in self._files.names(_BLOCKS):
            match = _NAME.fullmatch(name)
            if match is not None and int(match[1]) < self.blocks:
                self._names.setdefault(int(match[1]), name)

    @classmethod
    def at(cls, place: str | Path) -> "Kept":
        """Return the study that a folder holds. Raises Refusal where it holds none."""
        files = files_at(place)
        if _DOCUMENT not in files.names(""):
            raise Refusal(Message("study.none", place=str(place)))
        return cls(Study.model_validate_json(files.read(_DOCUMENT)), place)

    def span(self, block: int) -> tuple[int, int]:
        """Return the first run of a block and the one after its last."""
        return block * self.size, min((block + 1) * self.size, self.study.runs)

    def check(self) -> list[int]:
        """Return the blocks that are missing, after removing damaged ones.

        Raises Refusal where some are, and the others were computed by another version of the program.
        """
        for block, name in list(self._names.items()):
            try:
                whole = _digest(self._files.read(f"{_BLOCKS}/{name}")) == name.split("-")[1][:16]
            except OSError:
                whole = False
            if not whole:
                self._files.remove(f"{_BLOCKS}/{name}")
                del self._names[block]
        missing = [block for block in range(self.blocks) if block not in self._names]
        if missing and self._names and self._files.read(_VERSION).decode() != engine_version():
            raise Refusal(Message("study.version", done=self.runs_done, runs=self.study.runs))
        if missing and not self._names:
            self._files.write(_VERSION, engine_version().encode())
        return missing

    def add(self, block: int, data: bytes) -> None:
        """Keep the rows of a block. Raises Refusal where there is no room."""
        name = f"{block:07d}-{_digest(data)}.parquet"
        try:
            self._files.write(f"{_BLOCKS}/{name}", data)
        except OSError as error:
            reason = error.strerror or str(error)
            raise Refusal(
                Message("study.not-written", done=self.runs_done, runs=self.study.runs, reason=reason)
            ) from None
        self._names[block] = name

    @property
    def runs_done(self) -> int:
        """Return the number of runs whose rows are kept."""
        return sum(last - first for first, last in map(self.span, self._names))

    @property
    def names(self) -> frozenset[str]:
        """Return the names of the files of blocks."""
        return frozenset(self._names.values())

    def tables(self, known: Container[str] = ()) -> Iterator[pl.DataFrame]:
        """Yield the rows of all blocks that are kept, but those of known files, in the order of runs."""
        for block in sorted(self._names):
            name = self._names[block]
            if name not in known:
                yield pl.read_parquet(io.BytesIO(self._files.read(f"{_BLOCKS}/{name}")))

    def table(self, known: Container[str] = (), before: pl.DataFrame | None = None) -> pl.DataFrame:
        """Return all rows that are kept as one frame, with the columns in one order whatever blocks there are.

        `before`: the table of the known files, which are not read again.
        """
        frames = [*([before] if before is not None and len(before) else []), *self.tables(known)]
        if not frames:
            return pl.DataFrame()
        whole = pl.concat(frames, how="diagonal")
        fixed = [name for name in frames[0].columns if not is_measure(name, self.study)]
        return whole.select(*fixed, *sorted(name for name in whole.columns if name not in fixed)).sort("run")


def is_measure(name: str, study: Study) -> bool:
    """Return whether a column holds a measure, and neither the place of a run nor a factor."""
    factors = {factor.column for factor in study.vary}
    return name not in factors and name not in ("run", "id", "point", "seed", "faulty", "substeps", "error")


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]
