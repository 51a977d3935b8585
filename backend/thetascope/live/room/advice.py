"""The diagnosis of a session, and an input proposed for it; both may be computed on a copy of the session."""

import asyncio
from typing import TYPE_CHECKING

from thetascope_schemas.experiment.diagnosis import InputProposal
from thetascope_schemas.service.session import DiagnosisNow

if TYPE_CHECKING:
    from thetascope.live.room.room_parts import RoomParts
    from thetascope.live.session.session import Session


def diagnosis_of(session: "Session") -> DiagnosisNow:
    """Return the diagnosis of all rows so far."""
    return session.detector.report(session.current.detection, session.state.detects_outside)


async def propose_input_for(room: "RoomParts") -> InputProposal:
    """Return an input that separates the faults from the present row on.

    Raises:
        Unwatchable: the session has no detector.
    """
    copy: Session = await room.run_exclusive(room.session.fork)
    answer: asyncio.Future[InputProposal] = asyncio.get_running_loop().create_future()

    def then(value: InputProposal, error: Exception | None) -> None:
        if not answer.cancelled():
            answer.set_result(value) if error is None else answer.set_exception(error)

    room.services.workshop(lambda: copy.detector.propose_input(copy.experiment, copy.current.state), then)
    return await answer
