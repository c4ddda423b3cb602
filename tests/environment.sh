# Sourced by the scripts of the folders beside it: what they say when they cannot go on, and Python packages at pinned versions.

could_not() {
    echo "$(basename "$0"): $*" >&2
    exit 2
}

# install_python ENVIRONMENT REQUIREMENTS: an environment that holds what the file lists, and pulls in nothing else. Made at the first call
# and again when python3 or the file changes; that needs the network, a later call does not.
install_python() {
    local environment="$1" requirements="$2"
    local installed="$environment/installed-$(basename "$requirements")"
    python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))' || could_not "python3 is missing or older than 3.11"
    # Another python3 cannot use the packages of the one before.
    [[ "$("$environment/bin/python" --version 2> /dev/null)" = "$(python3 --version)" ]] || rm -rf "$environment"
    cmp -s "$requirements" "$installed" && return
    "$environment/bin/python" -m pip --version > /dev/null 2>&1 || python3 -m venv --clear "$environment" \
        || could_not "python3 -m venv failed: install its package (python3-venv)"
    "$environment/bin/python" -m pip install --quiet --disable-pip-version-check --only-binary :all: --no-deps \
        --requirement "$requirements" >&2 || could_not "pip could not install $requirements"
    # Written last, so that an interrupted installation does not count.
    cp "$requirements" "$installed"
}

# install_node FOLDER: the packages of the folder's package-lock.json, without their own install scripts; kept like those of Python.
install_node() {
    local folder="$1"
    local installed="$folder/node_modules/installed.json"
    cmp -s "$folder/package-lock.json" "$installed" && return
    (cd "$folder" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error >&2) \
        || could_not "npm could not install $folder/package-lock.json"
    cp "$folder/package-lock.json" "$installed"
}
