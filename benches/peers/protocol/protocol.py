"""How the comparison speaks to a driver written in Python; the commands stand in src/lib.rs.

A driver gives `serve` what `about` answers, and a function `build(case, mesh, setup)` that makes an object with
`advance(steps)`, `positions()` and `place(positions)`; arrays have one row of three numbers for each node, in metres.
"""

import json
import os
import sys
import time
import tomllib
from dataclasses import dataclass

import numpy as np

# Programs print what they like, on loading too, so that this is to be imported before them: answers have a channel of
# their own.
answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)


@dataclass
class Mesh:
    nodes: np.ndarray  # places [m]
    cells: np.ndarray  # corners, of positive volume

    @classmethod
    def read(cls, path):
        with open(path) as file:
            count, cells = map(int, file.readline().split())
            numbers = np.array(file.read().split(), float)
        return cls(numbers[: 3 * count].reshape(-1, 3), numbers[3 * count :].astype(np.int32).reshape(cells, 4))

    def held(self):
        """Numbers of the nodes at z = 0."""
        return np.flatnonzero(self.nodes[:, 2] == 0.0)

    def tip(self, case):
        """The node in the middle of the free end."""
        width, height, length = case["beam"]["size"]
        middle = [0.5 * width, 0.5 * height, length]
        return int(np.argmin(((self.nodes - middle) ** 2).sum(1)))

    def masses(self, density):
        """Lumped masses [kg]: a quarter of each cell at each of its corners."""
        corners = self.nodes[self.cells]
        edges = corners[:, 1:] - corners[:, :1]
        quarter = 0.25 * density * np.abs(np.linalg.det(edges)) / 6.0
        return np.bincount(self.cells.ravel(), np.repeat(quarter, 4), len(self.nodes))


@dataclass
class Setup:
    variant: str
    step: float  # s
    gravity: list  # m/s²
    damping: float  # rate of mass damping, 1/s


def lame(case):
    """λ and μ [Pa]."""
    young, poisson = case["tissue"]["young"], case["tissue"]["poisson"]
    return young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))


def stable_neo_hookean(case):
    """The λ and μ of the formulae of Smith et al. (2018), so that small strains obey Hooke's law with ours."""
    lam, mu = lame(case)
    return lam + 5 / 6 * mu, 4 / 3 * mu


def serve(about, build):
    with open(sys.argv[1], "rb") as file:
        case = tomllib.load(file)
    mesh = simulation = None
    for line in sys.stdin:
        command = json.loads(line)
        answer = {}
        try:
            match command["do"]:
                case "about":
                    answer = about
                case "build":
                    simulation = None
                    mesh = Mesh.read(command["mesh"])
                    setup = Setup(command["variant"], command["step"], command["gravity"], command["damping"])
                    simulation = build(case, mesh, setup)
                case "run":
                    # Time on the processor: what else the machine does is not counted.
                    begin = time.process_time()
                    simulation.advance(command["steps"])
                    seconds = time.process_time() - begin
                    moved = simulation.positions() - mesh.nodes
                    farthest, tip = np.sqrt((moved**2).sum(1)).max(), moved[mesh.tip(case)]
                    finite = bool(np.isfinite(farthest))
                    answer = {
                        "seconds": seconds,
                        "steps": command["steps"],
                        "tip": tip.tolist() if finite else None,
                        "farthest": float(farthest) if finite else None,
                    }
                case "place":
                    simulation.place(np.array(command["positions"]))
        except Exception as failure:
            answer = {"error": f"{type(failure).__name__}: {failure}"}
        print(json.dumps(answer), file=answers, flush=True)
