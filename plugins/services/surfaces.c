/* The surfaces of a run (plugins/common/contact/surfaces/surfaces.h), shared by all contact of it. */
#include "plugins/common/contact/surfaces/surface_patches.h"
#include "plugins/common/contact/candidates/start_check.h"
#include "plugins/common/space/reserve.h"
#include "plugins/kit/vector3.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct surfaces {
  bool joined;
  struct {
    const char *plugin;
    double friction;
  } joiner[8];
  size_t joiners;
  hk_surface_request request; /* `leave` is not used: ids last longer */
  uint32_t *left_id;          /* rising */
  size_t left_count;
  bool *left; /* n */
  hk_surface_lists lists;
  hk_broad_phase search;
  hk_surface_patch_set patches;
  hk_gather pairs, crossings, near;
  size_t *near_start; /* near_room: of what `between` found */
  size_t near_room;
  double *counted_at; /* n x 3, m: the positions of `crossings` */
  bool counted;
  double *const *mark; /* of `keep`; NULL: none */
  uint64_t number;
  double seconds;        /* wall time of the searches so far */
  double *strand_radius; /* n, m: published, for pictures; of particles of triangles 0 */
  hk_surfaces table;
  const hk_model *model;
  const hk_host *host;
} surfaces;

static const hk_field fields[] = {
    {"strand_radius", .per_particle = HK_AT(surfaces, strand_radius), .width = 1, .flags = HK_SCRATCH | HK_PUBLISHED},
    {0},
};

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- the lists ---- */

static int rising(const void *a, const void *b) {
  uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
  return (p > q) - (p < q);
}

static bool is_named(const surfaces *s, size_t i) {
  return s->left_count && bsearch(&s->model->id[i], s->left_id, s->left_count, sizeof *s->left_id, rising);
}

/* What the script leaves out, what is inside of rigid bodies, and the places where joints hold these. */
static void mark_left(surfaces *s) {
  const hk_model *m = s->model;
  for (size_t i = 0; i < m->n; i++) s->left[i] = is_named(s, i) || (m->inside && m->inside[i]);
  for (size_t k = 0; k < m->riders; k++)
    for (uint32_t j = 0; j < m->rider[k].joints; j++) {
      size_t point = hk_model_find(m, m->rider[k].joined + j);
      if (point < m->n) s->left[point] = true;
    }
}

static hk_status list(surfaces *s, const hk_view *view) {
  s->counted = false;
  s->number++;
  s->host->release(s->host, s->left);
  s->host->release(s->host, s->counted_at);
  s->left = s->host->allocate(s->host, view->n * sizeof *s->left);
  s->counted_at = s->host->allocate(s->host, 3 * view->n * sizeof *s->counted_at);
  if (!s->left || !s->counted_at)
    return s->host->fail(s->host, HK_NO_MEMORY, "no memory for the surfaces of %zu particles", view->n);
  mark_left(s);
  hk_status status = hk_surface_lists_build(&s->lists, s->host, view, &s->request, s->left);
  s->lists.mesh.number = s->number;
  for (size_t i = 0; i < view->n && status == HK_OK; i++)
    s->strand_radius[i] = s->lists.in_triangle[i] || s->left[i] ? 0 : s->lists.radius[i];
  if (status == HK_OK) status = hk_broad_phase_open(&s->search, s->host, &s->lists, s->model);
  return status == HK_OK ? hk_surface_patches_open(&s->patches, s->host, &s->search) : status;
}

/* ---- joining ---- */

static bool same_left(const surfaces *s, const hk_surface_request *r) {
  size_t count = r->leave ? r->leave->count : 0;
  if (count != s->left_count) return false;
  for (size_t k = 0; k < count; k++)
    if (!is_named(s, r->leave->index[k])) return false;
  return true;
}

