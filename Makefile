# Every target works alone on a fresh machine: Python >= 3.11, make and a package index.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
# Bytecode is kept, whatever the shell says: without it every command compiles all that it imports (a diagnosis: 3 s).
export PYTHONDONTWRITEBYTECODE :=

.PHONY: blind-ci setup demo test lint interop docs clean lock
setup: $(STAMP)

$(STAMP): requirements.txt pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "lostmotion needs Python >= 3.11, this is " + sys.version.split()[0])'
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --require-hashes -r requirements.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	touch $@

demo: setup
	$(BIN)/lostmotion demo

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# THOROUGH=1, as in CI, adds the tests that take seconds each and the forty frozen blind trials.
test: lint
	$(BIN)/python -m pytest -n 2 --dist worksteal -m "not interop$(if $(THOROUGH),, and not thorough)"
	$(if $(THOROUGH),$(BIN)/python bench/blind_ci.py)

docs: setup
	$(BIN)/lostmotion explain --markdown > docs/effects.md
	$(BIN)/lostmotion gallery

blind-ci: setup
	$(BIN)/python bench/blind_ci.py

interop: setup
	$(BIN)/python -m pytest -m interop -rs

lock: setup
	$(BIN)/python -m pip install --quiet pip-tools
	$(BIN)/pip-compile --quiet --generate-hashes --extra dev --strip-extras --allow-unsafe \
	  --no-emit-index-url --no-emit-trusted-host --no-emit-find-links --no-header \
	  --output-file requirements.txt pyproject.toml

clean:
	rm -rf $(VENV) .pytest_cache .mypy_cache .ruff_cache
