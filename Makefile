# make          build hooke and its plugins         make run     build, simulate a cloth, write pictures
# make test     build and run every test            make test SANITIZE=1   the same under sanitizers
# make bench    micro-benchmarks                    make install PREFIX=/usr/local [DESTDIR=]
# make format | lint | clean
#
# The folders are the lists: a file in plugins/KIND is a plugin, one in tests/ a test program, one in tests/fixtures a
# plugin for tests, one in tests/bench a benchmark. Nothing has to be added here for a new one.

PREFIX ?= /usr/local
CC     := $(if $(filter default,$(origin CC)),gcc,$(CC))
KINDS  := forces constraints correctors sources integrators solvers outputs
B      := build$(if $(SANITIZE),/sanitize)

ifeq (,$(filter -j%,$(MAKEFLAGS)))
MAKEFLAGS += -j$(shell nproc 2>/dev/null || echo 1)
endif

# -ffp-contract=off: the same bits on every machine. No -march: fast paths are chosen when a plugin is loaded.
WARNINGS := -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wundef -Wwrite-strings \
            -Wold-style-definition $(if $(CI)$(WERROR),-Werror)
FLAGS    := -std=c11 -D_POSIX_C_SOURCE=200809L -D_DEFAULT_SOURCE -I. -fPIC -fvisibility=hidden -g \
            -fno-math-errno -fno-trapping-math -ffp-contract=off -MMD -MP $(WARNINGS)
ifdef SANITIZE
FLAGS    += -O1 -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
LINK     := -fsanitize=address,undefined
else
FLAGS    += -O3
endif

LUA        := $(firstword $(foreach p,lua5.4 lua-5.4 lua54 lua,$(shell pkg-config --exists '$p >= 5.4' 2>/dev/null && echo $p)))
LUA_CFLAGS := $(shell pkg-config --cflags $(LUA) 2>/dev/null)
LUA_LIBS   := $(shell pkg-config --libs $(LUA) 2>/dev/null)
PNG_LIBS   := $(shell pkg-config --libs libpng 2>/dev/null)
ifeq (0,$(shell pkg-config --exists osmesa 2>/dev/null; echo $$?))
GL_CFLAGS := -DHK_GL_OSMESA=1 $(shell pkg-config --cflags osmesa)
GL_LIBS   := $(shell pkg-config --libs osmesa)
else ifeq (0,$(shell pkg-config --exists egl gl 2>/dev/null; echo $$?))
GL_CFLAGS := -DHK_GL_EGL=1 $(shell pkg-config --cflags egl gl)
GL_LIBS   := $(shell pkg-config --libs egl gl)
endif
SUITESPARSE_CFLAGS := $(addprefix -I,$(wildcard /usr/include/suitesparse /usr/local/include/suitesparse))

