/* Functions of the script that the engine calls: timed parameters, paths of pins, channel rates, measures, on_frame,
 * exact; and gusts, functions of time that need no script. A call runs under the script's limits and allocates nothing
 * outside a protected call. */
#include "core/app/script/script.h"

#include <string.h>

enum { DEEPEST = 4, ROOM = DEEPEST + 8 }; /* a list of triples is 2 deep */
enum { EMPTY = 1000 };                    /* tables of a result that need not hold a number */

static hk_status wrong_result(const hk_function *f, lua_State *L, hk_error *error, const char *what) {
  lua_Debug ar;
  lua_rawgeti(L, LUA_REGISTRYINDEX, f->reference);
  if (lua_iscfunction(L, -1)) lua_getupvalue(L, -1, 1); /* an adapter around the script's function */
  if (!lua_isfunction(L, -1) || !lua_getinfo(L, ">S", &ar) || ar.linedefined < 1)
    return hk_error_set(error, HK_SCRIPT, "%s: a function returned %s", hk_lua_script(L)->name, what);
  return hk_error_set(error, HK_SCRIPT, "%s:%d: this function returned %s", ar.short_src, ar.linedefined, what);
}

/* Appends the value at `index`, a number or a table of numbers and tables, to `out`. Returns NULL, or a text that says
 * why the value cannot be used. */
static const char *flatten(lua_State *L, int index, int depth, double *out, size_t max, size_t *count, size_t *looks) {
  int type = lua_type(L, index);
  if (type == LUA_TNUMBER) {
    if (*count == max) return "more numbers than are expected";
    out[(*count)++] = lua_tonumber(L, index);
    return NULL;
  }
  if (type == LUA_TNIL) return "nil where a number is needed";
  if (type == LUA_TSTRING) return "a text where a number is needed";
  if (type != LUA_TTABLE) return "something else where a number is needed";
  if (depth == DEEPEST) return "tables nested too deeply";
  if (++*looks > max + EMPTY) return "too many empty tables";
  const char *wrong = NULL;
  for (lua_Integer k = 1; !wrong && lua_rawgeti(L, index, k) != LUA_TNIL; k++) {
    wrong = flatten(L, lua_gettop(L), depth + 1, out, max, count, looks);
    lua_pop(L, 1);
  }
  if (!wrong) lua_pop(L, 1);
  return wrong;
}

/* A result that is not finite is an error that names the function, its line and the time, since it would otherwise
 * appear later as a diverged force. */
static const char *not_finite(const double *out, size_t count) {
  for (size_t k = 0; k < count; k++)
    if (!isfinite(out[k])) return isnan(out[k]) ? "nan" : out[k] > 0 ? "inf" : "-inf";
  return NULL;
}

/* The time, and the particle of a function of the state, at the end of the message; `raised`: of the script's own. */
static void add_place(const hk_function *f, const double *in, bool raised, hk_error *error) {
  size_t length = strlen(error->text), room = sizeof error->text - length;
  char particle[32] = "";
  if (f->id) snprintf(particle, sizeof particle, ", particle %.0f", in[f->id]);
  snprintf(error->text + length, room, raised ? " (at t = %.9g s%s)" : " at t = %.9g s%s", in[0], particle);
}

/* What the script's function does is no doing of the plugin that asked for its value. */
static const hk_instance *leave_plugin(const hk_script *s) {
  const hk_instance *volatile *acting = s->run_options.acting;
  const hk_instance *plugin = acting ? *acting : NULL;
  if (acting) *acting = NULL;
  return plugin;
}

static void push_arguments(lua_State *L, const hk_function *f, const double *in, size_t n_in) {
  for (size_t k = 0; k < n_in; k++)
    if (k && k == f->id)
      lua_pushinteger(L, (lua_Integer)in[k]);
    else
      lua_pushnumber(L, in[k]);
}

static hk_status call_function(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                               size_t max_out, size_t *n_out, hk_error *error) {
  hk_script *s = f->context;
  const hk_run *outer = s->calling;
  lua_State *L = s->current;
  int top = lua_gettop(L);
  const char *wrong = NULL;
  size_t looks = 0;
  *n_out = 0;
  if (!lua_checkstack(L, (int)n_in + ROOM)) return hk_error_set(error, HK_SCRIPT, "the script's calls are too deep");
  lua_rawgeti(L, LUA_REGISTRYINDEX, f->reference);
  push_arguments(L, f, in, n_in);
  s->calling = caller;
  const hk_instance *acting = leave_plugin(s);
  hk_status status = hk_lua_call(L, (int)n_in, max_out ? LUA_MULTRET : 0, error);
  s->calling = outer;
  if (s->run_options.acting) *s->run_options.acting = acting;
  if (status == HK_OK && !lua_checkstack(L, ROOM)) wrong = "too many values";
  for (int k = top + 1, last = lua_gettop(L); status == HK_OK && !wrong && k <= last; k++)
    wrong = flatten(L, k, 0, out, max_out, n_out, &looks);
  if (status == HK_OK && !wrong && n_in) wrong = not_finite(out, *n_out);
  if (wrong) status = wrong_result(f, L, error, wrong);
  if (n_in && (wrong || (f->id && status == HK_SCRIPT))) add_place(f, in, !wrong, error);
  lua_settop(L, top);
  return status;
}

