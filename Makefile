# Needs Python 3.11 or later, git, make and a C compiler; everything else is set up in .venv.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
CACHE := .cache
EXTRAS ?= dev
LOG := $(CACHE)/test.log
TARGETS := python c markdown typescript html
tested = mkdir -p $(CACHE) && { $(BIN)/python -m pytest -n auto --dist worksteal $(1) >$(LOG) 2>&1 \
	|| { cat $(LOG); exit 1; }; } && tail -n 1 $(LOG)

.PHONY: generate check test test-rest test-all coverage fuzz bench docs format clean

# What is made from schemas and from the compiler itself, and is checked in.
generate: $(INSTALLED)
	@$(BIN)/python -m protogen.problems.docs docs/problems.md
	@$(BIN)/python -m protogen.library.page docs/reference/library.md README.md
	@$(BIN)/protogen schema-json --output schemas/protogen.schema.json
	@$(BIN)/protogen generate --quiet $(TARGETS:%=--target %)

# Style and types, without running anything.
check: $(INSTALLED)
	@$(BIN)/ruff check --quiet
	@$(BIN)/ruff format --check --quiet || { $(BIN)/ruff format --check; exit 1; }
	@$(BIN)/mypy --no-error-summary

# What to wait for: style, types, and tests that touch every module, in some five minutes on two
# cores. Prints the closing line of pytest, and more only if something fails.
test: check
	@$(call tested,-m "not slow")

# The tests that `make test` leaves out: the same on more schemas, machines and seeds, and, like CI,
# with more examples of each property.
test-rest: export HYPOTHESIS_PROFILE ?= ci
test-rest: $(INSTALLED)
	@$(call tested,-m slow)

# Everything that must hold, in one go: what tests compile for one another is compiled once.
test-all: export HYPOTHESIS_PROFILE ?= ci
test-all: check
	@$(call tested,)

# All tests, with the lines and branches that no test reaches. Watching them takes twice the time.
coverage: check
	@mkdir -p $(CACHE)
	@$(BIN)/python -m pytest -n auto --dist worksteal --cov --cov-report= >$(LOG) 2>&1 || { cat $(LOG); exit 1; }
	@$(BIN)/coverage report --fail-under=95

# Thousands of random schemas; takes a quarter of an hour. The tests try some hundreds.
fuzz: $(INSTALLED)
	@HYPOTHESIS_PROFILE=thorough $(BIN)/python -m pytest -n auto --timeout 7200 tests/test_schema_fuzzing.py tests/test_c_schemas.py

bench: $(INSTALLED)
	@$(BIN)/python -m pip install -qq --disable-pip-version-check --editable '.[bench]'
	@for benchmark in benchmarks/bench_*.py; do $(BIN)/python $$benchmark || exit 1; done

# The site with our protocols' pages, in .cache/site. Fails if a link leads nowhere.
docs: $(INSTALLED)
	@mkdir -p $(CACHE)
	@$(BIN)/python -m pip install -qq --disable-pip-version-check --editable '.[docs]'
	@$(BIN)/zensical build --strict >$(CACHE)/docs.log 2>&1 || { cat $(CACHE)/docs.log; exit 1; }
	@rm -rf $(CACHE)/site/pages
	@cp -R generated/html $(CACHE)/site/pages

format: $(INSTALLED)
	@$(BIN)/ruff check --quiet --fix --exit-zero
	@$(BIN)/ruff format --quiet

clean:
	@rm -rf $(VENV) $(CACHE) .coverage .coverage.* .hypothesis .mypy_cache .pytest_cache .ruff_cache

$(INSTALLED): pyproject.toml
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@$(BIN)/python -m pip install -qq --disable-pip-version-check --editable '.[$(EXTRAS)]'
	@touch $@
