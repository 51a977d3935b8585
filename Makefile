# make run    set up and serve the page (PORT=9000 for another port, HOST=0.0.0.0 for other machines)
# make test   set up and check everything, on all cores (ARGS="tests/engine -k zhao" for a part)

# The first Python that is new enough; PYTHON=... chooses another.
PYTHON ?= $(shell for p in python3 python3.13 python3.12 python3.11 python; do \
	"$$p" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && { echo "$$p"; break; }; done)
BIN := .venv/bin
HERE = $(if $(PYTHON),,$(error Python 3.11 or newer is needed, and no python3 here is. Install one, or name it: make run PYTHON=/path/to/python3.11))

# Three workers on two cores: a browser test waits for half of its time. Compiled modules are kept even where the
# environment forbids it: tests start many processes.
WORKERS ?= $(shell "$(PYTHON)" -c 'import os; print(((os.cpu_count() or 1) * 3 + 1) // 2)')

# A browser is opened where there is a screen; elsewhere a text browser would take the terminal.
OPEN := $(if $(DISPLAY)$(WAYLAND_DISPLAY)$(filter Darwin,$(shell uname -s)),$(if $(CI)$(SSH_CONNECTION),,--open))
SERVE := $(OPEN) $(if $(PORT),--port $(PORT)) $(if $(HOST),--host $(HOST))

.PHONY: run test lint bench docs site pins clean help
.DEFAULT_GOAL := help

run: ## Serve the page; the address is printed
	$(HERE)@$(PYTHON) tools/environment.py run
	@exec $(BIN)/thetascope serve $(SERVE)

test: ## Check everything, in a browser too
	$(HERE)@$(PYTHON) tools/environment.py dev
	@browser=$$($(BIN)/python tools/browser.py) || exit 1; \
	PYTHONDONTWRITEBYTECODE= THETASCOPE_BROWSER="$$browser" exec $(BIN)/python -m pytest $(or $(ARGS),-n $(WORKERS) --dist worksteal)

lint: ## Check style and types
	$(HERE)@$(PYTHON) tools/environment.py dev
	@$(BIN)/ruff check --output-format concise .
	@$(BIN)/ruff format --check .
	@$(BIN)/node node_modules/prettier/bin/prettier.cjs --check --log-level warn .
	@$(BIN)/node node_modules/pyright/index.js --project pyproject.toml
	@$(BIN)/node node_modules/typescript/bin/tsc
	@$(BIN)/node node_modules/typescript/bin/tsc --project tests/page

bench: ## Measure speed
	$(HERE)@$(PYTHON) tools/environment.py bench
	@$(BIN)/python -m benchmarks $(ARGS)

docs: ## Write the generated pages of docs and the page's types from their sources
	$(HERE)@$(PYTHON) tools/environment.py dev
	@$(BIN)/python -m tools.document_observers
	@$(BIN)/python -m tools.document_papers
	@$(BIN)/python -m tools.page_types
	@$(BIN)/python -m tools.list_licences

site: ## Build the documentation as a site, in build/site
	$(HERE)@$(PYTHON) tools/environment.py dev
	@$(BIN)/python -m tools.site

pins: ## Choose versions anew from pyproject.toml (needs uv)
	uv pip compile --quiet $(PIN) --group build --output-file requirements.txt pyproject.toml
	uv pip compile --quiet $(PIN) --group build --extra cluster --constraint requirements.txt --output-file requirements-cluster.txt pyproject.toml
	uv pip compile --quiet $(PIN) --group build --group dev --constraint requirements-cluster.txt --output-file requirements-dev.txt pyproject.toml
	uv pip compile --quiet $(PIN) --group build --group dev --group bench --constraint requirements-dev.txt --output-file requirements-bench.txt pyproject.toml
PIN := --universal --python-version 3.11 --fork-strategy fewest --generate-hashes --upgrade --custom-compile-command "make pins"

clean: ## Remove the environment and what tools left behind
	rm -rf .venv node_modules build dist *.egg-info backend/*.egg-info .pytest_cache .ruff_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -not -path './.git/*' -prune -exec rm -rf {} +

help:
	@sed -n 's/^\([a-z]*\):.*## /make \1: /p' Makefile
