# `make run` and `make test` set up all they need; `make help` lists the rest.
BIN := .venv/bin
# A worker that crashes ends the tests: another one would try the same test again, and crash, too.
TESTS := -n auto --dist loadfile --no-loadscope-reorder --max-worker-restart=0
# the discs' kernels, which tests side by side would compile at the same time, each for itself
KERNELS := from dem.precompile import precompile; from meshes.executor import OneThread; precompile(OneThread(), print)
SECTION ?= meshes/sections/s13.toml
# a package is compiled when it is first imported, and kept: else each of the processes of the tests would compile it
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help setup run verify docs lint checked test test-all browser clean

help:       ## this list
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:[^#]*##/\t/' | expand -t 12

setup:      ## install what is missing; does nothing when all is there
	@.ci/setup

run: setup  ## the whole workflow on meshes/sections/s13.toml, or on SECTION=my.toml
	@$(BIN)/noshiro run $(SECTION)

verify: setup ## what others published on slopes, beside our answers; takes an hour
	@$(BIN)/python -m docs.verify
	@$(BIN)/python -m docs.published_slopes

docs: setup ## the documentation site from the same files, without the network: docs/build/site/index.html
	@$(BIN)/python docs/build.py

lint: setup ## style, types, who may import whom, and the words of the documentation
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python docs/prose.py
	$(BIN)/python -m docs.usage
	$(BIN)/python docs/docstrings.py
	$(BIN)/python docs/names.py

test: checked ## what every change must pass
	$(BIN)/python -m pytest $(TESTS)

test-all: checked ## and the long studies
	$(BIN)/python -m pytest $(TESTS) -m '' -o faulthandler_timeout=7200

checked: setup browser
	@$(BIN)/python -c "$(KERNELS)" & $(MAKE) --no-print-directory lint && wait

browser:    ## Chromium and a Japanese font, with which the tests look at the report
	@.ci/setup browser

clean:      ## forget the environment and the results
	rm -rf .venv runs
