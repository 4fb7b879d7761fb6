"""The tables: kept as CSV, so that some peers can be run again alone, and written for people."""

import csv
import math
import platform
import subprocess
from datetime import date
from pathlib import Path

from peers import ALL, HERE

RESULTS = HERE / "results"

# What the programs call themselves, by the names of their folders.
CALLED = {"rapier": "rapier3d"}

# What the converged rest is taken from.
FINEST = "nodally-integrated"

BEAMS = [
    "peer", "version", "variant", "law", "scheme", "precision", "note", "cubes", "tetrahedra", "step", "each", "speed",
    "tip", "reference", "rest", "moves", "simulated", "load", "failure",
]  # fmt: skip
TORTURES = ["peer", "version", "variant", "what", "outcome"]


def read(path):
    if not path.exists():
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def place(row):
    """Where a row stands in a table."""
    order = [CALLED.get(peer, peer) for peer in ALL]
    return order.index(CALLED.get(row["peer"], row["peer"])), row.get("variant") or "", int(row.get("tetrahedra") or 0)


def save(path, columns, rows):
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, columns, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def keep(beams, tortures, name):
    """Puts rows of a peer in the place of those that it had. Variants, meshes and trials that were left out keep theirs."""
    RESULTS.mkdir(exist_ok=True)
    for path, columns, rows in [(RESULTS / "beam.csv", BEAMS, beams), (RESULTS / "torture.csv", TORTURES, tortures)]:

        def key(row):
            return row["peer"], row.get("variant") or "", row.get("cubes") or row.get("what") or ""

        fresh = {key(row): row for row in rows}
        gone = bool(rows) and "variant" not in rows[0]
        old = [row for row in read(path) if key(row) not in fresh]
        if rows:
            # What failed to start has one row without a variant, and what starts has none such.
            called = {CALLED.get(name, name), name}
            old = [row for row in old if row["peer"] not in called or (bool(row.get("variant")) and not gone)]
        everything = old + list(rows)
        everything.sort(key=place)
        save(path, columns, everything)


def machine():
    """The processor, by its name."""
    try:
        text = subprocess.run(["lscpu"], capture_output=True, text=True, check=True, env={"LC_ALL": "C"}).stdout
        facts = dict(line.split(":", 1) for line in text.splitlines() if ":" in line)
        name, cores = facts["Model name"].strip(), facts["CPU(s)"].strip()
        sets = [isa for isa in ("avx2", "avx512f") if isa in facts.get("Flags", "").split()]
        family = f"family {facts['CPU family'].strip()}, model {facts['Model'].strip()}"
        return f"{name} ({family}), {cores} cores, {', '.join(sets) or platform.machine()}"
    except (OSError, subprocess.CalledProcessError, KeyError):
        return platform.processor() or platform.machine()


def number(text):
    return float(text) if text not in ("", None) else None


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def beam_row(row, converged, quiet):
    names = [row["peer"], row["variant"] or "–"]
    if row["failure"]:
        return [*names, row["cubes"] or "–", row["failure"].replace("|", "/"), *["–"] * 8]
    step, each, tip, rest = (number(row[key]) for key in ("step", "each", "tip", "rest"))
    moves = number(row["moves"])
    if math.isnan(tip):
        tip = rest = None
    error = "–" if rest is None else f"{100 * (tip / rest - 1):+.1f} %"
    if tip is not None and moves > quiet:
        after = f" after {number(row['simulated']):.1f} s"
        error += f" (moves{after})" if math.isinf(moves) else f" (moves {100 * moves:.1f} %{after})"
    return [
        *names,
        row["cubes"],
        row["scheme"],
        row["precision"],
        f"{1e3 * step:.3g}",
        f"{1e3 * each:.3g}",
        f"{1e9 * each / int(row['tetrahedra']):.0f}",
        f"{number(row['speed']):.3g}",
        f"{1e3 * tip:.1f}" if tip else "–",
        error,
        f"{100 * (tip / converged - 1):+.0f} %" if tip and converged else "–",
    ]


