/* members: the further functions of a force, called for `hooke check` on a subject of the module inspect: elements,
 * bounds, contact, encounters; births and deaths; what checkpoints save. */
#include "tools/native/common/subject.h"

#include "core/numerics/population/population.h"

#include <stdlib.h>
#include <string.h>

static bool has(lua_State *L, bool function) {
  if (!function) lua_pushnil(L);
  return function;
}

/* bound(subject, part, start) -> block[i] + start, 6 numbers a particle; part: 0 whole, 1 undamped, 2 damping. */
static int bound(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  hk_guarded g = {0};
  double start = luaL_optnumber(L, 3, 0);
  if (!has(L, s->force->bounds.stiffness_bound)) return 1;
  if (!hk_guard_get(&g, "the blocks of stiffness_bound", 6 * s->n * sizeof(double), s->side))
    return luaL_error(L, "no memory");
  for (size_t k = 0; k < 6 * s->n; k++) ((double *)g.at)[k] = start;
  hk_subject_enter(s, "stiffness_bound");
  s->force->bounds.stiffness_bound(s->instance->self, &s->view, (hk_stiffness_part)luaL_checkinteger(L, 2), g.at);
  hk_subject_leave(s);
  hk_table_push(L, g.at, 6 * s->n);
  hk_guard_free(&g);
  return 1;
}

/* ---- elements ---- */

static void push_tuple(lua_State *L, const hk_elements *e, size_t k, const double *C, const double (*dC)[3]) {
  size_t arity = e->node.arity;
  lua_newtable(L);
  for (size_t m = 0; m < arity; m++) {
    lua_pushinteger(L, hk_tuple(&e->node, k)[m]);
    lua_rawseti(L, -2, (lua_Integer)m + 1);
  }
  hk_table_set(L, "stiffness", hk_tuple_value(&e->stiffness, k));
  hk_table_set(L, "damping", e->damping.count ? hk_tuple_value(&e->damping, k) : 0);
  hk_table_push(L, C + k * e->values, e->values);
  lua_setfield(L, -2, "C");
  hk_table_push(L, dC[k * e->values * arity], 3 * e->values * arity);
  lua_setfield(L, -2, "dC");
}

/* C and dC of plain edges, as the contract defines them. */
static void edge(const hk_elements *e, const double *x, size_t k, double *C, double (*dC)[3]) {
  const uint32_t *pair = hk_tuple(&e->node, k);
  double length = 0;
  for (int c = 0; c < 3; c++) {
    dC[1][c] = x[3 * (size_t)pair[1] + c] - x[3 * (size_t)pair[0] + c];
    length += dC[1][c] * dC[1][c];
  }
  length = sqrt(length);
  for (int c = 0; c < 3; c++) dC[1][c] /= length, dC[0][c] = -dC[1][c];
  *C = length - (e->rest.count ? hk_tuple_value(&e->rest, k) : 0);
}

