# SPDX-License-Identifier: Apache-2.0
# A front door to CMake for people and for CI. Everything here is also a plain CMake preset.
SHELL := /bin/bash
.DEFAULT_GOAL := help
.PHONY: help deps configure build test demo bench check format tidy asan tsan faults fuzz \
  mutants install package wheel reference clean

# How many compilers and tests run at once; sanitized compilers need about 1.5 GB each.
JOBS ?= $(shell nproc)
# Where `make install` puts things.
PREFIX ?= /usr/local

# Ninja where there is one, but only for a folder that is configured for the first time.
with_ninja = command -v ninja >/dev/null && export CMAKE_GENERATOR=Ninja
cmake_preset = { $(with_ninja); cmake --preset $(1) >/dev/null; }

help:  ## This list
	@sed -n 's/^\([a-z]*\):.*##/  make \1\t/p' $(MAKEFILE_LIST) | expand -t 18

deps:
	@tools/install-deps

configure: deps
	@$(call cmake_preset,release)

build: configure  ## The release binary at build/ydd-slam; installs what is missing with apt
	@cmake --build --preset release --parallel $(JOBS) --target ydd-slam

test: check configure  ## Build everything, run all tests: quick ones, end to end, installation
	@cmake --build --preset release --parallel $(JOBS)
	ctest --test-dir build --output-on-failure --no-tests=error -L quick --parallel $(JOBS)
	tools/check-install build
	ctest --test-dir build --output-on-failure --no-tests=error -L e2e --parallel $(JOBS)
	ctest --test-dir build --output-on-failure --no-tests=error -L faults

demo: build  ## Simulate a static and a busy room, run SLAM on both, print how far off it was
	@tools/demo

bench: configure  ## Build and run the micro benchmarks
	@cmake --build --preset release --parallel $(JOBS)
	@for program in build/bench/*_bench; do "$$program" || exit 1; done

check: deps  ## What needs no build: architecture, formatting, README's tables, texts of public names
	tools/check-architecture --self-test
	tools/check-architecture
	tools/check-format
	tools/readme-tables --check
	tools/make-reference --check

format: deps  ## Format all sources in place
	@tools/check-format --fix

tidy: deps  ## clang-tidy over all sources (long); FILES="..." or SINCE=<commit> for some
	@tools/tidy $(if $(SINCE),--since $(SINCE)) $(FILES)

asan: deps  ## All tests under AddressSanitizer and UndefinedBehaviorSanitizer, in build-asan-ubsan
	@tools/sanitized-tests asan-ubsan

tsan: deps  ## All tests under ThreadSanitizer, in build-tsan
	@tools/sanitized-tests tsan

faults: configure  ## What is thrown at the program, thirty rounds of what has a chance in it (long)
	@cmake --build --preset release --parallel $(JOBS)
	YDD_FAULTS=$${YDD_FAULTS:-30} ctest --test-dir build --output-on-failure --no-tests=error -L faults

fuzz:  ## Fuzz every parser for a minute; FUZZ_RUNS=10000000 by executions, TARGETS="yaml png" some
	@tools/install-deps --fuzz
	@tools/fuzz $(TARGETS)

mutants: deps  ## Change the rules of dynamics/ one by one: does a test notice? (hours)
	@$(call cmake_preset,release -B build-mutants -DYDD_UNITY=OFF)
	@cmake --build build-mutants --parallel $(JOBS) --target ydd_dynamics_test ydd_e2e_dynamics_property_test
	@tools/mutate-dynamics

install: build  ## Install binary, libraries, headers and configurations below PREFIX (/usr/local)
	@cmake --build --preset release --parallel $(JOBS)
	@cmake --install build --prefix $(PREFIX)

package: configure  ## Debian packages in build/packages; tools/check-package tries them in a bare Debian
	@cmake --build --preset release --parallel $(JOBS) --target ydd_packaged
	@cd build && cpack -G DEB

wheel: configure  ## The Python module as a wheel for pip, in build/wheel (docs/python.md)
	@cmake --build --preset release --parallel $(JOBS) --target ydd_python
	@tools/make-wheel build

reference:  ## Pages of all public names by Doxygen (docs/reference.md), in build/reference/html
	@tools/make-reference

clean:  ## Remove what was built (not runs/)
	@rm -rf build build-*
