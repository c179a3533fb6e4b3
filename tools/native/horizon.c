/* horizon: the quadratic programs of a transcription (tools/native/gradients/horizon.h), for `hooke optimise --way
 * transcription`. Values of controls stand one control after the other in lists, as the search has them; states are a
 * list of lists, one a knot. Knots, segments and goals count from 1. */
#include "tools/native/gradients/horizon.h"

#include <lauxlib.h>
#include <string.h>

static const char type[] = "hooke.horizon";

static horizon *self(lua_State *L) { return *(horizon **)luaL_checkudata(L, 1, type); }

static int collect(lua_State *L) {
  horizon **held = luaL_checkudata(L, 1, type);
  hk_horizon_free(*held);
  *held = NULL;
  return 0;
}

static double *room(lua_State *L, size_t count) {
  double *numbers = lua_newuserdatauv(L, (count + 1) * sizeof *numbers, 0);
  memset(numbers, 0, count * sizeof *numbers);
  return numbers;
}

static void read_list(lua_State *L, int index, double *to, size_t count) {
  luaL_checktype(L, index, LUA_TTABLE);
  luaL_argcheck(L, lua_rawlen(L, index) == count, index, "a list of another length");
  for (size_t e = 0; e < count; e++) {
    lua_rawgeti(L, index, (lua_Integer)e + 1);
    to[e] = lua_tonumber(L, -1);
    lua_pop(L, 1);
  }
}

static void push_list(lua_State *L, const double *number, size_t count) {
  lua_createtable(L, (int)count, 0);
  for (size_t e = 0; e < count; e++) {
    lua_pushnumber(L, number[e]);
    lua_rawseti(L, -2, (lua_Integer)e + 1);
  }
}

/* Lists of d numbers each; NULL where there is nil. */
static double *read_states(lua_State *L, int index, size_t count) {
  size_t d = self(L)->d;
  if (lua_isnoneornil(L, index)) return NULL;
  luaL_checktype(L, index, LUA_TTABLE);
  double *states = room(L, count * d);
  for (size_t k = 0; k < count; k++) {
    lua_rawgeti(L, index, (lua_Integer)k + 1);
    read_list(L, lua_gettop(L), states + k * d, d);
    lua_pop(L, 1);
  }
  return states;
}

