/* sensitivity: the derivatives of a scene's measure by parameters, for `hooke gradient`. */
#include "core/engine/contract/contract.h"
#include "tools/native/gradients/sensitivity_record.h"

#include <lauxlib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int close_record(lua_State *L) {
  record *r = hk_record_at(L);
  for (size_t j = 0; j < r->count; j++) free(r->knots[j].slope);
  hk_sensitivity_close(r->steps);
  free(r->X);
  free(r->row);
  *r = (record){0};
  return 0;
}

/* Derivatives are those of steps that meet their equations. An iteration to the integrator's own tolerance, 1e-6 of the
 * speeds a step or so, ends elsewhere, and differences of whole runs, of 1e-5 of a parameter, would drown in it. */
static void solve_to_rounding(const hk_run *run) {
  static const double rounding = 1e-12;
  const hk_instance *integrator = run->loop.integrator;
  if (!(integrator->plugin->integrator->flags & HK_IMPLICIT)) return;
  for (const hk_param *p = integrator->plugin->params; p && p->name; p++) {
    double *tolerance = hk_param_in(p, integrator->self);
    if (strcmp(p->name, "tolerance") == 0) *tolerance = fmin(*tolerance, rounding);
  }
}

/* to_rounding(run): steps that are solved for meet their equations, as in a record. */
static int to_rounding(lua_State *L) {
  solve_to_rounding(hk_lua_run(L));
  return 0;
}

/* record(run [, reach]): keeps the steps of a run from here on; or nil and why they cannot be differentiated. `reach`:
 * how far differences of the measure go, in parts of what they do otherwise. */
static int begin(lua_State *L) {
  double reach = luaL_optnumber(L, 2, 1); /* hk_lua_run leaves something behind the arguments */
  hk_run *run = hk_lua_run(L);
  record *r = lua_newuserdatauv(L, sizeof *r, 1);
  *r = (record){.run = run, .reach = reach};
  luaL_setmetatable(L, hk_record_type);
  lua_createtable(L, 1, 0); /* runs, which live as long as the record */
  lua_pushvalue(L, 1);
  lua_rawseti(L, -2, 1);
  lua_setiuservalue(L, -2, 1);
  solve_to_rounding(run);
  if (hk_sensitivity_open(&run->loop, &r->steps, &r->error) != HK_OK) return hk_record_refuse(L, &r->error);
  r->X = malloc((12 * r->steps->n + 1) * sizeof *r->X);
  return r->X ? 1 : luaL_error(L, "no memory");
}

/* The run at the index, which is kept as long as the record. */
static hk_run *keep_run(lua_State *L, int index) {
  lua_pushvalue(L, index);
  lua_insert(L, 1);
  hk_run *run = hk_lua_run(L); /* reads argument 1 */
  lua_getiuservalue(L, 2, 1);
  lua_rotate(L, 1, -1);
  lua_rawseti(L, -2, (lua_Integer)lua_rawlen(L, -2) + 1);
  lua_pop(L, 1);
  return run;
}

static bool same_particles(const hk_run *a, const hk_run *b) {
  size_t n = a->state.model.n;
  return n == b->state.model.n && memcmp(a->state.id, b->state.id, n * sizeof *a->state.id) == 0;
}

/* The parameter that was added last is a function of time, from 0 to `end`. */
static int give_knots(lua_State *L, record *r, size_t count, double end) {
  size_t j = r->count - 1;
  luaL_argcheck(L, count >= 2 && end > 0, 5, "two knots at least");
  r->knots[j] = (hk_knots){count, 0, end, calloc(count, sizeof(double))};
  if (!r->knots[j].slope) return luaL_error(L, "no memory");
  r->by[j].knots = &r->knots[j];
  const double *more = r->more[j]->state.X, *less = r->less[j]->state.X;
  if (memcmp(more, less, 6 * r->steps->n * sizeof *more) == 0) {
    lua_pushboolean(L, true);
    return 1;
  }
  hk_error_set(&r->error, HK_FAILED, "it is a function of time, and the start depends on it");
  return hk_record_refuse(L, &r->error);
}

/* record:vary(more, less, by [, knots, end]): adds a parameter, by two runs of the scene at their start in which it is
 * larger and smaller by `by`; a number, or a function of time with so many knots. nil and a reason where it changes
 * what particles there are, or the order in which they are kept. */
