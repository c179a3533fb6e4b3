/* Reads shapes such as { union = { { blobs = ... }, { f = ..., level = ... } }, blend = 0.1 }. The functions lie on
 * Lua's stack, where they are called from; an error in one is kept, and ends the search for a surface by its NAN. */
#include "core/app/shapes/shapes.h"

#include <stdio.h>
#include <string.h>

enum { DEEPEST = 8, SLOTS = 32 };

const char *const hk_shape_keys[HK_SHAPE_KEYS] = {"f",          "level", "inside", "blobs", "union", "intersection",
                                                  "difference", "blend", NULL,     NULL};

/* ---- calling ---- */

static const char *not_a_value(lua_State *L) {
  if (lua_type(L, -1) == LUA_TNIL) return "nothing";
  return lua_type(L, -1) == LUA_TNUMBER ? NULL : luaL_typename(L, -1);
}

static double value_at(hk_script_shape *s, int function, const double x[3]) {
  lua_State *L = s->L;
  int top = lua_gettop(L);
  double value = NAN;
  s->calls++;
  lua_pushvalue(L, function);
  for (int c = 0; c < 3; c++) lua_pushnumber(L, x[c]);
  int code = lua_pcall(L, 3, 1, 0);
  const char *wrong = code == LUA_OK ? not_a_value(L) : NULL;
  if (code != LUA_OK)
    hk_error_set(&s->error, HK_SCRIPT, "implicit: f at (%g, %g, %g): %s", x[0], x[1], x[2],
                 lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "an error that is no text");
  else if (wrong)
    hk_error_set(&s->error, HK_BAD_PARAM, "implicit: f gives %s at (%g, %g, %g): it has to return a number", wrong,
                 x[0], x[1], x[2]);
  else
    value = lua_tonumber(L, -1);
  if (isnan(value)) value = NAN; /* without a sign that would be printed */
  if (code == LUA_OK && !wrong && !(fabs(value) <= 1e300))
    hk_error_set(&s->error, HK_BAD_PARAM,
                 "implicit: f gives %g at (%g, %g, %g): it has to return a finite number in the whole box, of at most "
                 "1e300 in size",
                 value, x[0], x[1], x[2]);
  lua_settop(L, top);
  return value;
}

/* The time between the calls is the engine's. */
static void call_function(void *context, int function, const double (*x)[3], size_t count, double *value) {
  hk_script_shape *s = context;
  hk_script *script = hk_lua_script(s->L);
  bool inside = hk_limits_inside(script, !script->options.trust);
  for (size_t k = 0; k < count; k++)
    value[k] = s->error.status == HK_OK && !script->spent ? value_at(s, function, x[k]) : NAN;
  hk_limits_inside(script, inside);
}

void hk_script_shape_evaluate(const void *shape, const double (*x)[3], size_t count, double *value) {
  hk_implicit_evaluate(&((const hk_script_shape *)shape)->shape, x, count, value);
}

/* ---- reading ---- */

static void read_blob(lua_State *L, hk_blob *blob, size_t number) {
  static const char *const keys[] = {"radius", "weight", NULL};
  char what[64];
  int table = lua_gettop(L);
  snprintf(what, sizeof what, "implicit: blobs[%zu]", number);
  hk_lua_vector(L, table, what, blob->centre);
  for (lua_pushnil(L); lua_next(L, table); lua_pop(L, 1))
    if (lua_type(L, -2) == LUA_TSTRING && strcmp(lua_tostring(L, -2), keys[0]) != 0 &&
        strcmp(lua_tostring(L, -2), keys[1]) != 0)
      hk_lua_fail(L, HK_BAD_PARAM, "%s: there is no '%s'; a blob is { x, y, z, radius = , weight = }", what,
                  lua_tostring(L, -2));
  blob->radius = hk_lua_field_number(L, table, what, "radius", NAN);
  blob->weight = hk_lua_field_number(L, table, what, "weight", 1);
  if (isnan(blob->radius))
    hk_lua_fail(L, HK_BAD_PARAM, "%s: radius is required, in m: { x, y, z, radius = 0.1 }", what);
  if (!(blob->radius > 0 && blob->radius <= 1e100))
    hk_lua_fail(L, HK_BAD_PARAM, "%s: radius: %g m has to be above 0", what, blob->radius);
}

static size_t list_length(lua_State *L, const char *key) {
  if (!lua_istable(L, -1)) hk_lua_fail(L, HK_BAD_PARAM, "implicit: %s: expected a list", key);
  hk_lua_check_plain(L, -1, key);
  size_t count = lua_rawlen(L, -1);
  if (count == 0) hk_lua_fail(L, HK_BAD_PARAM, "implicit: %s: there are none", key);
  return count;
}

static void read_blobs(lua_State *L, hk_implicit_shape *shape) {
  int list = lua_gettop(L);
  shape->kind = HK_IMPLICIT_BLOBS;
  shape->count = list_length(L, "blobs");
  shape->blob = lua_newuserdatauv(L, shape->count * sizeof *shape->blob, 0);
  for (size_t k = 0; k < shape->count; k++) {
    lua_rawgeti(L, list, (lua_Integer)k + 1);
    read_blob(L, &shape->blob[k], k + 1);
    lua_settop(L, list + 1);
  }
}

