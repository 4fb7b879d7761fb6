"""A scene with many values of its parameters, on the threads of this machine or on a cluster of Dask's."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ._viscera import Error, Scene, World


@dataclass(frozen=True)
class Table:
    """Results of a sweep, a row for each case in the order of the cases, whatever order they were computed in."""

    rows: list[dict[str, Any]]

    @property
    def columns(self) -> list[str]:
        """Names of the columns: of the parameters, then of what was measured."""
        return list(dict.fromkeys(name for row in self.rows for name in row))

    def __len__(self) -> int:
        """How many cases there are."""
        return len(self.rows)

    def __getitem__(self, column: str) -> list:
        """What stands in a column, None in rows that do not have it."""
        return [row.get(column) for row in self.rows]

    def to_pandas(self):
        """The table as a `pandas.DataFrame`."""
        import pandas

        return pandas.DataFrame(self.rows, columns=self.columns)

    def to_arrow(self):
        """The table as a `pyarrow.Table`: `time` as float64 and `error` as string whatever is in them, the others by what is in them."""
        import pyarrow

        kinds = {"time": pyarrow.float64(), "error": pyarrow.string()}
        return pyarrow.table({column: pyarrow.array(self[column], kinds.get(column)) for column in self.columns})

    def to_parquet(self, path) -> None:
        """Writes the table as a Parquet file."""
        import pyarrow.parquet

        pyarrow.parquet.write_table(self.to_arrow(), path)

    def to_csv(self, path) -> None:
        """Writes the table as CSV."""
        import csv

        with open(path, "w", newline="") as file:
            writer = csv.DictWriter(file, self.columns)
            writer.writeheader()
            writer.writerows(self.rows)


@dataclass(frozen=True)
class _Case:
    """One run: a scene, and what is changed in it. It goes to workers as it is."""

    text: str
    folder: Path
    changes: tuple[tuple[str, Any], ...]
    measure: Callable[[World], Mapping[str, Any]] | None


def cases(parameters: Mapping[str, Iterable] | Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """All combinations of values by dotted key, the last key's changing fastest; or the cases themselves, if they are given.

    Values of numpy's become Python's, and tuples lists: what stands in the table is what every format of it knows.
    """
    if not isinstance(parameters, Mapping):
        return [{key: _plain(value) for key, value in case.items()} for case in parameters]
    values = []
    for key, given in parameters.items():
        if isinstance(given, str) or not isinstance(given, Iterable):
            raise TypeError(f"the values of `{key}` are {given!r}: give them as a list, also where there is one")
        values.append([_plain(value) for value in given])
    return [dict(zip(parameters, combination)) for combination in itertools.product(*values)]


def _plain(value: Any) -> Any:
    """The value without numpy's types and without tuples."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return value


def _changed(case: _Case) -> Scene:
    """The scene with the changes of the case, its keys, types, units and ranges checked."""
    scene = Scene.parse(case.text, case.folder)
    for key, value in case.changes:
        scene.set(key, value)
    scene.check()
    return scene


def _run(case: _Case) -> dict[str, Any]:
    """Runs a case to its end; what the engine refuses, and what `measure` raises, stands in the row's `error`."""
    row: dict[str, Any] = dict(case.changes) | {"time": None, "error": None}
    try:
        world, steps, _ = _changed(case).build()
        world.steps(steps)
    except (Error, TypeError, ValueError, OSError) as error:
        return row | {"error": str(error)}
    row["time"] = world.time
    try:
        return row | dict((case.measure or observables)(world))
    except Exception as error:
        return row | {"error": f"measure raised {type(error).__name__}: {error}"}


def observables(world: World) -> dict[str, Any]:
    """What a sweep measures by default: numbers of every body and instrument at the end, by name."""
    row: dict[str, Any] = {}
    for name, body in world.bodies.items():
        seen = body.observe()
        row |= {
            f"{name}: kinetic energy [J]": seen.kinetic_energy,
            f"{name}: elastic energy [J]": seen.elastic_energy,
            f"{name}: volume variation [1]": seen.volume_variation,
            f"{name}: max displacement [m]": seen.max_displacement,
            f"{name}: reaction x [N]": seen.reaction[0],
            f"{name}: reaction y [N]": seen.reaction[1],
            f"{name}: reaction z [N]": seen.reaction[2],
            f"{name}: removed cells [1]": seen.removed_cells,
            f"{name}: inverted cells [1]": seen.inverted_cells,
        }
    for name, tool in world.instruments.items():
        row |= {f"{name}: force {axis} [N]": value for axis, value in zip("xyz", tool.observe().force)}
    return row


def sweep(
    scene: Scene | str | os.PathLike,
    parameters: Mapping[str, Iterable] | Sequence[Mapping[str, Any]],
    *,
    client=None,
    threads: int | None = None,
    measure: Callable[[World], Mapping[str, Any]] | None = None,
    retries: int = 5,
) -> Table:
    """Runs a scene to its end for every case and gives a table, one row for each.

    ``scene``: a `Scene`, or the path of a scene file. ``parameters``: values by dotted key, such as
    ``{"body.liver.law.young": ["2 kPa", "4 kPa"]}``, in all combinations; or a list of cases, each a dict. Values are what `Scene.set` takes:
    texts with units, numbers [SI], lists, dicts, ``numpy.linspace(...)``. ``measure`` makes of the world at the end what stands in the row;
    by default `observables`. Columns are the parameters, `time` [s] and `error` (the engine's text where it refused a case, or what
    ``measure`` raised, else None), and what was measured. A first case that the scene refuses raises at once: a key that is wrong is
    wrong in all of them.

    With ``client``, a `dask.distributed.Client`, cases run on its workers, which must see the files that the scene names. A case whose
    worker dies runs again on another, up to ``retries`` times; its row stands in the table once. Without it they run on
    ``threads`` of this machine, by default one for each core. The rows are the same either way.
    """
    if not isinstance(scene, Scene):
        scene = Scene.load(Path(scene))
    text, folder = scene.to_toml(), scene.folder
    todo = [_Case(text, folder, tuple(case.items()), measure) for case in cases(parameters)]
    if todo:
        _changed(todo[0])
    if client is None:
        with ThreadPoolExecutor(threads or os.cpu_count()) as pool:
            return Table(list(pool.map(_run, todo)))
    return Table(_on_cluster(client, todo, retries))


def _on_cluster(client, todo: list[_Case], retries: int) -> list[dict[str, Any]]:
    """Rows in the order of the cases. Futures are keyed by the case's number: a case that ran twice still has one row."""
    from distributed import KilledWorker, wait

    rows: dict[int, dict[str, Any]] = {}
    waiting, attempts = dict(enumerate(todo)), 0
    while waiting:
        futures = {number: client.submit(_run, case, pure=False, retries=retries) for number, case in waiting.items()}
        wait(list(futures.values()))
        killed = None
        for number, future in futures.items():
            try:
                rows[number] = future.result()
                del waiting[number]
            except KilledWorker as error:
                killed = error
        # The scheduler gives a case up after so many workers died with it, guilty or not; here it gets as many tries as were asked for.
        attempts += 1
        if killed is not None and attempts > retries:
            raise killed
    return [rows[number] for number in range(len(todo))]
