/* method: one integrator of a tool's run, stepped directly, for `hooke check`. Its system is the run's own, whose
 * functions are counted, noted with their times, and made to fail on demand; its state vector lies between guard pages
 * (common/guard.h). The run's own state does not change. */
#include "tools/native/common/subject.h"

#include <stdlib.h>
#include <string.h>

enum { TIMES = 256, CALLS = 5 };
enum { EVALUATIONS, JACOBIANS, FACTORIZATIONS, SOLVES, MOVES }; /* what is counted */

/* One method is at work at a time. */
static struct {
  hk_system real;         /* with the host's functions */
  hk_linear_table linear; /* the same */
  hk_contact_table contact;
  hk_run *run;
  size_t count[CALLS];
  int fail_what; /* which of the counted calls fails, from the fail_at-th on; 0: none */
  size_t fail_at;
  bool fail_once; /* and no later one */
  hk_status fail_with;
  bool within; /* one of the host's functions is at work and may call others */
  double time[TIMES];
  size_t times;
  hk_guarded X, spare;
} probe;

/* Whether this call is to fail; counts it. */
static bool fails(int what) {
  if (probe.within) return false;
  size_t count = ++probe.count[what];
  if (!probe.fail_at || what != probe.fail_what) return false;
  return probe.fail_once ? count == probe.fail_at : count >= probe.fail_at;
}

static hk_status failure(void) {
  return hk_error_set(&probe.run->error, probe.fail_with, "a failure made by hooke check");
}

static void note(double t) {
  if (probe.times < TIMES) probe.time[probe.times++] = t;
}

/* Calls the host's function, from which the plugin's name is taken meanwhile. */
#define HOST(what, call)                                                                                               \
  do {                                                                                                                 \
    if (fails(what)) return failure();                                                                                 \
    bool outer = probe.within;                                                                                         \
    probe.within = true;                                                                                               \
    hk_status status = (call);                                                                                         \
    probe.within = outer;                                                                                              \
    return status;                                                                                                     \
  } while (0)

static hk_status accelerations(hk_system *s, double t, double *x, double *v, const double *y, double *a, double *dy) {
  if (!probe.within) note(t);
  HOST(EVALUATIONS, probe.real.accelerations(s, t, x, v, y, a, dy));
}

static hk_status fused(hk_system *s, double t, double *x, double *v, const double *y, double *a, double *dy,
                       const hk_fused *work) {
  if (!probe.within) note(t);
  HOST(EVALUATIONS, probe.real.fused(s, t, x, v, y, a, dy, work));
}

/* X keeps its place between the guard pages. */
static void exchange(hk_system *s) {
  for (size_t e = 0; e < s->size; e++) {
    double number = s->X[e];
    s->X[e] = s->spare[e];
    s->spare[e] = number;
  }
}

static hk_status tile(hk_system *s, hk_tile_step *step, size_t count) {
  for (size_t k = 0; k < count && !probe.within; k++) note(step[k].t);
  HOST(EVALUATIONS, probe.real.tile(s, step, count));
}

static hk_status rates(hk_system *s, double t, double *X, double *dX) {
  if (!probe.within) note(t);
  HOST(EVALUATIONS, probe.real.rates(s, t, X, dX));
}

static hk_status jacobian(hk_system *s, double t, double *X, unsigned want, hk_matrix *K, hk_matrix *D) {
  HOST(JACOBIANS, probe.linear.jacobian(s, t, X, want, K, D));
}

static hk_status factorize(hk_system *s, const hk_matrix *A) { HOST(FACTORIZATIONS, probe.linear.factorize(s, A)); }

static hk_status solve(hk_system *s, const double *b, double *x, hk_solve_info *info) {
  HOST(SOLVES, probe.linear.solve(s, b, x, info));
}

static hk_status solve_along(hk_system *s, const double *b, const double *u, double *x, hk_solve_info *info) {
  HOST(SOLVES, probe.linear.solve_along(s, b, u, x, info));
}

static hk_status solve_columns(hk_system *s, const double *b, double *x, size_t columns) {
  HOST(SOLVES, probe.linear.solve_columns(s, b, x, columns));
}

static hk_status update(hk_system *s, double t, const double *X, const double *x_to) {
  HOST(MOVES, probe.real.contact ? probe.real.contact->update(s, t, X, x_to) : HK_OK);
}