/* `host` is that of the plugin that joins, whose line the errors name. */
static hk_status compare(const surfaces *s, const hk_host *host, const hk_surface_request *r) {
  const struct {
    const char *name;
    double first, second;
  } value[] = {{"thickness", s->request.thickness, r->thickness},
               {"body_thickness", s->request.body_thickness, r->body_thickness},
               {"radius", s->request.radius, r->radius}};
  for (size_t k = 0; k < sizeof value / sizeof *value; k++)
    if (value[k].first != value[k].second)
      return host->fail(host, HK_BAD_PARAM,
                        "another plugin that keeps the surfaces of this run apart has a %s of %g m, this one of %g m: "
                        "give both the same",
                        value[k].name, value[k].first, value[k].second);
  if (same_left(s, r)) return HK_OK;
  return host->fail(host, HK_BAD_PARAM,
                    "another plugin that keeps the surfaces of this run apart leaves out other particles: give both "
                    "the same list");
}

static hk_status check_request(const hk_host *host, const hk_surface_request *r) {
  double value[] = {r->thickness, r->body_thickness, r->radius};
  for (size_t k = 0; k < 3; k++)
    if (!(value[k] >= 0 && isfinite(value[k])))
      return host->fail(host, HK_BAD_PARAM, "a thickness or radius of surfaces is %g m: it has to be 0 or more",
                        value[k]);
  return HK_OK;
}

static hk_status keep_left(surfaces *s, const hk_tuples *leave) {
  s->left_count = leave ? leave->count : 0;
  s->left_id = s->host->allocate(s->host, s->left_count * sizeof *s->left_id);
  if (!s->left_id) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for a list of %zu particles", s->left_count);
  for (size_t k = 0; k < s->left_count; k++) s->left_id[k] = s->model->id[leave->index[k]];
  qsort(s->left_id, s->left_count, sizeof *s->left_id, rising);
  return HK_OK;
}

/* A second one of the same plugin with another friction would undo what the first does for all surfaces. */
static hk_status note_joiner(surfaces *s, const hk_host *host, const hk_surface_request *r) {
  const size_t room = sizeof s->joiner / sizeof *s->joiner;
  for (size_t k = 0; r->plugin && k < s->joiners; k++)
    if (strcmp(s->joiner[k].plugin, r->plugin) == 0 && s->joiner[k].friction != r->friction)
      return host->fail(host, HK_BAD_PARAM,
                        "the scene already has a '%s' with a friction of %g, which treats all of its surfaces, and "
                        "this one has %g: leave one out",
                        r->plugin, s->joiner[k].friction, r->friction);
  if (r->plugin && s->joiners < room) {
    s->joiner[s->joiners].plugin = r->plugin;
    s->joiner[s->joiners++].friction = r->friction;
  }
  return HK_OK;
}

static hk_status join(void *self, const hk_surface_request *request, const hk_view *view) {
  surfaces *s = self;
  hk_status status = check_request(view->host, request);
  if (status == HK_OK) status = note_joiner(s, view->host, request);
  if (status != HK_OK) return status;
  if (s->joined) return compare(s, view->host, request);
  s->request = *request;
  status = keep_left(s, request->leave);
  if (status == HK_OK) status = list(s, view);
  if (status == HK_OK) status = hk_start_check(&s->search, s->host, view, &s->request, &s->pairs);
  s->joined = status == HK_OK;
  return status;
}

static const hk_surface_mesh *mesh(void *self) {
  const surfaces *s = self;
  return s->joined ? &s->lists.mesh : NULL;
}

/* ---- searches ---- */

static hk_status name_lost(const surfaces *s, const double *x) {
  for (size_t k = 0; k < s->lists.mesh.points; k++) {
    size_t i = s->lists.mesh.point[k];
    const double *at = x + 3 * i;
    if (isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2])) continue;
    return s->host->fail(s->host, HK_NOT_FINITE, "particle %u is at (%g, %g, %g) m: nothing is near it there",
                         s->model->id[i], at[0], at[1], at[2]);
  }
  return HK_OK;
}

static hk_status not_joined(const surfaces *s) {
  return s->host->fail(s->host, HK_FAILED, "the surfaces were asked before a plugin had joined them");
}

static hk_status pairs(void *self, const double *x_from, const double *x_to, double reach, hk_feature_pairs *out) {
  surfaces *s = self;
  double begin = now();
  if (!s->joined) return not_joined(s);
  hk_surface_move move = {.x_from = x_from, .x_to = x_to, .reach = reach};
  hk_status status = hk_feature_pairs_find(&s->search, s->host, &move, &s->pairs);
  if (status == HK_NOT_FINITE && name_lost(s, x_from) == HK_OK) name_lost(s, x_to);
  *out = (hk_feature_pairs){status == HK_OK ? s->pairs.count : 0, s->pairs.record};
  s->seconds += now() - begin;
  return status;
}