/* Evaluates the tuples in ranges of `grain`, in arrays that hold NaN before. */
static int push_list(lua_State *L, hk_subject *s, const hk_elements *e, size_t grain) {
  hk_guarded C = {0}, dC = {0};
  size_t arity = e->node.arity, count = e->node.count, width = e->values;
  if (arity < 1 || arity > 4 || width < 1 || width > HK_ELEMENT_VALUES)
    return luaL_error(L, "elements: %d members and %d values: must be 1 to 4 and 1 to %d", (int)arity, (int)width,
                      (int)HK_ELEMENT_VALUES);
  double *kept = hk_table_memory(L, count * width), *slopes = hk_table_memory(L, 3 * count * width * arity);
  for (size_t begin = 0; begin < count; begin += grain) {
    size_t end = begin + grain < count ? begin + grain : count, part = (end - begin) * width;
    if (!hk_guard_get(&C, "the values C", part * sizeof(double), s->side) ||
        !hk_guard_get(&dC, "the gradients dC", 3 * part * arity * sizeof(double), s->side))
      return luaL_error(L, "no memory");
    memset(C.at, 0xff, C.bytes);
    memset(dC.at, 0xff, dC.bytes);
    hk_subject_enter(s, "elements.evaluate");
    if (e->evaluate)
      e->evaluate(e->self, s->x.at, begin, end, C.at, dC.at);
    else
      for (size_t k = begin; k < end; k++)
        edge(e, s->x.at, k, (double *)C.at + (k - begin), (double(*)[3])dC.at + 2 * (k - begin));
    hk_subject_leave(s);
    memcpy(kept + begin * width, C.at, C.bytes);
    memcpy(slopes + 3 * begin * width * arity, dC.at, dC.bytes);
  }
  hk_guard_free(&C);
  hk_guard_free(&dC);
  lua_newtable(L);
  for (size_t k = 0; k < count; k++) {
    push_tuple(L, e, k, kept, (const double(*)[3])(const void *)slopes);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  return 1;
}

/* elements(subject [, grain]) -> a list of lists of tuples { members (from 0), C, dC, stiffness, damping }, evaluated
 * in ranges of `grain` tuples; nil: it has none. The structs hold garbage before the call. */
static int elements(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  size_t lists = s->force->elements.lists ? s->force->elements.lists : 1,
         grain = (size_t)luaL_optinteger(L, 2, 1 << 30);
  if (!has(L, s->force->elements.list)) return 1;
  hk_elements *list = lua_newuserdatauv(L, lists * sizeof *list, 0);
  memset(list, 0, lists * sizeof *list);
  hk_subject_enter(s, "elements");
  s->force->elements.list(s->instance->self, &s->view, list);
  hk_subject_leave(s);
  if (!has(L, list[0].values > 0 || list[0].node.arity == 0)) return 1; /* none with these parameters */
  lua_newtable(L);
  int result = lua_gettop(L);
  for (size_t k = 0; k < lists; k++) {
    push_list(L, s, &list[k], grain);
    lua_rawseti(L, result, (lua_Integer)k + 1);
    lua_settop(L, result);
  }
  return 1;
}

/* ---- contact ---- */

static double *other(lua_State *L, hk_subject *s, int index) {
  hk_guard_allow(&s->dx, true);
  hk_table_read(L, index, s->dx.at, s->size);
  hk_guard_allow(&s->dx, false);
  return s->dx.at;
}

/* update(subject, x_to) -> whether it reports a changed pattern, whether it was fine. */
static int update(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  bool changed = false;
  if (!has(L, s->force->steps.update)) return 1;
  const double *x_to = other(L, s, 2);
  hk_subject_enter(s, "update");
  hk_status status = s->force->steps.update(s->instance->self, &s->view, x_to, &changed);
  hk_subject_leave(s);
  lua_pushboolean(L, changed);
  lua_pushboolean(L, status == HK_OK);
  return 2;
}

/* limit(subject, dx) -> step_limit. longest(subject) -> longest_step. */
static int limit(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  if (!has(L, s->force->surfaces.step_limit)) return 1;
  const double *dx = other(L, s, 2);
  hk_subject_enter(s, "step_limit");
  lua_pushnumber(L, s->force->surfaces.step_limit(s->instance->self, &s->view, dx));
  hk_subject_leave(s);
  return 1;
}

static int longest(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  if (!has(L, s->force->bounds.longest_step)) return 1;
  hk_subject_enter(s, "longest_step");
  lua_pushnumber(L, s->force->bounds.longest_step(s->instance->self, &s->view));
  hk_subject_leave(s);
  return 1;
}

/* accepted(subject, h) -> whether it was fine. */
static int accepted(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  if (!has(L, s->force->steps.accepted)) return 1;
  hk_subject_enter(s, "accepted");
  lua_pushboolean(L, s->force->steps.accepted(s->instance->self, &s->view, luaL_checknumber(L, 2)) == HK_OK);
  hk_subject_leave(s);
  return 1;
}

/* evolve(subject, h) -> what it dissipated, whether it says that the force changed, and that the blocks did, whether it
 * was fine. The subject's time becomes that of the last accepted state. */
static int evolve(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  hk_evolution e = {0};
  if (!has(L, s->force->internal.evolve)) return 1;
  hk_subject_enter(s, "evolve");
  hk_status status = s->force->internal.evolve(s->instance->self, &s->view, luaL_checknumber(L, 2), &e);
  hk_subject_leave(s);
  s->run->state.model.t = s->view.t;
  lua_pushnumber(L, e.dissipated);
  lua_pushboolean(L, e.changed);
  lua_pushboolean(L, e.pattern_changed);
  lua_pushboolean(L, status == HK_OK);
  return 4;
}

/* ---- encounters ---- */

typedef struct collector {
  hk_encounters encounters; /* first member */
  lua_State *L;
  lua_Integer count;
} collector;

static void push_at(lua_State *L, const char *key, const hk_encounter *p, double part,
                    void (*F)(const void *, const double *, double *), const void *self) {
  double r[3], force[3] = {NAN, NAN, NAN};
  for (int c = 0; c < 3; c++) r[c] = p->r[c] + part * p->dr[c];
  F(self, r, force);
  hk_table_push(L, force, 3);
  lua_setfield(L, -2, key);
}

/* F where r is least, and at 1.01 times that distance: F_near and F_out; `nearest` is the distance, m. */
static void push_nearest(lua_State *L, const hk_encounter *p, void (*F)(const void *, const double *, double *),
                         const void *self) {
  double along = 0, length2 = 0, near[3], nearest = 0;
  for (int c = 0; c < 3; c++) along -= p->r[c] * p->dr[c], length2 += p->dr[c] * p->dr[c];
  double part = length2 > 0 ? fmin(1, fmax(0, along / length2)) : 0;
  for (int c = 0; c < 3; c++) near[c] = p->r[c] + part * p->dr[c], nearest += near[c] * near[c];
  hk_encounter out = {.r = {1.01 * near[0], 1.01 * near[1], 1.01 * near[2]}};
  hk_table_set(L, "nearest", sqrt(nearest));
  push_at(L, "F_near", p, part, F, self);
  push_at(L, "F_out", &out, 0, F, self);
}

static void add_encounter(hk_encounters *into, const hk_encounter *p, void (*F)(const void *, const double *, double *),
                          const void *self) {
  collector *c = (collector *)(void *)into;
  lua_State *L = c->L;
  luaL_checkstack(L, 8, "encounters");
  lua_newtable(L);
  hk_table_set(L, "i", p->i);
  hk_table_set(L, "other", p->other);
  hk_table_set(L, "range", p->range);
  hk_table_push(L, p->r, 3);
  lua_setfield(L, -2, "r");
  hk_table_push(L, p->dr, 3);
  lua_setfield(L, -2, "dr");
  push_at(L, "F_from", p, 0, F, self);
  push_at(L, "F_to", p, 1, F, self);
  push_nearest(L, p, F, self);
  lua_rawseti(L, -2, ++c->count);
}

/* encounters(subject, x_from) -> a list of { i, other (from 0), r, dr, range, F_from, F_to }; nil: it has none. */
static int encounters(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  if (!has(L, s->force->encounters.find)) return 1;
  const double *x_from = other(L, s, 2);
  collector c = {{add_encounter}, L, 0};
  lua_newtable(L);
  hk_subject_enter(s, "encounters");
  bool any = s->force->encounters.find(s->instance->self, &s->view, x_from, &c.encounters);
  hk_subject_leave(s);
  if (!any && c.count == 0) lua_pushnil(L);
  return 1;
}

/* ---- births and deaths ---- */

/* change(run, {index, ...}, {{x, y, z}, ...}): those particles (from 0) die, and others of 1 kg are born. Subjects of
 * the run are void afterwards. */
static int change(lua_State *L) {
  hk_run *run = hk_lua_run(L);
  const hk_instances *forces = &run->plugins.kind[HK_FORCE];
  size_t n_old = run->state.model.n, deaths = lua_rawlen(L, 2), births = lua_rawlen(L, 3);
  hk_population_change *c = hk_population_open(&run->state);
  if (!c) return luaL_error(L, "births and deaths: no memory");
  c->source = forces->item[0];
  hk_status status = hk_population_begin(c, &run->error);
  for (size_t k = 0; k < deaths && status == HK_OK; k++, lua_pop(L, 1)) {
    lua_rawgeti(L, 2, (lua_Integer)k + 1);
    status = c->population.remove(&c->population, (uint32_t)lua_tointeger(L, -1));
  }
  for (size_t k = 0; k < births && status == HK_OK; k++, lua_pop(L, 1)) {
    hk_birth birth = {.mass = 1};
    lua_rawgeti(L, 3, (lua_Integer)k + 1);
    hk_table_read(L, lua_gettop(L), birth.position, 3);
    status = c->population.add(&c->population, &birth, NULL);
  }
  hk_guard_enter("topology");
  if (status == HK_OK) status = hk_population_apply(c, &run->error);
  if (status == HK_OK) status = hk_dynamics_remap(&run->dynamics, c->map, n_old);
  if (status == HK_OK) hk_dynamics_refresh(&run->dynamics);
  if (status == HK_OK) status = hk_forces_settle(&run->dynamics);
  hk_guard_enter(NULL);
  hk_population_close(c);
  if (status != HK_OK) return luaL_error(L, "births and deaths: %s", run->error.text);
  return 0;
}

/* ---- what a checkpoint saves ---- */

typedef struct tape {
  luaL_Buffer *buffer; /* writing; NULL: reading */
  const char *at;
  size_t left;
} tape;

static bool visit(void *context, void *data, size_t bytes) {
  tape *t = context;
  if (t->buffer) {
    if (data) luaL_addlstring(t->buffer, data, bytes);
    return true;
  }
  if (bytes > t->left) return false;
  if (!data) return true;
  memcpy(data, t->at, bytes);
  t->at += bytes;
  t->left -= bytes;
  return true;
}

/* save(subject) -> its fields as a string. restore(subject, string) -> whether they could be read. */
static int save(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  luaL_Buffer buffer;
  luaL_buffinit(L, &buffer);
  tape t = {.buffer = &buffer};
  hk_fields_visit(s->instance, s->n, s->run->state.size, visit, &t);
  luaL_pushresult(&buffer);
  return 1;
}

static int restore(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  tape t = {NULL, NULL, 0};
  t.at = luaL_checklstring(L, 2, &t.left);
  lua_pushboolean(L, hk_fields_visit(s->instance, s->n, s->run->state.size, visit, &t) && t.left == 0);
  return 1;
}

/* left(run) -> the number of allocations that the run's plugins may still make. selection(subject) -> a list, true: it
 * acts on the particle; nil: it acts on all. */
static int left(lua_State *L) {
  lua_pushinteger(L, hk_lua_run(L)->shared.allocations_left);
  return 1;
}

static int selection(lua_State *L) {
  const hk_subject *s = hk_subject_at(L, 1);
  if (!has(L, s->view.is_active)) return 1;
  lua_newtable(L);
  for (size_t i = 0; i < s->n; i++) {
    lua_pushboolean(L, s->view.is_active[i]);
    lua_rawseti(L, -2, (lua_Integer)i + 1);
  }
  return 1;
}

/* watch(fd): as the module inspect's. */
static int watch(lua_State *L) {
  hk_guard_watch((int)luaL_checkinteger(L, 1));
  return 0;
}

/* flags(subject) -> hk_force.flags, and a table of the members that it has. */
static int flags(lua_State *L) {
  const hk_force_tables *f = hk_subject_at(L, 1)->force;
  const struct {
    const char *name;
    bool there;
  } member[] = {{"rates", f->own.rates},
                {"elements", f->elements.list},
                {"stiffness_bound", f->bounds.stiffness_bound},
                {"update", f->steps.update},
                {"step_limit", f->surfaces.step_limit},
                {"longest_step", f->bounds.longest_step},
                {"accepted", f->steps.accepted},
                {"evolve", f->internal.evolve},
                {"encounters", f->encounters.find},
                {"add_part", f->own.add_part}};
  lua_pushinteger(L, f->own.flags);
  lua_newtable(L);
  for (size_t k = 0; k < sizeof member / sizeof *member; k++) {
    lua_pushboolean(L, member[k].there);
    lua_setfield(L, -2, member[k].name);
  }
  return 2;
}

__attribute__((visibility("default"))) int luaopen_members(lua_State *L);

int luaopen_members(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"bound", bound},         {"elements", elements}, {"update", update},     {"limit", limit},
      {"longest", longest},     {"evolve", evolve},     {"accepted", accepted}, {"encounters", encounters},
      {"change", change},       {"save", save},         {"restore", restore},   {"left", left},
      {"selection", selection}, {"flags", flags},       {"watch", watch},       {NULL, NULL}};
  luaL_newlib(L, functions);
  return 1;
}
