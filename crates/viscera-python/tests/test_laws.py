"""Laws by their values: what no tissue has is refused where it is given, with its cell and its reason."""

import numpy as np
import pytest

import viscera

FIBRED = "transverse-st-venant-kirchhoff"


@pytest.mark.parametrize(
    ("kind", "row", "says"),
    [
        ("neo-hookean", [4e3, -2e3], "mu = -2000 is out of range: it must be positive"),
        ("neo-hookean", [4e3, 0.0], "mu = 0 is out of range"),
        ("linear", [-2e3, 2e3], "lambda = -2000 is out of range: it must be above -2 mu/3"),
        ("stable-neo-hookean", [np.nan, 2e3], "lambda = NaN is no finite number"),
        ("st-venant-kirchhoff", [4e3, np.inf], "mu = inf is no finite number"),
        (FIBRED, [4e3, 2e3, 0, 0, 0, 1e3], "fibre direction has the length 0"),
        (FIBRED, [4e3, 2e3, 0, 2, 0, 1e3], "fibre direction has the length 2"),
        (FIBRED, [4e3, 2e3, 0, 1, 0, -4e3], "fibre-stiffness = -4000 is out of range: it must be above -E/2"),
        (FIBRED, [4e3, 2e3, 0, 1, np.nan, 1e3], "direction-z = NaN is no finite number"),
    ],
)
def test_values_that_no_tissue_has_are_refused_with_their_cell(kind, row, says):
    good = list(viscera.Law.example(kind).parameters.values())
    values = np.array([good, good, row, row])
    with pytest.raises(ValueError, match="values of cell 2: ") as error:
        viscera.Tissue.from_values(kind, values)
    assert says in str(error.value)
    assert not viscera.Tissue.from_values(kind, values[:2]).is_uniform


def test_values_of_a_cell_are_those_that_were_given_and_cells_without_a_law_are_named():
    values = np.array([[4e3, 2e3], [5e3, 1e3]])
    tissue = viscera.Tissue.from_values("neo-hookean", values)
    assert [tissue.values(cell).tolist() for cell in (0, 1)] == values.tolist()
    with pytest.raises(IndexError, match="no law for cell 2: they are numbered 0 to 1"):
        tissue.values(2)
    uniform = viscera.Tissue.uniform(viscera.Law.example("neo-hookean"))
    assert uniform.values(10**6).tolist() == list(viscera.Law.example("neo-hookean").parameters.values())
    with pytest.raises(OverflowError):
        tissue.values(-1)


@pytest.mark.parametrize("kind", ["linear", "st-venant-kirchhoff", "neo-hookean", "stable-neo-hookean", "transverse-linear", FIBRED])
def test_values_of_a_law_that_was_made_are_taken_for_each_cell(kind):
    example = viscera.Law.example(kind)
    rows = np.tile(list(example.parameters.values()), (3, 1))
    tissue = viscera.Tissue.from_values(kind, rows)
    assert tissue.kind == kind and np.array_equal([tissue.values(cell) for cell in range(3)], rows)
