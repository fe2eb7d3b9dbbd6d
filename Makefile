# Everything sets itself up on a machine with Python 3.11 or newer and nothing else; uv is used where it is there.
#   PYTHON=python3.12 make test      another Python than the one that .ci/setup finds
#   MUJOCO=3.11.0 make test          another MuJoCo than the pinned one
#   PYTEST_ARGS="-k arm -x"          other arguments for pytest

VENV ?= .venv
PYTEST_ARGS ?= -n auto --dist worksteal
# A container often sets this, and every program that tests start would compile all of mjcompose anew.
unexport PYTHONDONTWRITEBYTECODE
ifeq ($(OS),Windows_NT)
BIN := $(VENV)/Scripts
else
BIN := $(VENV)/bin
endif
STAMP := $(VENV)/.ready$(if $(MUJOCO),-mujoco-$(MUJOCO))
# The same environment without tests and linters, which a demo does not need; what wants those completes it.
LIGHT := $(VENV)/.light$(if $(MUJOCO),-mujoco-$(MUJOCO))

# With what slow tests alone need.
SLOW := $(VENV)/.slow$(if $(MUJOCO),-mujoco-$(MUJOCO))

.PHONY: demo setup test test-slow test-all test-usd test-worlds test-targets test-oldest foreign fuzz kills audit lint lint-style lint-types lint-page format docs wheel bench fidelity schemas constraints vscode clean
.DELETE_ON_ERROR:

demo: $(if $(wildcard $(STAMP)),$(STAMP),$(LIGHT))
	@$(BIN)/mjcompose build recipes/demo.yaml -o build/demo.zip
	@echo "The bundle is build/demo.zip: model.xml, its assets, the licenses of its parts and manifest.json."
	@$(BIN)/mjcompose view build/demo.zip --html build/demo.html -q
	@$(BIN)/mjcompose render recipes/demo.yaml -o build/demo.png || echo "Without OpenGL there is no picture; the page needs none."
	@echo "Look at it:  $(BIN)/mjcompose view recipes/demo.yaml     or open build/demo.html"

# All that `make test-all` and `make lint` need.
setup: $(SLOW)

# The tests that take at most a few seconds each.
test: $(STAMP)
	@$(BIN)/python -m pytest $(PYTEST_ARGS) -m "not slow"

# The slow ones: whole sets of real models, and what starts other programs, such as a cluster.
test-slow: $(SLOW)
	@$(BIN)/python -m pytest $(PYTEST_ARGS) -m slow

# All, in one go: workers start once, and those that are done take over from the others.
test-all: $(SLOW)
	@$(BIN)/python -m pytest $(PYTEST_ARGS)

# The tests of USD, in an environment of their own: the converter wants an older MuJoCo and Python 3.12 or older.
test-usd:
	@[ -e .venv-usd/.ready ] || { \
	  for python in $(PYTHON) python3.12 python3.11 python3; do $$python -c 'import ensurepip, sys; sys.exit(sys.version_info >= (3, 13))' 2>/dev/null && break; done; \
	  VENV=.venv-usd MUJOCO=3.16.0 EXTRAS=test,usd PYTHON=$$python bash .ci/setup && touch .venv-usd/.ready; }
	@.venv-usd/bin/python -m pytest tests/bundle/test_write.py

# The tests of worlds in simulators, and the guides that need such packages: MuJoCo Warp, MJX and playground in one environment, mjlab, which pins MuJoCo 3.11, in another.
test-worlds: $(STAMP)
	@for name in simulators mjlab; do [ -e build/$$name/.ready ] || { \
	  packages="mujoco-warp mujoco-mjx playground brax pyarrow pillow"; [ $$name = simulators ] || packages="mjlab==1.6.0"; \
	  $(BIN)/python -m venv build/$$name && build/$$name/bin/pip install --quiet pytest pytest-timeout . $$packages && \
	  touch build/$$name/.ready; } || exit 1; done
	@build/simulators/bin/pip install --quiet --no-deps robosuite
	@build/simulators/bin/python -m pytest tests/tools/worlds
	@build/simulators/bin/python -m pytest tests/docs/test_pages.py -k "train or mjspec or open_in_mujoco"
	@build/mjlab/bin/python -m pytest tests/tools/worlds/test_mjlab.py tests/tools/worlds/test_warp.py

# What other programs read of what `build --target` writes for them. They come from PyPI, each into an environment of its own below
# build/consumers (8 GB, and more where PyTorch comes with CUDA); what cannot be had is skipped, with the reason.
#   MENAGERIE_ROOT=…                 with the robots of Menagerie
test-targets: $(STAMP)
	@$(BIN)/python tests/targets/environments.py
	@$(BIN)/python -m pytest tests/targets/test_consumers.py tests/urdf/test_survey.py

# URDF on the oldest MuJoCo that builds, whose own reader loses more than newer ones: the tests, and robots of others beside Pinocchio. What
# cannot be had from PyPI is skipped.
OLDEST := 3.11.0
test-oldest: $(STAMP)
	@[ -e .venv-oldest/.ready ] || { \
	  VENV=.venv-oldest MUJOCO=$(OLDEST) EXTRAS=test PYTHON=$(BIN)/python bash .ci/setup && touch .venv-oldest/.ready; }
	@$(BIN)/python tests/targets/environments.py robots pinocchio
	@.venv-oldest/bin/python -m pytest tests/urdf tests/targets/test_urdf.py

