/* inspect: evaluates one force of a scene directly, for `hooke check`: F, energy, Jacobians, and central differences of
 * them. What is right is decided in Lua (common/check). */
#include "tools/native/common/imports.h"
#include "tools/native/common/outside.h"
#include "tools/native/common/subject.h"

#include <dlfcn.h>
#include <string.h>
#include <time.h>

/* threads(scene, n): sets the number of threads of the scene's run. allocations(scene, n): its plugins get n - 1, 0:
 * any number. */
static int set_threads(lua_State *L) {
  hk_script_run_options(hk_lua_owner(L, 1))->threads = (int)luaL_checkinteger(L, 2);
  return 0;
}

static int set_folder(lua_State *L) {
  hk_script_run_options(hk_lua_owner(L, 1))->out = luaL_checkstring(L, 2);
  lua_settop(L, 2);
  lua_setfield(L, LUA_REGISTRYINDEX, "hooke.check.folder"); /* keeps the text */
  return 0;
}

static int set_allocations(lua_State *L) {
  hk_script_run_options(hk_lua_owner(L, 1))->allocations = (long)luaL_checkinteger(L, 2);
  return 0;
}

/* quiet(): runs of this tool print no warnings, such as those of steps above the limit, which the tools use on
 * purpose. */
static int set_quiet(lua_State *L) {
  hk_script_run_options(hk_lua_script(L))->progress = -1;
  return 0;
}

/* blamed() -> whether the last error of the engine blames a value that the user gave. */
static int blamed(lua_State *L) {
  lua_pushboolean(L, hk_lua_script(L)->raised.status == HK_BAD_PARAM);
  return 1;
}

/* destroy(run): its plugins are destroyed now, not with the script. The run may not be used afterwards. */
static int destroy(lua_State *L) {
  hk_lua_run(L);
  lua_getiuservalue(L, 1, 1);
  hk_lua_slot *slot = ((hk_lua_scene_handle *)lua_touserdata(L, -1))->slot;
  hk_run_close(slot->run, NULL);
  hk_run_destroy(slot->run);
  slot->run = NULL;
  return 0;
}

/* watch(fd [, path]): the last message of this process goes to fd; the heap's functions of the plugin at `path` count.
 */
static int watch(lua_State *L) {
  hk_error error = {0};
  hk_guard_watch((int)luaL_checkinteger(L, 1));
  if (lua_isnoneornil(L, 2)) return 0;
  const hk_loaded *item =
      hk_registry_load(hk_script_asked(hk_lua_script(L))->registry, luaL_checkstring(L, 2), true, &error);
  if (item) hk_imports_watch(dlsym(item->handle, "hk_plugin_main"));
  return 0;
}

/* fill(byte): of new memory of the plugin's heap. heap() -> calls that allocated, calls that freed. */
static int set_fill(lua_State *L) {
  hk_imports_fill((unsigned char)luaL_checkinteger(L, 1));
  return 0;
}

static int get_heap(lua_State *L) {
  hk_heap heap = hk_imports_heap();
  lua_pushinteger(L, (lua_Integer)heap.allocated);
  lua_pushinteger(L, (lua_Integer)heap.freed);
  return 2;
}

/* clock(seconds): the plugin's clocks are ahead by so much. files() -> how many files it has opened. */
static int set_clock(lua_State *L) {
  hk_outside_shift(luaL_checknumber(L, 1));
  return 0;
}

static int get_files(lua_State *L) {
  lua_pushinteger(L, (lua_Integer)hk_outside_files());
  return 1;
}

/* sharpen(subject, part): a force that is not computed to rounding makes its errors `part` of what they were. */
static int sharpen(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  double part = luaL_checknumber(L, 2);
  if (!s->force->approximation.sharpen) return 0;
  hk_subject_enter(s, "sharpen");
  s->force->approximation.sharpen(s->instance->self, part);
  hk_subject_leave(s);
  return 0;
}

/* ---- the state ---- */

/* state(subject) -> {n, t, x, v, y}. */
static int get_state(lua_State *L) {
  const hk_subject *s = hk_subject_at(L, 1);
  lua_newtable(L);
  lua_pushinteger(L, (lua_Integer)s->n);
  lua_setfield(L, -2, "n");
  hk_table_set(L, "t", s->view.t);
  const hk_guarded *all[] = {&s->x, &s->v, &s->y};
  static const char *const key[] = {"x", "v", "y"};
  for (size_t k = 0; k < 3; k++) {
    hk_table_push(L, all[k]->at, all[k]->bytes / sizeof(double));
    lua_setfield(L, -2, key[k]);
  }
  return 1;
}

static void set_array(lua_State *L, const char *key, hk_guarded *g) {
  if (lua_getfield(L, 2, key) == LUA_TTABLE) {
    hk_guard_allow(g, true);
    hk_table_read(L, lua_gettop(L), g->at, g->bytes / sizeof(double));
    hk_guard_allow(g, false);
  }
  lua_pop(L, 1);
}

