"""The comparison from end to end: meshes, equilibria, every peer, the tables."""

import argparse
import json
import subprocess
import tomllib

import results
from measure import Run, measure
from peers import ALL, CASE, ENVIRONMENTS, Crash, Driver, Late, Unavailable, command, viscera
from torture import broke, comes_back, long_step, places, score


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
    """Rows of the two tables for a peer, variant after variant."""
    try:
        start = command(name)
        driver = Driver(start)
        about = driver.ask("about")
    except (Unavailable, Crash, Late) as failure:
        yield [{"peer": name, "failure": f"not available: {failure}"}], []
        return
    yield list(results.announce(about, case["beam"]["meshes"])), []
    for variant in about["variants"]:
        names = {"peer": about["name"], "version": about["version"], "variant": variant["name"]}
        beams, tortures, rung, first = [], [], 0, None
        for number, cells in enumerate(case["beam"]["meshes"][:meshes]):
            mesh = write_mesh(cells)
            print(f"{about['name']} {variant['name']} {cells}", flush=True)
            found, rung = measure(Run(driver, case, variant, mesh), number, rung)
            first = rung if first is None else first
            row = names | {key: variant[key] for key in ("law", "scheme", "precision", "reference", "note")} | found
            row |= {"cubes": "×".join(map(str, cells)), "tetrahedra": 6 * cells[0] * cells[1] * cells[2]}
            beams.append(row)
            print("   ", found, flush=True)
            if found.get("ended"):
                driver.close()
                driver = Driver(start)
        if torture:
            step = case["step"]["longest"] / case["step"]["ratio"] ** first
            tortures = [names | row for row in run_torture(start, case, variant, step)]
        yield beams, tortures
    driver.close()


def run_torture(start, case, variant, step):
    """What a variant does in each trial."""
    mesh = write_mesh(case["torture"]["mesh"])

    def outcome(trial, *arguments):
        # A driver of its own, so that nothing is left from the trial before.
        driver = Driver(start)
        try:
            return score(trial, Run(driver, case, variant, mesh), *arguments)
        finally:
            driver.close()

    for what, positions in places(case, nodes_of(mesh)).items():
        found = outcome(comes_back, positions, step)
        if broke(found) and not variant.get("chooses_step"):
            shorter = outcome(comes_back, positions, step / case["torture"]["shorter"])
            found += f"; at steps {case['torture']['shorter']} times shorter: {shorter}"
        print(f"    {what}: {found}", flush=True)
        yield {"what": what, "outcome": found}
    found = outcome(long_step)
    print(f"    steps of 10 ms: {found}", flush=True)
    yield {"what": "steps of 10 ms", "outcome": found}


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
        for beams, tortures in run_peer(name, case, options.meshes, not options.no_torture):
            results.keep(beams, tortures, name)
    results.write(case, [equilibria(cells) for cells in case["beam"]["meshes"]])
