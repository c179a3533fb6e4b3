/* Declarations shared by the files of core/app/lua. */
#ifndef HK_LUA_INTERNAL_H
#define HK_LUA_INTERNAL_H

#include "core/app/lua/lua.h"

/* state.c */
void hk_lua_push_state(lua_State *L, int scene); /* state of the scene at index `scene`, which the state keeps alive */
void hk_lua_open_state(lua_State *L);
bool hk_lua_state_has(const char *name);                    /* such a member */
hk_function hk_lua_frame_function(lua_State *L, int index); /* it is called with the state of the scene at index 1 */

/* param.c: param(), and the check that every name=value was declared. */
int hk_lua_param(lua_State *L);
hk_status hk_lua_check_given(const hk_script *, hk_error *error);

/* run.c */
int hk_lua_scene_run(lua_State *L); /* scene:run{} */
void hk_lua_note_verdict(hk_script *, hk_run *);
/* Closes the run and leaves its folder; a second call does nothing. */
hk_status hk_lua_end_run(hk_run *, hk_error *error);
void hk_lua_open_run(lua_State *L);

/* members.c: what the table on top of the stack does not have is an error that says what is meant */
void hk_lua_name_functions(lua_State *L); /* `hooke` */
void hk_lua_name_scene_methods(lua_State *L);
void hk_lua_name_run_methods(lua_State *L);

/* gust.c */
int hk_lua_gust(lua_State *L); /* hooke.gust{} */

/* periodic.c */
int hk_lua_scene_within(lua_State *L);
int hk_lua_scene_periodic(lua_State *L); /* scene:periodic{} */

/* channel.c */
int hk_lua_scene_channel(lua_State *L); /* scene:channel() */

/* control.c, goal.c: what `hooke optimise` looks for */
int hk_lua_scene_control(lua_State *L); /* scene:control() */
int hk_lua_scene_goal(lua_State *L);    /* scene:goal{} */
int hk_lua_scene_cost(lua_State *L);    /* scene:cost() */

/* scene.c */
void hk_lua_open_scene(lua_State *L);

/* scene_plugin.c */
int hk_lua_scene_add_kind(lua_State *L); /* scene:KIND(); the kind is its upvalue */
hk_scene *hk_lua_editable(lua_State *L); /* the first argument, a scene that does not run; an error otherwise */
void hk_lua_check(lua_State *L, hk_status status, const hk_error *error); /* raises the error of a call that failed */
void hk_lua_note_line(lua_State *L, char **line); /* *line: the script's line of the call, for messages of the run */
/* The positive number of a field of the table; an error where it is not. */
double hk_lua_positive(lua_State *L, int table, const char *what, const char *key, double otherwise);
/* Adds a plugin with the parameters of the table at `params`, 0: none. NULL: `auto`, which clears the choice. */
hk_plugin_spec *hk_lua_add_plugin(lua_State *L, hk_scene *scene, hk_kind kind, const char *name, int params);

/* plain.c */
const char *hk_lua_plain_text(lua_State *L, int index); /* pushes the value as text, without running any function */
/* Replaces functions of the environment on top of the stack that show addresses; `silent`: print does nothing. */
void hk_lua_hide_addresses(lua_State *L, bool silent);

/* sandbox.c: leaves the environment of scenes on the stack. */
void hk_lua_push_sandbox(lua_State *L);
/* guards.c */
/* Replaces a function of the table on top of the stack; its upvalue is the original. */
void hk_lua_replace(lua_State *L, const char *name, lua_CFunction by);
/* Replaces functions that could evade the limits, in the environment on top of the stack. */
void hk_lua_guard(lua_State *L);

#endif