/* set(subject, {t =, x =, v =, y =, fill =}): what is given; `fill` is a byte below the stack of each call, negative:
 * none. */
static int set_state(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  set_array(L, "x", &s->x);
  set_array(L, "v", &s->v);
  set_array(L, "y", &s->y);
  if (lua_getfield(L, 2, "t") == LUA_TNUMBER) s->view.t = lua_tonumber(L, -1);
  if (lua_getfield(L, 2, "fill") == LUA_TNUMBER) s->fill = (int)lua_tointeger(L, -1);
  return 0;
}

/* ---- force, energy, rates ---- */

/* force(subject [, start [, power]]) -> F + start, the power added to what stood there (nil: the view had no power),
 * whether it was fine. */
static int get_force(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  double start = luaL_optnumber(L, 2, 0), power = luaL_optnumber(L, 3, NAN), *F = s->F.at;
  for (size_t k = 0; k < s->size; k++) F[k] = start;
  s->status = HK_OK;
  double added = hk_subject_add(s, power);
  hk_table_push(L, F, s->size);
  lua_pushnumber(L, added);
  lua_pushboolean(L, s->status == HK_OK);
  return 3;
}

/* bytes(subject) -> F as a string. */
static int get_bytes(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  memset(s->F.at, 0, s->F.bytes);
  hk_subject_add(s, NAN);
  lua_pushlstring(L, s->F.at, s->F.bytes);
  return 1;
}

/* reverse(subject): see hk_reverse_chunks. */
static int reverse(lua_State *L) {
  hk_reverse_chunks(hk_subject_at(L, 1)->instance);
  return 0;
}

static int get_energy(lua_State *L) {
  lua_pushnumber(L, hk_subject_energy(hk_subject_at(L, 1)));
  return 1;
}

/* rates(subject, start) -> dy + start; nil: it has none. */
static int get_rates(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  double start = luaL_optnumber(L, 2, 0), *dy = s->dy.at;
  size_t count = s->dy.bytes / sizeof *dy;
  if (!s->force->own.rates) return 0;
  for (size_t k = 0; k < count; k++) dy[k] = start;
  hk_subject_enter(s, "rates");
  s->force->own.rates(s->instance->self, &s->view, dy);
  hk_subject_leave(s);
  hk_table_push(L, dy, count);
  return 1;
}

/* ---- differences ---- */

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* seconds(subject) -> the time of one evaluation, the least of several, since other load can only increase it. */
static int get_seconds(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  double best = INFINITY;
  for (int k = 0; k < 10; k++) {
    double begin = now();
    hk_subject_add(s, NAN);
    best = fmin(best, now() - begin);
  }
  lua_pushnumber(L, best);
  return 1;
}

static hk_guarded *variable(lua_State *L, hk_subject *s) {
  static const char *const names[] = {"x", "v", NULL};
  return luaL_checkoption(L, 2, NULL, names) ? &s->v : &s->x;
}

/* gradient(subject, "x" or "v", h) -> the central differences of the energy. */
static int energy_differences(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  hk_guarded *of = variable(L, s);
  double h = luaL_checknumber(L, 3), *z = of->at, *result = hk_table_memory(L, s->size);
  hk_guard_allow(of, true);
  for (size_t k = 0; k < s->size; k++) {
    double at = z[k];
    z[k] = at + h;
    double up = hk_subject_energy(s);
    z[k] = at - h;
    result[k] = (up - hk_subject_energy(s)) / (2 * h);
    z[k] = at;
  }
  hk_guard_allow(of, false);
  hk_table_push(L, result, s->size);
  return 1;
}

/* slopes(subject, "x" or "v", h) -> -dF/dz by central differences, 3n x 3n. */
static int force_differences(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  hk_guarded *of = variable(L, s);
  double h = luaL_checknumber(L, 3), *z = of->at, *F = s->F.at, *result = hk_table_memory(L, s->size * s->size);
  hk_guard_allow(of, true);
  for (size_t k = 0; k < s->size; k++)
    for (int side = 0; side < 2; side++) {
      double at = z[k];
      z[k] = side ? at - h : at + h;
      memset(F, 0, s->F.bytes);
      hk_subject_add(s, NAN);
      for (size_t r = 0; r < s->size; r++) result[r * s->size + k] += (side ? F[r] : -F[r]) / (2 * h);
      z[k] = at;
    }
  hk_guard_allow(of, false);
  hk_table_push(L, result, s->size * s->size);
  return 1;
}

/* ---- Jacobians ---- */

typedef struct names {
  hk_pattern pattern; /* first member */
  size_t count, room;
  uint32_t (*at)[2];
} names;

static void name_block(hk_pattern *pattern, uint32_t row, uint32_t column) {
  names *list = (names *)(void *)pattern;
  if (list->count < list->room) list->at[list->count][0] = row, list->at[list->count][1] = column;
  list->count++;
}

