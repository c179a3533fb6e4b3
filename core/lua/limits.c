/* The limits of a script on memory and instructions, kept by Lua's allocator and a hook that counts. An allocation is
 * charged as instructions as well. Once a script has exceeded a limit, every further instruction raises the same error.
 * Each call into the script has a budget of instructions of its own. */
#include "core/lua/internal.h"

#include <stdlib.h>

static const size_t default_memory = (size_t)512 << 20; /* bytes */
static const uint64_t default_instructions = 500000000; /* about three seconds */
/* Lua 5.4.4 reads a stale pointer when the stack moves inside a __concat of a chain, a .. b .. c, which scripts use to
 * join edges. Slots reserved at the bottom of the stack are never released, so the stack does not move at ordinary
 * depths. */
enum { STACK_SLOTS = 4000 };

enum { HOOK_COUNT = 10000, BYTES_PER_INSTRUCTION = 16, LARGE = 65536 };

hk_script *hk_lua_script(lua_State *L) { return *(hk_script **)lua_getextraspace(L); }

/* Lua repeats a refused request after collecting garbage: the second refusal of the same request is final. */
static bool refused(hk_script *s, const void *memory, size_t size, size_t more) {
  bool over = s->instructions > s->instruction_limit && more > LARGE; /* the message needs small ones */
  bool full = s->memory + more > s->memory_limit;
  bool same = s->refused_size == size && s->refused == memory;
  if (full && same) s->spent = s->memory_spent = true;
  if (full || same) {
    s->refused = full ? memory : NULL;
    s->refused_size = full ? size : 0;
  }
  if (!full) s->instructions += more / BYTES_PER_INSTRUCTION;
  return full || over;
}

static void *allocate(void *context, void *memory, size_t old, size_t size) {
  hk_script *s = context;
  size_t before = memory ? old : 0;
  if (size == 0) {
    free(memory);
    s->memory -= before;
    return NULL;
  }
  if (size > before && refused(s, memory, size, size - before)) return NULL;
  void *grown = realloc(memory, size);
  if (grown) s->memory += size - before;
  return grown;
}

/* Sets s->limit: the limit that was exceeded, and the place in the script. */
static void set_limit_error(hk_script *s, const char *place, int line) {
  s->limit = (hk_error){0};
  if (s->memory_spent)
    hk_error_set(&s->limit, HK_SCRIPT, "%s: not enough memory: the script went beyond its limit of %zu MiB", s->name,
                 s->memory_limit >> 20);
  else
    hk_error_set(&s->limit, HK_SCRIPT,
                 "%s:%d: the script ran beyond its limit of %d million instructions: is there an endless loop?", place,
                 line, (int)(s->instruction_limit / 1000000));
}

/* Instructions after which an interruption is heeded, some 0.1 s of a function that a run calls: the run then stops
 * between two steps, where it can be saved. */
static uint64_t grace(const hk_script *s) { return s->finished ? 10000000 : 0; }

static void count_instructions(lua_State *L, lua_Debug *ar) {
  hk_script *s = hk_lua_script(L);
  s->instructions += HOOK_COUNT;
  bool interrupted = s->run_options.interrupted && *s->run_options.interrupted && s->instructions > grace(s);
  if (!s->spent && !interrupted && s->instructions <= s->instruction_limit) return;
  s->spent = true;
  lua_sethook(L, count_instructions, LUA_MASKCOUNT, 1); /* each instruction now raises the error */
  lua_getinfo(L, "Sl", ar);
  if (interrupted)
    s->limit = (hk_error){HK_INTERRUPTED, "interrupted"};
  else if (s->limit.status == HK_OK)
    set_limit_error(s, ar->short_src, ar->currentline);
  lua_pushstring(L, s->limit.text);
  lua_error(L);
}

bool hk_limits_open(hk_script *s) {
  const hk_script_options *o = &s->options;
  s->memory_limit = o->memory_limit ? o->memory_limit : o->trust ? SIZE_MAX / 2 : default_memory;
  s->instruction_limit = o->instruction_limit ? o->instruction_limit : o->trust ? UINT64_MAX / 2 : default_instructions;
  s->L = lua_newstate(allocate, s);
  if (!s->L) return false;
  *(hk_script **)lua_getextraspace(s->L) = s;
  s->current = s->L;
  lua_sethook(s->L, count_instructions, LUA_MASKCOUNT, HOOK_COUNT);
  lua_gc(s->L, LUA_GCGEN, 0, 0);
  lua_checkstack(s->L, STACK_SLOTS);
  return true;
}

int hk_limits_call(lua_State *L, int arguments, int results) {
  hk_script *s = hk_lua_script(L);
  uint64_t outer = s->instructions;
  s->instructions = 0;
  lua_sethook(L, count_instructions, LUA_MASKCOUNT, HOOK_COUNT);
  int code = lua_pcall(L, arguments, results, 0);
  if (code == LUA_ERRMEM) s->spent = true;
  if (s->spent && code != LUA_OK) {
    if (s->instructions <= s->instruction_limit) s->memory_spent = true;
    if (s->limit.status == HK_OK) set_limit_error(s, s->name, 1);
  }
  s->instructions = outer;
  return code;
}
