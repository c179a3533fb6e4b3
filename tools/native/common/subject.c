/* A subject: see subject.h. A plugin's answer may hang on what its stack happened to hold; before each call the stack
 * below it is filled with a byte that the tool chooses. */
#include "tools/native/common/subject.h"

#include <string.h>

static const char type[] = "hooke.subject";

void hk_table_push(lua_State *L, const double *number, size_t count) {
  lua_createtable(L, (int)count, 0);
  for (size_t k = 0; k < count; k++) {
    lua_pushnumber(L, number[k]);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
}

void hk_table_read(lua_State *L, int index, double *number, size_t count) {
  luaL_checktype(L, index, LUA_TTABLE);
  if (lua_rawlen(L, index) < count) luaL_argerror(L, index, "too few numbers");
  for (size_t k = 0; k < count; k++) {
    lua_rawgeti(L, index, (lua_Integer)k + 1);
    number[k] = lua_tonumber(L, -1);
    lua_pop(L, 1);
  }
}

void hk_table_set(lua_State *L, const char *key, double value) {
  lua_pushnumber(L, value);
  lua_setfield(L, -2, key);
}

double *hk_table_memory(lua_State *L, size_t count) {
  double *p = lua_newuserdatauv(L, (count + 1) * sizeof *p, 0);
  memset(p, 0, (count + 1) * sizeof *p);
  return p;
}

hk_subject *hk_subject_at(lua_State *L, int index) { return luaL_checkudata(L, index, type); }

static void take(lua_State *L, hk_guarded *g, const char *name, const double *from, size_t count, hk_guard_side side) {
  if (!hk_guard_get(g, name, count * sizeof(double), side)) luaL_error(L, "no memory for %s", name);
  if (from) memcpy(g->at, from, count * sizeof(double));
}

static int close_subject(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  hk_guarded *const all[] = {&s->x, &s->v, &s->y, &s->F, &s->dy, &s->dx};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) hk_guard_free(all[k]);
  return 0;
}

static void find(lua_State *L, hk_subject *s, const char *name) {
  const hk_instances *forces = &s->run->plugins.kind[HK_FORCE];
  for (s->index = 0; s->index < forces->count; s->index++)
    if (strcmp(forces->item[s->index]->plugin->name, name) == 0) break;
  if (s->index == forces->count) luaL_error(L, "the scene has no force '%s'", name);
  s->instance = forces->item[s->index];
  s->force = hk_force_of(s->instance->plugin);
}

int hk_subject_open(lua_State *L) {
  hk_run *run = hk_lua_run(L);
  const char *name = luaL_checkstring(L, 2);
  static const char *const sides[] = {"behind", "before", NULL};
  int side = luaL_checkoption(L, 3, "behind", sides);
  hk_subject *s = lua_newuserdatauv(L, sizeof *s, 1);
  *s = (hk_subject){.run = run, .n = run->state.model.n, .fill = -1, .side = side ? HK_GUARD_BEFORE : HK_GUARD_BEHIND};
  lua_pushvalue(L, 1);
  lua_setiuservalue(L, -2, 1);
  if (luaL_newmetatable(L, type)) {
    lua_pushcfunction(L, close_subject);
    lua_setfield(L, -2, "__gc");
  }
  lua_setmetatable(L, -2);
  find(L, s, name);
  s->size = 3 * s->n;
  s->view = run->dynamics.force_view[s->index];
  size_t channels = run->state.width * s->n;
  take(L, &s->x, "the positions x", run->state.X, s->size, s->side);
  take(L, &s->v, "the velocities v", run->state.X + s->size, s->size, s->side);
  take(L, &s->y, "the channels y", run->state.X + 2 * s->size, channels, s->side);
  take(L, &s->F, "the forces F", NULL, s->size, s->side);
  take(L, &s->dy, "the rates dy", NULL, channels, s->side);
  take(L, &s->dx, "the other positions", NULL, s->size, s->side);
  s->view.x = s->x.at;
  s->view.v = s->v.at;
  if (channels) s->view.y = s->y.at;
  s->view.power = NULL;
  hk_guard_allow(&s->x, false);
  hk_guard_allow(&s->v, false);
  return 1;
}

static void backwards(const hk_host *host, size_t count, size_t grain,
                      void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context) {
  (void)host;
  if (grain == 0) grain = 1;
  for (size_t chunk = (count + grain - 1) / grain; chunk-- > 0;) {
    size_t begin = chunk * grain;
    body(context, begin, count - begin < grain ? count : begin + grain, chunk);
  }
}

void hk_reverse_chunks(hk_instance *instance) { instance->host.parallel_for = backwards; }

/* Not checked for its own addresses: the gaps that this leaves between variables would not be filled. */
__attribute__((noinline, no_sanitize("address"))) static void fill_stack(unsigned char byte) {
  volatile unsigned char below[1 << 14];
  for (size_t k = 0; k < sizeof below; k++) below[k] = byte;
}

__attribute__((no_sanitize("address"))) void hk_subject_enter(hk_subject *s, const char *function) {
  hk_guard_enter(function);
  if (s->fill >= 0) fill_stack((unsigned char)s->fill);
}

void hk_subject_leave(hk_subject *s) {
  (void)s;
  hk_guard_enter(NULL);
}

double hk_subject_add(hk_subject *s, double power) {
  double before = power;
  s->view.power = isnan(power) ? NULL : &power;
  hk_subject_enter(s, "add");
  hk_status status = hk_force_add(s->instance, &s->view, s->F.at);
  hk_subject_leave(s);
  s->view.power = NULL;
  if (status != HK_OK) s->status = status;
  return power - before;
}

double hk_subject_energy(hk_subject *s) {
  hk_subject_enter(s, "energy");
  double E = s->force->own.energy ? s->force->own.energy(s->instance->self, &s->view) : 0;
  hk_subject_leave(s);
  return E;
}
