# What developers type: make demo, make test, make doctest, make slow, make lint, make types, make browser, make web,
# make pictures, make docs, make dist.
# The environment .venv is made when it is needed and again only when pyproject.toml changes. Every call of pip makes a place of its own
# to build in, with all that compiles kernels: .venv/ready-all installs everything in one call.
# Work is stolen, not dealt: neighbouring tests run in one process and share what the fixtures of their module work out.

BIN := .venv/bin
FITS := import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))
WORKERS := auto
PYTEST := $(BIN)/python -m pytest -n $(WORKERS) --dist worksteal
TEST := bench,cluster,dxf,fast,film,halfplane,image,ipopt,page,prove,solid,test,verify
PYTHON := $(shell for p in python3 python3.13 python3.12 python3.11; do \
	$$p -c '$(FITS)' 2>/dev/null && { echo $$p; break; }; done)

.PHONY: demo test doctest slow browser web pictures pictures-check docs dist lint types clean

demo: .venv/ready-demo
	@mkdir -p out
	@echo "The first time this takes about half a minute: numerical kernels are compiled as they are used, and kept"
	$(BIN)/wiggleroom flex examples/drawings/pyjigsaw_4x5.svg --gap 1 --fix p1 --pull p20:+x --picture out/demo.svg
	@echo "The picture is in $(CURDIR)/out/demo.svg"

test: .venv/ready-kernels # with ALL=1 also the slow ones at once: what is loaded and worked out for both is so once
	$(PYTEST) -m "not $(if $(ALL),browser,slow)"

doctest: .venv/ready-kernels # the examples of all docstrings
	$(PYTEST) --doctest-modules src/wiggleroom

slow: .venv/ready-kernels # but for those that need a browser
	$(PYTEST) -m "slow and not browser"

browser: .venv/ready-browser .venv/ready-kernels # needs a Chromium on the path; only files that name its fixtures are collected
	$(PYTEST) -m browser $$(grep -lwE 'browser|opened' tests/test_*.py)

web: # the live page from its source; needs Node 20 or later and npm
	cd web && npm ci --silent --ignore-scripts && npm run --silent check && npm run --silent test && npm run --silent build

pictures: .venv/ready-kernels # all of docs/pictures but those that show measured times
	$(BIN)/python -m benchmarks.redraw

pictures-check: .venv/ready-kernels
	$(BIN)/python -m benchmarks.redraw --check

docs: .venv/ready-docs .venv/ready-kernels # the site, in out/site; without the network once the environment is there
	$(BIN)/python -m docs_site.live_pages out/live
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict --quiet
	$(BIN)/python -m docs_site.check_links out/site

dist: .venv/ready-dist # the sdist and the wheel, in dist; built twice and compared
	$(BIN)/python -m release.build_twice dist

lint: .venv/ready-lint
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: .venv/ready-lint
	$(BIN)/mypy

clean:
	rm -rf .venv out build

.venv/bin/python:
	@test -n "$(PYTHON)" || { echo "wiggleroom needs Python 3.11, 3.12 or 3.13 on the path" >&2; exit 1; }
	$(PYTHON) -m venv .venv

.venv/ready-demo: pyproject.toml | .venv/bin/python # kernels are compiled as they are first used: the demo needs some of them
	$(BIN)/python -m pip install --quiet --editable '.[dxf,fast,film,ipopt,page,prove,solid,verify]'
	@touch $@

.venv/ready-all: pyproject.toml | .venv/bin/python
	$(BIN)/python -m pip install --quiet --editable '.[$(TEST),browser,dist,docs,lint]'
	@touch $(addprefix .venv/ready-, test browser docs dist lint) $@

.venv/ready-test: pyproject.toml | .venv/bin/python
	$(BIN)/python -m pip install --quiet --editable '.[$(TEST)]'
	@touch $@

.venv/ready-kernels: pyproject.toml | .venv/ready-test
	$(BIN)/python -m wiggleroom.cli.compile
	@touch $@

.venv/ready-browser: pyproject.toml | .venv/ready-test
	$(BIN)/python -m pip install --quiet --editable '.[browser]'
	@touch $@

.venv/ready-docs: pyproject.toml | .venv/ready-test
	$(BIN)/python -m pip install --quiet --editable '.[docs]'
	@touch $@

.venv/ready-dist: pyproject.toml | .venv/ready-test
	$(BIN)/python -m pip install --quiet --editable '.[dist]'
	@touch $@

.venv/ready-lint: pyproject.toml | .venv/bin/python
	$(BIN)/python -m pip install --quiet --editable '.[lint]'
	@touch $@
