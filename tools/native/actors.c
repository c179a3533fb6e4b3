/* actors: calls of a constraint, a corrector, a source or a service, for `hooke check`. What is right is decided in Lua
 * (common/check). */
#include "tools/native/common/actor.h"

#include <string.h>

/* Pushes whether it was fine, and on the way back clears what the plugin said. */
static void push_status(lua_State *L, hk_actor *a, hk_status status) {
  lua_pushboolean(L, status == HK_OK);
  hk_actor_push_said(L, a);
  hk_guard_enter(NULL);
}

static const hk_plugin *plugin_of(const hk_actor *a) { return a->instance->plugin; }

/* state(actor) -> {n =, t =, x =, v =, mass =, fixed =} */
static int state(lua_State *L) {
  const hk_actor *a = hk_actor_at(L, 1);
  lua_newtable(L);
  hk_table_set(L, "n", (double)a->n);
  hk_table_set(L, "t", a->view.t);
  hk_table_push(L, a->x.at, 3 * a->n);
  lua_setfield(L, -2, "x");
  hk_table_push(L, a->v.at, 3 * a->n);
  lua_setfield(L, -2, "v");
  hk_table_push(L, a->view.model->mass, a->n);
  lua_setfield(L, -2, "mass");
  hk_table_push(L, a->view.model->inverse_mass, a->n);
  lua_setfield(L, -2, "inverse_mass");
  return 1;
}

/* flags(actor) -> the flags of its table, and {NAME = true} of the functions that it may leave out. */
static int flags(lua_State *L) {
  const hk_actor *a = hk_actor_at(L, 1);
  const hk_plugin *p = plugin_of(a);
  lua_pushinteger(L, p->kind == HK_CONSTRAINT  ? (lua_Integer)p->constraint->flags
                     : p->kind == HK_CORRECTOR ? (lua_Integer)p->corrector->flags
                     : p->kind == HK_SOURCE    ? (lua_Integer)p->source->flags
                                               : 0);
  lua_newtable(L);
  lua_pushboolean(L, (p->kind == HK_CONSTRAINT && p->constraint->speed) ||
                         (p->kind == HK_CORRECTOR && p->corrector->violation));
  lua_setfield(L, -2, p->kind == HK_CONSTRAINT ? "speed" : "violation");
  return 2;
}

/* reverse(actor): see hk_reverse_chunks. */
static int reverse(lua_State *L) {
  hk_reverse_chunks(hk_actor_at(L, 1)->instance);
  return 0;
}

/* ---- constraints ---- */

typedef struct block_list {
  hk_pattern naming;
  lua_State *L;
  lua_Integer count;
} block_list;

static void name_block(hk_pattern *naming, uint32_t row, uint32_t column) {
  block_list *list = (block_list *)(void *)naming;
  lua_pushinteger(list->L, (lua_Integer)row + 1);
  lua_rawseti(list->L, -2, ++list->count);
  lua_pushinteger(list->L, (lua_Integer)column + 1);
  lua_rawseti(list->L, -2, ++list->count);
}

/* equations(actor) -> their number, and the list of blocks: equation, particle, equation, particle, ... from 1 */
static int equations(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  hk_guard_enter("count");
  lua_pushinteger(L, (lua_Integer)plugin_of(a)->constraint->count(a->instance->self));
  lua_newtable(L);
  block_list list = {{name_block}, L, 0};
  hk_guard_enter("pattern");
  plugin_of(a)->constraint->pattern(a->instance->self, &list.naming);
  hk_guard_enter(NULL);
  return 2;
}

typedef hk_status evaluation(void *, const hk_view *, double *);

/* value, curvature, speed(actor, equations) -> list, whether it was fine, what it said */
static int evaluate(lua_State *L, evaluation *function, const char *name) {
  hk_actor *a = hk_actor_at(L, 1);
  size_t count = (size_t)luaL_checkinteger(L, 2);
  double *out = hk_actor_out(L, a, 0, "the answer", count);
  hk_guard_enter(name);
  hk_status status = function(a->instance->self, &a->view, out);
  hk_table_push(L, out, count);
  push_status(L, a, status);
  return 3;
}

