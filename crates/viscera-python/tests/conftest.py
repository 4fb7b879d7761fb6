"""What tests share: the reference cases that the engine's own tests have, where `test.sh` says they are."""

import json
import os
from pathlib import Path

import pytest

import viscera

REFERENCES = Path(os.environ["VISCERA_REFERENCES"])


@pytest.fixture
def reference():
    """A reference case by its name."""
    return lambda name: json.loads((REFERENCES / f"{name}.json").read_text())


@pytest.fixture
def reference_mesh():
    """The mesh of a reference case by its file name."""
    return lambda name: viscera.read_mesh(REFERENCES / name)[0]


@pytest.fixture
def beam():
    """A world with a beam of 10 x 10 x 40 cm that is held at z = 0, and the beam."""

    def make(precision="double", cells=(2, 2, 8), **world):
        mesh = viscera.TetMesh.box_grid(list(cells), [0.1, 0.1, 0.4])
        law = viscera.NeoHookean.from_young_poisson(young=10e3, poisson=0.4)
        made = viscera.World(precision=precision, **{"gravity": [0, -0.5, 0], **world})
        body = made.add(viscera.Body(mesh, 1000.0, model=viscera.TotalLagrangian(law), fix="z-min", name="beam"))
        return made, body

    return make
