#!/usr/bin/env bash
# Sets up what the page's tests need: Node's packages and a Chromium. Installs on Debian and its kin; elsewhere it says what is missing.
set -euo pipefail
cd "$(dirname "$0")/.."

least_node=20.19.0

missing() {
    printf '%s\n' "$@" >&2
    exit 1
}

may_install() { command -v apt-get >/dev/null && { [ "$(id -u)" = 0 ] || command -v sudo >/dev/null; }; }

install_packages() {
    local as_root=()
    [ "$(id -u)" = 0 ] || as_root=(sudo)
    "${as_root[@]}" apt-get update -qq
    DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "$@"
}

# Debian's own Node is older than Vite bears in some releases, so that it is checked and not installed.
version=$(node --version 2>/dev/null || echo v0)
if [ "$(printf '%s\n' "$least_node" "${version#v}" | sort -V | head -1)" != "$least_node" ]; then
    missing "The page needs Node.js $least_node or newer with npm; found ${version#v}." \
        "Install it from https://nodejs.org or with your system's packages."
fi

chromium() {
    local name
    for name in "${CHROMIUM:-}" chromium chromium-browser; do
        [ -n "$name" ] && command -v "$name" >/dev/null && return 0
    done
    return 1
}

if ! chromium; then
    if may_install; then
        install_packages chromium fonts-dejavu-core
    else
        missing "The page's tests need Chromium." \
            "Install your system's package, name an executable in CHROMIUM, or run: npx playwright install chromium"
    fi
fi

# As the lock says, and again only when the lock has changed. Not `npm ci`: it wants the binaries of every platform in the lock, which
# registries that mirror some do not have.
stamp=node_modules/.of-lock
if ! cmp -s package-lock.json "$stamp"; then
    npm install --no-save --no-audit --no-fund
    cp package-lock.json "$stamp"
fi
