"""What the detector of a session says of it, and what it proposes; both are worked out on a copy of the session."""

import asyncio
from typing import TYPE_CHECKING

from thetascope_schemas.experiment.diagnosis import InputProposal
from thetascope_schemas.service.session import DiagnosisNow

if TYPE_CHECKING:
    from thetascope.live.room.room_parts import RoomParts
    from thetascope.live.session.session import Session


def diagnosis_of(session: "Session") -> DiagnosisNow:
    """What the detector says of all rows so far."""
    return session.detector.report(session.current.watched, session.detects_outside)


async def propose_input_for(room: "RoomParts") -> InputProposal:
    """An input that would tell the faults apart from here on. Raises Unwatchable where nothing is watched."""
    copy = await room.run_exclusive(room.session.fork)
    answer: asyncio.Future[InputProposal] = asyncio.get_running_loop().create_future()

    def then(value: InputProposal | None, error: Exception | None) -> None:
        if not answer.cancelled():
            answer.set_result(value) if error is None else answer.set_exception(error)

    room.services.workshop(lambda: copy.detector.propose_input(copy.experiment, copy.current.state), then)
    return await answer