static double step_limit(hk_system *s, double t, const double *X, const double *dx) {
  return probe.real.contact ? probe.real.contact->step_limit(s, t, X, dx) : 1;
}

/* ---- Lua ---- */

static hk_instance *method_of(lua_State *L) {
  hk_run *run = hk_lua_run(L);
  hk_instance *m = hk_plugins_one(&run->plugins, HK_INTEGRATOR);
  if (!m) luaL_error(L, "the run has no integrator");
  return m;
}

static hk_status energy(hk_system *s, double t, const double *X, double *kinetic, double *whole) {
  (void)s, (void)t, (void)X;
  *kinetic = *whole = 0;
  return HK_OK;
}

/* Contact as the scene has it, or none that does anything. */
static void offer_contact(hk_system *s) {
  static const hk_contact_table none = {NULL, NULL, NULL, energy};
  probe.contact =
      (hk_contact_table){update, step_limit, hk_forces_potential, (s->contact ? s->contact : &none)->energy};
  s->contact = &probe.contact;
}

/* Takes the run's system over; give_back undoes it. */
static hk_system *take_over(lua_State *L, hk_run *run, hk_guard_side side) {
  hk_system *s = &run->dynamics.system;
  if (!hk_guard_get(&probe.X, "the state X", s->size * sizeof(double), side) ||
      !hk_guard_get(&probe.spare, "the spare memory", s->size * sizeof(double), side))
    luaL_error(L, "no memory");
  memset(probe.count, 0, sizeof probe.count);
  probe.real = *s;
  probe.linear = *s->linear;
  probe.run = run;
  probe.times = 0;
  s->X = probe.X.at;
  if (s->spare) s->spare = probe.spare.at;
  s->accelerations = accelerations;
  s->fused = fused;
  s->tile = tile;
  s->exchange = exchange;
  s->rates = rates;
  s->linear->jacobian = jacobian;
  s->linear->factorize = factorize;
  s->linear->solve = solve;
  s->linear->solve_along = solve_along;
  s->linear->solve_columns = solve_columns;
  if (s->contact) offer_contact(s);
  return s;
}

static void give_back(hk_system *s) {
  hk_system real = probe.real;
  *s = real;
  *s->linear = probe.linear;
  hk_dynamics_take_all(&probe.run->dynamics);
  hk_error_clear(&probe.run->error);
}

/* The fields that need not outlive a step get this byte. */
static void fill_scratch(const hk_instance *m, size_t size, size_t n, int byte) {
  for (const hk_field *f = m->plugin->fields; byte >= 0 && f && f->name; f++) {
    size_t length = f->width * (f->state ? size : n);
    if (f->flags & HK_SCRATCH && (f->state || f->per_particle))
      memset(*(double **)hk_field_in(f, m->self), byte, length * sizeof(double));
  }
  if (byte >= 0) memset(probe.spare.at, byte, size * sizeof(double));
}

static double option(lua_State *L, const char *key, double otherwise) {
  lua_getfield(L, 2, key);
  double value = luaL_optnumber(L, -1, otherwise);
  lua_pop(L, 1);
  return value;
}

static void push_report(lua_State *L, const hk_system *s, const hk_step *out, hk_status status) {
  static const char *const names[CALLS] = {"evaluations", "jacobians", "factorizations", "solves", "moves"};
  lua_newtable(L);
  hk_table_set(L, "status", status);
  hk_table_set(L, "h", out->h);
  hk_table_set(L, "h_next", out->h_next);
  hk_table_set(L, "error", out->error);
  for (int k = 0; k < CALLS; k++) hk_table_set(L, names[k], (double)probe.count[k]);
  hk_table_push(L, probe.X.at, s->size);
  lua_setfield(L, -2, "X");
  hk_table_push(L, probe.time, probe.times);
  lua_setfield(L, -2, "times");
  bool splits = false;
  for (size_t k = 0; k < s->split->forces; k++) splits |= !s->split->takes[k];
  lua_pushboolean(L, splits);
  lua_setfield(L, -2, "splits");
  lua_pushstring(L, probe.run->error.text);
  lua_setfield(L, -2, "message");
}

/* run(run, { t =, h =, X =, steps = 1, stop =, before =, scratch =, contact =, fail_what =, fail_at =, fail_once =,
 * fail_with = })
 * -> a report of the last step, with X, `t`, `taken` steps and the counts of all. An adaptive method takes steps to
 * `stop`; others, and it without a stop, `steps` steps of h. `moved_time` and `changed_system` say what the method did
 * to its host's data. */
