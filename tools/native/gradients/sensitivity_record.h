/* The record of a run's steps as tools/native/sensitivity.c has it, and the scene's measures in states that are not the
 * run's. */
#ifndef HK_SENSITIVITY_RECORD_H
#define HK_SENSITIVITY_RECORD_H

#include "core/app/lua/lua.h"
#include "core/numerics/sensitivity/sensitivity.h"

enum { HK_RECORD_MOST = 64 }; /* parameters */

typedef struct record {
  hk_sensitivity *steps;
  hk_run *run, *more[HK_RECORD_MOST], *less[HK_RECORD_MOST];
  hk_varied by[HK_RECORD_MOST];
  hk_knots knots[HK_RECORD_MOST]; /* of those that are functions of time */
  size_t count;                   /* of parameters */
  size_t measure;                 /* which of the scene is asked for */
  double reach;                   /* of differences of the measure, in parts of hk_record_reach's own */
  double *X;                      /* 12n: a state as a run is shown it, and derivatives by it */
  double *row;                    /* rows x (2 + count): t, value, derivatives */
  size_t rows, room;
  hk_error error;
} record;

extern const char hk_record_type[];
record *hk_record_at(lua_State *L);                                      /* argument 1 */
int hk_record_refuse(lua_State *L, const hk_error *error);               /* returns nil and the reason */
void hk_record_push(lua_State *L, const double *, size_t count);         /* a list of numbers */
size_t hk_record_measure_named(lua_State *L, const record *, int index); /* which of the scene, by its name */
/* What the record's measure is in a run, of its own script, that is shown another x and v for the time of the call. */
hk_status hk_record_measure_at(record *, hk_run *, double t, double *X, double *value);
/* The state X and, to both sides, the part `part` of its change dX; NULL: none. In the record's own memory. */
double *hk_record_moved(record *, const double *X, const double *dX, double part);
/* The reach of differences by numbers of the state X: by[0] of x, by[1] of v. */
void hk_record_reach(const record *, const double *X, double by[2]);
/* The derivatives of the record's measure at t by the 6n numbers of X, of which `slope` is no part. */
hk_status hk_record_slope(record *, double t, const double *X, double *slope);

/* sensitivity_segments.c: methods of records */
int hk_record_times(lua_State *L);
int hk_record_segment(lua_State *L);
int hk_record_curves(lua_State *L);
int hk_record_place(lua_State *L);
int hk_record_assign(lua_State *L);
int hk_record_survey(lua_State *L);

#endif
