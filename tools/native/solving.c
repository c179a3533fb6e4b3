/* solving: matrices in guarded memory, and the calls of a solver with them, for `hooke check`. */
#include "tools/native/common/actor.h"

#include <string.h>

static const char type[] = "hooke.matrix";

typedef struct guarded_matrix {
  hk_matrix A;
  hk_guarded row_start, column, value; /* read-only */
} guarded_matrix;

static guarded_matrix *matrix_at(lua_State *L, int index) { return luaL_checkudata(L, index, type); }

static int close_matrix(lua_State *L) {
  guarded_matrix *m = matrix_at(L, 1);
  hk_guard_free(&m->row_start);
  hk_guard_free(&m->column);
  hk_guard_free(&m->value);
  return 0;
}

static lua_Integer whole_at(lua_State *L, const char *key, size_t k) {
  lua_getfield(L, 1, key);
  lua_rawgeti(L, -1, (lua_Integer)k + 1);
  lua_Integer number = lua_tointeger(L, -1);
  lua_pop(L, 2);
  return number;
}

static void get(lua_State *L, hk_guarded *g, const char *name, size_t bytes) {
  if (!hk_guard_get(g, name, bytes, HK_GUARD_BEHIND)) luaL_error(L, "no memory for the matrix");
}

/* matrix{rows =, block =, row_start =, column =, value =, symmetric =, pattern =}: indices from 0. */
static int matrix(lua_State *L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  lua_getfield(L, 1, "rows");
  lua_getfield(L, 1, "block");
  lua_getfield(L, 1, "symmetric");
  lua_getfield(L, 1, "pattern");
  size_t rows = (size_t)lua_tointeger(L, 2), block = (size_t)lua_tointeger(L, 3);
  bool symmetric = lua_toboolean(L, 4);
  uint64_t pattern = (uint64_t)lua_tointeger(L, 5);
  size_t blocks = (size_t)whole_at(L, "row_start", rows);
  guarded_matrix *m = lua_newuserdatauv(L, sizeof *m, 0);
  *m = (guarded_matrix){0};
  if (luaL_newmetatable(L, type)) {
    lua_pushcfunction(L, close_matrix);
    lua_setfield(L, -2, "__gc");
  }
  lua_setmetatable(L, -2);
  get(L, &m->row_start, "the matrix's row_start", (rows + 1) * sizeof(size_t));
  get(L, &m->column, "the matrix's columns", blocks * sizeof(uint32_t));
  get(L, &m->value, "the matrix's values", blocks * block * block * sizeof(double));
  for (size_t k = 0; k <= rows; k++) ((size_t *)m->row_start.at)[k] = (size_t)whole_at(L, "row_start", k);
  for (size_t k = 0; k < blocks; k++) ((uint32_t *)m->column.at)[k] = (uint32_t)whole_at(L, "column", k);
  lua_getfield(L, 1, "value");
  hk_table_read(L, lua_gettop(L), m->value.at, blocks * block * block);
  lua_pop(L, 1);
  m->A = (hk_matrix){rows, block, m->row_start.at, m->column.at, m->value.at, symmetric, pattern};
  hk_guard_allow(&m->row_start, false);
  hk_guard_allow(&m->column, false);
  hk_guard_allow(&m->value, false);
  return 1;
}

/* Pushes "ok", "not converged", "not finite", "no memory" or "failed", and what it said. */
static int push_status(lua_State *L, hk_actor *a, hk_status status) {
  hk_guard_enter(NULL);
  lua_pushstring(L, status == HK_OK              ? "ok"
                    : status == HK_NOT_CONVERGED ? "not converged"
                    : status == HK_NOT_FINITE    ? "not finite"
                    : status == HK_NO_MEMORY     ? "no memory"
                                                 : "failed");
  hk_actor_push_said(L, a);
  return 2;
}

static const hk_solver *solver_of(const hk_actor *a) { return a->instance->plugin->solver; }