static const hk_surface_patches *patches(void *self) { return &((surfaces *)self)->patches.table; }

static hk_status list_starts(surfaces *s, size_t count) {
  hk_status status = hk_reserve(s->host, &s->near_start, &s->near_room, count + 1, sizeof *s->near_start);
  if (status != HK_OK) return status;
  for (size_t k = 0; k < count; k++) s->near_start[k] = s->near.row[k].at;
  s->near_start[count] = s->near.count;
  return HK_OK;
}

static hk_status between(void *self, const double *x_from, const double *x_to, double reach, const hk_patch_pair *pair,
                         size_t count, hk_patch_feature_pairs *out) {
  surfaces *s = self;
  double begin = now();
  *out = (hk_patch_feature_pairs){0};
  if (!s->joined) return not_joined(s);
  hk_surface_move move = {.x_from = x_from, .x_to = x_to, .reach = reach};
  hk_status status = hk_patch_pairs_find(&s->search, &s->patches, s->host, &move, pair, count, &s->near);
  if (status == HK_NOT_FINITE && name_lost(s, x_from) == HK_OK) name_lost(s, x_to);
  if (status == HK_OK) status = hk_gather_join(&s->near, s->host);
  if (status == HK_OK) status = list_starts(s, count);
  if (status == HK_OK) *out = (hk_patch_feature_pairs){s->near_start, s->near.record};
  s->seconds += now() - begin;
  return status;
}

static bool is_counted(const surfaces *s, const double *x) {
  return s->counted && hk_broad_phase_pins_kept(&s->search) &&
         (s->model->n == 0 || memcmp(s->counted_at, x, 3 * s->model->n * sizeof *x) == 0);
}

static hk_status count(surfaces *s, const double *x) {
  if (!s->joined) return not_joined(s);
  if (is_counted(s, x)) return HK_OK;
  s->counted = false;
  hk_status status = hk_crossings_find(&s->search, s->host, x, &s->crossings);
  if (status == HK_NOT_FINITE) name_lost(s, x);
  if (status != HK_OK) return status;
  if (s->model->n) memcpy(s->counted_at, x, 3 * s->model->n * sizeof *x);
  s->counted = true;
  return HK_OK;
}

static hk_status intersections(void *self, const double *x, hk_surface_intersections *out) {
  surfaces *s = self;
  double begin = now();
  hk_status status = count(s, x);
  *out = (hk_surface_intersections){0};
  if (status == HK_OK) *out = (hk_surface_intersections){s->crossings.count, s->crossings.record};
  s->seconds += now() - begin;
  return status;
}

/* Where an edge passes through the plane of a triangle; its middle, where it lies in that. */
static void crossing_point(const double *x, const uint32_t *e, const uint32_t *t, double at[3]) {
  double u[3], v[3], n[3], from = 0, to = 0;
  for (int c = 0; c < 3; c++) u[c] = x[3 * t[1] + c] - x[3 * t[0] + c], v[c] = x[3 * t[2] + c] - x[3 * t[0] + c];
  hk_cross(n, u, v);
  for (int c = 0; c < 3; c++) {
    from += n[c] * (x[3 * e[0] + c] - x[3 * t[0] + c]);
    to += n[c] * (x[3 * e[1] + c] - x[3 * t[0] + c]);
  }
  double part = from != to ? fmin(fmax(from / (from - to), 0), 1) : 0.5;
  for (int c = 0; c < 3; c++) at[c] = x[3 * e[0] + c] + part * (x[3 * e[1] + c] - x[3 * e[0] + c]);
}

