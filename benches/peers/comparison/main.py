"""The comparison from end to end: meshes, equilibria, every peer, the tables."""

import argparse
import json
import subprocess
import tomllib

import results
from measure import Run, measure
from peers import ALL, CASE, ENVIRONMENTS, Crash, Driver, Late, Unavailable, command, viscera
from torture import comes_back, long_step, places, score


def ours(task, cells):
    """What our program prints."""
    arguments = [str(viscera()), str(CASE), task, *map(str, cells)]
    return subprocess.run(arguments, check=True, capture_output=True, text=True).stdout


def write_mesh(cells):
    """The mesh as a file for all."""
    path = ENVIRONMENTS / f"beam-{'x'.join(map(str, cells))}.txt"
    if not path.exists():
        path.write_text(ours("mesh", cells))
    return str(path)


def equilibria(cells):
    """Displacement of the tip at rest [m], for each law and element; computed once."""
    path = ENVIRONMENTS / f"rest-{'x'.join(map(str, cells))}.json"
    if not path.exists():
        path.write_text(ours("reference", cells))
    return json.loads(path.read_text())


def nodes_of(mesh):
    with open(mesh) as file:
        count = int(file.readline().split()[0])
        return [list(map(float, file.readline().split())) for _ in range(count)]


def run_peer(name, case, meshes, torture):
    """Rows of the two tables for a peer."""
    beams, tortures = [], []
    try:
        start = command(name)
        driver = Driver(start)
        about = driver.ask("about")
    except (Unavailable, Crash, Late) as failure:
        return [{"peer": name, "failure": f"not available: {failure}"}], []
    for variant in about["variants"]:
        names = {"peer": about["name"], "version": about["version"], "variant": variant["name"]}
        rung, first = 0, None
        for number, cells in enumerate(case["beam"]["meshes"][:meshes]):
            mesh = write_mesh(cells)
            print(f"{about['name']} {variant['name']} {cells}", flush=True)
            found, rung = measure(Run(driver, case, variant, mesh), number, rung)
            if first is None:
                first = rung
            rest = equilibria(cells)[variant["reference"]]
            row = names | {key: variant[key] for key in ("law", "scheme", "precision", "note")} | found
            row |= {"cubes": "×".join(map(str, cells)), "tetrahedra": 6 * cells[0] * cells[1] * cells[2]}
            row["rest"] = None if "error" in rest else -rest[1]
            beams.append(row)
            print("   ", found, flush=True)
            if found.get("ended"):
                driver.close()
                driver = Driver(start)
        if torture:
            mesh = write_mesh(case["torture"]["mesh"])
            step = case["step"]["longest"] / case["step"]["ratio"] ** first
            trials = {
                what: lambda run, positions=positions: comes_back(run, positions, step)
                for what, positions in places(case, nodes_of(mesh)).items()
            }
            trials["steps of 10 ms"] = long_step
            for what, trial in trials.items():
                # A driver of its own, so that nothing is left from the trial before.
                driver.close()
                driver = Driver(start)
                outcome = score(lambda trial=trial: trial(Run(driver, case, variant, mesh)))
                tortures.append(names | {"what": what, "outcome": outcome})
                print(f"    {what}: {outcome}", flush=True)
    driver.close()
    return beams, tortures


def main(arguments):
    parser = argparse.ArgumentParser(prog="benches/peers/run", description="The beam, in other programs and in ours.")
    parser.add_argument("peers", nargs="*", metavar="peer", help=f"some of {', '.join(ALL)}; all of them by default")
    parser.add_argument("--meshes", type=int, default=None, help="how many of the meshes, the coarsest first")
    parser.add_argument("--no-torture", action="store_true", help="leave the torture out")
    options = parser.parse_args(arguments)
    if unknown := set(options.peers) - set(ALL):
        parser.error(f"no such peer: {', '.join(sorted(unknown))}; there are {', '.join(ALL)}")
    ENVIRONMENTS.mkdir(exist_ok=True)
    case = tomllib.loads(CASE.read_text())
    for name in options.peers or ALL:
        results.keep(*run_peer(name, case, options.meshes, not options.no_torture), name)
    results.write(case, [equilibria(cells) for cells in case["beam"]["meshes"]])
