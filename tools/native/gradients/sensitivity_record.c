/* A record of steps as Lua holds it, and the scene's measures in states that are not the run's. */
#include "tools/native/gradients/sensitivity_record.h"

#include <lauxlib.h>
#include <stdlib.h>
#include <string.h>

const char hk_record_type[] = "hooke.sensitivity";

record *hk_record_at(lua_State *L) { return luaL_checkudata(L, 1, hk_record_type); }

/* nil and a reason */
int hk_record_refuse(lua_State *L, const hk_error *error) {
  lua_pushnil(L);
  lua_pushstring(L, error->text);
  return 2;
}

void hk_record_push(lua_State *L, const double *number, size_t count) {
  lua_createtable(L, (int)count, 0);
  for (size_t k = 0; k < count; k++) {
    lua_pushnumber(L, number[k]);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
}

/* ---- the measure ---- */

size_t hk_record_measure_named(lua_State *L, const record *r, int index) {
  const char *name = luaL_checkstring(L, index);
  const hk_scene *scene = r->run->scene;
  for (size_t k = 0; k < scene->measures; k++)
    if (strcmp(scene->measure[k].name, name) == 0) return k;
  luaL_argerror(L, index, "no measure of the scene");
  return 0;
}

/* What the measure is in a run, of its own script, that is shown another x and v for the time of the call. */
hk_status hk_record_measure_at(record *r, hk_run *run, double t, double *X, double *value) {
  hk_state *s = &run->state;
  double *own = s->X, before = s->t;
  double *shown = malloc(s->size * sizeof *shown);
  if (!shown) return hk_error_set(&r->error, HK_NO_MEMORY, "no memory for a measure");
  memcpy(shown, own, s->size * sizeof *shown);
  memcpy(own, X, 6 * s->model.n * sizeof *X);
  hk_step_set_time(&run->loop, t);
  hk_status status = hk_figures_measure(&run->loop, &run->judgement, run);
  *value = run->judgement.measure[r->measure];
  memcpy(own, shown, s->size * sizeof *shown);
  hk_step_set_time(&run->loop, before);
  free(shown);
  if (status != HK_OK) return hk_error_set(&r->error, status, "%s", run->error.text);
  if (isfinite(*value)) return HK_OK;
  return hk_error_set(&r->error, HK_FAILED, "the measure is not finite at t = %g s", t);
}

/* The state X and, to both sides, the part `part` of its change dX. */
double *hk_record_moved(record *r, const double *X, const double *dX, double part) {
  for (size_t e = 0; e < 6 * r->steps->n; e++) r->X[e] = X[e] + (dX ? part * dX[e] : 0);
  return r->X;
}

static const double part = 6e-6; /* eps^(1/3), of the scene's size, over which differences by x and v are taken */

/* The largest of the numbers, or of their distances from the first three. */
static double size_of(const double *x, size_t count, bool places) {
  double most = 0;
  for (size_t e = 0; e < count; e++) most = fmax(most, fabs(x[e] - (places ? x[e % 3] : 0)));
  return most > 0 ? most : 1;
}

void hk_record_reach(const record *r, const double *X, double by[2]) {
  size_t v = 3 * r->steps->n;
  by[0] = r->reach * part * size_of(X, v, true);
  by[1] = r->reach * part * size_of(X + v, v, false);
}

/* ---- the measure's derivative by the state ---- */

/* A measure in the run's own state, of which single numbers are others for a while. */
typedef struct surveyed {
  record *r;
  double *X, *before; /* the run's; 6n, what changed numbers were */
  double by[2], value;
  uint32_t chance;
  double *slope;
} surveyed;

static hk_status measure_now(record *r, double *value) {
  hk_status status = hk_figures_measure(&r->run->loop, &r->run->judgement, r->run);
  *value = r->run->judgement.measure[r->measure];
  if (status != HK_OK) return hk_error_set(&r->error, status, "%s", r->run->error.text);
  if (isfinite(*value)) return HK_OK;
  return hk_error_set(&r->error, HK_FAILED, "the measure is not finite beside a state of the run");
}

static hk_status measure_beside(const surveyed *s, size_t e, double by, double *value) {
  double before = s->X[e];
  s->X[e] += by;
  hk_status status = measure_now(s->r, value);
  s->X[e] = before;
  return status;
}

/* Adds to numbers something between a half and all of the reach of differences, to either side. */
static void disturb(surveyed *s, size_t first, size_t count, double by) {
  for (size_t e = first; e < first + count; e++) {
    s->chance = s->chance * 1664525 + 1013904223; /* Knuth 1981, vol. 2, 3.3.4 */
    double size = by * (0.5 + (s->chance >> 9) * 0x1p-24);
    s->X[e] += s->chance >> 8 & 1 ? size : -size;
  }
}

/* Whether the measure changes, by a bit, where all numbers of these particles do, at either of two changes. */
static bool depends(surveyed *s, size_t begin, size_t end) {
  size_t v = 3 * s->r->steps->n, first = 3 * begin, count = 3 * (end - begin);
  bool does = false;
  memcpy(s->before + first, s->X + first, count * sizeof *s->X);
  memcpy(s->before + v + first, s->X + v + first, count * sizeof *s->X);
  for (int draw = 0; draw < 2 && !does; draw++) {
    double value;
    disturb(s, first, count, s->by[0]);
    disturb(s, v + first, count, s->by[1]);
    does = measure_now(s->r, &value) != HK_OK || value != s->value;
    memcpy(s->X + first, s->before + first, count * sizeof *s->X);
    memcpy(s->X + v + first, s->before + v + first, count * sizeof *s->X);
  }
  hk_error_clear(&s->r->error);
  return does;
}

static hk_status by_number(const surveyed *s, size_t e, double by) {
  double more, less;
  hk_status status = measure_beside(s, e, by, &more);
  if (status == HK_OK) status = measure_beside(s, e, -by, &less);
  if (status == HK_OK) s->slope[e] = (more - less) / (2 * by);
  return status;
}

/* By differences in each number of the particles on which the measure depends, found by halves: most measures depend
 * on few. */
static hk_status by_particles(surveyed *s, size_t begin, size_t end) {
  size_t v = 3 * s->r->steps->n, middle = begin + (end - begin) / 2;
  hk_status status = HK_OK;
  if (begin == end || !depends(s, begin, end)) return HK_OK;
  if (end - begin > 1) {
    status = by_particles(s, begin, middle);
    return status == HK_OK ? by_particles(s, middle, end) : status;
  }
  for (size_t e = 3 * begin; e < 3 * end && status == HK_OK; e++) {
    status = by_number(s, e, s->by[0]);
    if (status == HK_OK) status = by_number(s, v + e, s->by[1]);
  }
  return status;
}

hk_status hk_record_slope(record *r, double t, const double *X, double *slope) {
  hk_state *own = &r->run->state;
  size_t size = 6 * r->steps->n;
  double before = own->t, *memory = malloc((2 * size + 1) * sizeof *memory);
  if (!memory) return hk_error_set(&r->error, HK_NO_MEMORY, "no memory for the derivatives of a measure");
  surveyed s = {.r = r, .X = own->X, .before = memory + size, .slope = slope, .chance = 1};
  memcpy(memory, own->X, size * sizeof *memory);
  hk_record_reach(r, X, s.by);
  memmove(own->X, X, size * sizeof *X);
  hk_step_set_time(&r->run->loop, t);
  memset(slope, 0, size * sizeof *slope);
  hk_status status = measure_now(r, &s.value);
  if (status == HK_OK) status = by_particles(&s, 0, r->steps->n);
  memcpy(own->X, memory, size * sizeof *memory);
  hk_step_set_time(&r->run->loop, before);
  free(memory);
  return status;
}
