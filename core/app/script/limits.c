/* The limits of a script on memory and instructions, kept by Lua's allocator and a hook that counts. An allocation is
 * charged as instructions as well. Once a script has exceeded a limit, every further instruction raises the same error.
 * Each call into the script has a budget of instructions of its own. */
#include "core/app/script/script.h"

#include <stdlib.h>
#include <time.h>

static const size_t default_memory = (size_t)512 << 20; /* bytes */
static const uint64_t default_instructions = 500000000; /* 1.1 to 1.7 s of a processor */
static const double default_seconds = 3;                /* twice that: instructions may call what takes long */
enum { HOOK_COUNT = 10000, BYTES_PER_INSTRUCTION = 16, LARGE = 65536 };
/* A coroutine counts from 0: what it does between two calls of the hook is charged when it is made, so it is less. */
enum { COROUTINE_COUNT = 1000 };
/* Scenes and runs are plain arrays, which double as they grow: the default of 1 GiB holds some 10 million particles. */
enum { ENGINE_SHARE = 2 };

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

/* Sets s->limit: the limit that was exceeded, and the place in the script. */
static void set_limit_error(hk_script *s, const char *place, int line) {
  s->limit = (hk_error){0};
  bool counted = s->instructions > s->instruction_limit;
  if (s->memory_spent && s->refused_by_system)
    hk_error_set(&s->limit, HK_NO_MEMORY, "%s: no memory: the system gives no more to this process", s->name);
  else if (s->memory_spent)
    hk_error_set(&s->limit, HK_SCRIPT, "%s: not enough memory: the script went beyond its limit of %zu MiB", s->name,
                 (s->memory_limit >> 20) * (s->engine_memory / ENGINE_SHARE > s->memory_limit ? ENGINE_SHARE : 1));
  else if (!counted)
    hk_error_set(&s->limit, HK_SCRIPT, "%s:%d: the script ran beyond its limit of %g s: is there an endless loop?",
                 place, line, s->seconds_limit);
  else
    hk_error_set(&s->limit, HK_SCRIPT,
                 "%s:%d: the script ran beyond its limit of %d million instructions: is there an endless loop?", place,
                 line, (int)(s->instruction_limit / 1000000));
}

/* A stack that may not grow (stack.c); where there is no memory yet, `old` is a type, and a stack has none. Nothing
 * catches the error: the script could call itself without end once more. */
static bool overflows(hk_script *s, const void *memory, size_t old, size_t size) {
  lua_Debug ar;
  if ((!memory && old) || !hk_stack_overflows(s, size)) return false;
  s->spent = true;
  if (s->limit.status != HK_OK) return true;
  bool known = false; /* the innermost line of the script; of a coroutine, where it was called */
  for (int level = 0; !known && lua_getstack(s->current, level, &ar); level++)
    known = lua_getinfo(s->current, "Sl", &ar) && ar.currentline > 0;
  hk_error_set(&s->limit, HK_SCRIPT, "%s:%d: stack overflow: calls are nested too deeply: is there one without end?",
               known ? ar.short_src : s->name, known ? ar.currentline : 1);
  return true;
}

