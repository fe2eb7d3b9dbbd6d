# Everything sets itself up on a machine with Python 3.11 or newer and nothing else; uv is used where it is there.
#   PYTHON=python3.12 make test      another Python than the one that .ci/setup finds
#   MUJOCO=3.12.0 make test          another MuJoCo than the pinned one
#   PYTEST_ARGS="-k arm -x"          other arguments for pytest

VENV ?= .venv
PYTEST_ARGS ?= -n auto
ifeq ($(OS),Windows_NT)
BIN := $(VENV)/Scripts
else
BIN := $(VENV)/bin
endif
STAMP := $(VENV)/.ready$(if $(MUJOCO),-mujoco-$(MUJOCO))
# The same environment without tests and linters, which a demo does not need; what wants those completes it.
LIGHT := $(VENV)/.light$(if $(MUJOCO),-mujoco-$(MUJOCO))

.PHONY: demo test test-all test-usd foreign lint format bench fidelity schemas constraints clean
.DELETE_ON_ERROR:

demo: $(if $(wildcard $(STAMP)),$(STAMP),$(LIGHT))
	@$(BIN)/mjcompose build recipes/demo.yaml -o build/demo.zip
	@echo "The bundle is build/demo.zip: model.xml, its assets, the licences of its parts and manifest.json."
	@echo "Look at it:  unzip -o -q build/demo.zip -d build/demo && $(BIN)/python -m mujoco.viewer --mjcf=build/demo/model.xml"

# The tests that take at most a few seconds each.
test: $(STAMP)
	@$(BIN)/python -m pytest $(PYTEST_ARGS) -m "not slow"

# These, and then the slow ones: whole sets of real models, and what starts other programs.
test-all: test
	@$(BIN)/python -m pytest $(PYTEST_ARGS) -m slow

# The tests of USD, in an environment of their own: the converter wants an older MuJoCo and Python 3.12 or older.
test-usd:
	@[ -e .venv-usd/.ready ] || { \
	  for python in $(PYTHON) python3.12 python3.11 python3; do $$python -c 'import ensurepip, sys; sys.exit(sys.version_info >= (3, 13))' 2>/dev/null && break; done; \
	  VENV=.venv-usd MUJOCO=3.16.0 EXTRAS=test,usd PYTHON=$$python bash .ci/setup && touch .venv-usd/.ready; }
	@.venv-usd/bin/python -m pytest tests/bundle/test_usd.py

# Other projects' tests and models, with mjcompose. The packages come from PyPI, into build/foreign; what cannot be had is
# skipped, with the reason.
#   FOREIGN_ARGS=--write             the numbers into docs/fidelity.md
foreign: $(STAMP)
	@$(BIN)/python tests/foreign/run.py $(FOREIGN_ARGS)

lint: $(STAMP)
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports --no-logo

format: $(STAMP)
	$(BIN)/ruff check --fix
	$(BIN)/ruff format

bench: $(STAMP)
	@$(BIN)/python -m bench

# Everything against MuJoCo, into docs/fidelity.md; models from MJCOMPOSE_CORPUS, dm_control where it is installed.
#   FIDELITY_ARGS="--sample 10"      every tenth of each set, nothing written
FIDELITY_ARGS ?= --write
fidelity: $(STAMP)
	@$(BIN)/python tests/fidelity/run.py $(FIDELITY_ARGS)

schemas: $(STAMP)
	@for what in recipe manifest; do \
	  $(BIN)/mjcompose schema $$what > build/$$what.schema.json && mv build/$$what.schema.json schemas/ || exit 1; \
	done
	@$(BIN)/mjcompose schema reference > build/reference.md && mv build/reference.md docs/

# Pins of every test dependency for every supported Python; needs uv.
constraints:
	uv pip compile --quiet --universal --python-version 3.11 --no-header --no-annotate --no-emit-index-url \
	  --no-emit-find-links --upgrade --extra test --extra dev --extra menagerie pyproject.toml --output-file constraints.txt

clean:
	rm -rf $(VENV) .venv-usd build dist .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis

$(LIGHT): pyproject.toml constraints.txt .ci/setup
	@VENV="$(VENV)" MUJOCO="$(MUJOCO)" EXTRAS=menagerie bash .ci/setup
	@touch $@
	@mkdir -p build

$(STAMP): pyproject.toml constraints.txt .ci/setup
	@add=; [ ! -e $(LIGHT) ] || [ -n "$$(find $^ -newer $(LIGHT))" ] || add=1; \
	  VENV="$(VENV)" MUJOCO="$(MUJOCO)" ADD=$$add bash .ci/setup
	@rm -f $(VENV)/.ready* && touch $@
	@mkdir -p build
