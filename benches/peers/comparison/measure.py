"""What is measured of a variant on a mesh: the longest step that holds, time per step, where the tip comes to rest.

All times are those on the processor, so that what else runs on the machine counts as little as can be."""

import math
import os
from dataclasses import dataclass

from peers import Crash, Late


class Fails(Exception):
    """The beam does not hold: how it fails."""


class Spent(Exception):
    """The time that was given is spent."""


@dataclass
class Run:
    """A variant of a peer with one mesh."""

    driver: object
    case: dict
    variant: dict
    mesh: str
    spent: float = 0.0  # s on the processor since the beam was built
    budget: float = math.inf  # s on the processor
    each: float = math.inf  # s on the processor for one step, by the last answer

    def length(self):
        return self.case["beam"]["size"][2]

    def build(self, step, gravity=None, damping=0.0, budget=math.inf):
        gravity = self.case["beam"]["gravity"] if gravity is None else gravity
        answer = self.driver.ask(
            "build", mesh=self.mesh, variant=self.variant["name"], step=step, gravity=gravity, damping=damping
        )
        if "error" in answer:
            raise Fails(answer["error"])
        self.spent, self.budget, self.each = 0.0, budget, math.inf

    def advance_at_once(self, steps):
        """Advances the beam, wherever that leads, and gives the driver's answer."""
        if self.spent > self.budget:
            raise Spent
        answer = self.driver.ask("run", steps=steps)
        if "error" in answer:
            raise Fails(answer["error"])
        if answer["farthest"] is None:
            raise Fails("not a number")
        self.spent += answer["seconds"]
        self.each = answer["seconds"] / steps
        return answer

    def advance(self, steps, bound=math.inf):
        """As above, about a second on the processor at a time. No node may go farther than `bound` [m]."""
        while steps > 0:
            some = max(1, min(steps, int(1.0 / max(self.each, 1e-6))))
            answer = self.advance_at_once(some)
            if answer["farthest"] > bound:
                raise Fails("runs away")
            steps -= some
        return answer

    def swing(self, steps):
        """As above, for a beam that has to stay where a beam can be."""
        return self.advance(steps, self.case["step"]["bound"] * self.length())


def holds(run, step, seconds):
    """Whether the undamped beam, swinging from its rest shape, stays within its bound at this step."""
    try:
        run.build(step, budget=run.case["step"]["budget"])
        run.swing(math.ceil(seconds / step))
    except Fails:
        return False
    except Spent:
        pass
    return True


def longest_step(run, seconds, start):
    """The longest step that holds, on a ladder that goes down from the longest that is asked for; and its rung.

    The search starts at the rung that was found on the coarser mesh, as steps only get shorter on finer ones, and goes down
    by growing strides until one holds; between the last two it bisects.
    """
    longest, ratio = run.case["step"]["longest"], run.case["step"]["ratio"]

    def good(rung):
        return holds(run, longest / ratio**rung, seconds)

    if good(start):
        return start
    bad, stride = start, 2
    while not good(bad + stride):
        bad, stride = bad + stride, 2 * stride
        if bad > 40:
            raise Fails(f"no step down to {longest / ratio**bad:.0e} s holds")
    lowest = bad + stride
    while lowest - bad > 1:
        middle = (lowest + bad) // 2
        if good(middle):
            lowest = middle
        else:
            bad = middle
    return lowest


def time_per_step(run, step):
    """The least of several windows of the swinging beam, for one step of the program [s]; and how many such steps the
    program makes of one that it is asked for."""
    settings = run.case["time"]
    run.build(step)
    run.swing(3)
    # A window lasts no longer than half a second of the beam's time, so that all windows see it move.
    steps = max(1, min(round(settings["window"] / max(run.each, 1e-6)), round(0.5 / step)))
    windows = [run.advance_at_once(steps) for _ in range(settings["windows"])]
    best = min(windows, key=lambda window: window["seconds"] / window["steps"])
    return best["seconds"] / best["steps"], best["steps"] / steps


def settled_tip(run, step):
    """Deflection of the tip [m] when the beam has come to rest, by what share it still moves, and the time that was
    simulated [s].

    The tip is looked at every tenth of a second. It is at rest when the last second's places differ by a small share of
    their mean, which counts as its place.
    """
    settings = run.case["settle"]
    run.build(step, damping=settings["damping"], budget=settings["budget"])
    steps = max(1, round(0.1 / step))
    window = max(2, round(1.0 / (steps * step)))
    tips, simulated, moves = [], 0.0, math.inf
    try:
        while moves > settings["quiet"] and simulated < settings["seconds"]:
            tips.append(-run.swing(steps)["tip"][1])
            simulated += steps * step
            last = tips[-window:]
            moves = (max(last) - min(last)) / abs(sum(last) / len(last)) if len(last) == window else math.inf
    except Spent:
        pass
    last = tips[-window:]
    return sum(last) / len(last) if last else math.nan, moves, simulated


def measure(run, number, start):
    """All of it on the mesh of this number, and the rung of the ladder for the next mesh."""
    settings, free = run.case["step"], not run.variant.get("chooses_step")
    try:
        rung = longest_step(run, settings["seconds"][number], start) if free else start
        while True:
            step = settings["longest"] / settings["ratio"] ** rung
            try:
                each, made = time_per_step(run, step)
                load = os.getloadavg()[0]
                tip, moves, simulated = settled_tip(run, step)
                break
            except Fails:
                # It held for a while only: one rung down.
                if not free or rung > 40:
                    raise
                rung += 1
        found = {"step": step / made, "each": each, "speed": step / made / each, "tip": tip, "load": load}
        return found | {"moves": moves, "simulated": simulated}, rung
    except Fails as failure:
        return {"failure": str(failure)}, start
    except Late as late:
        return {"failure": f"too slow: {late}", "ended": True}, start
    except Crash as crash:
        return {"failure": f"crash: {crash}", "ended": True}, start