static void push_states(lua_State *L, const double *states, size_t count) {
  size_t d = self(L)->d;
  lua_createtable(L, (int)count, 0);
  for (size_t k = 0; k < count; k++) {
    push_list(L, states + k * d, d);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
}

/* Values of controls, here those of a knot together; NULL where there is nil. */
static double *read_controls(lua_State *L, int index) {
  const horizon *h = self(L);
  size_t n = h->knots * h->m;
  if (lua_isnoneornil(L, index)) return NULL;
  double *list = room(L, 2 * n), *u = list + n;
  read_list(L, index, list, n);
  for (size_t j = 0; j < h->m; j++)
    for (size_t k = 0; k < h->knots; k++) u[k * h->m + j] = list[j * h->knots + k];
  return u;
}

static void push_controls(lua_State *L, const double *u) {
  const horizon *h = self(L);
  lua_createtable(L, (int)(h->knots * h->m), 0);
  for (size_t j = 0; j < h->m; j++)
    for (size_t k = 0; k < h->knots; k++) {
      lua_pushnumber(L, u[k * h->m + j]);
      lua_rawseti(L, -2, (lua_Integer)(j * h->knots + k) + 1);
    }
}

/* new(knots, d, m, goals, interval): of states with d numbers and m controls, whose effort is the integral of their
 * squares, linear between knots that are so many s apart. */
static int create(lua_State *L) {
  size_t of[4];
  for (int k = 0; k < 4; k++) {
    lua_Integer count = luaL_checkinteger(L, k + 1);
    luaL_argcheck(L, count >= (k == 0 ? 2 : k == 3 ? 0 : 1) && count < 1 << 20, k + 1, "out of range");
    of[k] = (size_t)count;
  }
  double interval = luaL_checknumber(L, 5);
  horizon **held = lua_newuserdatauv(L, sizeof(horizon *), 0), *h;
  *held = NULL;
  luaL_setmetatable(L, type);
  h = *held = hk_horizon_create(of[0], of[1], of[2], of[3]);
  if (!h) return luaL_error(L, "no memory for %d knots with %d numbers each", (int)of[0], (int)of[1]);
  for (size_t k = 0; k + 1 < h->knots; k++)
    for (size_t j = 0; j < h->m; j++) { /* (a^2 + a b + b^2)/3 of the interval, its second derivatives */
      double *W = h->W + k * 4 * h->m * h->m;
      size_t two = 2 * h->m, a = j, b = h->m + j;
      W[a * two + a] = W[b * two + b] = 2 * interval / 3;
      W[a * two + b] = W[b * two + a] = interval / 3;
    }
  return 1;
}

static size_t segment_at(lua_State *L, int index, size_t most) {
  lua_Integer k = luaL_checkinteger(L, index);
  luaL_argcheck(L, k >= 1 && (size_t)k <= most, index, "out of range");
  return (size_t)k - 1;
}

/* Where column c of a record's derivatives (record:segment) stands here: both knots' values of a control are beside
 * each other there. */
static size_t place_of(const horizon *h, size_t c) {
  if (c < h->d) return c;
  return h->d + (c - h->d) % 2 * h->m + (c - h->d) / 2;
}

/* h:segment(k, J, C): the derivatives of segment k as record:segment gives them; C may be nil. */
static int set_segment(lua_State *L) {
  lua_settop(L, 4);
  const horizon *h = self(L);
  size_t k = segment_at(L, 2, h->knots - 1), w = h->d + 2 * h->m;
  double *J = h->J + k * h->d * w, *C = h->C + k * w * w, *list = room(L, w * w);
  read_list(L, 3, list, w * h->d);
  for (size_t c = 0; c < w; c++)
    for (size_t i = 0; i < h->d; i++) J[i * w + place_of(h, c)] = list[c * h->d + i];
  memset(C, 0, w * w * sizeof *C);
  if (lua_isnoneornil(L, 4)) return 0;
  read_list(L, 4, list, w * w);
  for (size_t c = 0; c < w; c++)
    for (size_t i = 0; i < w; i++) C[place_of(h, i) * w + place_of(h, c)] = list[c * w + i];
  return 0;
}

/* h:goal(g, knot, slope): without a square */
static int set_goal(lua_State *L) {
  const horizon *h = self(L);
  horizon_goal *goal = &h->goal[segment_at(L, 2, h->goals)];
  goal->knot = segment_at(L, 3, h->knots);
  read_list(L, 4, goal->slope, h->d);
  memset(goal->square, 0, h->d * sizeof *goal->square);
  return 0;
}

/* h:square(g, slope): of the number whose square stands in the matrix beside goal g. */
static int set_square(lua_State *L) {
  const horizon *h = self(L);
  read_list(L, 3, h->goal[segment_at(L, 2, h->goals)].square, h->d);
  return 0;
}

/* h:bend(k, list): the second derivatives of what stands at knot k, d squared; nil: 0. */
static int set_bend(lua_State *L) {
  const horizon *h = self(L);
  size_t d = h->d;
  lua_settop(L, 3);
  double *bend = h->bend + segment_at(L, 2, h->knots) * d * d;
  if (lua_isnil(L, 3))
    memset(bend, 0, d * d * sizeof *bend);
  else
    read_list(L, 3, bend, d * d);
  return 0;
}

/* h:factor(weight): of the squares. Whether the matrix is positive along the equations. */
static int factor(lua_State *L) {
  horizon *h = self(L);
  h->square = luaL_checknumber(L, 2);
  lua_pushboolean(L, hk_horizon_factor(h));
  return 1;
}

/* h:least(slope, prices, off, missing, by_states) -> the controls' changes, those of the goals, those of the states and
 * the multipliers of every segment's equations. slope of the cost by the controls, prices of the goals (what a unit of
 * each costs), off of every segment's equations (a list a segment), missing of every number whose square is in the
 * matrix, slope of the cost by the states (a list a knot); nil: 0. */
static int least(lua_State *L) {
  const horizon *h = self(L);
  size_t n = h->knots, d = h->d;
  lua_settop(L, 6);
  const double *gu = read_controls(L, 2), *off = read_states(L, 4, n - 1), *by_states = read_states(L, 6, n);
  double *gx = room(L, n * d), *x = room(L, n * d), *u = room(L, n * h->m), *y = room(L, h->goals);
  double *price = room(L, h->goals), *missing = room(L, h->goals), *list = room(L, (n - 1) * d);
  if (!lua_isnil(L, 3)) read_list(L, 3, price, h->goals);
  if (!lua_isnil(L, 5)) read_list(L, 5, missing, h->goals);
  if (by_states) memcpy(gx, by_states, n * d * sizeof *gx);
  for (size_t g = 0; g < h->goals; g++)
    for (size_t i = 0; i < d; i++)
      gx[h->goal[g].knot * d + i] += price[g] * h->goal[g].slope[i] + h->square * missing[g] * h->goal[g].square[i];
  hk_horizon_least(h, gx, gu, off, x, u, list);
  for (size_t g = 0; g < h->goals; g++)
    for (size_t i = 0; i < d; i++) y[g] += h->goal[g].slope[i] * x[h->goal[g].knot * d + i];
  push_controls(L, u);
  push_list(L, y, h->goals);
  push_states(L, x, n);
  push_states(L, list, n - 1);
  return 4;
}

/* h:row(g) -> how goal g changes with the controls. */
static int row_of(lua_State *L) {
  const horizon *h = self(L);
  const horizon_goal *goal = &h->goal[segment_at(L, 2, h->goals)];
  double *row = room(L, h->knots * h->m);
  hk_horizon_row(h, goal->knot, goal->slope, row);
  push_controls(L, row);
  return 1;
}

__attribute__((visibility("default"))) int luaopen_horizon(lua_State *L);

int luaopen_horizon(lua_State *L) {
  static const luaL_Reg functions[] = {{"new", create}, {NULL, NULL}};
  static const luaL_Reg methods[] = {{"segment", set_segment}, {"goal", set_goal}, {"square", set_square},
                                     {"bend", set_bend},       {"factor", factor}, {"least", least},
                                     {"row", row_of},          {NULL, NULL}};
  luaL_newmetatable(L, type);
  lua_pushcfunction(L, collect);
  lua_setfield(L, -2, "__gc");
  lua_newtable(L);
  luaL_setfuncs(L, methods, 0);
  lua_setfield(L, -2, "__index");
  lua_pop(L, 1);
  luaL_newlib(L, functions);
  return 1;
}