/* Has the force name its blocks, twice to count and to store them. False: the second naming differs. */
static bool collect(lua_State *L, hk_subject *s, names *list) {
  *list = (names){{name_block}, 0, 0, NULL};
  hk_subject_enter(s, "pattern");
  s->force->implicit.pattern(s->instance->self, &s->view, &list->pattern);
  list->room = list->count;
  list->at = lua_newuserdatauv(L, (list->room + 1) * sizeof *list->at, 0);
  list->count = 0;
  s->force->implicit.pattern(s->instance->self, &s->view, &list->pattern);
  hk_subject_leave(s);
  return list->count == list->room;
}

/* pattern(subject) -> rows and columns in turn, from 0; nil and why not. */
static int get_pattern(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  names list;
  if (!s->force->implicit.pattern) return 0;
  if (!collect(L, s, &list)) {
    lua_pushnil(L);
    lua_pushfstring(L, "%I blocks, then %I", (LUAI_UACINT)list.room, (LUAI_UACINT)list.count);
    return 2;
  }
  lua_newtable(L);
  for (size_t k = 0; k < 2 * list.count; k++) {
    lua_pushinteger(L, list.at[k / 2][k % 2]);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  return 1;
}

static void expand(const hk_subject *s, const names *list, const double *block, double *full) {
  for (size_t b = 0; b < list->count; b++)
    for (size_t q = 0; q < 9 && list->at[b][0] < s->n && list->at[b][1] < s->n; q++)
      full[(3 * list->at[b][0] + q / 3) * s->size + 3 * list->at[b][1] + q % 3] += block[9 * b + q];
}

/* blocks(subject, want, start) -> K and D, 3n x 3n, of blocks that held `start` before, which is taken off again; and
 * whether it was fine. */
static int get_blocks(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  unsigned want = (unsigned)luaL_optinteger(L, 2, 0);
  double start = luaL_optnumber(L, 3, 0);
  names list;
  if (!s->force->implicit.jacobian || !collect(L, s, &list)) return 0;
  hk_guarded all = {0}, slots = {0};
  size_t bytes = 9 * list.count * sizeof(double);
  if (!hk_guard_get(&all, "the blocks D (or K)", 2 * bytes, s->side) ||
      !hk_guard_get(&slots, "the slots of the blocks", list.count * sizeof(size_t), s->side))
    return luaL_error(L, "no memory for the blocks");
  double *K = all.at, *D = K + 9 * list.count;
  for (size_t k = 0; k < 18 * list.count; k++) K[k] = start;
  /* In another order than they were named, so that a force cannot go by its own count. */
  for (size_t b = 0; b < list.count; b++) ((size_t *)slots.at)[b] = list.count - 1 - b;
  hk_guard_allow(&slots, false);
  hk_subject_enter(s, "jacobian");
  hk_blocks into = {.slot = slots.at, .K = K, .D = D, .want = want};
  hk_status status = s->force->implicit.jacobian(s->instance->self, &s->view, &into);
  hk_subject_leave(s);
  for (size_t k = 0; k < 18 * list.count; k++) K[k] -= start;
  for (size_t b = 0; b < list.count / 2; b++) {
    uint32_t other[2];
    memcpy(other, list.at[b], sizeof other);
    memcpy(list.at[b], list.at[list.count - 1 - b], sizeof other);
    memcpy(list.at[list.count - 1 - b], other, sizeof other);
  }
  for (int m = 0; m < 2; m++) {
    double *full = hk_table_memory(L, s->size * s->size);
    expand(s, &list, m ? D : K, full);
    hk_table_push(L, full, s->size * s->size);
    lua_remove(L, -2);
  }
  hk_guard_free(&all);
  hk_guard_free(&slots);
  lua_pushboolean(L, status == HK_OK);
  return 3;
}

__attribute__((visibility("default"))) int luaopen_inspect(lua_State *L);

int luaopen_inspect(lua_State *L) {
  static const luaL_Reg functions[] = {{"threads", set_threads},
                                       {"allocations", set_allocations},
                                       {"folder", set_folder},
                                       {"destroy", destroy},
                                       {"blamed", blamed},
                                       {"quiet", set_quiet},
                                       {"watch", watch},
                                       {"fill", set_fill},
                                       {"heap", get_heap},
                                       {"clock", set_clock},
                                       {"files", get_files},
                                       {"open", hk_subject_open},
                                       {"sharpen", sharpen},
                                       {"state", get_state},
                                       {"set", set_state},
                                       {"force", get_force},
                                       {"bytes", get_bytes},
                                       {"parts", hk_subject_parts},
                                       {"reverse", reverse},
                                       {"energy", get_energy},
                                       {"rates", get_rates},
                                       {"seconds", get_seconds},
                                       {"gradient", energy_differences},
                                       {"slopes", force_differences},
                                       {"pattern", get_pattern},
                                       {"blocks", get_blocks},
                                       {"transposed", hk_subject_transposed},
                                       {"along", hk_subject_along},
                                       {"pair", hk_subject_pair},
                                       {"bilinear", hk_subject_bilinear},
                                       {NULL, NULL}};
  luaL_newlib(L, functions);
  return 1;
}
