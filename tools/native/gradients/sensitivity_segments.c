/* Of a record the steps between two knots, from states that are not the run's, and measures there: for `hooke
 * optimise`. */
#include "tools/native/gradients/sensitivity_record.h"

#include <lauxlib.h>

static void read_state(lua_State *L, int index, double *X, size_t count) {
  luaL_checktype(L, index, LUA_TTABLE);
  luaL_argcheck(L, lua_rawlen(L, index) == count, index, "6 numbers a particle");
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

/* record:segment(first, last, X, derivatives) -> the state after these steps from X, and where they are wanted the
 * derivatives (columns, one behind the other); or nil and a reason. Steps count from 1. */
int hk_record_segment(lua_State *L) {
  record *r = hk_record_at(L);
  size_t first = (size_t)luaL_checkinteger(L, 2), last = (size_t)luaL_checkinteger(L, 3), v = 6 * r->steps->n;
  luaL_argcheck(L, first >= 1 && first <= last && last <= r->steps->steps, 2, "steps of the run");
  size_t size = lua_toboolean(L, 5) ? v * (v + 2 * r->count) : 0;
  double *X = lua_newuserdatauv(L, (v + size + 1) * sizeof *X, 0);
  read_state(L, 4, X, v);
  hk_error_clear(&r->error);
  hk_status status =
      hk_sensitivity_segment(r->steps, first - 1, last, X, r->by, r->count, size ? X + v : NULL, &r->error);
  if (status != HK_OK) return hk_record_refuse(L, &r->error);
  hk_record_push(L, X, v);
  hk_record_push(L, X + v, size);
  return 2;
}

/* record:survey(measure, t, X) -> the measure at t in the state X, and its derivatives by that; or nil and a reason. */
int hk_record_survey(lua_State *L) {
  record *r = hk_record_at(L);
  double t = luaL_checknumber(L, 3), value;
  size_t size = 6 * r->steps->n;
  double *X = lua_newuserdatauv(L, (2 * size + 1) * sizeof *X, 0);
  read_state(L, 4, X, size);
  r->measure = hk_record_measure_named(L, r, 2);
  hk_error_clear(&r->error);
  hk_status status = hk_record_measure_at(r, r->run, t, hk_record_moved(r, X, NULL, 0), &value);
  if (status == HK_OK) status = hk_record_slope(r, t, X, X + size);
  if (status != HK_OK) return hk_record_refuse(L, &r->error);
  lua_pushnumber(L, value);
  hk_record_push(L, X + size, size);
  return 2;
}
