#!/usr/bin/env bash
# Installs what this project needs: Debian packages (apt-packages.txt), the solver with the load ledger (solver/), then
# .venv (requirements.txt, pinned and hashed).
# Safe to run again at any time; does nothing, quickly, when everything is in place. Prefer `make setup`.
set -euo pipefail

if [ "${1:-}" = "--help" ] || [ "${1:-}" = "-h" ]; then
    sed -n '2,4s/^# //p' "$0"
    exit 0
fi
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

say() { printf 'setup: %s\n' "$*"; }
stop() {
    printf 'setup: %s\n' "$*" >&2
    exit 1
}

# A $ in the path is taken for a variable by make and by what it calls.
case "$PWD" in
*'$'*) stop "this clone lies in $PWD: a \$ in its path breaks make and what it calls; move the clone to a path without one" ;;
esac

# --- Debian packages ------------------------------------------------------------------------------------------------

missing_packages() {
    local wanted installed
    wanted=$(sed 's/#.*//; s/[[:space:]]//g; /^$/d' apt-packages.txt | sort)
    # shellcheck disable=SC2086  # one argument per package
    installed=$(dpkg-query --show --showformat '${db:Status-Status} ${Package}\n' $wanted 2>/dev/null |
        sed -n 's/^installed //p' | sort -u) || true
    comm -23 <(printf '%s\n' "$wanted") <(printf '%s\n' "$installed") | tr '\n' ' ' | sed 's/ $//'
}

install_packages() {
    local missing as_root=()
    command -v dpkg-query >/dev/null || {
        say "this is not a Debian system: install by other means what apt-packages.txt names; going on"
        return
    }
    missing=$(missing_packages)
    [ -n "$missing" ] || return 0
    if [ "$(id -u)" -ne 0 ]; then
        as_root=(sudo)
        [ -t 0 ] || as_root=(sudo --non-interactive)
        { command -v sudo >/dev/null && "${as_root[@]}" true; } ||
            stop "Debian packages are missing and this user is not root; run: apt-get update && apt-get install --no-install-recommends $missing"
    fi
    say "installing Debian packages: $missing"
    as_root+=(env DEBIAN_FRONTEND=noninteractive apt-get --quiet=2 -o Dpkg::Use-Pty=0)
    "${as_root[@]}" update || say "apt-get update failed; trying with the package lists at hand"
    # shellcheck disable=SC2086
    "${as_root[@]}" install --yes --no-install-recommends $missing >/dev/null ||
        stop "apt-get could not install: $missing"
}

# --- Python environment ---------------------------------------------------------------------------------------------

find_python() {
    local name
    for name in python3.11 python3 python3.13 python3.12; do
        if "$name" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
            printf '%s' "$name"
            return
        fi
    done
    stop "Python 3.11 or newer is needed and neither python3.11 nor python3 is one; on Debian 12: apt-get install python3"
}

# What the environment was built from and where; an environment does not survive being moved.
fingerprint() {
    printf '%s\n' "$PWD"
    cat requirements.txt requirements-bootstrap.txt apt-packages.txt pyproject.toml | sha256sum
}

fill_environment() {
    # uv does not read pip's configuration: hand over the package index, if this machine has its own.
    local index
    index=${PIP_INDEX_URL:-$(.venv/bin/pip config get global.index-url 2>/dev/null || true)}
    [ -z "$index" ] || export UV_DEFAULT_INDEX="${UV_DEFAULT_INDEX:-$index}"
    export UV_SYSTEM_CERTS="${UV_SYSTEM_CERTS:-1}" UV_HTTP_TIMEOUT="${UV_HTTP_TIMEOUT:-180}"
    install_packages_of_lock
    # The package itself, from this folder: what is edited here counts, in every folder that the environment is used in.
    .venv/bin/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable . ||
        stop "the package itself could not be installed (see above)"
}

install_packages_of_lock() {
    .venv/bin/pip install --quiet --disable-pip-version-check --require-hashes --requirement requirements-bootstrap.txt &&
        .venv/bin/uv pip sync --quiet --link-mode copy --python .venv/bin/python --require-hashes requirements.txt && return
    say "uv did not succeed; trying with pip, which is slower"
    .venv/bin/pip install --quiet --disable-pip-version-check --require-hashes --requirement requirements.txt ||
        stop "the Python packages of requirements.txt could not be installed (see above)"
}

build_environment() {
    local python stamp=.venv/.setup-stamp
    [ ! -f "$stamp" ] || [ ! -x .venv/bin/python ] || [ "$(cat "$stamp")" != "$(fingerprint)" ] || return 0
    python=$(find_python)
    say "building .venv with $("$python" --version)"
    if ! .venv/bin/python -c 'import pip' 2>/dev/null || ! { [ -f "$stamp" ] && [ "$(head -n 1 "$stamp")" = "$PWD" ]; }; then
        # Python would clear what the link leads to, then refuse to build there.
        [ ! -L .venv ] || stop ".venv is a symbolic link to $(readlink .venv), allowed is a folder of its own: rm .venv"
        "$python" -m venv --clear .venv || stop "$python could not make .venv; on Debian: apt-get install python3-venv"
    fi
    rm -f "$stamp"
    fill_environment
    fingerprint >"$stamp.new"
    mv "$stamp.new" "$stamp"
    say "done; checking the machine"
    .venv/bin/python workflows/environment/doctor.py ||
        stop "the environment is built, but this machine lacks something (see above); check again with: make doctor"
}

# --- solver with the load ledger ------------------------------------------------------------------------------------

# make knows by itself whether there is anything to do. A machine without the headers can still run `ledger: dumps`.
build_solver() {
    make --silent --directory solver ||
        say "solver/ could not be built (see above); studies with 'ledger: solver' need it, see solver/README.md"
}

install_packages
build_solver
build_environment
