"""Carry out beforehand, in another process, what a session is about to do.

Its kernels, programs and thresholds are then in the cache on disk, where the session finds them: no text of a user
makes the service itself compile or do symbolic work. What takes too long or too much memory is ended there.
"""

from contextlib import suppress

from pydantic import ValidationError

from thetascope.engine.errors import SpecError
from thetascope.live.session.session import Session
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.service.session import SessionCommand


def rehearse_opening(spec: ResolvedExperiment, horizon_rows: int) -> None:
    """Open a session as the service will, and compute its first row. Raises SpecError."""
    Session(spec, horizon_rows).advance(1)


def rehearse_command(spec: ResolvedExperiment, command: SessionCommand, horizon_rows: int) -> None:
    """Carry out a command on a session that begins with the experiment of the present row, without timed commands.

    A command that is refused is refused again when the session carries it out, with the error's place in its spec.
    """
    session = Session(spec, horizon_rows)
    session.advance(1)
    with suppress(SpecError, ValidationError):
        session.handle(command)
        session.advance(1)
