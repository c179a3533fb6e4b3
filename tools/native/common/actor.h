/* One plugin of a tool's run, a constraint, a corrector, a source, an output or a service, called directly at states
 * made by the tool, in guarded arrays (guard.h). The run itself does not change. As Lua sees it an actor is a userdata;
 * arrays are tables of numbers. */
#ifndef HK_TOOLS_ACTOR_H
#define HK_TOOLS_ACTOR_H

#include "tools/native/common/subject.h"

typedef struct hk_actor {
  hk_run *run;
  hk_instance *instance;
  bool own; /* the instance was made for the tool: the run has none */
  hk_view view;
  size_t n, told_of;  /* told_of: particles that the instance knows of, where births and deaths are made up */
  hk_guarded x, v;    /* n x 3 each; what the view shows, read-only */
  hk_guarded out[2];  /* what the plugin writes */
  hk_guard_side side; /* where the arrays have their wall */
} hk_actor;

hk_actor *hk_actor_at(lua_State *L, int index);
/* open(run, kind [, "behind" or "before" [, fresh]]): the first plugin of that kind; its state is that of the run. With
 * `fresh`, or where the run does not use it, the instance is made anew and destroyed with the actor. */
int hk_actor_open(lua_State *L);
/* watch(fd): the last message of this process goes to fd; each module has arrays of its own. */
int hk_actor_watch(lua_State *L);
/* set(actor, {t =, x =, v =}): what is given. Timed parameters take their value of the time. */
int hk_actor_set(lua_State *L);
/* The k-th array for the plugin's answer, `count` numbers, zeroed. */
double *hk_actor_out(lua_State *L, hk_actor *, int k, const char *name, size_t count);
/* Pushes what the plugin said, without the script's line, and forgets it. */
void hk_actor_push_said(lua_State *L, hk_actor *);

#endif
