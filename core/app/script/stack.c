/* The stack of an untrusted script is as large from the start as it may become, and so it never moves. In Lua 5.4.4
 * (Debian 12; mended in later ones) luaV_concat goes on at an address in the old stack when a __concat has made the
 * stack move: a crash, or a wrong value without a word. lua_settop has the same mistake there with variables that are
 * closed. No mistake of this kind, in any version of Lua, does harm in a stack that stays where it is. Lua's limit of
 * 200 calls through C in each other (LUAI_MAXCCALLS) is no help, since each metamethod among them may call Lua
 * functions, whose depth nobody counts.
 *
 * A stack that is full asks for twice its slots, and the allocator knows it by that number of bytes. It would ask for
 * more only where a C function wants more slots at once than there are: lua/guards.c refuses that.
 *
 * Lua writes a type into each slot, and so every page of the stack is needed at the start of every run: the system is
 * asked for all of them in one call (Linux 5.14), which saves 160 page faults, half of what the stack costs a start. */
#include "core/app/script/script.h"

#include <stdint.h>
#include <sys/mman.h>
#include <unistd.h>

/* Some 4,000 calls of Lua functions in each other, or 800 in a coroutine, of which there may be many. */
enum { MAIN_SLOTS = 40000, COROUTINE_SLOTS = 8000, EXTRA_SLOTS = 5 };

static const size_t slot = 16; /* bytes, of Lua 5.4: a value and its type */

void hk_stack_back(void *memory, size_t bytes) {
#ifdef MADV_POPULATE_WRITE
  size_t page = (size_t)sysconf(_SC_PAGESIZE), before = (page - (uintptr_t)memory % page) % page;
  if (bytes >= before + page) madvise((char *)memory + before, (bytes - before) / page * page, MADV_POPULATE_WRITE);
#else
  (void)memory, (void)bytes;
#endif
}

bool hk_stack_reserve(hk_script *s, lua_State *L) {
  bool coroutine = L != s->L;
  s->reserving = !coroutine;
  bool fine = lua_checkstack(L, coroutine ? COROUTINE_SLOTS : MAIN_SLOTS);
  s->reserving = false;
  if (!fine) return false;
  s->doubled_stack[coroutine] = s->options.trust ? 0 : 2 * s->last_size - EXTRA_SLOTS * slot;
  return true;
}

bool hk_stack_overflows(const hk_script *s, size_t size) {
  return size == s->doubled_stack[0] || size == s->doubled_stack[1];
}

int hk_stack_slots(const hk_script *s, const lua_State *L) { return L == s->L ? MAIN_SLOTS : COROUTINE_SLOTS; }

int hk_stack_coroutine_slots(void) { return COROUTINE_SLOTS; }
