# Everything one does with octomarch. `make demo` and `make test` start from a bare Debian with Python ≥ 3.11, g++, make
# and pip: they make .venv, install what is missing and build. Each step leaves a stamp, and is redone when its inputs
# change.
#
#   make demo    render the demo scenes          make lint     check formats, types and style, Python and C++
#   make test    lint, C++ tests, pytest         make format   rewrite the sources as lint wants them
#   make build   install into .venv              make bench    measure speed
#   make docs    build the site in build/docs    make gallery  the same: it renders examples/gallery
#   make bench-peers   octomarch against Dr.Jit, Numba, JAX, Warp, Taichi and numpy, from PyPI into build/peers-venv
#   make bench-tables  rewrite the tables and plots of README.md and docs from benchmarks/results
#   make sanitize  both kinds of tests under the address and undefined-behaviour sanitizers
#   make clean   remove what was built           make distclean  remove .venv too
#
# Variables: PYTHON (interpreter to make .venv with), PYTEST_ARGS, BENCH_ARGS, SWEEP_ARGS, TRADE_ARGS, CELLS_ARGS,
# DOCS_ARGS (more arguments for pytest, run.py and compare.py, sweep.py, trade.py, cells.py, sphinx-build).
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DELETE_ON_ERROR:
.DEFAULT_GOAL := build
.PHONY: demo test build lint format bench bench-peers bench-tables docs gallery sanitize clean distclean check-cpp check-python check-cpp-style

PYTHON ?= python3
BIN := .venv/bin
STAMPS := .venv/stamps
BUILD_DIR := build/venv
SANITIZE_DIR := build/asan-ubsan
PIP := $(BIN)/python -m pip --disable-pip-version-check
export CMAKE_BUILD_PARALLEL_LEVEL ?= $(shell nproc)
# Clones in different places share what ccache keeps.
export CCACHE_BASEDIR ?= $(CURDIR)
export CCACHE_NOHASHDIR ?= 1
SYSTEM_PATH := $(PATH)
export PATH := $(CURDIR)/$(BIN):$(PATH)

# Directories are listed too: adding or removing a file changes theirs.
tree = $(shell find $(1) \( -name __pycache__ -o -name '.*_cache' \) -prune -o \( -type d -o -type f \) -print)
SOURCES := CMakeLists.txt pyproject.toml README.md LICENSE $(call tree,cmake cpp python)
CPP_FILES = $(shell find cpp tests/cpp benchmarks -name '*.hpp' -o -name '*.cpp')

# A stamp gets the time at which its step began, so that what is edited meanwhile counts as newer.
begin = touch $@.begun
end = mv $@.begun $@

demo: $(STAMPS)/installed
	$(BIN)/octomarch demo --output out

build: $(STAMPS)/installed

# pytest comes last, so that its summary is the last thing seen.
test: $(STAMPS)/installed $(STAMPS)/dev-tools
	@$(MAKE) --no-print-directory lint
	@$(MAKE) --no-print-directory check-cpp
	OCTOMARCH_BUILD_DIR=$(BUILD_DIR) $(BIN)/python -m pytest $(PYTEST_ARGS)

lint: check-python check-cpp-style

check-python: $(STAMPS)/installed $(STAMPS)/dev-tools
	ruff check .
	ruff format --check .
	mypy
	python -m mypy.stubtest octomarch._core --concise --ignore-missing-stub \
	  --allowlist tools/stubtest_allowlist.txt --ignore-unused-allowlist

check-cpp-style: $(STAMPS)/dev-tools $(STAMPS)/cpp-tests-built
	@echo clang-format --dry-run -Werror cpp tests/cpp benchmarks
	@clang-format --dry-run -Werror $(CPP_FILES)
	python tools/clang_tidy.py $(BUILD_DIR)

check-cpp: $(STAMPS)/cpp-tests-built
	ctest --test-dir $(BUILD_DIR) --output-on-failure

format: $(STAMPS)/dev-tools
	ruff check --fix .
	ruff format .
	clang-format -i $(CPP_FILES)

bench: $(STAMPS)/installed
	$(BIN)/python benchmarks/run.py --build-dir $(BUILD_DIR) $(BENCH_ARGS)
	$(BIN)/python benchmarks/sweep.py $(SWEEP_ARGS)
	$(BIN)/python benchmarks/trade.py $(TRADE_ARGS)
	$(BIN)/python benchmarks/cells.py $(CELLS_ARGS)

