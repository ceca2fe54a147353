# Two commands: `make demo` and `make test`. Both make their own virtual environment first.
SHELL := /bin/bash
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PROJECTS := packages/tpvqa/pyproject.toml packages/tpvqa-household/pyproject.toml experiments/pyproject.toml
DEMO := episodes/demo
SEED ?= 20

.PHONY: demo test lint types tests gl install install-dev clean

demo: install
	@rm -rf $(DEMO)
	@$(BIN)/tpvqa run serve_breakfast --seed $(SEED) --out $(DEMO) || [ $$? -eq 1 ]
	@$(BIN)/tpvqa report $(DEMO) > /dev/null
	@echo "report:  $$PWD/$(DEMO)/report.html  (open it in a browser)"
	@echo "next:    . $(BIN)/activate; tpvqa --help"

test: install-dev gl lint types tests

lint:
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types:
	$(BIN)/mypy

tests:
	MUJOCO_GL=osmesa $(BIN)/pytest -n auto

install: $(VENV)/.installed
install-dev: $(VENV)/.installed-dev

$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || { \
	  echo "tpvqa needs Python 3.11 or newer as '$(PYTHON)'. Name one: make PYTHON=python3.12 …"; exit 1; }
	@$(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); \
	  echo "Python's venv module is missing. Install it: apt-get install python3-venv"; exit 1; }

$(VENV)/.installed: $(VENV)/bin/python $(PROJECTS)
	@echo "installing tpvqa and its household into $(VENV) …"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check \
	  -e packages/tpvqa -e packages/tpvqa-household
	@touch $@

$(VENV)/.installed-dev: $(VENV)/bin/python $(PROJECTS) requirements-dev.txt
	@echo "installing tpvqa, its household, the experiments and development tools into $(VENV) …"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements-dev.txt
	@touch $(VENV)/.installed $@

# Software rendering needs Mesa's off-screen library, which is a system package.
gl:
	@$(PYTHON) -c 'import ctypes.util, sys; sys.exit(not ctypes.util.find_library("OSMesa"))' || { \
	  if [ "$$(id -u)" = 0 ] && command -v apt-get > /dev/null; then \
	    echo "installing libosmesa6 (software rendering) …"; \
	    apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq libosmesa6 > /dev/null; \
	  else \
	    echo "The rendering tests need Mesa's off-screen library. Install it, then run make test again:"; \
	    echo "  sudo apt-get install libosmesa6"; exit 1; \
	  fi; }

clean:
	rm -rf $(VENV) .mypy_cache .ruff_cache .pytest_cache
