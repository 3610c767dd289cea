# For developers and first visits: `make demo`, `make test`. The library itself needs no make; see README.md.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
DEMO_OUTPUT ?= demo-output
STUDY_OUTPUT ?= study-output

.DEFAULT_GOAL := help
.PHONY: help setup demo test slicer-test screenshots lint format bench study clean

help:
	@echo "make demo    reconstruct a simulated lumbar scan and draw it, into $(DEMO_OUTPUT)/"
	@echo "make test    lint, format check and all tests"
	@echo "make slicer-test  only the self tests of the Slicer module, on real MRML nodes and Qt, without Slicer"
	@echo "make screenshots  the module's panel and views as pictures, into Resources/Screenshots/"
	@echo "make setup   only install what the two above need, into $(VENV)/"
	@echo "make lint    only lint and format check"
	@echo "make format  reformat the code"
	@echo "make bench   measure the speed of this machine"
	@echo "make study   compare all methods on simulated patients, into $(STUDY_OUTPUT)/ (half an hour)"
	@echo "make clean   remove $(VENV)/ and everything that was built"

setup: $(STAMP)

# A broken or half-made environment (an interrupted set-up, a Python that was upgraded, a folder that was moved) is made anew
ifneq ($(shell $(BIN)/python -m pip --version >/dev/null 2>&1 && $(BIN)/python -c 'import AIFReconLib' >/dev/null 2>&1 && echo whole),whole)
.PHONY: $(STAMP)
endif

# Otherwise installed again only when pyproject.toml changes
$(STAMP): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' \
	  || { echo "AIFRecon needs Python 3.10 or newer. Name one with: make PYTHON=python3.12 $(MAKECMDGOALS)" >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null \
	  || { echo "Python cannot make virtual environments here. Install them with: sudo apt install python3-venv" >&2; exit 1; }
	@echo "Setting up $(VENV) (once; takes a minute)"
	@$(BIN)/python -m pip --version >/dev/null 2>&1 || $(PYTHON) -m venv --clear $(VENV)
	@PIP_DISABLE_PIP_VERSION_CHECK=1 $(BIN)/python -m pip install --quiet --editable '.[test,lint,figures]'
	@touch $(STAMP)

demo: setup
	@$(BIN)/python -m AIFReconLib demo --output "$(DEMO_OUTPUT)"

test: lint
	@$(BIN)/python -m pytest --quiet --cov --cov-report=term:skip-covered --cov-fail-under=90

slicer-test: setup
	@QT_QPA_PLATFORM=offscreen $(BIN)/python Testing/host/run_self_tests.py

screenshots: setup
	@QT_QPA_PLATFORM=offscreen $(BIN)/python Testing/host/screenshots.py

lint: setup
	@$(BIN)/python -m ruff check --quiet .
	@$(BIN)/python -m ruff format --quiet --check . || { echo "Run 'make format' and commit what it changes." >&2; exit 1; }

format: setup
	@$(BIN)/python -m ruff check --quiet --fix .
	@$(BIN)/python -m ruff format --quiet .

bench: setup
	@$(BIN)/python -m AIFReconLib benchmark

study: setup
	@$(BIN)/python -m AIFReconLib study --output "$(STUDY_OUTPUT)"

clean:
	rm -rf $(VENV) demo-output study-output htmlcov build dist .pytest_cache .ruff_cache .hypothesis .coverage *.egg-info
