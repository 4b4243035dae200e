# make demo    set everything up, run the main job on a bundled surface, end with the path of the report
# make test    set everything up, run every check and every test
# make lint    only the checks: style, layers, types
# make bench   measure the solver and its peers (installs ipyopt and unopy), the workbench, and batches
# make corpus CORPUS=DIR   fit every file of a folder of hostile files, each held to its expected class
# make environments   run in some forty sanitized environments
# make setup   only the set-up (.venv); PYTHON=... names another Python than python3
# make clean   remove what the other targets made

PY := .venv/bin/python
# The stamp's name carries all that the environment depends on, so that a moved folder or a new pin sets up again.
READY := .venv/ready-$(shell { pwd; cat pyproject.toml constraints.txt .ci/set-up; } | cksum | cut -d ' ' -f 1)

.PHONY: demo test lint bench corpus environments setup clean constraints

# kirisurf demo ends with the path of the report. Its code 1 is a report to read, not a failure to mend.
demo: $(READY)
	@$(PY) -m kirisurf demo; code=$$?; \
	if [ $$code -eq 1 ]; then \
		echo "make demo: done, with the warnings above (code 1); they stand in $(CURDIR)/demo/report.html"; \
	elif [ $$code -ne 0 ]; then \
		echo "make demo: kirisurf demo ended with code $$code" >&2; exit $$code; \
	fi

test: lint
	@$(PY) -m pytest

lint: $(READY)
	@$(PY) -m ruff check .
	@$(PY) -m ruff format --check .
	@$(PY) -c 'from importlinter.cli import lint_imports_command; lint_imports_command()' --no-logo
	@$(PY) -m mypy

bench: $(READY)
	@$(PY) -m pip install --quiet --disable-pip-version-check --only-binary :all: -c constraints.txt \
		--no-build-isolation --editable '.[peers]' \
		|| echo "make bench: the peers ipopt and uno could not be installed; going on without" >&2
	@OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(PY) tests/benchmarks/run.py
	@$(PY) tests/benchmarks/window.py
	@$(PY) tests/benchmarks/batch.py
	@if [ -f tests/benchmarks/deployment.py ]; then $(PY) tests/benchmarks/deployment.py; fi

# Every file of a folder of foreign and hostile files, held to its expected class: make corpus CORPUS=...
corpus: $(READY)
	@$(PY) tests/corpus/classes.py $(CORPUS)

# The product in some forty sanitized environments; also: make environments NAMES="wheel oldest newest"
environments: $(READY)
	@$(PY) tests/environments/matrix.py $(NAMES)

setup: $(READY)

$(READY):
	@sh .ci/set-up $@

# New pins: whatever is newest within the bounds of pyproject.toml, in a clean environment.
constraints:
	@rm -rf build/pins
	@python3 -m venv build/pins
	@build/pins/bin/python -m pip install --quiet --only-binary :all: \
		--editable '.[cluster,desktop,peers,repair,test,web]' hatchling editables
	@{ sed -n '/^#/p' constraints.txt; build/pins/bin/python -m pip freeze --exclude-editable; } > build/constraints.txt
	@mv build/constraints.txt constraints.txt
	@rm -rf build/pins

clean:
	rm -rf .venv build dist demo .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
