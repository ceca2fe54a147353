# Two commands: `make demo` and `make test`. Both make their own virtual environment first.
SHELL := /bin/bash
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PROJECTS := packages/tpvqa/pyproject.toml packages/tpvqa-household/pyproject.toml experiments/pyproject.toml
DEMO := episodes/demo
SEED ?= 20
ROBOT_VENV := .venv-robot
ROBOT_BIN := $(ROBOT_VENV)/bin
ROBOT_DEMO := episodes/robot
# Of the big libraries only what is imported is compiled, and then.
QUICKLY := --quiet --disable-pip-version-check --no-compile
# … and kept: where Python is told to keep nothing, each of the tests' processes compiles all anew.
unexport PYTHONDONTWRITEBYTECODE
# Ours are built in the environment itself: pip would make another one for each.
BUILD := hatchling editables
OURS := $(QUICKLY) --no-deps --no-build-isolation

.PHONY: demo test lint types tests gl install install-dev clean robot robot-env robot-interfaces test-robot

demo: install
	@rm -rf $(DEMO)
	@$(BIN)/tpvqa run serve_breakfast --seed $(SEED) --out $(DEMO) || [ $$? -eq 1 ]
	@$(BIN)/tpvqa report $(DEMO) > /dev/null
	@echo "report:  $$PWD/$(DEMO)/report.html  (open it in a browser)"
	@echo "next:    . $(BIN)/activate; tpvqa --help"

# Two installations at once, and the types beside the robot's tests, which mostly wait.
test:
	@$(MAKE) --no-print-directory -j2 install-dev robot-interfaces gl
	@$(MAKE) --no-print-directory lint
	@$(MAKE) --no-print-directory -j2 types test-robot
	@$(MAKE) --no-print-directory tests

lint:
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types:
	$(BIN)/mypy

# A process a core, of one thread each: threads that wait for each other take three times as long.
tests:
	MUJOCO_GL=osmesa OMP_NUM_THREADS=1 $(BIN)/pytest -n auto --dist worksteal

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
	@$(BIN)/python -m pip install $(QUICKLY) $(BUILD)
	@$(BIN)/python -m pip install $(OURS) -e packages/tpvqa -e packages/tpvqa-household -e experiments
	@$(BIN)/python -m pip install $(QUICKLY) -r requirements-dev.txt
	@touch $(VENV)/.installed $@

# Software rendering needs Mesa's off-screen library, which is a system package.
gl:
	@$(PYTHON) -c 'import ctypes.util, sys; sys.exit(not ctypes.util.find_library("OSMesa"))' || { \
	  if [ "$$(id -u)" = 0 ] && command -v apt-get > /dev/null; then \
	    echo "installing libosmesa6 (software rendering) …"; \
	    apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq libosmesa6 > /dev/null; \
	  else \
	    echo "Rendering needs Mesa's off-screen library. Install it, then run make again:"; \
	    echo "  sudo apt-get install libosmesa6"; exit 1; \
	  fi; }

# The robot has an environment of its own: MuJoCo is pinned there. Of robosuite only its models are
# read, so it is installed without what its own Python needs.
robot: robot-env gl
	@rm -rf $(ROBOT_DEMO)
	@$(ROBOT_BIN)/tpvqa film --seed 1 --out $(ROBOT_DEMO)
	@$(ROBOT_BIN)/tpvqa report $(ROBOT_DEMO) > /dev/null
	@echo "report:  $$PWD/$(ROBOT_DEMO)/report.html"
	@echo "film:    $$PWD/$(ROBOT_DEMO)/film.mp4"

robot-env: $(ROBOT_VENV)/.installed

# ROS 2's messages of our own, built into the robot's environment: half a minute, once.
robot-interfaces: robot-env
	@$(ROBOT_BIN)/python -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' || { \
	  echo "The wheels of ROS 2 are for Python 3.11 alone. Name one: rm -rf $(ROBOT_VENV); make PYTHON=python3.11 …"; exit 1; }
	@$(ROBOT_BIN)/tpvqa build-interfaces

# How soon processes hear of each other over DDS is not in our hands: what fails is tried again.
test-robot: robot-interfaces gl
	MUJOCO_GL=osmesa OMP_NUM_THREADS=1 $(ROBOT_BIN)/python -m pytest -n 3 --dist worksteal --reruns 2 tests_robot

$(ROBOT_VENV)/.installed: packages/tpvqa/pyproject.toml packages/tpvqa-robots/pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "tpvqa needs Python 3.11 or newer as '$(PYTHON)'. Name one: make PYTHON=python3.12 …"; exit 1; }
	@$(PYTHON) -m venv $(ROBOT_VENV)
	@echo "installing tpvqa and its robots into $(ROBOT_VENV) …"
	@$(ROBOT_BIN)/python -m pip install $(QUICKLY) $(BUILD)
	@$(ROBOT_BIN)/python -m pip install $(OURS) -e packages/tpvqa -e packages/tpvqa-robots
	@$(ROBOT_BIN)/python -m pip install $(QUICKLY) \
	  tpvqa 'tpvqa-robots[bag,grasps,gym,interfaces,ros2,trees]' 'mujoco==3.3.*' 'imageio-ffmpeg>=0.5' \
	  'pytest>=8.2' 'pytest-xdist>=3.6' 'pytest-rerunfailures>=15' 'hypothesis>=6.100'
	@$(ROBOT_BIN)/python -m pip install $(QUICKLY) --no-deps robosuite==1.5.2
	@touch $@

clean:
	rm -rf $(VENV) $(ROBOT_VENV) .mypy_cache .ruff_cache .pytest_cache