def announce(about, meshes):
    """Rows for all that a peer can run and was not run on yet, so that nothing is left out unseen."""
    known = {(row["peer"], row["variant"], row["cubes"]) for row in read(RESULTS / "beam.csv")}
    for variant in about["variants"]:
        for cells in meshes:
            cubes = "×".join(map(str, cells))
            if (about["name"], variant["name"], cubes) not in known:
                yield {
                    "peer": about["name"], "version": about["version"], "variant": variant["name"], "cubes": cubes,
                    "tetrahedra": 6 * math.prod(cells), "failure": "not run",
                }  # fmt: skip


def write(case, equilibria):
    """The page, from the tables as they are kept."""
    beams, tortures = read(RESULTS / "beam.csv"), read(RESULTS / "torture.csv")
    names = ["×".join(map(str, cells)) for cells in case["beam"]["meshes"]]
    for row in beams:
        if row["reference"]:
            rest = equilibria[names.index(row["cubes"])][row["reference"]]
            row["rest"] = -rest[1] if isinstance(rest, list) else ""
    save(RESULTS / "beam.csv", BEAMS, beams)
    absent = [CALLED.get(peer, peer) for peer in ALL if not {peer, CALLED.get(peer)} & {row["peer"] for row in beams}]
    shown = sorted(beams + [dict.fromkeys(BEAMS, "") | {"peer": peer, "failure": "not run"} for peer in absent], key=place)
    known = [(name, -mesh[FINEST][1]) for name, mesh in zip(names, equilibria) if isinstance(mesh[FINEST], list)]
    finest, converged = known[-1] if known else ("–", None)
    head = [
        "program", "variant", "cubes", "scheme", "", "step [ms]", "time per step [ms]", "ns per tetrahedron",
        "simulated s per s", "tip [mm]", "against our rest, same law and mesh", "against the converged rest",
    ]  # fmt: skip
    versions = sorted({(row["peer"], row["version"]) for row in beams if row["version"]})
    loads = [number(row["load"]) for row in beams if row["load"]]
    notes = sorted({(row["peer"], row["note"]) for row in beams if row["note"]})
    variants, trials = [], []
    for row in tortures:
        for value, seen in [((row["peer"], row["variant"]), variants), (row["what"], trials)]:
            if value not in seen:
                seen.append(value)
    outcomes = {(row["peer"], row["variant"], row["what"]): row["outcome"] for row in tortures}
    rests = [[law, *(f"{-1e3 * mesh[law][1]:.2f}" if isinstance(mesh[law], list) else "–" for mesh in equilibria)]
             for law in equilibria[0]]  # fmt: skip
    parts = [
        "# The beam, side by side",
        f"Written by `benches/peers/run` on {date.today():%d %B %Y}; one core of: {machine()}. What the columns mean, and how "
        "steps and rests were found: [README](../README.md). Numbers: [beam.csv](beam.csv), [torture.csv](torture.csv).",
        "Versions: " + ", ".join(f"{peer} {version}" for peer, version in versions) + ".",
        table(head, [beam_row(row, converged, case["settle"]["quiet"]) for row in shown]),
        "\n".join(f"* {peer}: {note}." for peer, note in notes),
    ]
    if loads:
        parts.append(
            f"Load of the machine while time was taken: {min(loads):.1f} to {max(loads):.1f} processes that want a core. Times "
            "are those on the processor, the best of several windows."
        )
    parts += [
        "## Our equilibria",
        f"Deflection of the tip at rest [mm], in double precision. The converged rest is that of {FINEST} on {finest}.",
        table(["law and element", *names], rests),
        "## Torture",
        f"The beam of {'×'.join(map(str, case['torture']['mesh']))} cubes at its longest step that holds, without gravity, damped.",
        table(
            ["program", "variant", *trials],
            [[*who, *(outcomes.get((*who, what), "–").replace("|", "/") for what in trials)] for who in variants],
        ),
    ]
    (RESULTS / "README.md").write_text("\n\n".join(part for part in parts if part) + "\n")
