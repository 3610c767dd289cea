# For developers and first visits: `make demo`, `make test`. The library itself needs no make; see README.md.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# The demo needs less than half of what the tests need
DEMO_STAMP := $(VENV)/.installed-for-demo
STAMP := $(VENV)/.installed
TOOK := $(VENV)/.seconds-of-test
DEMO_OUTPUT ?= demo-output
STUDY_OUTPUT ?= study-output
REAL_BONE_OUTPUT ?= real-bone-output
FUZZ_SECONDS ?= 600
FAULTS_SECONDS ?= 3600
# As the command line does: see AIFReconLib/machine/processes.py
export OPENBLAS_NUM_THREADS ?= 1
# Tests of the module wait much: one process more than processors
SPREAD := --numprocesses=$$(($$(getconf _NPROCESSORS_ONLN) + 1)) --dist=worksteal

.DEFAULT_GOAL := help
.PHONY: help setup demo test coverage slicer-test figures docs lint format wheel-test bench study real-bone soak fuzz faults clean

help:
	@echo "make demo         reconstruct a simulated lumbar scan and draw it, into $(DEMO_OUTPUT)/"
	@echo "make test         lint, format check, types and all tests"
	@echo "make coverage     all tests, and which lines of the library they run"
	@echo "make slicer-test  only the self tests of the Slicer module, on real MRML nodes and Qt, without Slicer"
	@echo "make figures      the pictures of docs/parameters.md and the bone in 3D, into docs/images/ (minutes)"
	@echo "make docs         the site with its gallery and API reference, into build/site/ (minutes)"
	@echo "make wheel-test   build wheel and source, check them, and run the README's Python lines in an empty environment"
	@echo "make setup        install what all of these need, into $(VENV)/"
	@echo "make lint         only lint, format check, types and workflows"
	@echo "make format       reformat the code"
	@echo "make bench        measure the speed of this machine, and renew the tables of docs/performance.md"
	@echo "make study        compare all methods, register CTs, mend calibrations, scan by guidance and find bone in CTs, into $(STUDY_OUTPUT)/ and the pages (two hours)"
	@echo "make real-bone    compare all methods on a recorded sweep of real bone with its CT, into $(REAL_BONE_OUTPUT)/ and the pages (half an hour)"
	@echo "make soak         an hour of live reconstruction from a server that fails at random, in simulated time (half an hour)"
	@echo "make faults       kill what records and writes sequences, at random, for FAULTS_SECONDS ($(FAULTS_SECONDS)); nothing may be lost (Linux, best as root)"
	@echo "make fuzz         damage input on purpose for FUZZ_SECONDS ($(FUZZ_SECONDS)); only clear refusals may come out"
	@echo "make clean        remove $(VENV)/ and everything that was built"

setup: $(STAMP)

# A broken or half-made environment (an interrupted set-up, a Python that was upgraded, a folder that was moved) is made anew
ifneq ($(shell $(BIN)/python -m pip --version >/dev/null 2>&1 && $(BIN)/python -c 'import AIFReconLib' >/dev/null 2>&1 && echo whole),whole)
.PHONY: $(DEMO_STAMP) $(STAMP)
endif

# Otherwise installed again only when pyproject.toml changes
$(DEMO_STAMP): EXTRAS := figures,fast
$(STAMP): EXTRAS := test,lint,figures
$(DEMO_STAMP) $(STAMP): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' \
	  || { echo "AIFRecon needs Python 3.10 or newer. Name one with: make PYTHON=python3.12 $(MAKECMDGOALS)" >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null \
	  || { echo "Python cannot make virtual environments here. Install them with: sudo apt install python3-venv" >&2; exit 1; }
	@echo "Setting up $(VENV) with $(EXTRAS) (once; a minute or more)"
	@$(BIN)/python -m pip --version >/dev/null 2>&1 || $(PYTHON) -m venv --clear $(VENV)
	@PIP_DISABLE_PIP_VERSION_CHECK=1 $(BIN)/python -m pip install --quiet --use-pep517 --editable '.[$(EXTRAS)]'
	@touch $(DEMO_STAMP) $@

demo: $(DEMO_STAMP)
	@$(BIN)/python -m AIFReconLib demo --output "$(DEMO_OUTPUT)"

