# Two commands do all the set-up: `make demo` renders a picture, `make test` runs the tests.
# Both look for a Vulkan driver first; where there is none and apt is, they install Mesa's.

PICTURE := target/demo.png
GALLERY := $(wildcard examples/scenes/gallery-*.json)
# lavapipe prints a warning on every run without a private folder of its own.
export XDG_RUNTIME_DIR ?= $(shell mkdir -p target/runtime && chmod 700 target/runtime && echo $(CURDIR)/target/runtime)
# Compiled shaders are kept beside what is built, also where there is no home folder for them.
export MESA_SHADER_CACHE_DIR ?= $(shell mkdir -p target/shaders && echo $(CURDIR)/target/shaders)

# The program that draws the gallery; another may be named: make gallery NEPHOS=nephos
NEPHOS ?= ./target/release/nephos

.PHONY: demo gallery test lint parts docs examples driver screen readers movies

demo: driver
	cargo build --release
	./target/release/nephos render examples/scenes/humilis.json -o $(PICTURE)
	@echo "The picture is $(CURDIR)/$(PICTURE)"

# The pictures of docs/gallery.md.
gallery: driver
	$(if $(filter ./target/release/nephos,$(NEPHOS)),cargo build --release)
	for scene in $(GALLERY:examples/scenes/gallery-%.json=%); do \
		$(NEPHOS) render examples/scenes/gallery-$$scene.json -o docs/pictures/gallery/$$scene.png || exit 1; \
	done

# One process for each binary: tests share a device and its compiled shaders. One that fails hides no other.
test: driver screen readers movies
	cargo test --all-features --no-fail-fast

lint:
	cargo fmt --check
	cargo clippy --all-targets --all-features -- -D warnings
	cargo clippy --no-default-features -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --all-features
	@! cargo tree --no-default-features -e normal --prefix none | grep -E '^(clap|egui|eframe|indicatif|image|exr|gltf|ktx2|flate2) ' \
		|| { echo "The library alone must not depend on the crates above."; exit 1; }
	@twice=$$(cargo tree --all-features -e normal --prefix none | grep -E '^(wgpu|naga|glam) ' \
		| cut -d' ' -f1,2 | sort -u | cut -d' ' -f1 | uniq -d); \
		[ -z "$$twice" ] || { echo "There must be one version of $$twice."; exit 1; }

# The library in a browser, then each feature without the others.
parts:
	cargo check --locked --target wasm32-unknown-unknown --no-default-features --lib
	for feature in cli editor export import measure slabs; do \
		cargo check --locked --no-default-features --features $$feature || exit 1; \
	done

# The scenes under examples/ are the presets, written anew when a preset changes, and those of the gallery, by hand.
examples:
	cargo build --release
	for preset in $(filter-out $(GALLERY),$(wildcard examples/scenes/*.json)); do \
		./target/release/nephos new --preset $$(basename $$preset .json) --force -o $$preset; \
	done

driver:
	@sh .ci/driver

screen:
	@sh .ci/screen

readers:
	@sh .ci/readers

movies:
	@sh .ci/movies
