"""`thetascope backup | restore | verify`: keep, bring back and check the store of runs."""

import sys
from contextlib import closing
from pathlib import Path

from thetascope.cli.words import Words
from thetascope.settings import load
from thetascope.store import Database, Verification, backup, opened, restore, verify


def backup_command(file: Path, force: bool, say: Words) -> int:
    """Write the store to a file, also while a server uses it; print its contents. Raises StoreError."""
    found = backup(load().store, file, force)
    print(say("cli.backup.done", runs=found.runs, results=found.results, size=file.stat().st_size, file=str(file)))
    return _defects(found, say)


def restore_command(file: Path, force: bool, say: Words) -> int:
    """Replace the store by a backup; print its contents. Raises StoreError."""
    settings = load()
    restored = restore(settings.store, file, force)
    found = restored.backup
    print(say("cli.restore.done", runs=found.runs, results=found.results, file=str(file)))
    if restored.kept is not None:
        print(say("cli.restore.kept", file=str(restored.kept)))
    return _defects(found, say)


def verify_command(file: Path | None, say: Words) -> int:
    """Check the store or a backup, also while a server uses it; print the defects. Raises StoreError."""
    if file is None:
        with closing(Database(load().store, read_only=True)) as database:
            place, found = database.place, verify(database)
    else:
        with opened(file) as database:
            place, found = str(file), verify(database)
    print(say("cli.verify.read", runs=found.runs, results=found.results, store=place))
    return _defects(found, say)


def _defects(found: Verification, say: Words) -> int:
    """Print the defects; return the exit code."""
    for defect in found.defects:
        print(defect.text(say.language), file=sys.stderr)
    if found.defects:
        print(say("cli.verify.damaged", n=len(found.defects)), file=sys.stderr)
    return 1 if found.defects else 0