# Says first how long it takes: as long as the last time, or else ten minutes of one core
test: setup
	@seconds=$$(cat $(TOOK) 2>/dev/null || echo $$((600 / $$(getconf _NPROCESSORS_ONLN) + 60))); \
	  echo "This takes about $$(((seconds + 59) / 60)) min here"; begin=$$(date +%s); \
	  $(MAKE) --no-print-directory lint && $(BIN)/python -m pytest --quiet $(SPREAD) && \
	  echo $$(($$(date +%s) - begin)) > $(TOOK)

# A third slower than `make test`, which therefore does without
coverage: setup
	@$(BIN)/python -m pytest --quiet $(SPREAD) --cov --cov-report=term:skip-covered --cov-fail-under=90

slicer-test: setup
	@QT_QPA_PLATFORM=offscreen $(BIN)/python Testing/host/run_self_tests.py

figures: setup
	@$(BIN)/python Testing/figures/parameters.py
	@$(BIN)/python Testing/figures/shown_bone.py
	@$(BIN)/python Testing/figures/motion.py

lint: setup
	@$(BIN)/python -m ruff check --quiet .
	@$(BIN)/python -m ruff format --quiet --check . || { echo "Run 'make format' and commit what it changes." >&2; exit 1; }
	@$(BIN)/python -m mypy --no-error-summary
	@! test -x $(BIN)/actionlint || $(BIN)/actionlint -no-color .github/workflows/*.yml

# Warnings are errors, a name or a link that leads nowhere is one
docs: setup
	@PIP_DISABLE_PIP_VERSION_CHECK=1 $(BIN)/python -m pip install --quiet --use-pep517 --editable '.[docs,figures]'
	@$(BIN)/python -m sphinx --conf-dir docs/site --builder html --nitpicky --fail-on-warning --keep-going --quiet . build/site
	@$(BIN)/python docs/site/links.py build/site
	@echo "look at   build/site/index.html"

wheel-test: setup
	@PIP_DISABLE_PIP_VERSION_CHECK=1 $(BIN)/python -m pip install --quiet --use-pep517 --editable '.[release]'
	@rm -rf dist && $(BIN)/python -m build --outdir dist . >/dev/null
	@$(BIN)/python -m twine check --strict dist/*
	@$(BIN)/python Testing/release/wheel.py dist/*.whl

format: setup
	@$(BIN)/python -m ruff check --quiet --fix .
	@$(BIN)/python -m ruff format --quiet .

# Full runs of bench, study and real-bone renew docs/measured and the pages. More or less of it: make bench BENCH="--quick". Others: BENCH=live, a session; BENCH=spine, 5,000 frames from file to file, which takes 3 GB
# of disk, 11 of memory and minutes
bench: setup
	@$(BIN)/python Testing/benchmark $(or $(BENCH),--pages)
	@$(if $(BENCH),,$(BIN)/python Testing/benchmark commands --pages)

study: setup
	@$(BIN)/python Testing/study methods --pages --output "$(STUDY_OUTPUT)"
	@$(BIN)/python Testing/study registration --pages --output "$(STUDY_OUTPUT)/registration"
	@$(BIN)/python Testing/study guidance --pages --output "$(STUDY_OUTPUT)/guidance"
	@$(BIN)/python Testing/study calibration --pages --output "$(STUDY_OUTPUT)/calibration"
	@$(BIN)/python Testing/study looks --pages --output "$(STUDY_OUTPUT)/looks"
	@$(BIN)/python Testing/study paths --pages --output "$(STUDY_OUTPUT)/paths"
	@$(BIN)/python Testing/study motion --pages --output "$(STUDY_OUTPUT)/motion"
	@$(BIN)/python Testing/study ct_bone --output "$(STUDY_OUTPUT)/ct-bone"

# Not run by continuous integration: the recording is not part of the project
real-bone: setup
	@$(BIN)/python Testing/study real_bone --pages --output "$(REAL_BONE_OUTPUT)"

# Shorter, or with other faults: make soak SOAK="--minutes 5 --seed 7"
soak: setup
	@$(BIN)/python Testing/soak $(SOAK)

# Not run by continuous integration; that runs a few of each kind
faults: setup
	@cd Testing && ../$(BIN)/python -m faults --pages --seconds $(FAULTS_SECONDS)

# Not run by continuous integration; that reads a few inputs of each kind
fuzz: setup
	@$(BIN)/python Testing/fuzz --seconds $(FUZZ_SECONDS)

clean:
	rm -rf $(VENV) demo-output study-output real-bone-output htmlcov build dist .pytest_cache .ruff_cache .mypy_cache .hypothesis .coverage *.egg-info
