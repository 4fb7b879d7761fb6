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

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }

update_packages() { as_root apt-get update -qq; }

install_packages() {
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@"
}

too_old() { [ "$(printf '%s\n' "$least_node" "${1:-0}" | sort -V | head -1)" != "$least_node" ]; }

# The version that the system's packages would bring, without epoch and revision.
offered_node() { apt-cache policy nodejs | sed -n 's/^ *Candidate: \([0-9]*:\)\{0,1\}\([0-9.]*\).*/\2/p'; }

node_version() { { node --version 2>/dev/null || echo v0; } | tr -d v; }

# Debian brings a Node that Vite bears since its release 13.
if too_old "$(node_version)" || ! command -v npm >/dev/null; then
    if may_install && update_packages && ! too_old "$(offered_node)"; then
        install_packages nodejs npm
    else
        missing "The page needs Node.js $least_node or newer with npm; found $(node_version)." \
            "Install it from https://nodejs.org or with your system's packages."
    fi
fi

# Not called after the program: `command -v` finds functions too.
has_chromium() {
    local name
    for name in "${CHROMIUM:-}" chromium chromium-browser; do
        [ -n "$name" ] && command -v "$name" >/dev/null && return 0
    done
    return 1
}

if ! has_chromium; then
    if may_install; then
        update_packages
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