sources  = $(wildcard core/*.c)
core     = $(patsubst %.c,$B/obj/%.o,$(filter-out core/main.c,$(sources)))
common   = $(patsubst %.c,$B/obj/%.o,$(wildcard plugins/common/*.c))
plugins  = $(foreach k,$(KINDS),$(patsubst %.c,$B/%.so,$(wildcard plugins/$k/*.c)))
fixtures = $(patsubst %.c,$B/%.so,$(wildcard tests/fixtures/*.c))
support  = $(patsubst %.c,$B/obj/%.o,$(wildcard tests/support/*.c))
tests    = $(patsubst %.c,$B/%,$(filter-out tests/fixtures/% tests/support/% tests/bench/%,$(shell find tests -name '*.c' 2>/dev/null)))
benches  = $(patsubst tests/bench/%.c,$B/bench/%,$(wildcard tests/bench/*.c))

.DELETE_ON_ERROR:
.SECONDARY:
.PHONY: all build deps run test bench clean format lint install

all: build
build: $B/hooke $(plugins)

deps:
	@tools/install-deps test

run: deps
	@$(MAKE) --no-print-directory build
	@$B/hooke run scripts/scenes/cloth.lua --out out/cloth

test: deps
	@$(MAKE) --no-print-directory $B/hooke $(plugins) $(fixtures) $(tests)
	@tests/run $B $(tests)

bench: deps
	@$(MAKE) --no-print-directory build $(benches)
	@for b in $(benches); do echo "== $$b"; $$b || exit 1; done

$B/hooke: $B/obj/core/main.o $(core)
	$(CC) $(LINK) $(LDFLAGS) -o $@ $^ $(LUA_LIBS) -ldl -lpthread -lm

$B/core.a: $(core)
	@rm -f $@
	$(AR) rcs $@ $^

$B/common.a: $(common)
	@rm -f $@
	$(AR) rcs $@ $^

$B/obj/core/%.o: EXTRA = $(LUA_CFLAGS)
$B/obj/plugins/common/%.o: EXTRA = $(GL_CFLAGS)
$B/obj/plugins/solvers/%.o: EXTRA = $(SUITESPARSE_CFLAGS)
$B/obj/plugins/outputs/%.o: EXTRA = $(GL_CFLAGS)
$B/obj/tests/%.o: EXTRA = $(LUA_CFLAGS) -DHK_ROOT='"$(CURDIR)"' -DHK_BUILD='"$(CURDIR)/$B"'
$B/obj/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(FLAGS) $(CPPFLAGS) $(CFLAGS) $(EXTRA) -c $< -o $@

# A plugin takes from common.a what it uses; libraries are asked for by those that use them.
$B/plugins/solvers/%.so: LIBS = -lcholmod
$B/plugins/outputs/frames.so: LIBS = $(GL_LIBS) $(PNG_LIBS)
$B/plugins/%.so: $B/obj/plugins/%.o $B/common.a
	@mkdir -p $(@D)
	$(CC) -shared $(LINK) $(LDFLAGS) -o $@ $^ $(LIBS) -lm
$B/tests/fixtures/%.so: $B/obj/tests/fixtures/%.o $B/common.a
	@mkdir -p $(@D)
	$(CC) -shared $(LINK) $(LDFLAGS) -o $@ $^ -lm

$B/tests/%: $B/obj/tests/%.o $(support) $B/core.a $B/common.a
	@mkdir -p $(@D)
	$(CC) $(LINK) $(LDFLAGS) -o $@ $^ $(LUA_LIBS) -lcmocka $(PNG_LIBS) -ldl -lpthread -lm
$B/bench/%: $B/obj/tests/bench/%.o $B/core.a $B/common.a
	@mkdir -p $(@D)
	$(CC) $(LINK) $(LDFLAGS) -o $@ $^ $(LUA_LIBS) -ldl -lpthread -lm

clean:
	rm -rf build

format:
	clang-format -i $(shell git ls-files '*.c' '*.h')

lint:
	@tools/install-deps lint
	clang-tidy --quiet $(sources) $(foreach k,$(KINDS) common,$(wildcard plugins/$k/*.c)) -- -std=c11 -D_POSIX_C_SOURCE=200809L \
	  -D_DEFAULT_SOURCE -I. $(LUA_CFLAGS) $(GL_CFLAGS) $(SUITESPARSE_CFLAGS)
	luacheck --quiet scripts tools

lib = $(DESTDIR)$(PREFIX)/lib/hooke
share = $(DESTDIR)$(PREFIX)/share/hooke
install: build
	install -D $B/hooke $(DESTDIR)$(PREFIX)/bin/hooke
	for p in $(patsubst $B/%,%,$(plugins)); do install -D -m 644 $B/$$p $(lib)/$$p || exit 1; done
	mkdir -p $(share)
	cp -R scripts tools $(share)/
	install -D -m 644 core/plugin.h $(DESTDIR)$(PREFIX)/include/hooke/core/plugin.h
	for h in plugins/common/*.h; do install -D -m 644 $$h $(DESTDIR)$(PREFIX)/include/hooke/$$h || exit 1; done

-include $(shell find $B/obj -name '*.d' 2>/dev/null)
