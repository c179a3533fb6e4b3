/* hooke.catalogue() and hooke.describe(): plugins as Lua tables, made from the declarations of each plugin. */
#include "core/app/tools/tools.h"
#include "core/engine/contract/contract.h"

#include <lauxlib.h>

static void push_param(lua_State *L, const hk_param *p) {
  static const char *const type[] = {
      [HK_NUMBER] = "number",       [HK_INTEGER] = "integer",       [HK_BOOLEAN] = "boolean",
      [HK_STRING] = "string",       [HK_CHOICE] = "choice",         [HK_VECTOR] = "vector",
      [HK_NUMBERS] = "numbers",     [HK_PARTICLES] = "particles",   [HK_EDGES] = "edges",
      [HK_TRIANGLES] = "triangles", [HK_TETRAHEDRA] = "tetrahedra", [HK_PER_TUPLE] = "per tuple",
      [HK_FUNCTION] = "function"};
  lua_newtable(L);
  hk_tool_set_text(L, "name", p->name);
  hk_tool_set_text(L, "unit", p->unit);
  hk_tool_set_text(L, "help", p->help);
  hk_tool_set_text(L, "type", type[hk_param_type(p)]);
  hk_tool_set_text(L, "text", p->text);
  hk_tool_set_flag(L, "required", p->flags & HK_REQUIRED);
  hk_tool_set_flag(L, "optional", p->flags & HK_OPTIONAL);
  hk_tool_set_flag(L, "timed", p->flags & HK_TIMED);
  hk_tool_set_flag(L, "above_min", p->limits.kind == HK_LEAST_EXCLUDED);
  if (p->limits.kind != HK_NO_LIMITS) {
    hk_tool_set_number(L, "min", p->limits.least);
    hk_tool_set_number(L, "max", p->limits.most);
  }
  lua_createtable(L, 3, 0);
  for (int c = 0; c < 3; c++) {
    lua_pushnumber(L, p->initial[c]);
    lua_rawseti(L, -2, c + 1);
  }
  lua_setfield(L, -2, "initial");
}

static void set_force(lua_State *L, const hk_plugin *plugin) {
  const hk_force *f = plugin->force;
  hk_tool_set_flag(L, "on_x", f->flags & HK_DEPENDS_ON_X);
  hk_tool_set_flag(L, "on_v", f->flags & HK_DEPENDS_ON_V);
  hk_tool_set_flag(L, "on_t", f->flags & HK_DEPENDS_ON_T);
  hk_tool_set_flag(L, "momentum", f->flags & HK_CONSERVES_MOMENTUM);
  hk_tool_set_flag(L, "angular_momentum", f->flags & HK_CONSERVES_ANGULAR_MOMENTUM);
  hk_tool_set_flag(L, "periodic", f->flags & HK_PERIODIC);
  hk_tool_set_flag(L, "symmetric", f->flags & HK_SYMMETRIC_JACOBIAN);
  hk_tool_set_flag(L, "power", f->flags & HK_POWER);
  hk_tool_set_flag(L, "offers_symmetric", f->flags & HK_OFFERS_SYMMETRIC);
  hk_tool_set_flag(L, "offers_definite", f->flags & HK_OFFERS_DEFINITE);
  hk_tool_set_flag(L, "stiffer_blocks", f->flags & HK_STIFFER_BLOCKS);
  hk_tool_set_flag(L, "energy", f->energy != NULL);
  hk_tool_set_flag(L, "jacobian", hk_force_of(plugin)->implicit.jacobian != NULL);
  hk_tool_set_flag(L, "transposed", hk_force_of(plugin)->implicit.transposed != NULL);
  hk_tool_set_flag(L, "along", hk_force_of(plugin)->implicit.along != NULL);
  hk_tool_set_flag(L, "bilinear", hk_force_of(plugin)->implicit.bilinear != NULL);
}

static void set_method(lua_State *L, const hk_integrator *m) {
  hk_tool_set_number(L, "order", m->order);
  hk_tool_set_number(L, "stages", m->stages);
  hk_tool_set_flag(L, "implicit", m->flags & HK_IMPLICIT);
  hk_tool_set_flag(L, "adaptive", m->flags & HK_ADAPTIVE);
  hk_tool_set_flag(L, "symplectic", m->flags & HK_SYMPLECTIC);
  hk_tool_set_flag(L, "reversible", m->flags & HK_REVERSIBLE);
}

/* The names of its facets: "implicit/1, parts/1". */
static void set_facets(lua_State *L, const hk_plugin *plugin) {
  luaL_Buffer names;
  luaL_buffinit(L, &names);
  for (const hk_facet *f = hk_facets_of(plugin); f && f->id; f++) {
    if (f != hk_facets_of(plugin)) luaL_addstring(&names, ", ");
    luaL_addstring(&names, f->id);
  }
  luaL_pushresult(&names);
  lua_setfield(L, -2, "facets");
}

/* Whether it says something of each particle to others. */
static bool publishes(const hk_plugin *plugin) {
  for (const hk_field *f = plugin->fields; f && f->name; f++)
    if (f->flags & HK_PUBLISHED) return true;
  return false;
}

static void push_plugin(lua_State *L, const hk_loaded *item) {
  const hk_plugin *plugin = item->plugin;
  lua_newtable(L);
  hk_tool_set_text(L, "path", item->path);
  hk_tool_set_text(L, "kind", hk_kind_name(plugin->kind));
  hk_tool_set_text(L, "name", plugin->name);
  hk_tool_set_text(L, "summary", plugin->summary);
  hk_tool_set_text(L, "reference", plugin->reference);
  if (plugin->kind == HK_FORCE) set_force(L, plugin);
  if (plugin->kind == HK_INTEGRATOR) set_method(L, plugin->integrator);
  set_facets(L, plugin);
  lua_pushboolean(L, publishes(plugin));
  lua_setfield(L, -2, "publishes");
  lua_newtable(L);
  lua_Integer count = 0;
  for (const hk_param *p = plugin->params; p && p->name; p++) {
    push_param(L, p);
    lua_rawseti(L, -2, ++count);
  }
  lua_setfield(L, -2, "params");
}

/* Returns the plugins and the failed loads, {path =, reason =}. */
int hk_tool_catalogue(lua_State *L) {
  hk_registry *registry = hk_script_asked(hk_lua_script(L))->registry;
  hk_error error = {0};
  lua_Integer good = 0, bad = 0;
  if (hk_registry_load_all(registry, &error) != HK_OK) return hk_lua_raise(L, &error);
  lua_newtable(L);
  lua_newtable(L);
  for (size_t k = 0; k < registry->count; k++) {
    const hk_loaded *item = &registry->item[k];
    if (item->plugin) {
      push_plugin(L, item);
      lua_rawseti(L, -3, ++good);
    } else {
      lua_newtable(L);
      hk_tool_set_text(L, "path", item->path);
      hk_tool_set_text(L, "reason", item->reason);
      lua_rawseti(L, -2, ++bad);
    }
  }
  return 2;
}

/* hooke.describe(path): one plugin of the catalogue, by its file; or nil and the reason. */
int hk_tool_describe(lua_State *L) {
  hk_error error = {0};
  const hk_loaded *item =
      hk_registry_load(hk_script_asked(hk_lua_script(L))->registry, luaL_checkstring(L, 1), true, &error);
  if (item) {
    push_plugin(L, item);
    return 1;
  }
  lua_pushnil(L);
  lua_pushstring(L, error.text);
  return 2;
}