static int vary(lua_State *L) {
  record *r = hk_record_at(L);
  double by = luaL_checknumber(L, 4), end = luaL_optnumber(L, 6, 0);
  lua_Integer knots = luaL_optinteger(L, 5, 0);
  hk_run *more = keep_run(L, 2), *less = keep_run(L, 3);
  luaL_argcheck(L, r->count < HK_RECORD_MOST, 2, "too many parameters");
  solve_to_rounding(more);
  solve_to_rounding(less);
  if (!same_particles(r->run, more) || !same_particles(r->run, less)) {
    hk_error_set(&r->error, HK_FAILED, "it changes the number or the order of the particles");
    return hk_record_refuse(L, &r->error);
  }
  r->more[r->count] = more;
  r->less[r->count] = less;
  r->by[r->count++] = (hk_varied){&more->dynamics, &less->dynamics, by, NULL};
  if (knots > 0) return give_knots(L, r, (size_t)knots, end);
  lua_pushboolean(L, true);
  return 1;
}

/* record:finish(): takes the steps again; by which part of its size the scene then ends elsewhere, or nil and why these
 * are not the steps of the run. */
static int finish(lua_State *L) {
  record *r = hk_record_at(L);
  if (hk_sensitivity_finish(r->steps, &r->error) != HK_OK) return hk_record_refuse(L, &r->error);
  lua_pushnumber(L, r->steps->off);
  return 1;
}

/* record:about() -> steps, particles, a force without an exact Jacobian or nil, bytes of the states of an adjoint, and
 * the tolerance of a method that chooses its steps */
static int about(lua_State *L) {
  const hk_sensitivity *s = hk_record_at(L)->steps;
  lua_pushinteger(L, (lua_Integer)s->steps);
  lua_pushinteger(L, (lua_Integer)s->n);
  lua_pushstring(L, s->inexact);
  lua_pushnumber(L, hk_sensitivity_kept_bytes(s));
  if (!s->linearised) return 4;
  lua_pushnumber(L, s->dynamics->system.tol);
  return 5;
}

/* d(measure)/dp where the state changes by dX/dp: of the state and of what the script makes of the parameter. */
static hk_status differ(record *r, size_t j, double t, const double *X, const double *dX, double *slope) {
  double more, less, by = r->by[j].by;
  hk_status status = hk_record_measure_at(r, r->more[j], t, hk_record_moved(r, X, dX, by), &more);
  if (status == HK_OK) status = hk_record_measure_at(r, r->less[j], t, hk_record_moved(r, X, dX, -by), &less);
  if (status == HK_OK) *slope = (more - less) / (2 * by);
  return status;
}

/* record:direct(measure, t, X) -> the derivatives of the measure at t in the state X by the values of every function of
 * time there; or nil and a reason. */
static int direct_slopes(lua_State *L) {
  record *r = hk_record_at(L);
  double t = luaL_checknumber(L, 3), slope[HK_RECORD_MOST];
  size_t size = 6 * r->steps->n;
  luaL_checktype(L, 4, LUA_TTABLE);
  luaL_argcheck(L, lua_rawlen(L, 4) == size, 4, "6 numbers a particle");
  double *X = lua_newuserdatauv(L, (size + 1) * sizeof *X, 0);
  for (size_t e = 0; e < size; e++, lua_pop(L, 1)) {
    lua_rawgeti(L, 4, (lua_Integer)e + 1);
    X[e] = lua_tonumber(L, -1);
  }
  r->measure = hk_record_measure_named(L, r, 2);
  hk_error_clear(&r->error);
  hk_status status = HK_OK;
  for (size_t j = 0; j < r->count && status == HK_OK; j++) status = differ(r, j, t, X, NULL, &slope[j]);
  if (status != HK_OK) return hk_record_refuse(L, &r->error);
  hk_record_push(L, slope, r->count);
  return 1;
}

/* ---- forwards ---- */

static bool is_frame(const record *r, double t) {
  double frame = t * r->run->scene->fps;
  return fabs(frame - round(frame)) < 1e-6 || t >= r->run->state.t;
}

static hk_status note_row(void *context, double t, const double *X, const double *tangents) {
  record *r = context;
  size_t width = 2 + r->count;
  void *rows = r->row;
  if (!is_frame(r, t)) return HK_OK;
  if (hk_array_reserve(&rows, &r->room, r->rows + 1, width * sizeof *r->row) != 0)
    return hk_error_set(&r->error, HK_NO_MEMORY, "no memory for the derivatives at frames");
  r->row = rows;
  double *row = r->row + r->rows * width;
  row[0] = t;
  hk_status status = hk_record_measure_at(r, r->run, t, hk_record_moved(r, X, NULL, 0), &row[1]);
  for (size_t j = 0; j < r->count && status == HK_OK; j++)
    status = differ(r, j, t, X, tangents + r->steps->wide * j, &row[2 + j]);
  r->rows += status == HK_OK;
  return status;
}

