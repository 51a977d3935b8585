"""Hidden faults to be found: drawn by a key, simulated, judged by what could be told when, and answers graded."""

from thetascope.challenge.detector_answer import detector_answer
from thetascope.challenge.draw import Drawn, draw
from thetascope.challenge.experiments import experiment_of, setup_plant
from thetascope.challenge.grade import grade
from thetascope.challenge.mystery import Challenge, challenge, mystery_of, solution_of
from thetascope.challenge.told import truth_of

__all__ = [
    "Challenge",
    "Drawn",
    "challenge",
    "detector_answer",
    "draw",
    "experiment_of",
    "grade",
    "mystery_of",
    "setup_plant",
    "solution_of",
    "truth_of",
]