/* A matrix is there during the calls alone that get it. */
static void show(guarded_matrix *m, bool there) {
  hk_guarded *const all[] = {&m->row_start, &m->column, &m->value};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
    if (there)
      hk_guard_allow(all[k], false);
    else
      hk_guard_shut(all[k]);
  }
}

/* factorize(actor, matrix, whether its pattern is new) -> status, what it said */
static int factorize(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  guarded_matrix *m = matrix_at(L, 2);
  const hk_matrix *A = &m->A;
  hk_status status = HK_OK;
  show(m, true);
  hk_guard_enter("analyze");
  if (lua_toboolean(L, 3) && solver_of(a)->analyze) status = solver_of(a)->analyze(a->instance->self, A);
  hk_guard_enter("factorize");
  if (status == HK_OK) status = solver_of(a)->factorize(a->instance->self, A);
  show(m, false);
  return push_status(L, a, status);
}

/* solve(actor, b, tolerance) -> x, {iterations =, residual =}, status, what it said */
static int solve(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  size_t count = lua_rawlen(L, 2);
  hk_solve_info info = {.tolerance = luaL_checknumber(L, 3)};
  double *b = hk_actor_out(L, a, 0, "the right-hand side b", count);
  double *x = hk_actor_out(L, a, 1, "the solution x", count);
  hk_table_read(L, 2, b, count);
  for (size_t k = 0; k < count; k++) x[k] = NAN; /* what a solver leaves there is no part of its answer */
  hk_guard_allow(&a->out[0], false);
  hk_guard_enter("solve");
  hk_status status = solver_of(a)->solve(a->instance->self, b, x, &info);
  hk_table_push(L, x, count);
  lua_newtable(L);
  hk_table_set(L, "iterations", info.iterations);
  hk_table_set(L, "residual", info.residual);
  return 2 + push_status(L, a, status);
}

/* columns(actor, b, columns) -> x of as many right-hand sides side by side, status, what it said; nil: it cannot */
static int columns(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  size_t count = lua_rawlen(L, 2);
  if (!solver_of(a)->solve_columns) return 0;
  double *b = hk_actor_out(L, a, 0, "the right-hand sides b", count);
  double *x = hk_actor_out(L, a, 1, "the solutions x", count);
  hk_table_read(L, 2, b, count);
  hk_guard_allow(&a->out[0], false);
  hk_guard_enter("solve_columns");
  hk_status status = solver_of(a)->solve_columns(a->instance->self, b, x, (size_t)luaL_checkinteger(L, 3));
  hk_table_push(L, x, count);
  return 1 + push_status(L, a, status);
}

/* describe(actor) -> the text, whether it has an end within what was asked for; nil: it has none */
static int describe(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  char text[65];
  memset(text, 'x', sizeof text);
  if (!solver_of(a)->describe) return 0;
  hk_guard_enter("describe");
  solver_of(a)->describe(a->instance->self, text, 64);
  hk_guard_enter(NULL);
  bool ends = memchr(text, 0, 64) != NULL;
  lua_pushstring(L, ends ? text : "");
  lua_pushboolean(L, ends);
  return 2;
}

/* flags(actor) -> unsymmetric, indefinite, iterative */
static int flags(lua_State *L) {
  unsigned f = solver_of(hk_actor_at(L, 1))->flags;
  lua_pushboolean(L, (f & HK_SOLVES_UNSYMMETRIC) != 0);
  lua_pushboolean(L, (f & HK_SOLVES_INDEFINITE) != 0);
  lua_pushboolean(L, (f & HK_ITERATIVE) != 0);
  return 3;
}

__attribute__((visibility("default"))) int luaopen_solving(lua_State *L);

int luaopen_solving(lua_State *L) {
  static const luaL_Reg functions[] = {{"open", hk_actor_open},  {"watch", hk_actor_watch}, {"matrix", matrix},
                                       {"factorize", factorize}, {"solve", solve},          {"columns", columns},
                                       {"describe", describe},   {"flags", flags},          {NULL, NULL}};
  luaL_newlib(L, functions);
  return 1;
}
