/* Fields of the table on top of the stack. */
#include "core/app/tools/tools.h"

void hk_tool_set_text(lua_State *L, const char *key, const char *value) {
  hk_lua_push_plain(L, value ? value : "");
  lua_setfield(L, -2, key);
}

void hk_tool_set_number(lua_State *L, const char *key, double value) {
  lua_pushnumber(L, value);
  lua_setfield(L, -2, key);
}

void hk_tool_set_flag(lua_State *L, const char *key, bool value) {
  lua_pushboolean(L, value);
  lua_setfield(L, -2, key);
}
