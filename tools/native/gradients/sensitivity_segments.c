/* Of a record the steps between two knots, from states that are not the run's, and measures there: for `hooke
 * optimise`. */
#include "tools/native/gradients/sensitivity_record.h"

#include <lauxlib.h>
#include <math.h>
#include <string.h>

static void read_state(lua_State *L, int index, double *X, size_t count) {
  luaL_checktype(L, index, LUA_TTABLE);
  luaL_argcheck(L, lua_rawlen(L, index) == count, index, "6 numbers a particle, or one a knot");
  for (size_t e = 0; e < count; e++) {
    lua_rawgeti(L, index, (lua_Integer)e + 1);
    X[e] = lua_tonumber(L, -1);
    lua_pop(L, 1);
  }
}

/* record:times() -> when every step begins, and the end of the last one; the state at the start */
int hk_record_times(lua_State *L) {
  const hk_sensitivity *s = hk_record_at(L)->steps;
  lua_createtable(L, (int)s->steps + 1, 0);
  for (size_t k = 0; k <= s->steps; k++) {
    lua_pushnumber(L, k < s->steps ? s->step[k].t : s->reached);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  hk_record_push(L, s->start, 6 * s->n);
  return 2;
}

/* record:curves() -> whether segments have second derivatives: not with constraints. */
int hk_record_curves(lua_State *L) {
  lua_pushboolean(L, !hk_record_at(L)->steps->projection);
  return 1;
}

/* record:place(X) -> X on the constraints, and the derivatives of that by X (columns, one behind the other); or nil and
 * a reason. */
int hk_record_place(lua_State *L) {
  record *r = hk_record_at(L);
  size_t v = 6 * r->steps->n;
  double *X = lua_newuserdatauv(L, (v + v * v + 1) * sizeof *X, 0), *D = X + v;
  read_state(L, 2, X, v);
  hk_error_clear(&r->error);
  if (hk_sensitivity_segment(r->steps, 0, 0, X, NULL, 0, D, &r->error) != HK_OK) return hk_record_refuse(L, &r->error);
  hk_record_push(L, X, v);
  hk_record_push(L, D, v * v);
  return 2;
}

/* What is asked of a segment beside its end. */
typedef struct wanted {
  size_t columns;         /* of derivatives; 0: none */
  double *J, *weight, *H; /* weight NULL: no second derivatives */
  bool *moves;
} wanted;

/* Which numbers of the state move, a list of booleans at `index`. */
static void read_moves(lua_State *L, int index, bool *moves, size_t count) {
  luaL_checktype(L, index, LUA_TTABLE);
  for (size_t e = 0; e < count; e++) {
    lua_rawgeti(L, index, (lua_Integer)e + 1);
    moves[e] = lua_toboolean(L, -1);
    lua_pop(L, 1);
  }
}

static wanted read_wanted(lua_State *L, const record *r) {
  size_t v = 6 * r->steps->n;
  wanted w = {.columns = lua_toboolean(L, 5) ? v + 2 * r->count : 0};
  w.J = lua_newuserdatauv(L, (v * w.columns + 1) * sizeof *w.J, 0);
  if (lua_isnoneornil(L, 6)) return w;
  luaL_argcheck(L, w.columns, 5, "second derivatives come with the first ones");
  w.weight = lua_newuserdatauv(L, (v + w.columns * w.columns) * sizeof *w.weight, 0);
  w.H = w.weight + v;
  w.moves = lua_newuserdatauv(L, v * sizeof *w.moves, 0);
  read_state(L, 6, w.weight, v);
  read_moves(L, 7, w.moves, v);
  return w;
}

/* record:segment(first, last, X, derivatives, weight, moves) -> the state after these steps from X, where they are
 * wanted the derivatives (columns, one behind the other), and with a weight of every number of that state the second
 * derivatives of their sum (columns squared), by those numbers of X that move (a list of booleans); or nil and a
 * reason. Steps count from 1. */
int hk_record_segment(lua_State *L) {
  record *r = hk_record_at(L);
  size_t first = (size_t)luaL_checkinteger(L, 2), last = (size_t)luaL_checkinteger(L, 3), v = 6 * r->steps->n;
  luaL_argcheck(L, first >= 1 && first <= last && last <= r->steps->steps, 2, "steps of the run");
  lua_settop(L, 7);
  double *X = lua_newuserdatauv(L, (v + 1) * sizeof *X, 0);
  wanted w = read_wanted(L, r);
  read_state(L, 4, X, v);
  hk_error_clear(&r->error);
  hk_status status = w.weight ? hk_sensitivity_curvature(r->steps, first - 1, last, X, r->by, r->count, w.moves,
                                                         w.weight, w.J, w.H, &r->error)
                              : hk_sensitivity_segment(r->steps, first - 1, last, X, r->by, r->count,
                                                       w.columns ? w.J : NULL, &r->error);
  if (status != HK_OK) return hk_record_refuse(L, &r->error);
  hk_record_push(L, X, v);
  hk_record_push(L, w.J, v * w.columns);
  if (w.weight) hk_record_push(L, w.H, w.columns * w.columns);
  return w.weight ? 3 : 2;
}

/* Gives the run's control other values, all larger by `by`; or why that cannot be. */
static hk_status assign_in(hk_run *run, const char *name, const double *value, size_t count, double by,
                           hk_error *error) {
  const hk_scene *scene = run->scene;
  size_t k = 0;
  while (k < scene->controls && strcmp(scene->control[k].name, name) != 0) k++;
  if (k == scene->controls || scene->control[k].knots != count)
    return hk_error_set(error, HK_FAILED, "the scene has no control '%s' with %zu knots", name, count);
  if (*scene->control[k].asked)
    return hk_error_set(error, HK_FAILED,
                        "control '%s': the script asks for its value while it makes the scene, which is not "
                        "differentiated: give forces a function of t",
                        name);
  for (size_t e = 0; e < count; e++) scene->control[k].current[e] = value[e] + by;
  run->dynamics.timed_at = NAN; /* what was asked for at a time is asked for again */
  return HK_OK;
}

/* record:assign(j, name, values, by): parameter j, the control of that name, has these values from now on, and is
 * varied by `by`: true; or nil and a reason. */
int hk_record_assign(lua_State *L) {
  record *r = hk_record_at(L);
  size_t j = (size_t)luaL_checkinteger(L, 2) - 1;
  const char *name = luaL_checkstring(L, 3);
  luaL_argcheck(L, j < r->count && r->by[j].knots, 2, "a function of time that is varied");
  size_t count = r->by[j].knots->count;
  double by = luaL_checknumber(L, 5), *value = lua_newuserdatauv(L, (count + 1) * sizeof *value, 0);
  read_state(L, 4, value, count);
  hk_error_clear(&r->error);
  hk_status status = assign_in(r->run, name, value, count, 0, &r->error);
  for (size_t k = 0; k < r->count && status == HK_OK; k++) {
    status = assign_in(r->more[k], name, value, count, k == j ? by : 0, &r->error);
    if (status == HK_OK) status = assign_in(r->less[k], name, value, count, k == j ? -by : 0, &r->error);
  }
  if (status != HK_OK) return hk_record_refuse(L, &r->error);
  r->by[j].by = by;
  lua_pushboolean(L, true);
  return 1;
}

/* record:survey(measure, t, X, derivatives) -> the measure at t in the state X, and where they are wanted its
 * derivatives by that; or nil and a reason. */
int hk_record_survey(lua_State *L) {
  record *r = hk_record_at(L);
  double t = luaL_checknumber(L, 3), value;
  size_t size = 6 * r->steps->n;
  double *X = lua_newuserdatauv(L, (2 * size + 1) * sizeof *X, 0);
  read_state(L, 4, X, size);
  r->measure = hk_record_measure_named(L, r, 2);
  hk_error_clear(&r->error);
  hk_status status = hk_record_measure_at(r, r->run, t, hk_record_moved(r, X, NULL, 0), &value);
  bool slopes = lua_toboolean(L, 5);
  if (status == HK_OK && slopes) status = hk_record_slope(r, t, X, X + size);
  if (status != HK_OK) return hk_record_refuse(L, &r->error);
  lua_pushnumber(L, value);
  if (!slopes) return 1;
  hk_record_push(L, X + size, size);
  return 2;
}
