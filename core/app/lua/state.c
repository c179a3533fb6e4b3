/* The object `state`, through which callbacks of a script read a run: t, n, position(id) and so on. It refers to the
 * scene; in a function that a run calls it reads that run, otherwise the run that the script drives. */
#include "core/app/lua/internal.h"
#include "core/engine/text/text.h"

#include <string.h>

void hk_lua_push_state(lua_State *L, int scene) {
  scene = lua_absindex(L, scene);
  hk_lua_slot **holder = lua_newuserdatauv(L, sizeof *holder, 1);
  *holder = hk_lua_slot_at(L, scene);
  lua_pushvalue(L, scene);
  lua_setiuservalue(L, -2, 1);
  luaL_setmetatable(L, hk_lua_state_type);
}

static hk_run *run_of(lua_State *L) {
  hk_lua_self(L, hk_lua_state_type, "state:position(id)");
  hk_run *run = hk_lua_state_run(L, 1);
  if (!run) hk_lua_fail(L, HK_BAD_PARAM, "there is no state: the scene does not run");
  return run;
}

static uint32_t index_of(lua_State *L, hk_run *run, int argument) {
  uint32_t index = 0;
  if (!lua_isinteger(L, argument))
    hk_lua_fail(L, HK_BAD_PARAM, "expected the id of one particle, got a %s", luaL_typename(L, argument));
  lua_Integer id = lua_tointeger(L, argument);
  if (id < 1 || id > UINT32_MAX || !hk_run_index(run, (uint32_t)id, &index))
    hk_lua_fail(L, HK_BAD_PARAM, "there is no particle %lld now", (long long)id);
  return index;
}

