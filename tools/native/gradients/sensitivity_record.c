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
  by[0] = part * size_of(X, v, true);
  by[1] = part * size_of(X + v, v, false);
}

/* What the measure is where one number of X is another one. */
static hk_status beside(record *r, double t, const double *X, size_t e, double by, double *value) {
  double *shown = hk_record_moved(r, X, NULL, 0);
  shown[e] += by;
  return hk_record_measure_at(r, r->run, t, shown, value);
}

hk_status hk_record_slope(record *r, double t, const double *X, double *slope) {
  size_t v = 3 * r->steps->n;
  double by[2];
  hk_status status = HK_OK;
  hk_record_reach(r, X, by);
  for (size_t e = 0; e < 2 * v && status == HK_OK; e++) {
    double more, less = 0, step = by[e >= v];
    status = beside(r, t, X, e, step, &more);
    if (status == HK_OK) status = beside(r, t, X, e, -step, &less);
    slope[e] = (more - less) / (2 * step);
  }
  return status;
}