static int value(lua_State *L) { return evaluate(L, plugin_of(hk_actor_at(L, 1))->constraint->value, "value"); }

static int curvature(lua_State *L) {
  return evaluate(L, plugin_of(hk_actor_at(L, 1))->constraint->curvature, "curvature");
}

static int speed(lua_State *L) { return evaluate(L, plugin_of(hk_actor_at(L, 1))->constraint->speed, "speed"); }

/* jacobian(actor, blocks) -> 3 numbers a block, whether it was fine, what it said */
static int jacobian(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  size_t blocks = (size_t)luaL_checkinteger(L, 2);
  double *J = hk_actor_out(L, a, 0, "the blocks J", 3 * blocks);
  hk_guard_enter("jacobian");
  hk_status status = plugin_of(a)->constraint->jacobian(a->instance->self, &a->view, (double(*)[3])(void *)J);
  hk_table_push(L, J, 3 * blocks);
  push_status(L, a, status);
  return 3;
}

/* ---- correctors ---- */

/* correct(actor, h, x_before, v_before) -> {x, v, changed, work, reject}, whether it was fine, what it said */
static int correct(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  const hk_corrector *functions = plugin_of(a)->corrector;
  double *before = hk_table_memory(L, 6 * a->n);
  hk_table_read(L, 3, before, 3 * a->n);
  hk_table_read(L, 4, before + 3 * a->n, 3 * a->n);
  hk_correction c = {.h = luaL_checknumber(L, 2)};
  c.x = hk_actor_out(L, a, 0, "the positions x", 3 * a->n);
  c.v = hk_actor_out(L, a, 1, "the velocities v", 3 * a->n);
  memcpy(c.x, a->x.at, a->x.bytes);
  memcpy(c.v, a->v.at, a->v.bytes);
  if (functions->flags & HK_WANTS_BEFORE) c.x_before = before, c.v_before = before + 3 * a->n;
  hk_view own = a->view, *view = &own; /* as in a run, the view shows what is corrected */
  own.x = c.x;
  own.v = c.v;
  hk_guard_enter("correct");
  hk_status status = functions->correct(a->instance->self, view, &c);
  lua_newtable(L);
  hk_table_push(L, c.x, 3 * a->n);
  lua_setfield(L, -2, "x");
  hk_table_push(L, c.v, 3 * a->n);
  lua_setfield(L, -2, "v");
  hk_table_set(L, "work", c.work);
  hk_table_set(L, "part", c.part);
  lua_pushboolean(L, c.changed);
  lua_setfield(L, -2, "changed");
  lua_pushboolean(L, c.reject);
  lua_setfield(L, -2, "reject");
  push_status(L, a, status);
  return 3;
}

static int violation(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  hk_guard_enter("violation");
  lua_pushnumber(L, plugin_of(a)->corrector->violation(a->instance->self, &a->view));
  hk_guard_enter(NULL);
  return 1;
}

/* ---- sources ---- */

typedef struct recorded {
  hk_population population;
  lua_State *L;
  size_t n, most, channels; /* most: births that succeed; channels: numbers of a particle */
  lua_Integer births, deaths;
  bool refused;

  uint32_t next_id;
} recorded;

static hk_status add(hk_population *population, const hk_birth *b, uint32_t *id) {
  recorded *r = (recorded *)(void *)population;
  if ((size_t)r->births == r->most) {
    r->refused = true;
    return HK_NO_MEMORY;
  }
  lua_newtable(r->L);
  hk_table_set(r->L, "mass", b->mass);
  hk_table_set(r->L, "group", b->group);
  hk_table_push(r->L, b->position, 3);
  lua_setfield(r->L, -2, "x");
  hk_table_push(r->L, b->velocity, 3);
  lua_setfield(r->L, -2, "v");
  hk_table_push(r->L, b->channel, b->channel ? r->channels : 0);
  lua_setfield(r->L, -2, "channels");
  lua_rawseti(r->L, -3, ++r->births);
  if (id) *id = r->next_id++;
  return HK_OK;
}

