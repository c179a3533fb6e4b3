# hooke: `make` builds, `make test` and `make run` also install what is missing. The folders are the lists: a new file
# in core/, plugins/KIND/, tools/native/ or tests/ needs no line here.
#
#   make [all]   build/hooke, build/plugins/KIND/NAME.so, build/tools/NAME.so     V=1 shows the commands
#   make run     builds and runs a first scene: a hanging cloth, with pictures in out/cloth
#   make test    builds and runs the tests        SANITIZE=1: under the sanitizers   ONLY=TEXT: paths that contain it
#   make bench   the programs of tests/bench, one after another
#   make lint    clang-tidy and luacheck          make format   clang-format
#   make install PREFIX=/usr/local DESTDIR=       make clean

KINDS := forces constraints correctors sources integrators solvers outputs
PREFIX ?= /usr/local
PKG_CONFIG ?= pkg-config
SANITIZE ?=
WERROR ?= $(filter true 1,$(CI))
B := $(if $(SANITIZE),build/sanitize,build)

# As many jobs as processors, unless the caller said a number or is a make that hands out jobs itself.
ifeq ($(MAKELEVEL)$(findstring j,$(filter-out --%,$(MAKEFLAGS))),0)
MAKEFLAGS += -j$(shell nproc 2>/dev/null || getconf _NPROCESSORS_ONLN)
endif

# ---- Libraries. -isystem: their headers are not held to our warnings. Each variable can be given instead. ----------

pkg_cflags = $(patsubst -I%,-isystem%,$(shell $(PKG_CONFIG) --cflags $(1) 2>/dev/null))
pkg_libs = $(shell $(PKG_CONFIG) --libs $(1) 2>/dev/null)
pkg_first = $(shell for p in $(1); do $(PKG_CONFIG) --exists $$p 2>/dev/null && echo $$p && break; done)

LUA := $(call pkg_first,lua5.4 lua-5.4 lua54 lua)
LUA_CFLAGS ?= $(call pkg_cflags,$(LUA))
LUA_LIBS ?= $(call pkg_libs,$(LUA))
CMOCKA_LIBS ?= $(or $(call pkg_libs,cmocka),-lcmocka)
# SuiteSparse 5 comes without pkg-config files, 7 keeps the folder.
SUITESPARSE_CFLAGS ?= -isystem/usr/include/suitesparse
SUITESPARSE_LIBS ?= -lcholmod -lumfpack -lamd -lcolamd -lsuitesparseconfig
# Pictures are drawn without a window: by OSMesa, or by EGL where Mesa no longer has OSMesa.
GL ?= $(or $(call pkg_first,osmesa),$(if $(call pkg_first,egl),$(if $(call pkg_first,opengl gl),egl)))
GL_MODULES = $(if $(filter egl,$(GL)),egl $(call pkg_first,opengl gl),$(GL))
PNG ?= $(call pkg_first,libpng libpng16)
ifneq ($(and $(GL),$(PNG)),)
PICTURES_CFLAGS ?= $(if $(filter egl,$(GL)),-DHK_GL_EGL=1,-DHK_GL_OSMESA=1) $(call pkg_cflags,$(GL_MODULES) $(PNG))
PICTURES_LIBS ?= $(call pkg_libs,$(GL_MODULES) $(PNG))
endif

# Expanded once: every := here is one child process less per compilation.
$(foreach v,LUA_CFLAGS LUA_LIBS CMOCKA_LIBS PICTURES_CFLAGS PICTURES_LIBS,$(eval $v := $$($v)))

# ---- Flags -----------------------------------------------------------------------------------------------------------

CFLAGS ?= $(if $(SANITIZE),-O1,-O3) -g
WARNINGS := -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wold-style-definition -Wundef \
  -Wwrite-strings -Wredundant-decls -Wdisabled-optimization -Wformat=2 $(if $(WERROR),-Werror)
# No contraction into fused multiply-add: results are the same bits on every machine.
FLOATS := -fno-math-errno -fno-trapping-math -ffp-contract=off
SANITIZER := $(if $(SANITIZE),-fsanitize=address$(,)undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
COMPILE := $(CC) -std=c11 -D_POSIX_C_SOURCE=200809L -D_DEFAULT_SOURCE -I. $(CPPFLAGS) $(WARNINGS) $(FLOATS) -fPIC \
  -fvisibility=hidden -ffunction-sections -fdata-sections $(CFLAGS) $(SANITIZER) -MMD -MP

# What the files of each top folder see beyond that.
FLAGS_core := $(LUA_CFLAGS)
FLAGS_plugins := $(SUITESPARSE_CFLAGS) $(PICTURES_CFLAGS)
FLAGS_tools := $(LUA_CFLAGS)
FLAGS_tests := $(LUA_CFLAGS) $(FLAGS_plugins) -DHK_ROOT='"$(CURDIR)"' -DHK_BUILD='"$(CURDIR)/$(B)"'

LINK := $(CC) $(CFLAGS) $(SANITIZER) $(LDFLAGS) -Wl,--as-needed -Wl,--gc-sections
# A sanitizer's own symbols may be left to the program that loads the plugin.
LINK_PLUGIN := $(LINK) -shared $(if $(SANITIZE),,-Wl,-z$(,)defs)
SYSTEM_LIBS := -ldl -lpthread -lm
LIBS_solvers := $(SUITESPARSE_LIBS)
LIBS_outputs := $(PICTURES_LIBS)
