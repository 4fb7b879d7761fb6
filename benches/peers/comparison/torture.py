"""What a beam does after everything was done to it: it comes back, stays wrong, or breaks the program."""

import math
import random

from measure import Fails, Spent
from peers import Crash, Late


def places(case, nodes):
    """What is done to the beam, and where that puts every node. Held nodes stay where they are."""
    size = case["beam"]["size"]
    middle = [0.5 * extent for extent in size]
    chance = random.Random(1)

    def free(place):
        return [node if node[2] == 0.0 else place(node) for node in nodes]

    def anywhere(_):
        return [middle[axis] + (2.0 * chance.random() - 1.0) * size[axis] for axis in range(3)]

    done = {
        "scrambled": free(anywhere),
        "in one point": free(lambda _: middle),
        "in a plane": free(lambda node: [middle[0], node[1], node[2]]),
        "mirrored": free(lambda node: [node[0], node[1], -node[2]]),
    }
    for factor in case["torture"]["stretches"]:
        done[f"stretched {factor:g} times"] = free(lambda node, factor=factor: [node[0], node[1], factor * node[2]])
    return done


def score(trial, *arguments):
    """What a trial comes to, in few words."""
    try:
        return trial(*arguments)
    except Fails as failure:
        what = str(failure)
        if what in ("not a number", "runs away"):
            return {"not a number": "NaN"}.get(what, what)
        # The first part of a message says what, the rest where and why.
        return f"refuses: {what.split(':')[0]}"
    except Late:
        return "no answer"
    except Crash as crash:
        return f"crash ({crash})"


def comes_back(run, positions, step):
    """What becomes of the beam, put there, without gravity."""
    settings = run.case["torture"]
    run.build(step, gravity=[0.0, 0.0, 0.0], damping=settings["damping"], budget=settings["budget"])
    answer = run.driver.ask("place", positions=positions)
    if "error" in answer:
        raise Fails(answer["error"])
    steps, simulated, farthest = max(1, round(0.1 / step)), 0.0, math.inf
    try:
        while simulated < settings["seconds"]:
            farthest = run.advance(steps)["farthest"]
            simulated += steps * step
            if farthest <= settings["back"] * run.length():
                return f"comes back in {simulated:.1f} s"
    except Spent:
        return f"wrong after {simulated:.1f} s, too slow to go on"
    return "stays wrong" if farthest <= 10.0 * run.length() else "flies apart"


def broke(outcome):
    """Whether that may be the fault of the step."""
    return outcome.startswith(("NaN", "flies apart", "runs away"))


def long_step(run):
    """What becomes of the swinging beam at steps of 10 ms."""
    run.build(0.01, budget=run.case["torture"]["budget"])
    try:
        run.swing(math.ceil(run.case["step"]["seconds"][0] / 0.01))
    except Spent:
        return "holds while it was watched"
    return "holds"
