/* `hooke NAME`: runs tools/NAME.lua with full rights. */
#ifndef HK_TOOLS_H
#define HK_TOOLS_H

#include "core/app/lua/lua.h"

typedef struct hk_choice { /* of an integrator and its step */
  char integrator[256];    /* "name" or "name:parameter=value,..."; "": no choice */
  double dt, tol;          /* NAN: the integrator's default */
} hk_choice;

/* The script gets its arguments in `arg` and ends with the exit code that it returns (0 without one). Besides the
 * functions of scenes, `hooke` has catalogue(), describe(), explain(), load(), nearest() and paths; `require` finds
 * modules in the tool's folder and in scripts/lib. `choice` gets the arguments of hooke.chosen(), or an empty name;
 * NULL: the caller needs no choice. */
hk_status hk_tool_run(const char *path, int argc, char **argv, const hk_script_options *options, int *exit_code,
                      hk_choice *choice, hk_error *error);

/* ---- shared by the files of core/app/tools ---- */

/* Functions of Lua, each by the file that defines it. */
int hk_tool_catalogue(lua_State *L);  /* catalogue.c: the plugins and the failed loads */
int hk_tool_describe(lua_State *L);   /* catalogue.c: one plugin, by its file */
int hk_tool_explain(lua_State *L);    /* explain.c */
int hk_tool_definition(lua_State *L); /* definition.c: hooke.definition(path [, name [, answers]]) */
int hk_tool_ask(lua_State *L);        /* ask.c: hooke.ask(path, name, argument, {option = value}) */
/* load.c: hooke.load(path, {name = value}, {option = value}) -> the scene and its parameters; or nil and why not */
int hk_tool_load(lua_State *L);
void hk_tool_open_verify(lua_State *L); /* verify.c: adds run:verify() */

/* parameters.c: the list of the parameters that a script declares. */
void hk_tool_push_parameters(lua_State *L, const hk_script *script);

/* load.c: converts the table {name = value} at `table`, or nil, to a block on the Lua stack. */
hk_param_given *hk_tool_push_given(lua_State *L, int table, size_t *count);
/* load.c: sets the labels that the list `without` of the table of options names, if there is one; what holds them lives
 * as long as the table. `what`: whose options they are, for errors. */
void hk_tool_read_without(lua_State *L, int table, const char *what, hk_run_options *);

/* copy.c: copies the text, number, boolean or table on top of the stack of `from` to that of `to`. A function in it, a
 * circle or control characters are an error of `from` that begins with `what`. */
void hk_tool_copy(lua_State *to, lua_State *from, const char *what);

/* fields.c: sets fields of the table on top of the stack. */
void hk_tool_set_text(lua_State *L, const char *key, const char *value); /* NULL: "" */
void hk_tool_set_number(lua_State *L, const char *key, double value);
void hk_tool_set_flag(lua_State *L, const char *key, bool value);

#endif
