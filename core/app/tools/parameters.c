/* The parameters of a script, for tools. */
#include "core/app/tools/tools.h"

/* Pushes the parameters that the script declares: { name, help, type, initial (a text), min, max }. */
void hk_tool_push_parameters(lua_State *L, const hk_script *script) {
  const hk_param_declared *param;
  size_t count = hk_script_params(script, &param);
  lua_createtable(L, (int)count, 0);
  for (size_t k = 0; k < count; k++) {
    lua_newtable(L);
    hk_tool_set_text(L, "name", param[k].name);
    hk_tool_set_text(L, "help", param[k].help);
    hk_tool_set_text(L, "type", param[k].type);
    hk_tool_set_text(L, "initial", param[k].initial);
    hk_tool_set_number(L, "min", param[k].min);
    hk_tool_set_number(L, "max", param[k].max);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
}
