#!/usr/bin/env bash
# Prepares the machine for the Makefile: Python's headers, GLM and ccache ("build"), doctest, POV-Ray and Chromium ("test")
# or the LLVM that Dr.Jit works with ("peers") through apt where they are missing and apt may be used, then, for "build",
# the virtual environment .venv. Says what to do where it may not. Called as: setup.sh PYTHON build|test|peers
set -euo pipefail
python=$1
stage=$2

has_header() { printf '#include <%s>\n' "$1" | "${CXX:-c++}" -E -x c++ -o /dev/null - 2> /dev/null; }
has_python_headers() {
  "$python" -c 'import os, sys, sysconfig as s; sys.exit(not os.path.exists(s.get_paths()["include"] + "/Python.h"))'
}
has_venv() { "$python" -c 'import ensurepip, venv' 2> /dev/null; }

# The packages that are missing of those this stage wants.
missing_packages() {
  if [ "$stage" = build ]; then
    has_python_headers || echo python3-dev
    has_venv || echo python3-venv
    has_header glm/glm.hpp || echo libglm-dev
    command -v ccache > /dev/null || echo ccache
  elif [ "$stage" = test ]; then
    has_header doctest/doctest.h || echo doctest-dev
    command -v povray > /dev/null || echo povray
    command -v chromium > /dev/null || command -v google-chrome > /dev/null || echo chromium
  else
    compgen -G '/usr/lib/*/libLLVM-19.so' > /dev/null || echo libllvm19
  fi
}

# Installs packages through apt; fails where there is no apt, no right to use it, or no such package.
apt_install() {
  command -v apt-get > /dev/null || return 1
  local sudo=()
  if [ "$(id -u)" != 0 ]; then
    sudo -n true 2> /dev/null || return 1
    sudo=(sudo -n)
  fi
  "${sudo[@]}" apt-get update -qq || true
  "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" > /dev/null
}

"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || {
  echo "octomarch needs Python 3.11 or newer; $python is $("$python" --version 2>&1). Try: make PYTHON=python3.11 …" >&2
  exit 1
}
command -v "${CXX:-c++}" > /dev/null || {
  echo "octomarch needs a C++20 compiler; on Debian: apt-get install g++" >&2
  exit 1
}

mapfile -t missing < <(missing_packages)
if [ ${#missing[@]} -gt 0 ]; then
  echo "Installing through apt: ${missing[*]}"
  apt_install "${missing[@]}" || echo "apt could not be used (it needs root or sudo without a password)." >&2
fi
for package in $(missing_packages); do
  case $package in
    python3-dev) echo "Python's headers are missing; ask for: apt-get install python3-dev" >&2 && exit 1 ;;
    python3-venv) ;;  # pip makes up for it below
    libglm-dev) echo "GLM is missing: CMake will download it. To avoid that: apt-get install libglm-dev" >&2 ;;
    doctest-dev) echo "doctest is missing: CMake will download it. To avoid that: apt-get install doctest-dev" >&2 ;;
    povray) echo "POV-Ray is missing: tests against it will be skipped. To run them: apt-get install povray" >&2 ;;
    chromium) echo "Chromium is missing: tests of notebooks and shaders will be skipped. To run them: apt-get install chromium" >&2 ;;
    libllvm19) echo "libllvm19 is missing: Dr.Jit will be reported as failed, or work with another LLVM." >&2 ;;
    ccache) echo "ccache is missing: builds from scratch will take longer." >&2 ;;
  esac
done

if [ "$stage" = build ]; then
  if has_venv; then
    "$python" -m venv .venv
  else
    "$python" -m venv --without-pip .venv
    "$python" -m pip --python .venv/bin/python install --quiet pip
  fi
fi
