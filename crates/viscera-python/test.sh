#!/usr/bin/env bash
# Builds the wheel, installs it into a clean environment and runs the tests there: against the wheel, not against the source tree.
# Builds in the dev profile into the workspace's target folder, so that what other commands compiled serves here as well.
set -euo pipefail
cd "$(dirname "$0")"
root=$(cd ../.. && pwd)
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$root/target}"
export CARGO_INCREMENTAL=0
python="${PYTHON:-python3}"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$python" -m venv "$work/tools"
"$work/tools/bin/pip" install --quiet --disable-pip-version-check "maturin==1.16.0"
# The whole workspace is selected so that features, and with them the engine that the other tests compiled, stay the same.
(cd "$root" && cargo build --locked --workspace --bin viscera)
"$work/tools/bin/maturin" build --profile dev --locked --out "$work/wheels"

"$python" -m venv "$work/clean"
"$work/clean/bin/pip" install --quiet --disable-pip-version-check -r requirements-test.txt "$work"/wheels/viscera-*.whl

# From another folder, so that `import viscera` can only find what is installed.
cp -r tests examples "$work/"
cd "$work"
VISCERA_PROGRAM="$CARGO_TARGET_DIR/debug/viscera" VISCERA_REFERENCES="$root/crates/viscera/tests/data/references" \
    "$work/clean/bin/python" -m pytest -q -p no:cacheprovider tests "$@"
