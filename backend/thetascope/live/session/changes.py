"""Changes of a session's spec: stages that begin, commands of a viewer."""

from dataclasses import replace
from itertools import takewhile

from thetascope.assembly.build.experiment_builder import engine
from thetascope.assembly.build.incremental import adapted
from thetascope.assembly.build.prepare import prepare
from thetascope.diagnosis.evaluation.verdicts import fault_ids
from thetascope.engine.execution.stages import Stage, carry
from thetascope.live.session import edits, log_events
from thetascope.live.session.gain_moves import check_moves
from thetascope.live.session.session_state import SessionState
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.commands import AddObserver
from thetascope_schemas.service.session import AddNote, Clear, Event, Inject, NoteCommand, SetGainNow, SpecCommand


def change(state: SessionState, command: SpecCommand) -> tuple[SessionState, Event]:
    """Return the state after a command that changes the spec from the present row on, and the event for the log.

    Raises:
        SpecError, pydantic.ValidationError: the command is refused.
    """
    state = enter_stage(state)
    faults = state.spec.faults
    changed = _changed(state, command)
    if changed.spec.faults is not faults:
        changed = replace(changed, faults=(*changed.faults, (changed.row, changed.spec.faults)))
    dropped = len(faults) - len(changed.spec.faults)
    event = log_events.command_event(command, changed.row, changed.t, dropped)
    if isinstance(command, Inject):
        event = event.model_copy(update={"fault": fault_ids(changed.spec.faults)[-1]})
    return note(changed, event)


def _changed(state: SessionState, command: SpecCommand) -> SessionState:
    state, untimed = _untimed(state)
    if isinstance(command, Inject):
        spec = edits.with_fault(state.spec, command, state.t)
        here = untimed.model_copy(update={"faults": spec.faults})
    elif isinstance(command, Clear):
        spec = edits.with_faults_ended(state.spec, command, state.t)
        here = untimed.model_copy(update={"faults": spec.faults})
    else:
        if isinstance(command, SetGainNow):
            check_moves(state.experiment, command)
        spec, here = edits.with_command(state.spec, command, state.t, untimed)
    return adopt(state, spec, here, untimed)


def annotate(state: SessionState, command: NoteCommand) -> SessionState:
    """Return the state with a note added, replaced or removed; rows, stages and log are as they were.

    Raises:
        SpecError: the command is refused.
    """
    if isinstance(command, AddNote):
        spec = edits.with_note(state.spec, command.note, state.t, 0.5 * state.setup.record)
    else:
        spec = edits.without_note(state.spec, command.note)
    known = state.untimed
    if known is not None and known[0] is state.spec:  # the same, whatever the notes say
        state = replace(state, untimed=(spec, *known[1:]))
    return replace(state, spec=spec)


def note(state: SessionState, event: Event) -> tuple[SessionState, Event]:
    """Return the state with an event of a command in its log, and the event."""
    return state.with_log((*state.log, event)), event


def enter_stage(state: SessionState) -> SessionState:
    """Return the state in the stage that holds from the present row on; observers of that stage start here."""
    current, k = state.current, state.row * state.setup.every
    while current.stage + 1 < len(state.stages) and state.stages[current.stage + 1].k <= k:
        old, new = state.stages[current.stage].experiment, state.stages[current.stage + 1]
        current = replace(
            current,
            state=carry(current.state, old, new),
            stage=current.stage + 1,
            live_columns=current.live_columns.carried(new.experiment, current.row),
        )
    if current is not state.current:
        state = replace(state, current=current)
    columns = current.live_columns.columns
    return state if columns == state.columns else replace(state, columns=columns, epoch=state.epoch + 1)


def adopt(
    state: SessionState, spec: ResolvedExperiment, here: ResolvedExperiment, before: ResolvedExperiment | None
) -> SessionState:
    """Return the state with a spec that differs from the present row on; earlier stages stay as they are.

    Args:
        here: the experiment from this row on, without timed commands.
        before: the same in the present stage, before the change; None if it is unknown.

    Raises:
        SpecError, pydantic.ValidationError: the spec is refused.
    """
    complete = edits.checked(spec, state.spec)
    step, k, stage = state.setup.step, state.row * state.setup.every, state.current.stage
    current = state.stages[stage].experiment
    since = {estimator.label: estimator.since for estimator in current.estimators}
    newest = list(takewhile(lambda c: round(c.at / step) >= k, reversed(complete.commands)))
    for command in newest:
        if isinstance(command, AddObserver) and round(command.at / step) == k:
            since[command.observer.label] = k
    experiment = (
        engine(here, since, current.context.healthy) if before is None else adapted(here, since, before, current)
    )
    commanded = any(round(command.at / step) == k for command in newest)
    stages = (*state.stages[: stage + 1], Stage(k, experiment, commanded))
    if newest and round(newest[0].at / step) > k:
        stages += tuple(later for later in prepare(complete).stages if later.k > k)
    state = enter_stage(replace(state, spec=complete, stages=stages))
    return replace(state, untimed=(complete, state.current.stage, here))


def _untimed(state: SessionState) -> tuple[SessionState, ResolvedExperiment]:
    """Return the experiment of the present stage without timed commands, and the state that remembers it."""
    known = state.untimed
    if known is None or known[0] is not state.spec or known[1] != state.current.stage:
        known = state.spec, state.current.stage, edits.without_commands(state.spec, state.t)
        state = replace(state, untimed=known)
    return state, known[2]