/* ---- many calls in one that is protected ---- */

typedef struct batch {
  const hk_function *f;
  const double *in;
  double *out;
  size_t n_in, n_out, count, made, got;
  const char *wrong;
} batch;

/* NULL, or why the results above index 2 cannot be used. */
static const char *take_results(lua_State *L, batch *b) {
  double *out = b->out + b->made * b->n_out;
  const char *wrong = lua_checkstack(L, ROOM) ? NULL : "too many values";
  size_t looks = 0;
  b->got = 0;
  for (int k = 3, last = lua_gettop(L); !wrong && k <= last; k++)
    wrong = flatten(L, k, 0, out, b->n_out, &b->got, &looks);
  return wrong ? wrong : not_finite(out, b->got);
}

/* The batch is at 1. Every call has a budget of its own. */
static int call_batch(lua_State *L) {
  batch *b = lua_touserdata(L, 1);
  const hk_script *s = hk_lua_script(L);
  luaL_checkstack(L, (int)b->n_in + ROOM, "too many arguments");
  lua_rawgeti(L, LUA_REGISTRYINDEX, b->f->reference);
  for (; b->made < b->count; b->made++) {
    if (b->made) hk_limits_renew(L);
    lua_pushvalue(L, 2);
    push_arguments(L, b->f, b->in + b->made * b->n_in, b->n_in);
    lua_call(L, (int)b->n_in, LUA_MULTRET);
    if (s->spent || (b->wrong = take_results(L, b)) || b->got != b->n_out) return 0;
    lua_settop(L, 2);
  }
  return 0;
}

static hk_status call_each(const hk_function *f, const double *in, size_t n_in, double *out, size_t n_out, size_t count,
                           size_t *made, size_t *got, hk_error *error) {
  hk_script *s = f->context;
  const hk_run *outer = s->calling;
  lua_State *L = s->current;
  int top = lua_gettop(L);
  batch b = {.f = f, .in = in, .out = out, .n_in = n_in, .n_out = n_out, .count = count, .got = n_out};
  if (!lua_checkstack(L, ROOM)) return hk_error_set(error, HK_SCRIPT, "the script's calls are too deep");
  lua_pushcfunction(L, call_batch);
  lua_pushlightuserdata(L, &b);
  s->calling = NULL;
  const hk_instance *acting = leave_plugin(s);
  hk_status status = hk_lua_call(L, 1, 0, error);
  s->calling = outer;
  if (s->run_options.acting) *s->run_options.acting = acting;
  if (status == HK_OK && b.wrong) status = wrong_result(f, L, error, b.wrong);
  if (b.wrong || (f->id && status == HK_SCRIPT)) add_place(f, in + b.made * n_in, !b.wrong, error);
  lua_settop(L, top);
  *made = b.made, *got = b.got;
  return status;
}

/* ---- gusts: a function of C, whose upvalue is the gust ---- */

enum { GUST_COST = 100 }; /* instructions: it is several cosines for each column */

static int gust_at(lua_State *L) {
  const hk_gust *g = lua_touserdata(L, lua_upvalueindex(1));
  double t = luaL_checknumber(L, 1), out[HK_COLUMNS];
  hk_limits_count(L, GUST_COST * g->columns);
  hk_gust_at(g, t, out);
  for (size_t c = 0; c < g->columns; c++) lua_pushnumber(L, out[c]);
  return (int)g->columns;
}

hk_gust *hk_lua_push_gust(lua_State *L) {
  hk_gust *g = lua_newuserdatauv(L, sizeof *g, 0);
  *g = (hk_gust){.columns = 0};
  lua_pushcclosure(L, gust_at, 1);
  return g;
}

/* s; 0: not known. */
static double fastest_of(lua_State *L, int index) {
  if (lua_tocfunction(L, index) != gust_at) return 0;
  lua_getupvalue(L, index, 1);
  double fastest = ((const hk_gust *)lua_touserdata(L, -1))->fastest;
  lua_pop(L, 1);
  return fastest;
}

/* ---- */

hk_function hk_lua_function(lua_State *L, int index) {
  luaL_checktype(L, index, LUA_TFUNCTION);
  double fastest = fastest_of(L, index);
  lua_pushvalue(L, index);
  return (hk_function){.call = call_function,
                       .each = call_each,
                       .context = hk_lua_script(L),
                       .reference = luaL_ref(L, LUA_REGISTRYINDEX),
                       .fastest = fastest};
}

hk_function hk_lua_rate_function(lua_State *L, int index) {
  hk_function function = hk_lua_function(L, index);
  function.id = 1;
  return function;
}