/* record:tangents(measure) -> rows { t, value, derivative by each parameter } at the start, at frames and at the end;
 * or nil and a reason. */
static int tangents(lua_State *L) {
  record *r = hk_record_at(L);
  size_t width = 2 + r->count;
  r->measure = hk_record_measure_named(L, r, 2);
  r->rows = 0;
  hk_error_clear(&r->error);
  if (hk_sensitivity_tangents(r->steps, r->by, r->count, note_row, r, &r->error) != HK_OK)
    return hk_record_refuse(L, &r->error);
  lua_createtable(L, (int)r->rows, 0);
  for (size_t k = 0; k < r->rows; k++) {
    hk_record_push(L, r->row + k * width, width);
    lua_rawseti(L, -2, (lua_Integer)k + 1);
  }
  return 1;
}

/* ---- backwards ---- */

/* record:adjoint(measure) -> a list of the derivatives at the end by each parameter, of a function of time the list of
 * those by its values at the knots; or nil and a reason. */
static int adjoint(lua_State *L) {
  record *r = hk_record_at(L);
  double slope[HK_RECORD_MOST], direct = 0;
  r->measure = hk_record_measure_named(L, r, 2);
  hk_error_clear(&r->error);
  double *X = lua_newuserdatauv(L, (6 * r->steps->n + 1) * sizeof *X, 0);
  hk_status status = hk_record_slope(r, r->run->state.t, r->run->state.X, X);
  if (status == HK_OK) status = hk_sensitivity_adjoint(r->steps, X, r->by, r->count, slope, &r->error);
  lua_createtable(L, (int)r->count, 0);
  for (size_t j = 0; j < r->count && status == HK_OK; j++) {
    status = differ(r, j, r->run->state.t, r->run->state.X, NULL, &direct);
    if (status == HK_OK && r->by[j].knots && direct != 0)
      status = hk_error_set(&r->error, HK_FAILED, "the measure itself depends on a function of time that is varied");
    if (r->by[j].knots)
      hk_record_push(L, r->knots[j].slope, r->knots[j].count);
    else
      lua_pushnumber(L, slope[j] + direct);
    lua_rawseti(L, -2, (lua_Integer)j + 1);
  }
  return status == HK_OK ? 1 : hk_record_refuse(L, &r->error);
}

/* ---- of an integral ---- */

/* The part of the time to which the trapezium rule gives the frame at t, s. */
static double weight_at(const record *r, double t) {
  double fps = r->run->scene->fps, end = r->run->state.t, near = 1e-6;
  double before = t > 0 ? t - (ceil(t * fps - near) - 1) / fps : 0;
  double after = t < end ? fmin((floor(t * fps + near) + 1) / fps, end) - t : 0;
  return (before + after) / 2;
}

/* hk_adjoint_source: what the frame at t adds to the integral of the measure, by its state and by functions of time. */
static hk_status add_frame(void *context, double t, const double *X, double *L) {
  record *r = context;
  size_t size = 6 * r->steps->n;
  double weight = weight_at(r, t), *slope = r->X + size;
  if (!is_frame(r, t)) return HK_OK;
  hk_status status = hk_record_slope(r, t, X, slope);
  for (size_t e = 0; e < size && status == HK_OK; e++) L[e] += weight * slope[e];
  for (size_t j = 0; j < r->count && status == HK_OK; j++) {
    double direct;
    status = differ(r, j, t, X, NULL, &direct);
    if (status == HK_OK) hk_knots_note(&r->knots[j], t, weight * direct);
  }
  return status;
}

/* record:integral(measure) -> the lists of the derivatives of the measure's integral over the frames, by the trapezium
 * rule, by the values of each function of time; or nil and a reason. */
