"""Sweeps: the same table from threads, from a cluster, from a cluster that loses a worker, and from the command line."""

import contextlib
import csv
import os
import subprocess
import threading
import time

import distributed
import pandas
import pyarrow
from pyarrow import parquet

import viscera
from test_engine import SCENE

VALUES = {"body.bar.law.young": ["3 kPa", "6 kPa", "12 kPa"], "gravity": [[0, -1, 0], [0, -2, 0]]}


def sag(world):
    return {"sag": world.body("bar").max_displacement}


def test_a_sweep_has_a_row_for_each_case_in_their_order():
    table = viscera.sweep(viscera.Scene.parse(SCENE), VALUES, threads=2)
    assert table["body.bar.law.young"] == ["3 kPa"] * 2 + ["6 kPa"] * 2 + ["12 kPa"] * 2
    assert table["error"] == [None] * 6
    # After 60 ms it still falls: twice the weight, twice the way, whatever the stiffness.
    light, heavy = table["bar: max displacement [m]"][:2]
    assert 1.9 < heavy / light < 2.1
    alone = viscera.Scene.parse(SCENE)
    alone.set("body.bar.law.young", "6 kPa")
    alone.set("gravity", [0, -2, 0])
    world, steps, _ = alone.build()
    world.steps(steps)
    assert table["bar: max displacement [m]"][3] == world.body("bar").max_displacement


def test_a_case_that_is_refused_says_why_in_its_row_and_the_others_run():
    table = viscera.sweep(viscera.Scene.parse(SCENE), [{"body.bar.law.poisson": 0.3}, {"body.bar.law.poisson": 0.6}], measure=sag)
    assert table["error"][0] is None and "poisson" in table["error"][1]
    assert table["sag"][0] > 0 and table["sag"][1] is None


def test_a_table_becomes_pandas_arrow_parquet_and_csv(tmp_path):
    table = viscera.sweep(viscera.Scene.parse(SCENE), {"body.bar.law.poisson": [0.3, 0.4]}, measure=sag)
    frame = table.to_pandas()
    assert list(frame.columns) == ["body.bar.law.poisson", "time", "error", "sag"] and frame["sag"].tolist() == table["sag"]
    table.to_parquet(tmp_path / "t.parquet")
    assert pandas.read_parquet(tmp_path / "t.parquet")["sag"].tolist() == table["sag"]
    table.to_csv(tmp_path / "t.csv")
    assert len((tmp_path / "t.csv").read_text().splitlines()) == 3


def test_columns_have_the_types_of_what_is_in_them_also_where_a_case_was_refused(tmp_path):
    changes = [
        {"body.bar.law.poisson": 0.3, "gravity": [0, -1, 0], "precision": "single"},
        {"body.bar.law.poisson": 0.6, "gravity": [0, -2, 0], "precision": "double"},
    ]

    def measure(world):
        return sag(world) | {"cells": world.body("bar").cell_count, "rests": world.body("bar").observe().at_rest}

    whole, part = (viscera.sweep(viscera.Scene.parse(SCENE), cases, measure=measure) for cases in (changes[:1], changes))
    types = {
        "body.bar.law.poisson": pyarrow.float64(),
        "gravity": pyarrow.list_(pyarrow.int64()),
        "precision": pyarrow.string(),
        "time": pyarrow.float64(),
        "error": pyarrow.string(),
        "sag": pyarrow.float64(),
        "cells": pyarrow.int64(),
        "rests": pyarrow.bool_(),
    }
    for table in (whole, part):
        schema = table.to_arrow().schema
        assert dict(zip(schema.names, schema.types)) == types
    part.to_parquet(tmp_path / "t.parquet")
    back = parquet.read_table(tmp_path / "t.parquet")
    assert back.schema.equals(part.to_arrow().schema) and back.to_pylist() == part.to_arrow().to_pylist()
    assert back["sag"].null_count == back["time"].null_count == 1 and "poisson" in back["error"][1].as_py()
    frame = part.to_pandas()
    assert frame["sag"].dtype == float and frame["sag"].isna().tolist() == [False, True]


def count(path):
    """Measures slowly, and takes down that it did."""

    def measure(world):
        time.sleep(0.3)
        with open(path, "a") as file:
            file.write(f"{os.getpid()}\n")
        return sag(world)

    return measure


def test_a_cluster_that_loses_a_worker_gives_the_table_of_the_threads(tmp_path):
    """One of two worker processes is killed with SIGKILL in the middle: its cases run again, and no row is lost or doubled."""
    scene, values = viscera.Scene.parse(SCENE), {"body.bar.law.young": [1000.0 * (3 + k) for k in range(10)]}
    wanted = viscera.sweep(scene, values, measure=sag)
    runs = tmp_path / "runs"
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None)
    client = distributed.Client(cluster)

    def kill_one():
        while not (runs.exists() and len(runs.read_text().splitlines()) >= 2):
            time.sleep(0.02)
        os.kill(int(runs.read_text().splitlines()[0]), 9)

    killer = threading.Thread(target=kill_one)
    killer.start()
    try:
        table = viscera.sweep(scene, values, client=client, measure=count(str(runs)))
        killer.join()
        client.wait_for_workers(2, timeout=60)
    finally:
        client.close()
        # A busy machine ends processes more slowly than distributed waits for them.
        with contextlib.suppress(TimeoutError):
            cluster.close(timeout=60)
    assert table.rows == wanted.rows


def test_the_command_line_gives_the_same_rows(tmp_path):
    (tmp_path / "bar.toml").write_text(SCENE)
    command = [os.environ["VISCERA_PROGRAM"], "sweep", "bar.toml", "--vary", "body.bar.law.young=3 kPa,6 kPa,12 kPa"]
    command += ["--vary", "gravity=[0, -1, 0],[0, -2, 0]", "--out", "table.csv", "--threads", "2", "--quiet"]
    subprocess.run(command, cwd=tmp_path, check=True)
    with open(tmp_path / "table.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    table = viscera.sweep(tmp_path / "bar.toml", VALUES)
    assert [row["body.bar.law.young"] for row in rows] == table["body.bar.law.young"]
    for column in table.columns[4:]:
        assert [float(row[column]) for row in rows] == table[column], column
