/* states: arithmetic on packed states, the strings of doubles that run:packed() makes: n, t, n ids, 3n positions (m),
 * 3n velocities (m/s). */
#include <lauxlib.h>
#include <lua.h>
#include <math.h>
#include <string.h>

typedef struct packed {
  size_t n;
  const char *at; /* address of the ids; a string need not be aligned */
} packed;

static double number(const packed *s, size_t k) {
  double value;
  memcpy(&value, s->at + k * sizeof value, sizeof value);
  return value;
}

static packed check(lua_State *L, int index) {
  size_t bytes;
  double n = -1;
  const char *text = luaL_checklstring(L, index, &bytes);
  if (bytes >= 2 * sizeof n) memcpy(&n, text, sizeof n);
  if (n < 0 || bytes != (2 + 7 * (size_t)n) * sizeof n) luaL_argerror(L, index, "not a packed state");
  return (packed){(size_t)n, text + 2 * sizeof n};
}

/* The RMS over the particles, and the largest, of the distance between 3-vectors that start at number `begin`. */
static void distance_of(const packed *a, const packed *b, size_t begin, double *rms, double *most) {
  double sum = 0;
  *most = 0;
  for (size_t i = 0; i < a->n; i++) {
    double square = 0;
    for (size_t c = 0; c < 3; c++) {
      double d = number(a, begin + 3 * i + c) - number(b, begin + 3 * i + c);
      square += d * d;
    }
    sum += square;
    if (!(sqrt(square) <= *most)) *most = sqrt(square); /* true for NAN as well */
  }
  *rms = a->n ? sqrt(sum / (double)a->n) : 0;
}

static void set(lua_State *L, const char *key, double value) {
  lua_pushnumber(L, value);
  lua_setfield(L, -2, key);
}

/* distance(a, b) -> {x_rms, x_max, v_rms, v_max}, m and m/s; nil and the reason when the particles differ. */
static int distance(lua_State *L) {
  packed a = check(L, 1), b = check(L, 2);
  if (a.n != b.n) {
    lua_pushnil(L);
    lua_pushfstring(L, "%I particles against %I", (LUAI_UACINT)a.n, (LUAI_UACINT)b.n);
    return 2;
  }
  if (memcmp(a.at, b.at, a.n * sizeof(double)) != 0) {
    lua_pushnil(L);
    lua_pushliteral(L, "the particles are others: some were born or died on one side only");
    return 2;
  }
  double rms, most;
  lua_createtable(L, 0, 4);
  distance_of(&a, &b, a.n, &rms, &most);
  set(L, "x_rms", rms);
  set(L, "x_max", most);
  distance_of(&a, &b, 4 * a.n, &rms, &most);
  set(L, "v_rms", rms);
  set(L, "v_max", most);
  return 1;
}

/* positions(a, {x, y, z, ...}) -> the packed state of `a` with these positions of its first particles and no
 * velocities: the form in which an exact solution is compared. Particles without a position keep theirs. */
static int positions(lua_State *L) {
  packed a = check(L, 1);
  luaL_checktype(L, 2, LUA_TTABLE);
  size_t bytes = (2 + 7 * a.n) * sizeof(double), given = lua_rawlen(L, 2);
  luaL_argcheck(L, given <= 3 * a.n, 2, "more positions than particles");
  double *copy = lua_newuserdatauv(L, bytes, 0);
  memcpy(copy, a.at - 2 * sizeof(double), bytes);
  for (size_t k = 0; k < given; k++, lua_pop(L, 1)) {
    lua_rawgeti(L, 2, (lua_Integer)k + 1);
    copy[2 + a.n + k] = lua_tonumber(L, -1);
  }
  memset(copy + 2 + 4 * a.n, 0, 3 * a.n * sizeof *copy);
  lua_pushlstring(L, (const char *)copy, bytes);
  return 1;
}

__attribute__((visibility("default"))) int luaopen_states(lua_State *L);

int luaopen_states(lua_State *L) {
  static const luaL_Reg functions[] = {{"distance", distance}, {"positions", positions}, {NULL, NULL}};
  luaL_newlib(L, functions);
  return 1;
}
