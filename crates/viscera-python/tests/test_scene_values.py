"""Values of Python's and numpy's in scenes and sweeps: each arrives as what it is, and what is wrong is said at once."""

from pathlib import Path

import numpy as np
import pytest

import viscera
from test_engine import SCENE

STEPS = [(0.0, [0.1, 0.05, 0.2]), (0.03, [0.1, 0.02, 0.2])]


@pytest.mark.parametrize(
    ("key", "value", "wanted"),
    [
        ("body.bar.law.young", np.float64(2000.0), 2000.0),
        ("body.bar.law.young", np.float32(2000.0), 2000.0),
        ("body.bar.law.young", np.array(2000.0), 2000.0),
        ("body.bar.law.young", "2 kPa", 2000.0),
        ("body.bar.law.young", np.str_("2 kPa"), 2000.0),
        ("body.bar.damping", np.int64(3), 3.0),
        ("body.bar.damping", 1e-7, 1e-7),
        ("body.bar.damping", 1e16, 1e16),
        ("gravity", (0, -1, 0), [0.0, -1.0, 0.0]),
        ("gravity", np.array([0.0, -1.5, 0.0]), [0.0, -1.5, 0.0]),
        ("gravity", (np.float64(0.5), np.int32(-1), "2 m/s^2"), [0.5, -1.0, 2.0]),
        ("body.bar.mesh.size", ["10 cm", 0.1, np.float64(0.3)], [0.1, 0.1, 0.3]),
        ("body.bar.mesh.cells", np.array([1, 2, 3], dtype=np.uint8), [1, 2, 3]),
        ("body.bar.mesh.cells", range(1, 4), [1, 2, 3]),
    ],
)
def test_a_value_that_is_set_is_the_value_that_the_scene_has(key, value, wanted):
    scene = viscera.Scene.parse(SCENE)
    scene.set(key, value)
    found = scene.check()
    for part in key.split("."):
        found = found[part]
    assert found == wanted


def test_tables_paths_and_texts_in_lists_are_set_as_they_would_be_written(tmp_path):
    scene = viscera.Scene.parse(SCENE)
    scene.set("body.bar.law", {"kind": "st-venant-kirchhoff", "young": np.float64(3e3), "poisson": 0.3})
    scene.set("body.bar.model", {"kind": "tensor-mass", "adaptive": 1e-3})
    scene.set("instrument", {"rod": {"kind": "probe", "path": [[time, np.array(place)] for time, place in STEPS]}})
    found = scene.check()
    assert found["body"]["bar"]["law"] == {"kind": "st-venant-kirchhoff", "young": 3000.0, "poisson": 0.3}
    assert found["body"]["bar"]["model"]["adaptive"] == 1e-3
    assert [[time, place] for time, place in found["instrument"]["rod"]["path"]] == [[time, place] for time, place in STEPS]
    mesh = viscera.TetMesh.box_grid([1, 1, 2], [0.1, 0.1, 0.3])
    path = tmp_path / 'a "bar" of liver.msh'
    mesh.write(path)
    for given in (path, str(path)):
        scene.set("body.bar.mesh", {"file": given})
        assert scene.check()["body"]["bar"]["mesh"]["file"] == str(path)
    world, _, _ = scene.build()
    assert len(world.body("bar").mesh) == len(mesh)


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        ("gravity", [True, False, np.True_], "expected an acceleration, found `true`"),
        ("body.bar.density", True, "found `true`"),
        ("body.bar.density", np.False_, "found `false`"),
        ("body.bar.law.young", float("nan"), "young"),
        ("body.bar.law.young", np.array([1.0, 2.0]), "young"),
    ],
)
def test_a_value_of_a_wrong_kind_is_refused_as_what_it_is(key, value, says):
    scene = viscera.Scene.parse(SCENE)
    scene.set(key, value)
    with pytest.raises(viscera.SceneError) as error:
        scene.check()
    assert says in str(error.value) and "np." not in str(error.value)


@pytest.mark.parametrize(("value", "says"), [(object(), "no words for"), ({3: 1.0}, "is no text"), ({1.0, 2.0}, "of type set")])
def test_what_a_scene_has_no_words_for_is_a_type_error(value, says):
    with pytest.raises(TypeError, match=says):
        viscera.Scene.parse(SCENE).set("gravity", value)
    with pytest.raises(ValueError, match="None is no value of a scene"):
        viscera.Scene.parse(SCENE).set("gravity", None)


def sag(world):
    return {"sag": world.body("bar").max_displacement}


def test_a_sweep_over_arrays_and_tuples_has_the_rows_of_one_over_lists(tmp_path):
    scene = viscera.Scene.parse(SCENE)
    lists = {"body.bar.law.young": [3000.0, 4500.0, 6000.0], "gravity": [[0, -1, 0], [0, -2, 0]]}
    arrays = {"body.bar.law.young": np.linspace(3e3, 6e3, 3), "gravity": ((0, -1, 0), np.array([0, -2, 0]))}
    wanted, found = (viscera.sweep(scene, values, measure=sag, threads=2) for values in (lists, arrays))
    assert found.rows == wanted.rows and found["error"] == [None] * 6
    assert {type(value) for value in found["body.bar.law.young"]} == {float}
    singles = viscera.sweep(scene, [{"body.bar.law.young": value} for value in np.geomspace(3e3, 6e3, 2)], measure=sag)
    assert singles["error"] == [None, None] and singles["sag"][0] != singles["sag"][1]
    found.to_csv(tmp_path / "table.csv")
    assert "np." not in (tmp_path / "table.csv").read_text()


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({"body.bar.law.yung": [2e3, 3e3]}, "unknown key `yung`"),
        ({"body.bar.law.young": ["2 kPascal", "3 kPascal"]}, "young"),
        ({"body.bar.density": np.linspace(-2.0, -1.0, 2)}, "must be above 0"),
    ],
)
def test_a_key_or_value_that_is_wrong_from_the_first_case_on_raises_at_once(values, says):
    measured = []
    with pytest.raises(viscera.SceneError) as error:
        viscera.sweep(viscera.Scene.parse(SCENE), values, measure=lambda world: measured.append(world) or {})
    assert says in str(error.value) and not measured


@pytest.mark.parametrize("values", [{"body.bar.law.young": "2 kPa"}, {"body.bar.law.young": 2e3}])
def test_one_value_that_is_not_in_a_list_is_refused_and_not_taken_to_pieces(values):
    with pytest.raises(TypeError, match="give them as a list"):
        viscera.sweep(viscera.Scene.parse(SCENE), values)


def test_a_measurement_that_fails_for_one_case_of_many_leaves_the_table_whole():
    numbers = iter(range(3))

    def measure(world):
        if next(numbers) == 1:
            raise KeyError("lung")
        return sag(world)

    table = viscera.sweep(viscera.Scene.parse(SCENE), {"body.bar.law.young": [3e3, 4e3, 5e3]}, measure=measure, threads=1)
    assert table["error"] == [None, "measure raised KeyError: 'lung'", None]
    assert table["time"] == pytest.approx([0.06] * 3) and table["sag"][1] is None
    assert table["sag"][0] > table["sag"][2] > 0


def test_a_scene_file_is_taken_by_its_path(tmp_path):
    path = Path(tmp_path / "bar.toml")
    path.write_text(SCENE)
    assert viscera.sweep(path, {"gravity": [(0, -1, 0)]}, measure=sag)["error"] == [None]
