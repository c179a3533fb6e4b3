/* hooke.ask(path, name, argument, options): a script that returns a table of functions answers a question. It runs as
 * untrusted scenes do, in a Lua state of its own with their sandbox and limits, and may make scenes and drive runs. The
 * function `name` of its table gets a copy of the argument; a copy of what it returns comes out, and what the runs
 * cost: { runs =, steps =, evaluations =, diverged = }. Or nil, and the reason. Options: threads, seed, trust,
 * stand_in = { force =, path = }, a plugin in the place of that force in all of the script's scenes, and within =
 * NAME: the script makes its table by hooke.NAME{}, as for hooke.definition. */
#include "core/app/tools/tools.h"

#include <lauxlib.h>

typedef struct question {
  lua_State *asker;    /* on which the answer is pushed */
  lua_State *argument; /* a plain copy of the question's argument is on top */
  const char *path, *name;
  const char *within; /* hooke.WITHIN gives what it gets; NULL: there is no such function */
  hk_work work;
} question;

static int same(lua_State *L) {
  lua_settop(L, 1);
  return 1;
}

static void add_to_hooke(lua_State *L, const char *name) {
  lua_getglobal(L, "hooke");
  lua_pushstring(L, name);
  lua_pushcfunction(L, same);
  lua_rawset(L, -3);
  lua_pop(L, 1);
}

static int run(lua_State *L) {
  question *q = lua_touserdata(L, 1);
  const char *what = lua_pushfstring(L, "%s: the answer of %s", q->path, q->name);
  if (q->within) add_to_hooke(L, q->within);
  hk_lua_run_file(L);
  if (!lua_istable(L, -1) || hk_lua_field(L, lua_gettop(L), q->name) != LUA_TFUNCTION)
    hk_lua_fail(L, HK_SCRIPT, "%s: it has to return a table with the function %s", q->path, q->name);
  hk_tool_copy(L, q->argument, "the question");
  lua_call(L, 1, 1);
  hk_tool_copy(q->asker, L, what);
  q->work = hk_script_work(hk_lua_script(L));
  return 0;
}

static void read_stand_in(lua_State *L, hk_stand_in *stand_in) {
  static const char *const keys[] = {"force", "path", NULL};
  if (hk_lua_field(L, 4, "stand_in") != LUA_TTABLE) return; /* it stays on the stack, and keeps its texts alive */
  int table = lua_gettop(L);
  hk_lua_check_keys(L, table, "stand_in", keys);
  if (hk_lua_field(L, table, "force") != LUA_TSTRING || hk_lua_field(L, table, "path") != LUA_TSTRING)
    luaL_error(L, "ask: stand_in: expected { force = , path = }");
  *stand_in = (hk_stand_in){lua_tostring(L, -2), lua_tostring(L, -1)};
}

static void read_options(lua_State *L, hk_script_options *options, question *q) {
  static const char *const keys[] = {"threads", "seed", "trust", "stand_in", "within", NULL};
  static const double most = 9007199254740992.0; /* 2^53 */
  options->trust = false;
  options->given_count = 0;
  if (!lua_istable(L, 4)) return;
  hk_lua_check_keys(L, 4, "ask", keys);
  options->threads = (int)hk_lua_field_whole(L, 4, "ask", "threads", 0, 1024);
  options->seed = hk_lua_field_whole(L, 4, "ask", "seed", 0, most);
  options->trust = hk_lua_field(L, 4, "trust") == LUA_TBOOLEAN && lua_toboolean(L, -1);
  if (hk_lua_field(L, 4, "within") == LUA_TSTRING) q->within = lua_tostring(L, -1); /* it stays on the stack */
  read_stand_in(L, &options->stand_in);
}

static void push_work(lua_State *L, const hk_work *work) {
  lua_newtable(L);
  hk_tool_set_number(L, "runs", (double)work->runs);
  hk_tool_set_number(L, "steps", (double)work->steps);
  hk_tool_set_number(L, "evaluations", (double)work->evaluations);
  hk_tool_set_flag(L, "diverged", work->worst == HK_DIVERGED);
}

int hk_tool_ask(lua_State *L) {
  question q = {.asker = L, .path = luaL_checkstring(L, 1), .name = luaL_checkstring(L, 2)};
  hk_script *tool = hk_lua_script(L);
  hk_script_options options = *hk_script_asked(tool);
  hk_run_options run_options = {
      .dt = NAN, .tol = NAN, .until = NAN, .accuracy = NAN, .no_output = true, .progress = -1};
  hk_error error = {0};
  lua_settop(L, 4);
  read_options(L, &options, &q);
  run_options.interrupted = hk_script_run_options(tool)->interrupted;
  run_options.acting = hk_script_run_options(tool)->acting;
  options.run = &run_options;
  q.argument = lua_newthread(L); /* what is wrong with the argument is the tool's error, before the script begins */
  lua_pushvalue(L, 3);
  hk_tool_copy(q.argument, L, "ask: the argument");
  lua_pop(L, 1);
  int top = lua_gettop(L);
  if (hk_script_host(q.path, &options, run, &q, &error) == HK_OK) {
    push_work(L, &q.work);
    return 2;
  }
  lua_settop(L, top);
  lua_pushnil(L);
  lua_pushstring(L, error.text);
  return 2;
}
