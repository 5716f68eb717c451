# Needs a Python from 3.11 on, and nothing else: whatever it installs goes into .venv.
#
#   make demo     a whole mission in the built-in apartment, with the live view in the browser
#   make test     the tests
#   make lint     style, types, and which room may import which
#   make bench    compare methods:  make bench EPISODES=episodes.jsonl METHODS="zavis nearest"
#   make bench-speed    time what runs often
#   make clean    remove .venv, caches and builds; results under runs/ stay
#
# ARGS="…" goes to the program: make demo ARGS=--no-view, make test ARGS=tests/mapping

PYTHON ?= python3
JOBS ?= 2
METHODS ?= zavis nearest frontier
OUT ?= runs/bench
ARGS ?=

BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
SAY := @echo "→"
CHROMIUM := { command -v chromium || command -v chromium-browser || command -v google-chrome; } >/dev/null

.DEFAULT_GOAL := help
.PHONY: help demo test lint bench bench-speed browser clean episodes-named

help:
	@sed -n '3,10s/^#  *//p' Makefile

demo: .venv/.core
	@$(BIN)/zavis demo $(ARGS)

test: .venv/.dev browser
	@set --; $(CHROMIUM) || set -- -m "not browser"; $(BIN)/pytest -n $(JOBS) "$$@" $(ARGS)

lint: .venv/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: episodes-named .venv/.core
	@$(BIN)/zavis bench $(EPISODES) $(METHODS:%=--method %) --workers $(JOBS) --out $(OUT) $(ARGS)

episodes-named:
	@[ -n "$(EPISODES)" ] || { echo 'make bench: name the episodes: make bench EPISODES=episodes.jsonl' >&2; exit 1; }

bench-speed: .venv/.dev
	@for name in lidar mapping_speed planning missions startup arcos scip pan_tilt camera fuzz; do echo "== $$name"; $(BIN)/python -m benchmarks.$$name $(ARGS) || exit; done

clean:
	rm -rf .venv build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache .benchmarks
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# Debian's Python may come without ensurepip; then the machine's pip puts pip into the environment.
.venv/.made:
	@for python in "$(PYTHON)" python3 python3.13 python3.12 python3.11; do \
	  "$$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && break; python=; \
	done; \
	[ -n "$$python" ] || { echo 'make: no Python 3.11 or newer found (install it, or: make PYTHON=/path/to/python3)' >&2; exit 1; }; \
	echo "→ making .venv with $$("$$python" --version)"; \
	rm -rf .venv; \
	"$$python" -m venv .venv >/dev/null 2>&1 || { \
	  "$$python" -m venv --without-pip --clear .venv && "$$python" -m pip --quiet --python .venv/bin/python install pip; \
	} || { rm -rf .venv; echo 'make: this Python can make no environment (Debian: apt-get install python3-venv)' >&2; exit 1; }
	@touch $@

.venv/.core: .venv/.made pyproject.toml
	$(SAY) "installing zavis_bt and what it needs, without torch (about a minute at first)"
	@$(PIP) install --editable .
	@touch $@

.venv/.dev: .venv/.made pyproject.toml
	$(SAY) "installing zavis_bt, torch and the tools of its tests (some minutes and gigabytes at first)"
	@$(PIP) install --editable '.[dev]'
	@touch $@ .venv/.core

# Without a browser the tests that drive one are left out, so failing here must not stop anything.
browser:
	@$(CHROMIUM) || { \
	  [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null && echo "→ installing chromium for the browser tests" && \
	  { apt-get update && DEBIAN_FRONTEND=noninteractive timeout 300 apt-get install -y --no-install-recommends chromium; } \
	    >/dev/null 2>&1; \
	} || echo "→ no chromium here: the browser tests are left out"
