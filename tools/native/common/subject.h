/* One force of a tool's run, evaluated directly at states made by the tool, in guarded arrays (guard.h): positions and
 * velocities it may only read. The run itself does not change. As Lua sees it a subject is a userdata; arrays are
 * tables of numbers. */
#ifndef HK_TOOLS_SUBJECT_H
#define HK_TOOLS_SUBJECT_H

#include "core/app/lua/lua.h"
#include "core/engine/contract/contract.h"
#include "tools/native/common/guard.h"

#include <lauxlib.h>
#include <lua.h>

typedef struct hk_subject {
  hk_run *run;
  hk_instance *instance;
  const hk_force_tables *force;
  size_t index; /* of the force in the run */
  hk_view view;
  size_t n, size;                /* particles, 3n */
  hk_guarded x, v, y, F, dy, dx; /* dx: a displacement, or other positions, n x 3 */
  hk_guard_side side;
  int fill;         /* the byte that the stack below a call is filled with; negative: none */
  hk_status status; /* the last that was not HK_OK */
} hk_subject;

hk_subject *hk_subject_at(lua_State *L, int index);
/* open(run, name [, "behind" or "before"]): the first force of the run that is a plugin of that name; its state is that
 * of the run. */
int hk_subject_open(lua_State *L);
void hk_subject_enter(hk_subject *, const char *function); /* before a call of the plugin */
void hk_subject_leave(hk_subject *);
/* F += force, with what is there; returns the power that it added to `power`. With NAN the view has no power. */
double hk_subject_add(hk_subject *, double power);
double hk_subject_energy(hk_subject *);
/* parts(subject) -> F summed part by part, its power, a particle that was written to by a part that does not have it, a
 * particle whose force a part computed from one that it does not have, or 0; nil: it has no add_part. */
int hk_subject_parts(lua_State *L);

/* Products of the force's own; nil: it has none. With `start`, of lists that held that before, which is taken off
 * again. transposed(subject, u, start) -> (dF/dx)^T u and (dF/dv)^T u, and whether it was fine. */
int hk_subject_transposed(lua_State *L);
/* along(subject, dx, dv, start) -> the change of F, that along -dx and -dv, of one call, and whether it was fine. */
int hk_subject_along(lua_State *L);
/* pair(subject, u, dx, dv) -> u.along(w) - transposed(u).w, w with some changes of parameters and masses as well, and
 * the size of both. */
int hk_subject_pair(lua_State *L);
/* bilinear(subject, want, u, w, by_x, by_v, start) -> the derivatives of u.(by_x K + by_v D) w by x and by v, and
 * whether it was fine. */
int hk_subject_bilinear(lua_State *L);

/* From now on the instance's parallel_for takes the chunks one by one from the last to the first: what depends on the
 * order in which threads come is seen without luck. */
void hk_reverse_chunks(hk_instance *);

/* Numbers and tables. */
void hk_table_push(lua_State *L, const double *number, size_t count);
/* The table at `index`, `count` numbers of it. */
void hk_table_read(lua_State *L, int index, double *number, size_t count);
void hk_table_set(lua_State *L, const char *key, double value);
double *hk_table_memory(lua_State *L, size_t count); /* zeroed; belongs to the Lua state */

#endif
