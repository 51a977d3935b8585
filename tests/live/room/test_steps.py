"""The row of a paused session after single steps, and after going back."""

import numpy as np
import pytest

from tests.live.stage import Stage, staged

FAULT = {"channel": "gain", "shape": "step", "onset": 0, "size": 0.3}


def test_the_status_after_steps_is_that_of_the_row_that_was_shown():
    """Whether the rows were computed before (as after a pause) or are computed for the step."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "play")
        await stage.go(1.0)
        await stage.say(page, "pause")
        for rows in (1, 1, 3, 500):
            shown = stage.room.shown
            await stage.say(page, "step", rows=rows)
            await stage.go(0.1)
            status = page.of("status")[-1]
            assert status["row"] == stage.room.shown == shown + rows and status["playing"] is False
            assert status["t"] == pytest.approx(0.01 * (shown + rows - 1))

    staged(scenario)


def test_going_back_while_paused_shows_the_row_at_that_time():
    """The time shown is the requested one, and the command given then is undone."""

    async def scenario(stage: Stage) -> None:
        page = await stage.connect()
        await stage.say(page, "step", rows=60)
        await stage.go(0.1)
        before, faults = page.rows_at(50), stage.session.spec.faults
        await stage.say(page, "inject", fault=FAULT)
        await stage.say(page, "step", rows=60)
        await stage.go(0.1)
        await stage.say(page, "seek", t=0.5)
        assert page.of("status")[-1]["t"] == pytest.approx(0.5) and stage.room.shown == 51
        np.testing.assert_array_equal(page.rows_at(50), before)
        assert stage.session.spec.faults == faults

    staged(scenario)