static double processor_time(void) {
  struct timespec t = {0};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Of the current call, looked at by the hook and at large allocations alone, so that short calls cost nothing. */
static bool out_of_time(hk_script *s) {
  double now = processor_time();
  if (s->started < 0) s->started = now;
  return now - s->started > s->seconds_limit;
}

static void beat(const hk_script *s) {
  if (s->options.pulse) atomic_fetch_add_explicit(&s->options.pulse->beats, 1, memory_order_relaxed);
}

/* Between two calls of the hook a script may fill much memory: that is no standstill, and it takes time. */
static bool too_slow(hk_script *s) {
  beat(s);
  if (!out_of_time(s)) return false;
  s->spent = true;
  if (s->limit.status == HK_OK) set_limit_error(s, s->name, 1);
  return true;
}

static void *allocate(void *context, void *memory, size_t old, size_t size) {
  hk_script *s = context;
  size_t before = memory ? old : 0;
  if (size == 0) {
    free(memory);
    s->memory -= before;
    return NULL;
  }
  if (size > before && (overflows(s, memory, old, size) || refused(s, memory, size, size - before))) return NULL;
  if (size > before + LARGE && too_slow(s)) return NULL;
  void *grown = realloc(memory, size);
  if (grown) s->memory += size - before;
  if (grown && s->reserving) hk_stack_back(grown, size);
  s->last_size = size;
  s->refused_by_system = !grown;
  return grown;
}

bool hk_limits_inside(hk_script *s, bool inside) {
  hk_pulse *pulse = s->options.pulse;
  if (!pulse) return false;
  beat(s);
  return atomic_exchange_explicit(&pulse->inside, inside, memory_order_relaxed);
}

/* Instructions after which an interruption is heeded, some 0.1 s of a function that a run calls: the run then stops
 * between two steps, where it can be saved. */
static uint64_t grace(const hk_script *s) { return s->finished ? 10000000 : 0; }

static void count_instructions(lua_State *L, lua_Debug *ar) {
  hk_script *s = hk_lua_script(L);
  s->instructions += (uint64_t)lua_gethookcount(L); /* 1 once the limit is exceeded */
  beat(s);
  bool interrupted = s->run_options.interrupted && *s->run_options.interrupted && s->instructions > grace(s);
  if (!s->spent && !interrupted && s->instructions <= s->instruction_limit && !out_of_time(s)) return;
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
  s->seconds_limit = o->trust ? INFINITY : default_seconds;
  s->started = -1;
  s->L = lua_newstate(allocate, s);
  if (!s->L) return false;
  *(hk_script **)lua_getextraspace(s->L) = s;
  s->current = s->L;
  lua_sethook(s->L, count_instructions, LUA_MASKCOUNT, HOOK_COUNT);
  lua_gc(s->L, LUA_GCGEN, 0, 0);
  if (hk_stack_reserve(s, s->L)) return true;
  lua_close(s->L);
  s->L = NULL;
  return false;
}

/* Raises the error of a limit that was exceeded in C code. */
static void raise_limit(lua_State *L, hk_script *s) {
  s->spent = true;
  if (s->limit.status == HK_OK) set_limit_error(s, s->name, 1);
  lua_pushstring(L, s->limit.text);
  lua_error(L);
}

void hk_limits_count(lua_State *L, size_t instructions) {
  hk_script *s = hk_lua_script(L);
  s->instructions += instructions;
  if (s->instructions > s->instruction_limit) raise_limit(L, s);
}

void hk_limits_take(lua_State *L, size_t bytes) {
  hk_script *s = hk_lua_script(L);
  s->engine_memory += bytes < SIZE_MAX / 2 - s->engine_memory ? bytes : SIZE_MAX / 2 - s->engine_memory;
  if (s->engine_memory / ENGINE_SHARE <= s->memory_limit) return;
  s->memory_spent = true;
  raise_limit(L, s);
}

size_t hk_limits_left(const hk_script *s) {
  size_t most = s->memory_limit * ENGINE_SHARE;
  return most > s->engine_memory ? most - s->engine_memory : 1;
}

double hk_limits_pause(hk_script *s) { return s->started < 0 ? -1 : processor_time() - s->started; }

void hk_limits_resume(hk_script *s, double used) {
  if (used >= 0) s->started = processor_time() - used;
}

void hk_limits_coroutine(lua_State *L, lua_State *coroutine) {
  hk_script *s = hk_lua_script(L);
  s->memory_spent = !hk_stack_reserve(s, coroutine);
  if (s->memory_spent) raise_limit(L, s);
  lua_sethook(coroutine, count_instructions, LUA_MASKCOUNT, COROUTINE_COUNT);
  hk_limits_count(L, COROUTINE_COUNT);
}

void hk_limits_renew(lua_State *L) {
  hk_script *s = hk_lua_script(L);
  s->started = -1;
  s->instructions = 0;
  lua_sethook(L, count_instructions, LUA_MASKCOUNT, HOOK_COUNT);
}

int hk_limits_call(lua_State *L, int arguments, int results) {
  hk_script *s = hk_lua_script(L);
  uint64_t outer = s->instructions;
  double started = s->started;
  hk_limits_renew(L);
  bool inside = hk_limits_inside(s, !s->options.trust);
  int base = lua_gettop(L) - arguments - 1, code = lua_pcall(L, arguments, results, 0);
  hk_limits_inside(s, inside);
  if (code == LUA_ERRMEM) s->spent = true;
  if (s->spent) {
    if (code == LUA_ERRMEM && s->instructions <= s->instruction_limit) s->memory_spent = true;
    if (s->limit.status == HK_OK) set_limit_error(s, s->name, 1);
    lua_settop(L, base);   /* a function that got away with an exceeded limit has failed, too */
    lua_pushboolean(L, 0); /* in place of the error: a text would need memory, and s->limit has it */
    code = LUA_ERRRUN;
  }
  s->instructions = outer;
  s->started = started;
  return code;
}
