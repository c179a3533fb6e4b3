/* Errors between the engine and a script. An error raised by the engine carries a status beside its text and is
 * prefixed by the script's file and line; a plain Lua error is HK_SCRIPT. Every call into the script, from the first
 * line to a measure in the last frame, goes through hk_lua_call, which turns a raised error into one hk_error. A script
 * that catches errors cannot hide that it exceeded a limit. */
#include "core/app/script/script.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *hk_lua_where(lua_State *L) {
  lua_Debug ar;
  for (int level = 1; lua_getstack(L, level, &ar); level++) {
    lua_getinfo(L, "Sl", &ar);
    if (ar.currentline > 0) return lua_pushfstring(L, "%s:%d", ar.short_src, ar.currentline);
  }
  return lua_pushfstring(L, "%s", hk_lua_script(L)->name);
}

/* Whether the text contains a place such as "file.lua:12:". */
static bool has_place(const hk_script *s, const char *text) {
  size_t length = strlen(s->name);
  if (strncmp(text, s->name, length) == 0 && text[length] == ':') return true;
  for (const char *at = strstr(text, ".lua:"); at; at = strstr(at + 1, ".lua:"))
    if (at[5] >= '0' && at[5] <= '9') return true;
  return false;
}

int hk_lua_raise(lua_State *L, const hk_error *error) {
  hk_script *s = hk_lua_script(L);
  s->raised = *error;
  if (has_place(s, error->text))
    lua_pushstring(L, error->text);
  else
    lua_pushfstring(L, "%s: %s", hk_lua_where(L), error->text);
  lua_error(L);
  abort(); /* lua_error does not return */
}

int hk_lua_fail(lua_State *L, hk_status status, const char *format, ...) {
  hk_error error = {0};
  va_list arguments;
  va_start(arguments, format);
  hk_error_setv(&error, status, format, arguments);
  va_end(arguments);
  hk_lua_raise(L, &error);
}

void hk_lua_warn(lua_State *L, hk_scene *scene, const char *format, ...) {
  char text[900];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  hk_limits_take(L, sizeof text);
  hk_warn(&scene->warnings, "%s: %s", hk_lua_where(L), text);
  lua_pop(L, 1);
}

static hk_status take_error(lua_State *L, hk_error *error) {
  hk_script *s = hk_lua_script(L);
  const char *text = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : NULL;
  bool ours = s->raised.status != HK_OK && text && strstr(text, s->raised.text);
  hk_status status = ours ? s->raised.status : HK_SCRIPT;
  if (s->spent) /* also when the script caught the error and raised another one */
    hk_error_set(error, status = s->limit.status, "%s", s->limit.text);
  else if (text)
    hk_error_set(error, status, "%s", text);
  else
    hk_error_set(error, status, "%s: the script raised an error that is a %s, not a text", s->name,
                 luaL_typename(L, -1));
  lua_pop(L, 1);
  return status;
}

/* Calls may be nested: a script calls scene:run, and the run calls the script's measures. */
hk_status hk_lua_call(lua_State *L, int arguments, int results, hk_error *error) {
  hk_lua_script(L)->raised.status = HK_OK;
  return hk_limits_call(L, arguments, results) == LUA_OK ? HK_OK : take_error(L, error);
}