static int run_steps(lua_State *L) {
  hk_run *run = hk_lua_run(L);
  hk_instance *m = method_of(L);
  const hk_integrator *method = m->plugin->integrator;
  bool adaptive = method->flags & HK_ADAPTIVE, moved = false, changed = false;
  hk_system *s = take_over(L, run, option(L, "before", 0) != 0 ? HK_GUARD_BEFORE : HK_GUARD_BEHIND);
  size_t steps = (size_t)option(L, "steps", adaptive ? 100000 : 1), size = s->size, taken = 0;
  double h = option(L, "h", 0.01), t = option(L, "t", 0), stop = option(L, "stop", INFINITY);
  bool free = adaptive && stop < INFINITY; /* to choose its steps */
  int scratch = (int)option(L, "scratch", -1);
  if (lua_getfield(L, 2, "X") == LUA_TTABLE)
    hk_table_read(L, lua_gettop(L), probe.X.at, size);
  else
    memcpy(probe.X.at, run->state.X, size * sizeof(double));
  s->t = t;
  if (option(L, "contact", 0) != 0) offer_contact(s);
  probe.fail_what = (int)option(L, "fail_what", 0);
  probe.fail_at = (size_t)option(L, "fail_at", 0);
  probe.fail_once = option(L, "fail_once", 0) != 0;
  probe.fail_with = (hk_status)option(L, "fail_with", HK_FAILED);
  hk_step out = {NAN, NAN, NAN};
  hk_status status = HK_OK;
  while (status == HK_OK && taken < steps && (!adaptive || t < stop)) {
    double end = free ? stop : t + h;
    out = (hk_step){adaptive ? NAN : h, NAN, NAN};
    fill_scratch(m, size, s->n, scratch);
    hk_guard_enter("step");
    status = method->step(m->self, method->method, s, end, h, &out);
    hk_guard_enter(NULL);
    moved |= s->t != t;
    changed |= s->X != probe.X.at || s->size != size || s->n != run->state.model.n;
    taken++;
    if (moved || changed || status != HK_OK) break;
    if (adaptive && !(out.h > 0)) break;
    t = adaptive && t + out.h >= stop * (1 - 1e-14) ? stop : t + out.h;
    if (free && out.h_next > 0) h = out.h_next;
    s->t = t;
  }
  push_report(L, s, &out, status);
  hk_table_set(L, "taken", (double)taken);
  hk_table_set(L, "t", t);
  lua_pushboolean(L, moved);
  lua_setfield(L, -2, "moved_time");
  lua_pushboolean(L, changed);
  lua_setfield(L, -2, "changed_system");
  give_back(s);
  return 1;
}

/* `count` steps of h from s->t by the facet tile; what it sets `count` to. Where it takes none, one by `step`. */
static hk_status take_tile(const hk_instance *m, hk_system *s, double h, size_t *count, double *kept, bool *changed) {
  const hk_integrator_tables *tables = hk_integrator_of(m->plugin);
  const hk_integrator *method = &tables->own;
  double t[HK_TILE_STEPS];
  hk_status status = HK_OK;
  size_t asked = *count;
  for (size_t i = 0; i < asked; i++) t[i] = s->t + (double)(i + 1) * h;
  memcpy(kept, s->X, s->size * sizeof *kept);
  hk_guard_enter("tile");
  if (asked > 0) status = tables->tile.steps(m->self, method->method, s, t, h, count);
  hk_guard_enter(NULL);
  *changed |= memcmp(kept, s->X, s->size * sizeof *kept) != 0;
  if (*count == 0) {
    hk_step out = {h, NAN, NAN};
    hk_guard_enter("step");
    status = method->step(m->self, method->method, s, s->t + h, h, &out);
    hk_guard_enter(NULL);
  } else if (status == HK_OK) {
    memcpy(s->X, s->spare, s->size * sizeof *kept);
  }
  if (*count > asked && asked > 0) status = hk_error_set(&probe.run->error, HK_FAILED, "it takes more than asked for");
  return status;
}

/* tile(run, { t =, h =, steps =, lengths = {...} }) -> X after steps of h from the run's state, in tiles of these
 * lengths in turn, 0: a step alone; how many were taken in tiles; whether X was changed before its end; status; the
 * times of evaluations. */
