# Everything a fresh Debian 12 machine needs is one word away: make demo, make test.
PACKAGES = build-essential cmake ninja-build ccache pkg-config \
  libtorch-dev libopencv-dev libembree-dev libeigen3-dev libopenblas0-pthread libcli11-dev libspdlog-dev \
  nlohmann-json3-dev liblmdb-dev libgtest-dev libbenchmark-dev libgloo-dev libdnnl-dev libonnx-dev libprotobuf-dev libfaiss-dev \
  gnuplot-nox
# The page of reports is built with npm, and tested in a browser; the demo needs neither.
WEB_PACKAGES := $(shell command -v npm >/dev/null || echo nodejs npm)
TEST_PACKAGES := $(shell command -v chromium >/dev/null || echo chromium)
RECOLLECT = build/recollect

# make demo DATA=folder: the laps to show (docs/data.md); without, it renders some, and tunes a
# network that has learnt on another simulated route (docs/relative-pose.md).
DATA =
PRETRAINED = models/campus-compact.rcm

.PHONY: setup setup-program setup-web setup-test configure build test sanitize demo format

# Installs what is missing and nothing else; quiet and quick when all is there.
setup: setup-program setup-web

setup-program: PACKAGES_WANTED = $(PACKAGES)
setup-web: PACKAGES_WANTED = $(WEB_PACKAGES)
setup-test: PACKAGES_WANTED = $(TEST_PACKAGES)

setup-web setup-test: | setup-program
setup-program setup-web setup-test:
	@missing=$$(for p in $(PACKAGES_WANTED); do \
	  dpkg-query -W -f='$${Status}' $$p 2>/dev/null | grep -q 'install ok installed' || echo $$p; done); \
	[ -z "$$missing" ] && exit 0; \
	if [ "$$(id -u)" = 0 ]; then as=; elif command -v sudo >/dev/null; then as=sudo; else \
	  echo "make setup: missing Debian packages:" $$missing >&2; \
	  echo "  not root and no sudo here; as root: apt-get install" $$missing >&2; exit 1; fi; \
	echo "Installing" $$missing; \
	$$as apt-get update -qq && \
	DEBIAN_FRONTEND=noninteractive $$as apt-get install -y -qq --no-install-recommends $$missing >/dev/null || { \
	  echo "make setup: could not install:" $$missing >&2; exit 1; }

configure: setup-program
	@cmake --preset default >build.log 2>&1 || { cat build.log; rm -f build.log; exit 1; }; rm -f build.log

build: setup-web configure
	@cmake --build build

test: setup-test build
	ctest --preset default

# Maps all laps but the last, trains on them, localises the last, draws the picture.
demo: configure
	@cmake --build build --target recollect
	@$(RECOLLECT) demo $(if $(DATA),--data $(DATA),--start $(PRETRAINED))

# The unit tests again under the address and undefined-behaviour sanitizers.
sanitize: setup-program
	cmake --preset sanitize >/dev/null
	cmake --build build-sanitize
	ctest --preset sanitize

format:
	git ls-files '*.h' '*.cc' | xargs clang-format -i
