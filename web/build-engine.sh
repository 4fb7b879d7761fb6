#!/usr/bin/env bash
# Builds the engine as WebAssembly into web/src/engine/generated, for a page that needs no server.
# Takes the compiler's own target where it can be had, or else the library's sources. Ends with 3, and says what is missing, where there is
# neither.
set -euo pipefail
cd "$(dirname "$0")/.."

out=web/src/engine/generated
target_dir="${CARGO_TARGET_DIR:-$PWD/target}"
version="$(sed -n '/^name = "wasm-bindgen"$/{n;s/^version = "\(.*\)"$/\1/p}' Cargo.lock)"

missing() {
    printf 'the engine cannot be built for the web: %s\n' "$1" >&2
    exit 3
}

has_target() {
    [ -d "$(rustc --print sysroot)/lib/rustlib/wasm32-unknown-unknown/lib" ]
}

# Without relaxed operations: they are not in every browser, and round otherwise on each. Flags for all builds may stand in
# CARGO_BUILD_RUSTFLAGS; RUSTFLAGS would take the place of these.
unset RUSTFLAGS
export CARGO_BUILD_RUSTFLAGS="-C target-feature=+simd128 ${CARGO_BUILD_RUSTFLAGS:-}"

if has_target || { command -v rustup >/dev/null && rustup target add wasm32-unknown-unknown >/dev/null 2>&1 && has_target; }; then
    cargo build --locked --profile web --target wasm32-unknown-unknown -p viscera-web
elif [ -n "${WEB_RUST_SRC:-}" ]; then
    # The library is built along, from its sources (the folder `library`), which have to be of the compiler's version.
    RUSTC_BOOTSTRAP=1 __CARGO_TESTS_ONLY_SRC_ROOT="$WEB_RUST_SRC" cargo build --locked --profile web \
        --target wasm32-unknown-unknown -Zbuild-std=std,panic_abort -p viscera-web
else
    missing "the target wasm32-unknown-unknown is not installed: \`rustup target add wasm32-unknown-unknown\`, or Debian's packages \
libstd-rust-dev-wasm32 and lld for Debian's compiler. Where neither can be had, name the folder \`library\` of the sources of \
$(rustc --version) by WEB_RUST_SRC (Debian: package rust-src; RUSTUP_TOOLCHAIN chooses another compiler)"
fi

# The tool has to be of the library's version to the last digit. Not optimised: it runs for seconds and would be compiled for minutes.
bindgen="$target_dir/tools/wasm-bindgen-$version"
if [ ! -x "$bindgen/bin/wasm-bindgen" ]; then
    env -u CARGO_BUILD_RUSTFLAGS CARGO_TARGET_DIR="$target_dir/tools" cargo install wasm-bindgen-cli --debug --bin wasm-bindgen --version "=$version" --root "$bindgen"
fi
rm -rf "$out"
"$bindgen/bin/wasm-bindgen" --remove-name-section --target web --out-dir "$out" "$target_dir/wasm32-unknown-unknown/web/viscera_web.wasm"

# Smaller, where binaryen is there: `npm install --no-save binaryen`, or the system's package. A hundred megabytes, so that it is no dependency.
wasm_opt="$(command -v web/node_modules/.bin/wasm-opt || command -v wasm-opt || true)"
if [ -n "$wasm_opt" ]; then
    "$wasm_opt" -O3 --enable-simd --enable-bulk-memory --enable-nontrapping-float-to-int --enable-sign-ext \
        --enable-mutable-globals --enable-reference-types --enable-multivalue \
        "$out/viscera_web_bg.wasm" -o "$out/viscera_web_bg.wasm.small"
    mv "$out/viscera_web_bg.wasm.small" "$out/viscera_web_bg.wasm"
fi
printf 'the engine is in %s: %s bytes, %s compressed\n' "$out" "$(wc -c <"$out/viscera_web_bg.wasm")" "$(gzip -9c "$out/viscera_web_bg.wasm" | wc -c)"
