# `make run` and `make test` need Python 3.11 or later and nothing else; both make the environment,
# each with what it needs itself.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check install --quiet --constraint constraints.txt
# uv installs in a quarter of pip's time; where it finds no index that pip is configured for, pip does.
UV := $(BIN)/uv pip install --quiet --link-mode copy --compile-bytecode --constraint constraints.txt
COMMA := ,
INSTALL = $(UV) --editable '.[$(1)]' || $(PIP) --editable '.[$(1)]'
RUNNING := $(VENV)/.running
SERVING := $(VENV)/.serving
TESTING := $(VENV)/.testing
FIGURE := fig-5-1

.PHONY: run test test-all night check docs serve clean

run: $(RUNNING)
	$(BIN)/vibrafeed run configs/nut.toml -o results/nut.nc --force
	$(BIN)/vibrafeed plot results/nut.nc -o results/nut.png --force
	$(BIN)/vibrafeed run configs/figures/$(FIGURE).toml -o results/$(FIGURE).nc --force
	$(BIN)/vibrafeed plot results/$(FIGURE).nc -o results/$(FIGURE).png --force

# Units and laws of less than a second each, and ten ways of a user. They compute, and hardly wait: a
# process a core, since each more takes four seconds of processor time to collect.
test: $(TESTING)
	scripts/test $(BIN) tests/fast tests/journeys -n logical

# The rest besides: long laws, services, browsers, pages of docs/, packages.
test-all: test
	scripts/test $(BIN) tests/laws tests/service tests/browser tests/docs tests/packaging

# All with more cases, and searches, kills and attacks, in random order: hours of one processor. With
# VIBRAFEED_NIGHT=1, `scripts/test .venv/bin tests -p randomly --randomly-seed=N` repeats an order.
night: $(TESTING)
	VIBRAFEED_NIGHT=1 scripts/test $(BIN) tests -p randomly

check: $(TESTING)
	scripts/check $(BIN)

# The pages of docs/ as a site; a link that leads nowhere ends it.
docs: $(TESTING)
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build
	@echo "Open results/site/index.html; for the search: python3 -m http.server -d results/site"

serve: $(SERVING)
	$(BIN)/vibrafeed serve

clean:
	rm -rf $(VENV) results

$(RUNNING): pyproject.toml constraints.txt
	@echo "Installing what vibrafeed needs to run in $(VENV): some 0.8 GB, up to a minute ..."
	@$(PYTHON) -m venv $(VENV)
	@$(PIP) uv || true
	@$(call INSTALL,plot)
	@$(BIN)/python -m compileall -q app core vibrafeed
	@touch $@

$(SERVING): $(RUNNING)
	@echo "Adding what the service needs ..."
	@$(call INSTALL,plot$(COMMA)serve)
	@touch $@

$(TESTING): $(RUNNING)
	@echo "Adding what its tests and checks need: some 0.5 GB ..."
	@$(call INSTALL,plot$(COMMA)dev)
	@touch $@
