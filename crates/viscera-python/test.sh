#!/usr/bin/env bash
# Builds the wheel, installs it into a clean environment and runs the tests there: against the wheel, not against the source tree.
# Builds in the dev profile into the workspace's target folder, so that what other commands compiled serves here as well. Arguments go to
# pytest. PYTHON names an interpreter; WHEEL a wheel that is there already.
set -euo pipefail
cd "$(dirname "$0")"
root=$(cd ../.. && pwd)
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$root/target}"
python="${PYTHON:-python3}"

missing() {
    printf '%s\n' "$@" >&2
    exit 1
}

command -v "$python" >/dev/null && "$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' ||
    missing "Python 3.10 or newer is needed; \`$python\` is $("$python" --version 2>&1 || true)." "Name another in PYTHON."

# Debian has what makes environments in a package of its own.
has_venv() { "$python" -c 'import ensurepip, venv' 2>/dev/null; }
if ! has_venv && command -v apt-get >/dev/null; then
    as_root=()
    [ "$(id -u)" = 0 ] || as_root=(sudo)
    version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    "${as_root[@]}" apt-get update -qq || true
    DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "python$version-venv" || true
fi
has_venv || missing "\`$python -m venv\` makes no environments: its modules \`venv\` and \`ensurepip\` are needed." \
    "On Debian they are the package python3-venv."

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
install() { "$work/$1/bin/pip" install --quiet --disable-pip-version-check "${@:2}"; }

# For one package cargo switches on the features that it needs; the tests of the workspace need more, of crates under the engine, which would
# be compiled once more. So maturin is handed a cargo that builds the workspace, with one of its tests, but for what is long to compile and
# changes no features.
cat >"$work/cargo" <<'SHIM'
#!/usr/bin/env bash
[ "$1" = rustc ] || exec cargo "$@"
exec cargo build --locked --workspace --exclude viscera-validation --exclude viscera-peers --exclude viscera-peers-protocol \
    --lib --bin viscera --test house --message-format json-render-diagnostics
SHIM
chmod +x "$work/cargo"

"$python" -m venv "$work/tools"
install tools "maturin==1.16.0"
CARGO="$work/cargo" "$work/tools/bin/maturin" build --profile dev --locked --out "$work/wheels"

"$python" -m venv "$work/clean"
install clean "$work"/wheels/viscera-*.whl
# From another folder, so that `import viscera` can only find what is installed.
cp -r tests examples requirements-test.txt "$work/"
cd "$work"
"$work/clean/bin/python" tests/only_numpy.py
install clean -r requirements-test.txt
# The measured beads of the truth cube are published without a licence, and are used where they lie beside the checkout.
beads="${VISCERA_TRUTH_CUBE:-$root/../shared/references/truthcube/bead-positions.csv}"
if [ -f "$beads" ]; then
    export VISCERA_TRUTH_CUBE="$beads"
else
    unset VISCERA_TRUTH_CUBE
    printf 'the measured beads are not at %s: the tests with them are left out\n' "$beads" >&2
fi
VISCERA_PROGRAM="$CARGO_TARGET_DIR/debug/viscera" VISCERA_SCENES="$root/scenes" \
    VISCERA_REFERENCES="$root/crates/viscera/tests/data/references" \
    "$work/clean/bin/python" -m pytest -q -p no:cacheprovider tests "$@"
