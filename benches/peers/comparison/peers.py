"""Setting up the programs, each in an environment of its own, and starting their drivers."""

import json
import os
import select
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent.parent
ENVIRONMENTS = HERE / ".env"
CASE = HERE / "case.toml"

PYTHON = ["mujoco", "newton", "pybullet"]
RUST = ["rapier"]
ALL = ["viscera", *RUST, *PYTHON]

# The core that all of them run on.
CORE = max(os.sched_getaffinity(0))

# How long a driver may take for an answer that needs no simulation [s].
PATIENCE = 300.0


class Unavailable(Exception):
    """The program cannot be installed or started here; says why."""


class Crash(Exception):
    """The driver is gone; says how."""


class Late(Exception):
    """The driver did not answer in time."""


def run(command, **options):
    finished = subprocess.run(command, capture_output=True, text=True, **options)
    if finished.returncode:
        lines = finished.stderr.strip().splitlines() or ["no message"]
        raise Unavailable(f"{command[0]}: {lines[-1]}".replace(str(HERE), "benches/peers"))
    return finished.stdout


def cargo(manifest, package, binary):
    """Builds a driver in Rust, and says where it is."""
    target = ENVIRONMENTS / "target" / package
    if not shutil.which("cargo"):
        raise Unavailable("cargo is not installed")
    environment = {name: value for name, value in os.environ.items() if name not in ("CARGO_TARGET_DIR", "RUSTFLAGS")}
    command = ["cargo", "build", "--release", "--locked", "--manifest-path", str(manifest), "-p", package]
    run(command, env={**environment, "CARGO_TARGET_DIR": str(target)})
    return target / "release" / binary


def python(name):
    """Makes an environment of Python with the pinned packages, and says where its interpreter is."""
    environment = ENVIRONMENTS / name
    interpreter, wanted = environment / "bin" / "python", HERE / name / "requirements.txt"
    installed = environment / "installed.txt"
    if not installed.exists() or installed.read_text() != wanted.read_text():
        run([sys.executable, "-m", "venv", str(environment)])
        # Wheels only: a peer is compared as its makers built it.
        run([str(interpreter), "-m", "pip", "install", "--quiet", "--disable-pip-version-check",
             "--only-binary", ":all:", "--requirement", str(wanted)])  # fmt: skip
        installed.write_text(wanted.read_text())
    return interpreter


def viscera():
    """Our driver, which also knows the meshes and the equilibria."""
    return cargo(HERE / "viscera" / "Cargo.toml", "viscera-peers", "viscera-peers")


def command(name):
    """What starts a driver."""
    if name == "viscera":
        return [str(viscera()), str(CASE), "serve"]
    if name in RUST:
        package = f"viscera-peers-{name}"
        return [str(cargo(HERE / name / "Cargo.toml", package, package)), str(CASE)]
    return [str(python(name)), str(HERE / name / "drive.py"), str(CASE)]


class Driver:
    """A driver that runs, on one core."""

    def __init__(self, command):
        one = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS")}
        environment = {**os.environ, **one}
        environment["PYTHONPATH"] = str(HERE / "protocol")
        environment["WARP_CACHE_PATH"] = str(ENVIRONMENTS / "warp")
        pinned = ["taskset", "--cpu-list", str(CORE)] if shutil.which("taskset") else []
        self.process = subprocess.Popen(
            [*pinned, *command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=ENVIRONMENTS,  # where programs leave their logs
            env=environment,
        )

    def ask(self, do, patience=PATIENCE, **what):
        """Its answer to a command, with `error` in it if it refuses."""
        try:
            self.process.stdin.write((json.dumps({"do": do, **what}) + "\n").encode())
            self.process.stdin.flush()
        except BrokenPipeError:
            raise Crash(self.how_it_ended()) from None
        line = b""
        while not line.endswith(b"\n"):
            ready, _, _ = select.select([self.process.stdout], [], [], patience)
            if not ready:
                raise Late(f"no answer in {patience:.0f} s")
            part = os.read(self.process.stdout.fileno(), 1 << 20)
            if not part:
                raise Crash(self.how_it_ended())
            line += part
        return json.loads(line)

    def how_it_ended(self):
        code = self.process.wait()
        return f"signal {-code}" if code < 0 else f"exit {code}"

    def close(self):
        self.process.kill()
        self.process.wait()