static void push_numbers(lua_State *L, const double *list, size_t count) {
  lua_createtable(L, (int)count, 0);
  for (size_t k = 0; k < count; k++) {
    lua_pushnumber(L, list[k]);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
}

static int position(lua_State *L) {
  hk_run *run = run_of(L);
  push_numbers(L, hk_run_view(run)->x + 3 * (size_t)index_of(L, run, 2), 3);
  return 1;
}

static int velocity(lua_State *L) {
  hk_run *run = run_of(L);
  push_numbers(L, hk_run_view(run)->v + 3 * (size_t)index_of(L, run, 2), 3);
  return 1;
}

static int mass(lua_State *L) {
  hk_run *run = run_of(L);
  lua_pushnumber(L, hk_run_view(run)->model->mass[index_of(L, run, 2)]);
  return 1;
}

static int channel(lua_State *L) {
  hk_run *run = run_of(L);
  const char *name = hk_lua_text(L, 2, "state:channel(\"heat\", id)");
  const hk_view *view = hk_run_view(run);
  size_t i = index_of(L, run, 3);
  for (size_t k = 0; k < view->model->channels; k++) {
    const hk_channel *c = &view->model->channel[k];
    if (strcmp(c->name, name) != 0) continue;
    const double *value = view->y + c->offset * view->n + c->size * i;
    if (c->size == 1)
      lua_pushnumber(L, *value);
    else
      push_numbers(L, value, c->size);
    return 1;
  }
  return hk_lua_fail(L, HK_BAD_PARAM, "there is no channel '%s'", name);
}

/* What a plugin publishes of each particle (HK_PUBLISHED), such as a density. */
static int field(lua_State *L) {
  hk_run *run = run_of(L);
  const char *name = hk_lua_text(L, 2, "state:field(\"full\", id)");
  const hk_model *m = hk_run_view(run)->model;
  size_t i = index_of(L, run, 3);
  for (size_t k = 0; k < m->publications; k++) {
    const hk_publication *p = &m->published[k];
    if (strcmp(p->name, name) != 0) continue;
    const double *value = *p->values + p->width * i;
    if (p->width == 1)
      lua_pushnumber(L, *value);
    else
      push_numbers(L, value, p->width);
    return 1;
  }
  return hk_lua_fail(L, HK_BAD_PARAM, "no plugin of the scene publishes a field '%s' of particles", name);
}

static int ids(lua_State *L) {
  const hk_view *view = hk_run_view(run_of(L));
  lua_createtable(L, (int)view->n, 0);
  for (size_t i = 0; i < view->n; i++) {
    lua_pushinteger(L, view->model->id[hk_model_nth(view->model, i)]);
    lua_rawseti(L, -2, (lua_Integer)i + 1);
  }
  return 1;
}

static int push_energy(lua_State *L, bool with_kinetic, bool with_potential) {
  double kinetic, potential, work;
  hk_run_energy(run_of(L), &kinetic, &potential, &work);
  lua_pushnumber(L, (with_kinetic ? kinetic : 0) + (with_potential ? potential : 0));
  return 1;
}

static int energy(lua_State *L) { return push_energy(L, true, true); }
static int kinetic_energy(lua_State *L) { return push_energy(L, true, false); }
static int potential_energy(lua_State *L) { return push_energy(L, false, true); }

static int force(lua_State *L) {
  hk_run *run = run_of(L);
  hk_error error = {0};
  double f[3];
  const char *label = hk_lua_text(L, 2, "state:force(LABEL, id)");
  uint32_t id = hk_run_view(run)->model->id[index_of(L, run, 3)];
  if (hk_run_force(run, label, id, f, &error) != HK_OK) return hk_lua_raise(L, &error);
  push_numbers(L, f, 3);
  return 1;
}

/* The multipliers of a constraint, one number per equation. The buffer belongs to Lua, which frees it after an error.
 */
static int constraint_forces(lua_State *L) {
  hk_run *run = run_of(L);
  const char *label = hk_lua_text(L, 2, "state:constraint_forces(LABEL)");
  hk_error error = {0};
  size_t count = 0;
  if (hk_run_equations(run, label, &count, &error) != HK_OK) return hk_lua_raise(L, &error);
  double *list = lua_newuserdatauv(L, (count + 1) * sizeof *list, 0);
  if (hk_run_constraint_forces(run, label, list, &error) != HK_OK) return hk_lua_raise(L, &error);
  push_numbers(L, list, count);
  return 1;
}

static int strain(lua_State *L) {
  hk_error error = {0};
  double largest;
  hk_run *run = run_of(L);
  const char *label = lua_isnoneornil(L, 2) ? NULL : hk_lua_text(L, 2, "state:strain(LABEL)");
  if (hk_run_strain(run, label, &largest, &error) != HK_OK) return hk_lua_raise(L, &error);
  lua_pushnumber(L, largest);
  return 1;
}

static const luaL_Reg methods[] = {{"position", position},
                                   {"velocity", velocity},
                                   {"mass", mass},
                                   {"channel", channel},
                                   {"field", field},
                                   {"ids", ids},
                                   {"energy", energy},
                                   {"kinetic", kinetic_energy},
                                   {"potential", potential_energy},
                                   {"force", force},
                                   {"constraint_forces", constraint_forces},
                                   {"strain", strain},
                                   {NULL, NULL}};

/* t and n, which are no functions, and the methods. */
static const char *member_at(const void *context, size_t k) {
  static const char *const values[] = {"t", "n"};
  (void)context;
  return k < 2 ? values[k] : methods[k - 2].name;
}

bool hk_lua_state_has(const char *name) {
  const char *member;
  for (size_t k = 0; (member = member_at(NULL, k)) != NULL; k++)
    if (strcmp(member, name) == 0) return true;
  return false;
}

static int member(lua_State *L) {
  const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
  if (strcmp(name, "t") == 0)
    lua_pushnumber(L, hk_run_view(run_of(L))->t);
  else if (strcmp(name, "n") == 0)
    lua_pushinteger(L, (lua_Integer)hk_run_view(run_of(L))->n);
  else {
    const luaL_Reg *m = methods;
    while (m->name && strcmp(m->name, name) != 0) m++;
    if (!m->name) return hk_lua_no_member(L, "a state", member_at, NULL, "see scripts/README.md, the state");
    lua_pushcfunction(L, m->func);
  }
  return 1;
}

/* t -> function(state): upvalues are the function and the state */
static int with_state(lua_State *L) {
  lua_settop(L, 0);
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_pushvalue(L, lua_upvalueindex(2));
  lua_call(L, 1, LUA_MULTRET);
  return lua_gettop(L);
}

hk_function hk_lua_frame_function(lua_State *L, int index) {
  lua_pushvalue(L, index);
  hk_lua_push_state(L, 1);
  lua_pushcclosure(L, with_state, 2);
  hk_function function = hk_lua_function(L, lua_gettop(L));
  lua_pop(L, 1);
  return function;
}

void hk_lua_open_state(lua_State *L) {
  luaL_newmetatable(L, hk_lua_state_type);
  lua_pushcfunction(L, member);
  lua_setfield(L, -2, "__index");
  lua_pushboolean(L, 0);
  lua_setfield(L, -2, "__metatable");
  lua_pop(L, 1);
}
