# `make` sets up the environment, fits the law, draws the figures and writes the report; `make help`
# lists the rest. What has no target here is a command: `cylcontact --help`.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
CYLCONTACT := $(BIN)/cylcontact

# Versions and hashes of all packages are in one lock; a step installs those that it needs.
LOCKED := requirements.lock
UV = $(BIN)/uv pip install --quiet --python $(BIN)/python --require-hashes -c $(LOCKED) -r pyproject.toml
SOURCES := $(shell find src/cylcontact -name '*.py')
DATA := $(wildcard datasets/*.toml datasets/*.csv datasets/*/*.toml datasets/*/*.csv datasets/*/*.jsonl)
# Your own, named mine*, are for `cylcontact fit` and `cylcontact figure` alone.
CAMPAIGNS := $(filter-out fitting/mine%,$(wildcard fitting/*.toml))
RESULTS := $(CAMPAIGNS:fitting/%.toml=fitting/results/%.json)
RECIPES := $(filter-out reports/mine%,$(wildcard reports/*.py))
# First the published coefficients recovered, then all of them searched freely.
REFITS := $(patsubst %,build/%.json,recovered-internal recovered-external internal external)
# Figures 17 to 19 compile the mechanism, so they come first.
FIGURES := $(foreach number,17 18 19 02 03 04 05 06 07 08 09 10 11 12 13 14,fig$(number)) fig_choices

# Another user's Python packages must not leak into the environment. Without compiled files on disk,
# each process would compile numpy, scipy and the tests anew.
unexport PYTHONHOME PYTHONPATH PYTHONDONTWRITEBYTECODE

.DELETE_ON_ERROR:
.PHONY: all figures docs explore notebooks test clean extras test-all lint format fits bench lock committed help FORCE

##@ The main job

all: build/comparison.txt build/report.html ## Set up, fit the paper's law, draw its figures, write the report (default)
	@cat build/comparison.txt
	@echo "The figures are in build/figures, each with its numbers as CSV and its caption."
	@echo "All of it on one page: build/report.html"

build/%.json: fitting/%.toml datasets/%.toml $(SOURCES) $(VENV)/.dependencies | $(VENV)/.editable
	@mkdir -p $(@D)
	$(CYLCONTACT) fit $< --jobs 1 -o $@

# Two fits at a time take less than one after the other with two workers each.
build/.refits: $(REFITS:build/%.json=fitting/%.toml) $(SOURCES) $(DATA) | $(VENV)/.editable
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

figures: build/.figures ## Draw the figures from this machine's fits, in build/figures

docs: $(VENV)/.docs ## Build the documentation, to read from build/docs/index.html
	$(CYLCONTACT) figure -o docs/figures --format png
	$(BIN)/python docs/results.py
	$(BIN)/mkdocs build --quiet --strict -d build/docs

explore: $(VENV)/.kernel ## Explore the laws in a browser: a pair, its housing, a load
	$(BIN)/voila notebooks/3_explore.ipynb

notebooks: $(VENV)/.kernel ## Open the notebooks in JupyterLab
	$(BIN)/jupyter lab notebooks/1_quick_start.ipynb

# A kernel of its own name: no other Python on the machine can take its place.
$(VENV)/.kernel: $(VENV)/.notebooks
	@$(BIN)/python -m ipykernel install --sys-prefix --name cylcontact --display-name cylcontact
	@touch $@

# Two workers, each with two threads for matrices, would wait for each other on two cores.
PYTEST := OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -p no:nbmake -p no:anyio -n logical --dist worksteal

test: $(VENV)/.test ## Run the tests that any change may break, and the examples in the docstrings
	$(PYTEST)

# A user's fit beside its table is never deleted.
clean: ## Remove what the commands above made
	rm -rf build dist datasets/generated docs/figures docs/figures.md docs/claims.md
	rm -rf .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find src tests reports -name __pycache__ -type d -prune -exec rm -rf {} +

##@ For developers

extras: $(VENV)/.extras ## Add what all tests, notebooks, the documentation, a cluster and peers need

test-all: $(VENV)/.extras ## Run what make test leaves out or has skipped; none may skip now
	$(PYTEST) --rest -m "not long" --durations=40

lint: $(VENV)/.extras ## Check style, formatting and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: $(VENV)/.extras ## Rewrite the sources in the project's format
	$(BIN)/ruff check --fix-only .
	$(BIN)/ruff format .

fits: $(RESULTS) | committed ## Redo every committed fit and the study of choices, into fitting/results
	$(BIN)/python reports/choices.py

# A result says what it came from, so the checkout must be as its commit has it.
committed: FORCE
	@changed=$$(git status --porcelain -- ':/' ':!fitting/results'); [ -z "$$changed" ] || { \
		echo "Commit these first, or stash them: a committed result says which commit it came" \
		"from." >&2; echo "$$changed" >&2; exit 1; }

# Always redone when asked for: a checkout's timestamps say nothing about what a result came from.
fitting/results/%.json: fitting/%.toml FORCE | committed $(VENV)/.editable
	$(CYLCONTACT) fit $< -o $@

bench: $(VENV)/.extras ## Measure the speed against alternatives, write docs/validation.md (ten minutes)
	$(BIN)/python -m benchmarks

lock: ## Pin the dependencies anew; make lock UPGRADE=--upgrade for the latest
	$(BIN)/uv pip compile pyproject.toml --all-extras --group dev --universal --generate-hashes \
		--python-version 3.11 --custom-compile-command "make lock" --no-config --quiet $(UPGRADE) -o $(LOCKED)

help: ## Show this list
	@awk 'BEGIN { FS = ":.*## " } /^##@ / { printf "\n%s\n", substr($$0, 5) } \
		/^[a-z-]+:.*## / { printf "  make %-10s %s\n", $$1, $$2 }' Makefile

# The environment. `make PYTHON=python3.12` chooses the interpreter.

# An interpreter named on the command line is used, even if the environment stands on another one.
ifeq ($(origin PYTHON),command line)
ifneq ($(shell cat $(VENV)/.dependencies 2>/dev/null),$(PYTHON))
$(VENV)/.dependencies: FORCE
endif
endif

# pip installs uv, which installs the rest in half the time. The stamp is written last, so an
# interrupted install is simply redone.
$(VENV)/.dependencies: $(LOCKED)
	@command -v "$(PYTHON)" >/dev/null || { echo "There is no '$(PYTHON)' here;" \
		"name a Python 3.11 or newer, for example: make PYTHON=python3.12" >&2; exit 1; }
	@"$(PYTHON)" -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else \
		"$(PYTHON) is Python %d.%d.%d, and 3.11 or newer is needed;" % sys.version_info[:3] + \
		" name one, for example: make PYTHON=python3.12")'
	@"$(PYTHON)" -c 'import ensurepip, venv' 2>/dev/null || { echo "$(PYTHON) cannot make virtual" \
		"environments; on Debian and Ubuntu: apt install python3-venv" >&2; exit 1; }
	@echo "Installing the pinned dependencies in $(VENV) ..."
	@"$(PYTHON)" -m venv --clear $(VENV)
	@sed -n '/^uv==/,/[^\]$$/p' $(LOCKED) > $(VENV)/uv.txt
	@{ $(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r $(VENV)/uv.txt && \
		$(UV) --group build; } || { echo "The install did not finish: the reason is above (behind a" \
		"package mirror, set UV_DEFAULT_INDEX to its address). The same make command resumes." >&2; exit 1; }
	@echo "$(PYTHON)" > $@

# The build backend is installed, so this step needs no network.
$(VENV)/.editable: pyproject.toml $(VENV)/.dependencies
	@$(BIN)/uv pip install --quiet --python $(BIN)/python --no-build-isolation --no-deps -e .
	@touch $@

GROUPS_test := --group test
GROUPS_docs := --extra docs
GROUPS_notebooks := --extra notebooks
GROUPS_extras := --all-extras --group dev
$(patsubst %,$(VENV)/.%,test docs notebooks extras): $(VENV)/.%: $(VENV)/.dependencies | $(VENV)/.editable
	@echo "Adding the packages of '$*' to $(VENV) ..."
	@$(UV) --group build $(GROUPS_$*)
	@touch $@