static hk_status add_aged(hk_population *population, const hk_birth *b, double age, double lifetime, uint32_t *id) {
  recorded *r = (recorded *)(void *)population;
  hk_status status = add(population, b, id);
  if (status != HK_OK) return status;
  lua_rawgeti(r->L, -2, r->births);
  hk_table_set(r->L, "age", age);
  hk_table_set(r->L, "lifetime", lifetime);
  lua_pop(r->L, 1);
  return status;
}

static hk_status take(hk_population *population, uint32_t index) {
  recorded *r = (recorded *)(void *)population;
  lua_pushinteger(r->L, (lua_Integer)index + 1);
  lua_rawseti(r->L, -2, ++r->deaths);
  return index < r->n ? HK_OK : HK_FAILED;
}

/* emit(actor, h, most) -> births, deaths (indices from 1), whether it was fine, what it said, whether a birth was
 * refused. The births beyond `most` are. */
static int emit(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  double h = luaL_checknumber(L, 2);
  size_t most = (size_t)luaL_checkinteger(L, 3);
  lua_newtable(L);
  lua_newtable(L);
  luaL_checkstack(L, 10, NULL);
  recorded r = {.population = {add, take, add_aged}, .L = L, .n = a->n, .most = most, .next_id = 1000};
  r.channels = a->run->state.width;
  hk_guard_enter("emit");
  hk_status status = plugin_of(a)->source->emit(a->instance->self, &a->view, h, &r.population);
  push_status(L, a, status);
  lua_pushboolean(L, r.refused);
  return 5;
}

/* groups(actor) -> how many groups there are */
static int groups(lua_State *L) {
  lua_pushinteger(L, (lua_Integer)hk_actor_at(L, 1)->view.model->groups);
  return 1;
}

/* ---- services ---- */

/* table(actor) -> the address of its table as a text, nil: none; its interface */
static int table(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  hk_guard_enter("table");
  const void *address = plugin_of(a)->service->table(a->instance->self);
  hk_guard_enter(NULL);
  if (address)
    lua_pushfstring(L, "%p", address);
  else
    lua_pushnil(L);
  lua_pushstring(L, plugin_of(a)->service->interface);
  return 2;
}

/* interface(path) -> the interface of the service in a file; nil: it is no service */
static int interface(lua_State *L) {
  hk_error error = {0};
  const hk_loaded *item =
      hk_registry_load(hk_script_asked(hk_lua_script(L))->registry, luaL_checkstring(L, 1), true, &error);
  if (!item || item->plugin->kind != HK_SERVICE) return 0;
  lua_pushstring(L, item->plugin->service->interface);
  return 1;
}

/* serve(run, interface): asks for the service as a plugin does in `create` -> whether there was an answer, what was
 * said. */
static int serve(lua_State *L) {
  hk_run *run = hk_lua_run(L);
  hk_guard_enter("create");
  lua_pushboolean(L, run->shared.query(run->shared.context, luaL_checkstring(L, 2)) != NULL);
  hk_guard_enter(NULL);
  lua_pushstring(L, run->error.text);
  return 2;
}

__attribute__((visibility("default"))) int luaopen_actors(lua_State *L);

int luaopen_actors(lua_State *L) {
  static const luaL_Reg functions[] = {
      {"open", hk_actor_open}, {"watch", hk_actor_watch}, {"set", hk_actor_set}, {"state", state},
      {"flags", flags},        {"equations", equations},  {"value", value},      {"curvature", curvature},
      {"speed", speed},        {"jacobian", jacobian},    {"correct", correct},  {"violation", violation},
      {"emit", emit},          {"reverse", reverse},      {"groups", groups},    {"table", table},
      {"serve", serve},        {"interface", interface},  {NULL, NULL}};
  luaL_newlib(L, functions);
  return 1;
}