bench-peers: $(STAMPS)/installed
	@PATH="$(SYSTEM_PATH)" tools/setup.sh "$(PYTHON)" peers
	$(BIN)/python benchmarks/compare.py $(BENCH_ARGS)

bench-tables: $(STAMPS)/docs-tools
	$(BIN)/python benchmarks/tables.py

docs: $(STAMPS)/installed $(STAMPS)/docs-tools
	@rm -rf docs/gallery  # pages of scripts that are no more
	$(BIN)/python -m sphinx -W --keep-going -q -d build/doctrees $(DOCS_ARGS) docs build/docs
	@echo "The site: build/docs/index.html; its gallery: build/docs/gallery/index.html, with the pictures in out/gallery"

gallery: docs

# The sanitizers' libraries must come before everything else in Python's process; its own leaks are not of interest.
sanitize: $(STAMPS)/installed $(STAMPS)/dev-tools
	cmake --preset asan-ubsan
	cmake --build --preset asan-ubsan
	ctest --preset asan-ubsan
	cmake --install $(SANITIZE_DIR) --component python --prefix $(SANITIZE_DIR)/python
	cp -R python/octomarch $(SANITIZE_DIR)/python
	LD_PRELOAD="$(foreach library,asan ubsan stdc++,$$($(CXX) -print-file-name=lib$(library).so))" \
	  ASAN_OPTIONS=detect_leaks=0 PYTHONPATH=$(SANITIZE_DIR)/python OCTOMARCH_BUILD_DIR=$(BUILD_DIR) \
	  $(BIN)/python -m pytest --ignore tests/test_typing.py $(PYTEST_ARGS)

clean:
	rm -rf build dist docs/gallery docs/reference $(STAMPS)/installed $(STAMPS)/cpp-tests-built

distclean: clean
	rm -rf .venv .mypy_cache .pytest_cache .ruff_cache .hypothesis

$(STAMPS)/venv:
	@echo "== Preparing the machine and .venv"
	@PATH="$(SYSTEM_PATH)" tools/setup.sh "$(PYTHON)" build
	@mkdir -p $(STAMPS) && touch $@

# Build requirements live in .venv, and the build directory stays: an incremental build only compiles what changed.
$(STAMPS)/build-tools: pyproject.toml tools/requirements.py | $(STAMPS)/venv
	@echo "== Installing what the build needs into .venv"
	@$(begin)
	@$(BIN)/python tools/requirements.py build > $@.txt
	@$(PIP) install --quiet --requirement $@.txt
	@$(end)

$(STAMPS)/dev-tools: pyproject.toml tools/requirements.py | $(STAMPS)/venv
	@echo "== Installing what tests and linters need into .venv"
	@$(begin)
	@PATH="$(SYSTEM_PATH)" tools/setup.sh "$(PYTHON)" test
	@$(BIN)/python tools/requirements.py dev > $@.txt
	@$(PIP) install --quiet --requirement $@.txt
	@$(end)

$(STAMPS)/docs-tools: pyproject.toml tools/requirements.py | $(STAMPS)/venv
	@echo "== Installing what the documentation needs into .venv"
	@$(begin)
	@$(BIN)/python tools/requirements.py docs > $@.txt
	@$(PIP) install --quiet --requirement $@.txt
	@$(end)

$(STAMPS)/installed: $(STAMPS)/build-tools $(SOURCES)
	@echo "== Building octomarch and installing it into .venv"
	@$(begin)
	@$(PIP) install --quiet --no-build-isolation . --config-settings=build-dir=$(BUILD_DIR) \
	  --config-settings=cmake.define.OCTOMARCH_WERROR=ON
	@$(end)

# Benchmarks are compiled too, so that they do not rot.
$(STAMPS)/cpp-tests-built: $(STAMPS)/installed $(STAMPS)/dev-tools $(call tree,tests/cpp benchmarks/cpp)
	@echo "== Building the C++ tests and benchmarks"
	@$(begin)
	@cmake -S . -B $(BUILD_DIR) -DOCTOMARCH_BUILD_TESTS=ON -DOCTOMARCH_BUILD_BENCHMARKS=ON > $(BUILD_DIR)/configure.log
	@cmake --build $(BUILD_DIR) --target octomarch_tests octomarch_bench
	@$(end)