static void read_function(lua_State *L, int table, hk_script_shape *s, hk_implicit_shape *shape) {
  if (!lua_isfunction(L, -1))
    hk_lua_fail(L, HK_BAD_PARAM, "implicit: f: expected a function, f = function(x, y, z) return ... end, got %s",
                luaL_typename(L, -1));
  shape->kind = HK_IMPLICIT_FUNCTION;
  shape->evaluate = call_function;
  shape->context = s;
  shape->function = lua_gettop(L);
  shape->level = hk_lua_field_number(L, table, "implicit", "level", 0);
  if (!(fabs(shape->level) <= 1e300)) hk_lua_fail(L, HK_BAD_PARAM, "implicit: level: %g is no level", shape->level);
  hk_lua_field(L, table, "inside");
  const char *side = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : lua_isnil(L, -1) ? "above" : "";
  shape->below = strcmp(side, "below") == 0;
  if (!shape->below && strcmp(side, "above") != 0)
    hk_lua_fail(L, HK_BAD_PARAM,
                "implicit: inside: expected \"above\" (where f >= level, the default) or \"below\" (where f <= level)");
  lua_pop(L, 1);
}

static void read_shape(lua_State *L, int table, hk_script_shape *s, hk_implicit_shape *shape, int depth);

static void read_parts(lua_State *L, int table, hk_script_shape *s, hk_implicit_shape *shape, hk_implicit_kind kind,
                       int depth) {
  int list = lua_gettop(L);
  const char *key = kind == HK_IMPLICIT_UNION          ? "union"
                    : kind == HK_IMPLICIT_INTERSECTION ? "intersection"
                                                       : "difference";
  if (depth == DEEPEST) hk_lua_fail(L, HK_BAD_PARAM, "implicit: %s: shapes are nested more than %d deep", key, DEEPEST);
  shape->kind = kind;
  shape->count = list_length(L, key);
  shape->blend = hk_lua_field_number(L, table, "implicit", "blend", 0);
  if (!(shape->blend >= 0 && shape->blend <= 1e300))
    hk_lua_fail(L, HK_BAD_PARAM, "implicit: blend: %g must not be below 0: it is a difference of values", shape->blend);
  shape->part = lua_newuserdatauv(L, shape->count * sizeof *shape->part, 0);
  memset(shape->part, 0, shape->count * sizeof *shape->part);
  for (size_t k = 0; k < shape->count; k++) {
    if (lua_rawgeti(L, list, (lua_Integer)k + 1) != LUA_TTABLE)
      hk_lua_fail(L, HK_BAD_PARAM, "implicit: %s[%d]: expected a shape, { f = ... } or { blobs = ... }", key,
                  (int)k + 1);
    hk_lua_check_keys(L, lua_gettop(L), "implicit", hk_shape_keys);
    read_shape(L, lua_gettop(L), s, &shape->part[k], depth + 1);
  }
}

/* A key that has no meaning for the kind of shape would be passed over in silence. */
static void refuse_unused(lua_State *L, int table, const char *used, const char *const *keys) {
  for (; *keys; keys++) {
    if (hk_lua_field(L, table, *keys) != LUA_TNIL)
      hk_lua_fail(L, HK_BAD_PARAM, "implicit: %s: it has no meaning beside %s", *keys, used);
    lua_pop(L, 1);
  }
}

static void read_shape(lua_State *L, int table, hk_script_shape *s, hk_implicit_shape *shape, int depth) {
  static const char *const kinds[] = {"f", "blobs", "union", "intersection", "difference"};
  static const char *const of_function[] = {"level", "inside", NULL}, *const of_parts[] = {"blend", NULL};
  int found = -1;
  luaL_checkstack(L, SLOTS, "implicit");
  for (int k = 0; k < 5; k++) {
    bool there = hk_lua_field(L, table, kinds[k]) != LUA_TNIL;
    lua_pop(L, 1);
    if (there && found >= 0)
      hk_lua_fail(L, HK_BAD_PARAM, "implicit: %s and %s: a shape has one of them; join two in a union", kinds[found],
                  kinds[k]);
    if (there) found = k;
  }
  if (found < 0)
    hk_lua_fail(
        L, HK_BAD_PARAM,
        "implicit: a shape is required: f = function(x, y, z) ... end, blobs, union, intersection or difference");
  if (found != 0) refuse_unused(L, table, kinds[found], of_function);
  if (found < 2) refuse_unused(L, table, kinds[found], of_parts);
  hk_lua_field(L, table, kinds[found]);
  if (found == 0)
    read_function(L, table, s, shape);
  else if (found == 1)
    read_blobs(L, shape);
  else
    read_parts(L, table, s, shape, (hk_implicit_kind)(HK_IMPLICIT_UNION + found - 2), depth);
}

void hk_script_shape_read(lua_State *L, int table, hk_script_shape *s) {
  *s = (hk_script_shape){.L = L};
  read_shape(L, table, s, &s->shape, 0);
}