static int integral(lua_State *L) {
  record *r = hk_record_at(L);
  double slope[HK_RECORD_MOST];
  r->measure = hk_record_measure_named(L, r, 2);
  hk_error_clear(&r->error);
  for (size_t j = 0; j < r->count; j++) luaL_argcheck(L, r->by[j].knots, 1, "functions of time alone");
  double *X = lua_newuserdatauv(L, (6 * r->steps->n + 1) * sizeof *X, 0);
  memset(X, 0, 6 * r->steps->n * sizeof *X);
  r->steps->source = add_frame;
  r->steps->source_context = r;
  hk_status status = hk_sensitivity_adjoint(r->steps, X, r->by, r->count, slope, &r->error);
  r->steps->source = NULL;
  if (status != HK_OK) return hk_record_refuse(L, &r->error);
  lua_createtable(L, (int)r->count, 0);
  for (size_t j = 0; j < r->count; j++) {
    hk_record_push(L, r->knots[j].slope, r->knots[j].count);
    lua_rawseti(L, -2, (lua_Integer)j + 1);
  }
  return 1;
}

/* record:replayed(measure, j) -> the measure at the end of the same steps where parameter j is larger, and where it is
 * smaller: of a method that chooses its steps whole runs take others. nil: it has no such steps; nil, true: they fail.
 */
static int replayed(lua_State *L) {
  record *r = hk_record_at(L);
  size_t j = (size_t)luaL_checkinteger(L, 3) - 1;
  luaL_argcheck(L, j < r->count, 3, "no such parameter");
  r->measure = hk_record_measure_named(L, r, 2);
  if (!r->steps->linearised) return 0;
  hk_run *side[2] = {r->more[j], r->less[j]};
  double *X = lua_newuserdatauv(L, (6 * r->steps->n + 1) * sizeof *X, 0), value;
  for (int k = 0; k < 2; k++) {
    hk_status status = hk_sensitivity_replay(r->steps, &side[k]->dynamics, X);
    if (status == HK_OK)
      status = hk_record_measure_at(r, side[k], r->run->state.t, hk_record_moved(r, X, NULL, 0), &value);
    if (status != HK_OK) {
      lua_pushnil(L);
      lua_pushboolean(L, 1);
      return 2;
    }
    lua_pushnumber(L, value);
  }
  return 2;
}

/* record:refusal(measure): why the measure at the end is none that can be differentiated, or nil. */
static int refusal(lua_State *L) {
  record *r = hk_record_at(L);
  hk_state *s = &r->run->state;
  double value, shifted, again, work = s->X[s->size - 1], scale = 1 + fabs(work);
  r->measure = hk_record_measure_named(L, r, 2);
  hk_status status = hk_record_measure_at(r, r->run, s->t, hk_record_moved(r, s->X, NULL, 0), &value);
  s->X[s->size - 1] += scale;
  if (status == HK_OK) status = hk_record_measure_at(r, r->run, s->t, hk_record_moved(r, s->X, NULL, 0), &shifted);
  s->X[s->size - 1] = work;
  if (status == HK_OK) status = hk_record_measure_at(r, r->run, s->t, hk_record_moved(r, s->X, NULL, 0), &again);
  if (status != HK_OK)
    lua_pushstring(L, r->error.text);
  else if (value != again)
    lua_pushstring(L, "it remembers its calls: make it a function of the state alone");
  else if (value != shifted)
    lua_pushstring(L, "it depends on the work done on the scene, which is not differentiated");
  else
    lua_pushnil(L);
  return 1;
}

__attribute__((visibility("default"))) int luaopen_sensitivity(lua_State *L);

int luaopen_sensitivity(lua_State *L) {
  static const luaL_Reg functions[] = {{"record", begin}, {"to_rounding", to_rounding}, {NULL, NULL}};
  static const luaL_Reg methods[] = {{"vary", vary},
                                     {"finish", finish},
                                     {"about", about},
                                     {"refusal", refusal},
                                     {"adjoint", adjoint},
                                     {"tangents", tangents},
                                     {"integral", integral},
                                     {"replayed", replayed},
                                     {"times", hk_record_times},
                                     {"segment", hk_record_segment},
                                     {"curves", hk_record_curves},
                                     {"place", hk_record_place},
                                     {"assign", hk_record_assign},
                                     {"survey", hk_record_survey},
                                     {"direct", direct_slopes},
                                     {NULL, NULL}};
  luaL_newmetatable(L, hk_record_type);
  lua_pushcfunction(L, close_record);
  lua_setfield(L, -2, "__gc");
  lua_newtable(L);
  luaL_setfuncs(L, methods, 0);
  lua_setfield(L, -2, "__index");
  lua_pop(L, 1);
  luaL_newlib(L, functions);
  return 1;
}
