/* scene:control(name, { knots = }): a function of time that `hooke optimise` finds, linear between values at equally
 * spaced knots and constant beyond them. The values are a parameter of the scene, the text "DURATION: VALUE VALUE ...",
 * so that what was found is run again as it is: hooke run SCENE.lua thrust="2: 1 0.5 ...". */
#include "core/app/lua/internal.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_KNOTS = 10000 };

/* The values as the script has them at work. */
typedef struct knots {
  bool making, asked; /* the script still makes the scene; it has asked for a value in that time */
  size_t count;
  double duration, value[];
} knots;

/* t -> the value; upvalues are the knots and the scene */
static int value_at(lua_State *L) {
  knots *c = lua_touserdata(L, lua_upvalueindex(1));
  if (c->making) {
    c->making = !hk_lua_scene(L, lua_upvalueindex(2))->frozen;
    c->asked |= c->making;
  }
  double last = (double)(c->count - 1), at = luaL_checknumber(L, 1) / c->duration * last;
  if (!(at > 0)) at = 0;
  size_t k = at < last ? (size_t)at : c->count - 2;
  double part = fmin(at - (double)k, 1);
  lua_pushnumber(L, (1 - part) * c->value[k] + part * c->value[k + 1]);
  return 1;
}

static const char *control_name(lua_State *L) { return lua_tostring(L, 2); }

/* The first guess at knot k: of `start`, at index 4, a number, a list or a function of time. */
static double guess(lua_State *L, size_t k, size_t count, double duration) {
  int type = lua_type(L, 4);
  if (type == LUA_TNIL)
    lua_pushnumber(L, 0);
  else if (type == LUA_TFUNCTION) {
    lua_pushvalue(L, 4);
    lua_pushnumber(L, (double)k / (double)(count - 1) * duration);
    lua_call(L, 1, 1);
  } else if (type == LUA_TTABLE)
    lua_rawgeti(L, 4, (lua_Integer)k + 1);
  else
    lua_pushvalue(L, 4);
  double value = lua_type(L, -1) == LUA_TNUMBER ? lua_tonumber(L, -1) : NAN;
  lua_pop(L, 1);
  if (!isfinite(value))
    hk_lua_fail(L, HK_BAD_PARAM, "control '%s': start: not a finite number at knot %zu", control_name(L), k + 1);
  return value;
}

/* Pushes the text of the first guess. */
static void push_guess(lua_State *L, double duration) {
  size_t count = (size_t)hk_lua_field_whole(L, 3, "control", "knots", 0, MOST_KNOTS);
  if (count < 2)
    hk_lua_fail(L, HK_BAD_PARAM, "control '%s': knots: a whole number from 2 to %d", control_name(L), MOST_KNOTS);
  hk_lua_field(L, 3, "start"); /* at 4 */
  if (lua_istable(L, 4) && lua_rawlen(L, 4) != count)
    hk_lua_fail(L, HK_BAD_PARAM, "control '%s': start: %zu values for %zu knots", control_name(L),
                (size_t)lua_rawlen(L, 4), count);
  double *value = lua_newuserdatauv(L, count * sizeof *value, 0);
  for (size_t k = 0; k < count; k++) value[k] = guess(L, k, count, duration);
  char number[40];
  luaL_Buffer text;
  luaL_buffinit(L, &text);
  snprintf(number, sizeof number, "%.17g:", duration);
  luaL_addstring(&text, number);
  for (size_t k = 0; k < count; k++) {
    snprintf(number, sizeof number, " %.17g", value[k]);
    luaL_addstring(&text, number);
  }
  luaL_pushresult(&text);
}

/* Pushes the text that param() has for the control, of the guess on top or of the command line. */
static const char *push_param(lua_State *L) {
  int initial = lua_gettop(L);
  lua_pushcfunction(L, hk_lua_param);
  lua_pushvalue(L, 2);
  lua_pushvalue(L, initial);
  hk_lua_field(L, 3, "help");
  lua_call(L, 3, 1);
  return lua_tostring(L, -1);
}

/* Pushes the knots of the text. */
static knots *push_knots(lua_State *L, const char *text) {
  char *end;
  double duration = strtod(text, &end);
  if (end == text || *end != ':' || !(duration > 0) || !isfinite(duration))
    hk_lua_fail(L, HK_BAD_PARAM, "control '%s': '%.40s' is not DURATION: VALUE VALUE ...", control_name(L), text);
  size_t room = strlen(end) / 2 + 1;
  knots *c = lua_newuserdatauv(L, sizeof *c + room * sizeof(double), 0);
  *c = (knots){.making = true, .duration = duration};
  for (const char *at = end + 1; *(at += strspn(at, " \t\r\n")); at = end) {
    double value = strtod(at, &end);
    if (end == at || !isfinite(value) || !strchr(" \t\r\n", *end))
      hk_lua_fail(L, HK_BAD_PARAM, "control '%s': '%.*s' is not a finite number", control_name(L),
                  (int)strcspn(at, " \t\r\n"), at);
    c->value[c->count++] = value;
  }
  if (c->count < 2) hk_lua_fail(L, HK_BAD_PARAM, "control '%s': two values at least", control_name(L));
  return c;
}

int hk_lua_scene_control(lua_State *L) {
  static const char *const keys[] = {"knots", "duration", "start", "min", "max", "help", NULL};
  static const char form[] = "scene:control(\"thrust\", { knots = 31 })";
  hk_scene *target = hk_lua_editable(L);
  hk_error error = {0};
  hk_lua_text(L, 2, form);
  hk_lua_check_table(L, 3, "control", form);
  lua_settop(L, 3);
  hk_lua_check_keys(L, 3, "control", keys);
  push_guess(L, hk_lua_positive(L, 3, "control", "duration", target->duration));
  knots *c = push_knots(L, push_param(L));
  hk_control control = {.name = (char *)(uintptr_t)control_name(L),
                        .duration = c->duration,
                        .knots = c->count,
                        .value = c->value,
                        .current = c->value,
                        .asked = &c->asked};
  control.min = hk_lua_field_number(L, 3, "control", "min", -INFINITY);
  control.max = hk_lua_field_number(L, 3, "control", "max", INFINITY);
  hk_limits_take(L, sizeof control + strlen(control.name) + c->count * sizeof(double));
  hk_lua_check(L, hk_scene_add_control(target, &control, &error), &error);
  lua_pushvalue(L, -1);
  luaL_ref(L, LUA_REGISTRYINDEX); /* the scene's `current` is there as long as the state is */
  lua_pushvalue(L, 1);
  lua_pushcclosure(L, value_at, 2);
  return 1;
}