/* The first of them by its particles, and the box that has all, where the text has room for it. */
static void name_places(const surfaces *s, const hk_view *view, const hk_surface_intersections *found, char *text,
                        size_t room) {
  const uint32_t *id = view->model->id;
  double at[3], low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  int length = 0;
  for (size_t k = 0; k < found->count; k++) {
    const uint32_t *e = s->lists.mesh.edge[found->pair[k][0]], *t = s->lists.mesh.triangle[found->pair[k][1]];
    crossing_point(view->x, e, t, at);
    for (int c = 0; c < 3; c++) low[c] = fmin(low[c], at[c]), high[c] = fmax(high[c], at[c]);
    if (k == 0)
      length = snprintf(text, room, "edge %u %u and triangle %u %u %u at (%.4g, %.4g, %.4g) m", id[e[0]], id[e[1]],
                        id[t[0]], id[t[1]], id[t[2]], at[0], at[1], at[2]);
  }
  if (found->count < 2 || length < 0 || (size_t)length >= room) return;
  size_t left = room - (size_t)length;
  int more = snprintf(text + length, left, ", all from (%.3g, %.3g, %.3g) to (%.3g, %.3g, %.3g) m", low[0], low[1],
                      low[2], high[0], high[1], high[2]);
  if (more < 0 || (size_t)more >= left) text[length] = 0;
}

static hk_status report(void *self, const hk_view *view, hk_contact_report *out) {
  surfaces *s = self;
  hk_surface_intersections found;
  hk_status status = intersections(self, view->x, &found);
  out->intersections = found.count;
  out->first[0] = 0;
  if (status != HK_OK || found.count == 0) return status;
  name_places(s, view, &found, out->first, sizeof out->first);
  out->remedy = "scene:corrector(\"untangle\", { thickness = ... }) does it";
  return HK_OK;
}

/* What of the members from `begin` to `end` are marked, together, and whether all are pinned. */
static unsigned marks_of(const surfaces *s, const hk_feature_pair *p, int begin, int end, bool *pinned) {
  unsigned marks = 0;
  *pinned = true;
  for (int k = begin; k < end; k++) {
    marks |= (unsigned)(*s->mark)[p->vertex[k]];
    *pinned &= s->model->inverse_mass[p->vertex[k]] == 0;
  }
  return marks;
}

static bool leaves(void *self, const hk_feature_pair *p) {
  const surfaces *s = self;
  if (!s->mark) return false;
  int second = p->kind == HK_POINT_TRIANGLE ? 1 : 2;
  bool held[2];
  unsigned a = marks_of(s, p, 0, second, &held[0]), b = marks_of(s, p, second, 4, &held[1]);
  return (a & b & HK_MARK_TANGLED) || (a & HK_MARK_PINCHED && held[1]) || (b & HK_MARK_PINCHED && held[0]);
}

static void keep(void *self, double *const *mark) { ((surfaces *)self)->mark = mark; }

/* ---- the plugin ---- */

static hk_status topology(void *self, const hk_view *view) {
  surfaces *s = self;
  return s->joined ? list(s, view) : HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  surfaces *s = self;
  s->host = host;
  s->model = view->model;
  if (view->model->box)
    return host->fail(
        host, HK_BAD_PARAM,
        "contact of surfaces sees no images across the faces of a periodic box: leave scene:periodic out, "
        "or the force or corrector that keeps surfaces apart");
  s->pairs.record_size = sizeof(hk_feature_pair);
  s->crossings.record_size = 2 * sizeof(uint32_t);
  s->near.record_size = sizeof(hk_feature_pair);
  s->table = (hk_surfaces){self, join, mesh, pairs, intersections, report, keep, leaves, patches, between};
  return HK_OK;
}

static const void *table(void *self) { return &((surfaces *)self)->table; }

static double seconds(void *self) { return ((surfaces *)self)->seconds; }

static const hk_service service = {
    .size = sizeof(hk_service), .interface = HK_SURFACES_INTERFACE, .table = table, .seconds = seconds};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SERVICE,
    .name = "surfaces",
    .summary = "surfaces that contact keeps apart: candidate pairs of features in a move, and intersections, exactly",
    .reference = "Curtis, Tamstorf, Manocha 2008, Fast collision detection for deformable models, I3D; Ericson 2005, "
                 "Real-Time Collision Detection, chapter 6",
    .instance_size = sizeof(surfaces),
    .fields = fields,
    .create = create,
    .topology = topology,
    .service = &service,
};
