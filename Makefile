# `make run` and `make test` need Python 3.11 or later and nothing else; both make the environment.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
FIGURE := fig-5-1

.PHONY: run test check serve clean

run: $(READY)
	$(BIN)/vibrafeed run configs/figures/$(FIGURE).toml -o results/$(FIGURE).nc
	$(BIN)/vibrafeed plot results/$(FIGURE).nc -o results/$(FIGURE).png

test: $(READY)
	$(BIN)/python -m pytest

check: $(READY)
	scripts/check $(BIN)

serve: $(READY)
	$(BIN)/vibrafeed serve

clean:
	rm -rf $(VENV) results

$(READY): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[plot,dev]'
	touch $@