static int tiles(lua_State *L) {
  hk_run *run = hk_lua_run(L);
  hk_instance *m = method_of(L);
  hk_system *s = take_over(L, run, HK_GUARD_BEHIND);
  size_t steps = (size_t)option(L, "steps", 1), size = s->size, taken = 0, lengths, turn = 0;
  double h = option(L, "h", 0.01), t0 = option(L, "t", 0), *kept = hk_table_memory(L, size);
  bool changed = false;
  hk_status status = HK_OK;
  probe.fail_at = 0;
  memcpy(probe.X.at, run->state.X, size * sizeof(double));
  lua_getfield(L, 2, "lengths");
  lengths = lua_rawlen(L, -1);
  for (size_t k = 0; k < steps && status == HK_OK; turn++) {
    lua_rawgeti(L, -1, (lua_Integer)(turn % lengths) + 1);
    size_t count = (size_t)lua_tointeger(L, -1);
    lua_pop(L, 1);
    if (count > steps - k) count = steps - k;
    s->t = t0 + (double)k * h;
    status = take_tile(m, s, h, &count, kept, &changed);
    taken += count;
    k += count ? count : 1;
  }
  lua_pop(L, 1);
  hk_table_push(L, probe.X.at, size);
  lua_pushinteger(L, (lua_Integer)taken);
  lua_pushboolean(L, changed);
  lua_pushinteger(L, status);
  hk_table_push(L, probe.time, probe.times);
  give_back(s);
  return 5;
}

/* reset(run, "particles", "state" or "step") */
static int reset(lua_State *L) {
  static const char *const reasons[] = {"particles", "state", "step", NULL};
  hk_instance *m = method_of(L);
  int why = luaL_checkoption(L, 2, "state", reasons);
  hk_guard_enter("reset");
  if (m->plugin->integrator->reset) m->plugin->integrator->reset(m->self, (hk_reason)why);
  hk_guard_enter(NULL);
  return 0;
}

/* state(run) -> X, n. flags(run) -> hk_integrator.flags, whether it states its growth, also where velocities turn,
 * whether it can be used with constraints, whether it takes tiles, whether
 * it keeps constraints. */
static int state(lua_State *L) {
  const hk_run *run = hk_lua_run(L);
  hk_table_push(L, run->state.X, run->state.size);
  lua_pushinteger(L, (lua_Integer)run->state.model.n);
  return 2;
}

static int flags(lua_State *L) {
  const hk_instance *instance = method_of(L);
  const hk_integrator_tables *tables = hk_integrator_of(instance->plugin);
  const hk_integrator *m = &tables->own;
  hk_guard_enter("growth");
  bool turns = m->growth && !isnan(m->growth(instance->self, m->method, 0.1, 0.1, 0.1));
  hk_guard_enter(NULL);
  lua_pushinteger(L, m->flags);
  lua_pushboolean(L, m->growth != NULL);
  lua_pushboolean(L, turns);
  lua_pushboolean(L, !tables->constrained.refused);
  lua_pushboolean(L, tables->tile.steps != NULL);
  lua_pushboolean(L, tables->constrained.keeps);
  return 6;
}

/* growth(run, hw, hg [, hb]) -> what the method states, with the parameters of the run. */
static int growth(lua_State *L) {
  const hk_instance *m = method_of(L);
  const hk_integrator *method = m->plugin->integrator;
  double hw = luaL_checknumber(L, 2), hg = luaL_checknumber(L, 3), hb = luaL_optnumber(L, 4, 0);
  hk_guard_enter("growth");
  lua_pushnumber(L, method->growth(m->self, method->method, hw, hg, hb));
  hk_guard_enter(NULL);
  return 1;
}

/* reverse(run): see hk_reverse_chunks. */
static int reverse(lua_State *L) {
  hk_reverse_chunks(method_of(L));
  return 0;
}

static int watch(lua_State *L) {
  hk_guard_watch((int)luaL_checkinteger(L, 1));
  return 0;
}

__attribute__((visibility("default"))) int luaopen_method(lua_State *L);

int luaopen_method(lua_State *L) {
  static const luaL_Reg functions[] = {{"run", run_steps},   {"reset", reset},   {"state", state},
                                       {"flags", flags},     {"growth", growth}, {"watch", watch},
                                       {"reverse", reverse}, {"tile", tiles},    {NULL, NULL}};
  luaL_newlib(L, functions);
  return 1;
}
