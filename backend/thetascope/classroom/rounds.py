"""A round of a room: what is asked, and what students have answered."""

from dataclasses import dataclass, field

from thetascope_schemas.service.classroom.requests import LeadRequest
from thetascope_schemas.service.classroom.views import LeadView, Marked

_STEPS = 200
"""Steps of lessons whose votes a room keeps; the oldest are dropped."""


@dataclass
class Step:
    """A step that the teacher has shown: the votes by student, and which answers were right once it was run."""

    lead: LeadRequest
    votes: dict[str, int] = field(default_factory=dict)
    at: dict[str, float] = field(default_factory=dict)
    begun: float = 0.0


@dataclass
class FollowRound:
    """All see the teacher's session; predictions of the steps that the teacher shows are votes."""

    number: int
    lead: LeadRequest = field(default_factory=LeadRequest)
    steps: dict[str, Step] = field(default_factory=dict)

    @property
    def step(self) -> Step | None:
        """The step that is shown; None: no lesson is."""
        return self.steps.get(self.lead.step)

    def show(self, lead: LeadRequest, now: float) -> None:
        """Show what the teacher shows. A step that is shown again before it was run keeps its votes."""
        self.lead = lead
        if not lead.step:
            return
        known = self.steps.get(lead.step)
        if known is None or (known.lead.phase == "after" and lead.phase == "before"):
            self.steps.pop(lead.step, None)  # to the end
            known = self.steps[lead.step] = Step(lead, begun=now)
            while len(self.steps) > _STEPS:
                del self.steps[next(iter(self.steps))]
        known.lead = lead

    def vote(self, student: str, step: str, choice: int, now: float) -> bool:
        """Count a vote, or change it; return whether that is still possible."""
        known = self.step
        if known is None or step != self.lead.step or self.lead.phase != "before" or self.lead.card is None:
            return False
        if choice >= len(self.lead.card.options):
            return False
        known.votes[student], known.at[student] = choice, now
        return True

    def counts(self) -> tuple[int, ...]:
        """Return the votes for each answer of the step that is shown."""
        card, step = self.lead.card, self.step
        if card is None or step is None:
            return ()
        votes = list(step.votes.values())
        return tuple(votes.count(place) for place in range(len(card.options)))

    def mark(self, student: str) -> Marked:
        """Return whether a student's vote was right; None: no vote, or the step was not run."""
        step = self.step
        return None if step is None else mark_of(step, student)

    def lead_view(self, live: bool) -> LeadView:
        """Return what students are shown."""
        lead = self.lead
        return LeadView(
            live=live,
            step=lead.step,
            card=lead.card,
            phase=lead.phase,
            since=lead.since,
            until=lead.until,
            right=lead.right if lead.phase == "after" else (),
        )


def mark_of(step: Step, student: str) -> Marked:
    """Return whether a student's vote for a step was right; None: no vote, or it was not judged."""
    choice = step.votes.get(student)
    if choice is None or step.lead.phase != "after" or choice >= len(step.lead.right):
        return None
    return "right" if step.lead.right[choice] else "wrong"
