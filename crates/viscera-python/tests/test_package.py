"""What a user of the package meets before any physics: extras, types, docstrings."""

import importlib.metadata
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import viscera
import viscera.gym
import viscera.identify
from viscera import _viscera

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def run(*arguments):
    done = subprocess.run([sys.executable, "-m", *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_numpy_is_the_only_requirement_and_the_rest_are_extras():
    wanted = importlib.metadata.requires("viscera")
    assert [line for line in wanted if "extra ==" not in line] == ["numpy>=1.24"]
    extras = {line.split("extra ==")[1].strip(" '\"") for line in wanted if "extra ==" in line}
    assert extras == {"gym", "dask", "plot", "mesh", "sparse"} == set(importlib.metadata.metadata("viscera").get_all("Provides-Extra"))


def test_one_wheel_serves_every_python_from_the_one_that_it_asks_for_on():
    """The stable interface of 3.10, in the wheel's tag and in the name of what was compiled."""
    distribution = importlib.metadata.distribution("viscera")
    tags = [line.removeprefix("Tag: ") for line in distribution.read_text("WHEEL").splitlines() if line.startswith("Tag: ")]
    assert tags and all(tag.startswith("cp310-abi3-") for tag in tags)
    assert distribution.metadata["Requires-Python"] == ">=3.10"
    assert Path(_viscera.__file__).name.split(".")[1] == "abi3"


def test_the_stub_says_what_the_compiled_module_is(tmp_path):
    """mypy's stubtest: every name, argument, default and special method; but for `__all__`, which the compiled module makes by itself."""
    allowed = tmp_path / "allowed"
    allowed.write_text("viscera._viscera.__all__\n")
    run("mypy.stubtest", "viscera._viscera", "--concise", "--ignore-disjoint-bases", "--allowlist", str(allowed))


def test_package_and_examples_pass_mypy():
    run("mypy", "-p", "viscera", "--ignore-missing-imports", "--check-untyped-defs")
    run("mypy", *map(str, sorted(EXAMPLES.glob("*.py"))), "--ignore-missing-imports", "--check-untyped-defs")


def public(module):
    """Everything public of a module, with what classes have."""
    for name in module.__all__ if hasattr(module, "__all__") else [name for name in vars(module) if not name.startswith("_")]:
        found = getattr(module, name)
        if inspect.ismodule(found) or not (inspect.isclass(found) or callable(found)):
            continue
        if not (getattr(found, "__module__", "") or "").startswith("viscera"):
            continue
        yield f"{module.__name__}.{name}", found
        if inspect.isclass(found):
            for member, value in vars(found).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, property | staticmethod) or inspect.isdatadescriptor(value)):
                    yield f"{module.__name__}.{name}.{member}", value


@pytest.mark.parametrize("module", [viscera, viscera.identify, viscera.gym], ids=lambda module: module.__name__)
def test_everything_public_has_a_docstring(module):
    without = [name for name, found in public(module) if not inspect.getdoc(found)]
    assert not without


def test_arrays_have_shapes_and_quantities_units_in_their_docstrings():
    """What gives or takes an array of the state says its shape; what is a force, a place or an energy its unit."""
    units = {"positions": "[m]", "velocities": "[m/s]", "forces": "[N]", "stress": "[Pa]", "energy": "[J", "masses": "[kg]", "gravity": "[m/s²]"}
    missing = []
    for name, found in public(viscera):
        doc, last = inspect.getdoc(found) or "", name.rsplit(".", 1)[-1]
        for word, unit in units.items():
            if last.split("_")[-1] == word and inspect.isgetsetdescriptor(found) and unit not in doc:
                missing.append((name, unit))
        stub = found.__doc__ or ""
        if last.endswith(("positions", "velocities", "_forces", "_strain", "_stress", "_ratio", "_gradient")) and "shape (" not in stub:
            missing.append((name, "shape"))
    assert not missing
    assert _viscera.World.__doc__
