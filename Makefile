# `make` sets up the environment, recovers the published coefficients, refits them and draws the
# maps; `make help` lists the rest.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
CYLCONTACT := $(BIN)/cylcontact

LOCKS := requirements.lock $(patsubst %,requirements-%.lock,test lint extras)
# Modules are compiled when they are first imported: most never are.
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile
SOURCES := $(shell find src/cylcontact -name '*.py')
BENCH := $(wildcard datasets/*.toml datasets/*.csv datasets/*/*.toml datasets/*/*.csv datasets/*/*.jsonl)
# Your own, named mine*, are for `cylcontact fit` and `cylcontact figure` alone.
CAMPAIGNS := $(filter-out fitting/mine%,$(wildcard fitting/*.toml))
RESULTS := $(CAMPAIGNS:fitting/%.toml=fitting/results/%.json)
RECIPES := $(filter-out reports/mine%,$(wildcard reports/*.py))
# First the published coefficients recovered, then all of them searched freely.
REFITS := $(patsubst %,build/%.json,recovered-internal recovered-external internal external)
# Figures 17 to 19 compile the mechanism, so they come first.
FIGURES := $(foreach number,17 18 19 02 03 04 05 06 07 08 09 10 11 12 13 14,fig$(number)) fig_choices

# Another user's Python packages must not leak into the environment.
unexport PYTHONHOME PYTHONPATH

.DELETE_ON_ERROR:
.PHONY: all committed env extras fits finite-element mechanism figures report claims verify \
	bench references explore notebooks notebooks-run docs test test-all test-long lint format lock clean distclean help FORCE

##@ The main job

all: build/comparison.txt build/report.html ## Set up, recover the coefficients, refit them, draw the figures (default)
	@cat build/comparison.txt
	@echo "The figures are in build/figures, each with its numbers as CSV and its caption."
	@echo "All of it on one page: build/report.html"

build/%.json: fitting/%.toml datasets/%.toml $(SOURCES) $(VENV)/.dependencies | $(VENV)/.editable
	@mkdir -p $(@D)
	$(CYLCONTACT) fit $< --jobs 1 -o $@

# Two fits at a time take less than one after the other with two workers each.
build/.refits: $(REFITS:build/%.json=fitting/%.toml) $(SOURCES) $(BENCH) | $(VENV)/.editable
	@$(MAKE) --no-print-directory --jobs=2 --output-sync $(REFITS)
	@touch $@

build/comparison.txt: build/.refits
	@$(CYLCONTACT) compare $(REFITS) > $@

build/.figures: build/.refits $(RECIPES)
	$(CYLCONTACT) figure $(FIGURES) -o build/figures
	$(CYLCONTACT) figure fig_refit result=build/internal.json -o build/figures
	@touch $@

build/report.html: build/comparison.txt build/.figures
	@$(CYLCONTACT) report --results build --figures build/figures -o $@

##@ Results and figures

fits: $(RESULTS) | committed ## Redo every committed fit and the study of choices, into fitting/results
	$(BIN)/python reports/choices.py

# A result names the commit that it came from, so the checkout must be as that commit has it.
committed: FORCE
	@changed=$$(git status --porcelain -- ':/' ':!fitting/results'); [ -z "$$changed" ] || { \
		echo "Commit these first, or stash them: a committed result says which commit it came" \
		"from." >&2; echo "$$changed" >&2; exit 1; }

# Always redone when asked for: a checkout's timestamps say nothing about what a result came from.
fitting/results/%.json: fitting/%.toml FORCE | committed $(VENV)/.editable
	$(CYLCONTACT) fit $< -o $@

# No files of make's own: a checkout's timestamps say nothing, and the figures, which read these
# tables, must not redo them. CalculiX solves the recommended set-up; the other studies vary it.
finite-element: $(VENV)/.editable ## Redo the finite elements' tables (some 20 minutes; needs CalculiX)
	set -e; for study in $(basename $(wildcard datasets/finite_element/*.toml)); do \
		$(CYLCONTACT) finite-element $$study.toml -o $$study-embedded.csv; done
	$(BIN)/python -m cylcontact.datasets.finite_element.lug datasets/finite_element/lug.csv
	$(BIN)/python -m benchmarks.calculix

# The paper's 24 cases and those of the explicit law.
mechanism: $(VENV)/.editable ## Redo datasets/mechanism/cases.csv, 1,000 revolutions of 32 cases (minutes)
	$(CYLCONTACT) sweep datasets/slider_crank.toml \
		--law lankarani-nikravesh,johnson,enhanced,explicit --radial-clearance 0.5,0.02 \
		--restitution 1,0.9 --friction 0,0.1 --revolutions 1000 --beyond tangent \
		-o datasets/mechanism/cases.csv

figures: build/.figures ## Draw the figures from this machine's fits, in build

report: build/report.html ## Write one page with coefficients, figures and claims

claims: $(VENV)/.editable ## Compare what the paper claims with our numbers
	$(CYLCONTACT) claims

verify: $(VENV)/.editable ## Fit afresh and compare with the committed results
	$(CYLCONTACT) verify

bench: $(VENV)/.extras ## Measure the speed against alternatives, write docs/validation.md (ten minutes)
	$(BIN)/python -m benchmarks

references: $(VENV)/.editable ## Print numbers of others beside ours
	$(BIN)/python -m benchmarks.references

##@ To read and to try

explore: $(VENV)/.kernel ## Explore the laws in a browser: a pair, its housing, a load
	$(BIN)/voila notebooks/3_explore.ipynb

notebooks: $(VENV)/.kernel ## Open the notebooks in JupyterLab
	$(BIN)/jupyter lab notebooks/1_quick_start.ipynb

# A kernel of its own name: no other Python on the machine can take its place.
$(VENV)/.kernel: $(VENV)/.extras
	@$(BIN)/python -m ipykernel install --sys-prefix --name cylcontact --display-name cylcontact
	@touch $@

notebooks-run: $(VENV)/.kernel ## Run the notebooks without a browser
	$(BIN)/python -m pytest --nbmake --nbmake-timeout=180 -n 2 notebooks

docs: $(VENV)/.extras ## Build the documentation, to read from build/docs/index.html
	$(CYLCONTACT) figure -o docs/figures --format png
	$(BIN)/python docs/results.py
	$(BIN)/mkdocs build --quiet --strict -d build/docs

##@ Checks

# Two workers, each with two threads for matrices, would wait for each other on two cores.
PYTEST := OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -p no:nbmake -p no:anyio -n logical --dist worksteal

test: $(VENV)/.test ## Run the tests that any change may break, and the examples in the docstrings
	$(PYTEST)

test-all: $(VENV)/.extras ## Run what make test leaves out or has skipped; none may skip now
	$(PYTEST) --rest -m "not long" --durations=40

test-long: $(VENV)/.extras ## Run killed commands, clusters, large grids and studies of many minutes
	$(PYTEST) -m long

lint: $(VENV)/.lint $(VENV)/.extras ## Check style, formatting and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: $(VENV)/.lint ## Rewrite the sources in the project's format
	$(BIN)/ruff check --fix-only .
	$(BIN)/ruff format .

##@ The environment

env: $(VENV)/.editable ## Set up the environment only; make PYTHON=python3.12 chooses the interpreter

# An interpreter named on the command line is used, even if the environment stands on another one.
ifeq ($(origin PYTHON),command line)
ifneq ($(shell cat $(VENV)/.dependencies 2>/dev/null),$(PYTHON))
$(VENV)/.dependencies: FORCE
endif
endif

# The stamp is written last, so an interrupted install is simply redone.
$(VENV)/.dependencies: requirements.lock
	@command -v "$(PYTHON)" >/dev/null || { echo "There is no '$(PYTHON)' here;" \
		"name a Python 3.11 or newer, for example: make PYTHON=python3.12" >&2; exit 1; }
	@"$(PYTHON)" -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else \
		"$(PYTHON) is Python %d.%d.%d, and 3.11 or newer is needed;" % sys.version_info[:3] + \
		" name one, for example: make PYTHON=python3.12")'
	@"$(PYTHON)" -c 'import ensurepip, venv' 2>/dev/null || { echo "$(PYTHON) cannot make virtual" \
		"environments; on Debian and Ubuntu: apt install python3-venv" >&2; exit 1; }
	@echo "Installing the pinned dependencies in $(VENV) (half a minute) ..."
	@"$(PYTHON)" -m venv --clear $(VENV)
	@$(PIP) --require-hashes -r requirements.lock || { echo "The install did not finish:" \
		"the reason is above; once it is mended, the same make command resumes." >&2; exit 1; }
	@echo "$(PYTHON)" > $@

extras: $(VENV)/.extras ## Add what all tests, notebooks, the documentation, a cluster and peers need

$(VENV)/.test $(VENV)/.lint $(VENV)/.extras: $(VENV)/.%: requirements-%.lock $(VENV)/.dependencies | $(VENV)/.editable
	@echo "Adding requirements-$*.lock to $(VENV) ..."
	@$(PIP) --require-hashes -r $<
	@touch $@

# The build backend is in the lock, so this step needs no network.
$(VENV)/.editable: pyproject.toml $(VENV)/.dependencies
	@$(PIP) --no-build-isolation --no-deps -e .
	@touch $@

# The locks hold the same versions, each more packages than the first.
UV_COMPILE = build/lock-tools/bin/uv pip compile pyproject.toml --group build --universal \
	--generate-hashes --python-version 3.11 --custom-compile-command "make lock" --no-config \
	--quiet $(UPGRADE)

lock: ## Pin the dependencies anew in the locks; make lock UPGRADE=--upgrade for the latest
	@mkdir -p build
	@"$(PYTHON)" -m venv --clear build/lock-tools
	@build/lock-tools/bin/python -m pip install --quiet --disable-pip-version-check uv
	@cp $(LOCKS) build
	$(UV_COMPILE) -o build/requirements.lock
	set -e; for group in test lint; do \
		$(UV_COMPILE) --group $$group -c build/requirements.lock -o build/requirements-$$group.lock; done
	$(UV_COMPILE) --all-extras --group dev -c build/requirements-test.lock -c build/requirements-lint.lock \
		-o build/requirements-extras.lock
	@mv $(LOCKS:%=build/%) .

clean: ## Remove what the commands above made: fits, figures, tables, caches
	rm -rf build dist datasets/generated docs/figures docs/figures.md docs/claims.md
	rm -rf .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find src tests reports -name __pycache__ -type d -prune -exec rm -rf {} +

distclean: clean ## Remove the environment as well
	rm -rf $(VENV)

help: ## Show this list
	@awk 'BEGIN { FS = ":.*## " } /^##@ / { printf "\n%s\n", substr($$0, 5) } \
		/^[a-z-]+:.*## / { printf "  make %-14s %s\n", $$1, $$2 }' Makefile