# Other projects' tests and models, with mjcompose. The packages come from PyPI, into build/foreign; what cannot be had is
# skipped, with the reason.
#   FOREIGN_ARGS=--write             the numbers into docs/contributing/fidelity.md
#   FOREIGN_ARGS="--sample 12"       at most twelve models of each suite
foreign: $(STAMP)
	@$(BIN)/python tests/foreign/run.py $(FOREIGN_ARGS)

# Hostile input, made up from the project's recipes and models and those of MJCOMPOSE_CORPUS; what is wrong is kept in build/fuzz.
#   FUZZ_ARGS="--seconds 60 --seed 1 --targets recipe mjcf"
fuzz: $(STAMP)
	@$(BIN)/python tests/fuzz/run.py $(FUZZ_ARGS)

lint: lint-style lint-types lint-page

lint-style: $(STAMP)
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/lint-imports --no-logo
	$(BIN)/bandit --quiet --configfile pyproject.toml --recursive composer
	$(BIN)/codespell
	@$(BIN)/python .ci/english

lint-types: $(STAMP)
	$(BIN)/mypy

# The TypeScript and CSS of the page of `view` and of the extension for VS Code, by Biome; skipped, with the reason, where npm cannot be had.
lint-page:
	.ci/page ci

# Known weaknesses of what mjcompose needs, by pip-audit, in an environment of its own. It asks PyPI, and fails without an answer.
audit: $(STAMP)
	@[ -e build/audit/bin/pip-audit ] || { $(BIN)/python -m venv build/audit && build/audit/bin/pip install --quiet pip-audit; }
	build/audit/bin/pip-audit --strict --requirement constraints.txt --no-deps --disable-pip

# Builds of every kind of output, ended with `kill -9` at random moments.
#   KILLS_ARGS="--kills 100 --seed 1"
kills: $(STAMP)
	@$(BIN)/python tests/kills/run.py $(KILLS_ARGS)

format: $(STAMP)
	$(BIN)/ruff check --fix
	$(BIN)/ruff format
	.ci/page check --write

bench: $(STAMP)
	@$(BIN)/python -m bench

# Everything against MuJoCo, into docs/contributing/fidelity.md; models from MJCOMPOSE_CORPUS, dm_control where it is installed.
#   FIDELITY_ARGS="--sample 10"      every tenth of each set, nothing written
FIDELITY_ARGS ?= --write
fidelity: $(STAMP)
	@$(BIN)/python tests/fidelity/run.py $(FIDELITY_ARGS)

# The site of the docs, in build/site: it works from its files, without a server. Zensical and mkdocstrings are installed into build/docs; npm is needed.
docs: $(STAMP)
	@[ -e build/docs/.ready ] || { $(BIN)/python -m venv build/docs && \
	  build/docs/bin/pip install --quiet zensical mkdocstrings-python && touch build/docs/.ready; }
	@PATH="$(CURDIR)/build/docs/bin:$$PATH" $(BIN)/python .ci/site

# What is published, in dist.
wheel: $(STAMP)
	@[ -e build/wheel/bin/pyproject-build ] || { $(BIN)/python -m venv build/wheel && build/wheel/bin/pip install --quiet build; }
	@rm -rf dist && build/wheel/bin/python -m build --outdir dist

schemas: $(STAMP)
	@for what in recipe manifest diagnostics; do \
	  $(BIN)/mjcompose schema $$what > build/$$what.schema.json && mv build/$$what.schema.json schemas/ || exit 1; \
	done
	@$(BIN)/python -m mjcompose.language.reference_page docs/reference/keys
	@$(BIN)/python .ci/rule_index.py docs/rules
	@$(BIN)/python .ci/element_stub.py
	@$(BIN)/python .ci/model_types.py
	@$(BIN)/python -m mjcompose.targets.table
	@$(BIN)/python .ci/datasheet_table.py docs/how-to/actuators.md
	@$(BIN)/python -m mjcompose.language.reference_page > build/key_order.json && mv build/key_order.json composer/mjcompose/text/

# Pins of every test dependency for every supported Python; needs uv.
constraints:
	uv pip compile --quiet --universal --python-version 3.11 --no-header --no-annotate --no-emit-index-url \
	  --no-emit-find-links --upgrade --extra test --extra dev --extra menagerie --extra slow pyproject.toml --output-file constraints.txt

# The extension for VS Code, build/mjcompose-VERSION.vsix; needs npm.
vscode:
	@mkdir -p build && cd editors/vscode && npm ci --no-audit --no-fund --loglevel=error && npm run --silent package -- --out ../../build/
	@echo "Install it:  code --install-extension $$(ls -t build/mjcompose-*.vsix | head -1)"

clean:
	rm -rf $(VENV) .venv-usd build dist .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis

$(LIGHT): pyproject.toml constraints.txt .ci/setup
	@VENV="$(VENV)" MUJOCO="$(MUJOCO)" EXTRAS=menagerie bash .ci/setup
	@touch $@
	@mkdir -p build

$(SLOW): $(STAMP)
	@VENV="$(VENV)" MUJOCO="$(MUJOCO)" EXTRAS=test,dev,menagerie,slow ADD=1 bash .ci/setup
	@touch $@

$(STAMP): pyproject.toml constraints.txt .ci/setup
	@add=; [ ! -e $(LIGHT) ] || [ -n "$$(find $^ -newer $(LIGHT))" ] || add=1; \
	  VENV="$(VENV)" MUJOCO="$(MUJOCO)" ADD=$$add bash .ci/setup
	@rm -f $(VENV)/.ready* && touch $@
	@mkdir -p build
