/* The evaluation of rods: discrete elastic rods (Bergou and others 2008, 2010) with quasi-static twist.
 *
 * Directors are transported in parallel along a rod from its first edge, whose own director is transported in time from
 * the last accepted step. The angles of the cross sections from them are those of least energy, from where they were at
 * that step; a clamped edge's section moves with the edge, without turning about it. So forces are a function of the
 * state and of what `accepted` keeps, which changes once per step; a twist of several turns is known by how it came
 * about. */
#include "plugins/common/rods/rods.h"
#include "plugins/common/rods/rod_rows.h"
#include "plugins/kit/vector3.h"

#include <string.h>

enum { LANES = HK_ROD_LANES, GRAIN = 8 /* batches, about a thousand edges of hair */, UNSURE = 2 };

static const double MOST_TURN = 2.356; /* rad in a step, 3/4 of half a turn, above which turns may be miscounted */

static hk_rod_frame *frame_of(const hk_rods *r, size_t e) { return (hk_rod_frame *)r->frames.item + e; }

/* The director d of a section whose edge turns from t0 to t1, without turning about it. */
static void transport(const double t0[3], const double t1[3], const double d[3], double to[3]) {
  double chi = fmax(1 + hk_dot(t0, t1), HK_ROD_FOLD), along = hk_dot(d, t1) / chi, size = 0;
  for (int c = 0; c < 3; c++) to[c] = d[c] - along * (t0[c] + t1[c]);
  along = hk_dot(to, t1); /* roundings of many steps would add up */
  for (int c = 0; c < 3; c++) to[c] -= along * t1[c];
  size = hk_length(to);
  for (int c = 0; c < 3; c++) to[c] = size > 0 ? to[c] / size : d[c];
}

/* From a to d, both orthogonal to t, in (-pi, pi]. */
static double angle_from(const double t[3], const double a[3], const double d[3]) {
  double b[3];
  hk_cross(b, t, a);
  return atan2(hk_dot(b, d), hk_dot(a, d));
}

static void row_vector(double *const p[3], size_t at, double to[3]) {
  for (int c = 0; c < 3; c++) to[c] = p[c][at];
}

/* ---- one lane of a batch with frames ---- */

static void start_lane(const hk_rods *r, const hk_rod_batch *b, size_t lane) {
  const hk_rod_rows *w = &r->rows;
  size_t at = b->first * LANES + lane, node = (b->first + b->number) * LANES + lane;
  double t[3], d[3], size;
  for (int c = 0; c < 3; c++) t[c] = w->x[c][node + LANES] - w->x[c][node];
  size = hk_length(t);
  const hk_rod_frame *head = frame_of(r, w->edge[at]);
  for (int c = 0; c < 3; c++) t[c] = size > 0 ? t[c] / size : head->tangent[c];
  transport(head->tangent, t, head->director, d);
  for (int c = 0; c < 3; c++) w->a[c][at] = d[c];
  for (size_t k = 0; k < b->count[lane]; k++, at += LANES) w->angle[at] = frame_of(r, w->edge[at])->angle;
}

/* rad, by which an edge's section has turned about it since the last accepted step, where that is a coordinate. */
static double spun(const hk_rods *r, const hk_view *view, size_t e) {
  if (r->spins.count == 0) return 0;
  return (view->x[3 * (size_t)r->spins.index[e]] - frame_of(r, e)->spin) / r->radius;
}

/* The angle of an edge whose section is held, from the director that came along the rod to it. */
static void hold_edge(const hk_rods *r, const hk_view *view, size_t at) {
  const hk_rod_rows *w = &r->rows;
  const hk_rod_frame *f = frame_of(r, w->edge[at]);
  double t[3], a[3], d[3];
  row_vector(w->t, at, t);
  row_vector(w->a, at, a);
  transport(f->tangent, t, f->director, d);
  w->angle[at] = f->angle + angle_from(t, a, d) + spun(r, view, w->edge[at]);
}

/* What a ring's directors lack of closing, near to what it was. */
static void close_ring(const hk_rods *r, const hk_rod_batch *b, size_t lane) {
  const hk_rod_rows *w = &r->rows;
  size_t first = b->first * LANES + lane, last = first + (b->edges - 1) * LANES;
  double t0[3], t1[3], a0[3], a1[3], d[3], before = frame_of(r, w->edge[last])->offset;
  row_vector(w->t, last, t0);
  row_vector(w->t, first, t1);
  row_vector(w->a, last, a0);
  row_vector(w->a, first, a1);
  transport(t0, t1, a0, d);
  w->offset[last] = before + remainder(angle_from(t1, d, a1) - before, 2 * M_PI) + r->turn;
}

static void hold_lane(const hk_rods *r, const hk_view *view, const hk_rod_batch *b, size_t lane) {
  const hk_rod_rows *w = &r->rows;
  size_t first = b->first * LANES + lane;
  w->angle[first] += spun(r, view, w->edge[first]);
  for (size_t k = 1; k < b->count[lane]; k++)
    if (w->held[first + k * LANES] != 0) hold_edge(r, view, first + k * LANES);
  if (b->turned[lane] != HK_ROD_NONE) w->angle[first + b->turned[lane] * LANES] += r->turn - r->turned;
  if (b->ring) close_ring(r, b, lane);
}

/* Frames and angles; false: no angles of least energy were found. */
static bool find_angles(const hk_rods *r, const hk_view *view, hk_rod_batch *b) {
  for (size_t lane = 0; lane < LANES; lane++)
    if (b->count[lane]) start_lane(r, b, lane);
  r->path.frames(&r->rows, b);
  for (size_t lane = 0; lane < LANES; lane++)
    if (b->count[lane]) hold_lane(r, view, b, lane);
  b->turn = r->turn;
  return b->found = r->path.solve(&r->rows, b);
}

/* ---- clamps that move ---- */

/* dE/d angle at one end of the joint at `at`, whose second edge is at `next`: sign -1 for its first edge, 1 for its
 * second. */
static double torque_of(const hk_rod_rows *w, size_t at, size_t next, double sign) {
  double angle0 = w->angle[at], angle1 = w->angle[next] + w->offset[at], half = (angle0 + angle1) / 2;
  double k0 = cos(half) * w->turn[0][at] + sin(half) * w->turn[1][at];
  double k1 = cos(half) * w->turn[1][at] - sin(half) * w->turn[0][at];
  double bending = w->bend[0][at] * (k0 - w->rest[0][at]) * k1 - w->bend[1][at] * (k1 - w->rest[1][at]) * k0;
  return bending / 2 + sign * w->twist[at] * (angle1 - angle0 - w->rest_twist[at]);
}

/* dE/d angle of edge k. */
static double torque_on(const hk_rods *r, const hk_rod_batch *b, size_t lane, size_t k) {
  const hk_rod_rows *w = &r->rows;
  size_t first = b->first * LANES + lane, at = first + k * LANES, count = b->count[lane];
  double torque = 0;
  if (k + 1 < count || b->ring) torque += torque_of(w, at, k + 1 < count ? at + LANES : first, -1);
  if (k > 0 || b->ring) torque += torque_of(w, k > 0 ? at - LANES : first + (count - 1) * LANES, at, 1);
  return torque;
}

/* The section of a clamp goes with its edge from where that was, t0, to t on the shortest way. Against going there by
 * way of t, it is turned at t + dt by minus the area between, (t0 x t).dt/(1 + t0.t): its torque works on that. */
static void move_clamp(const hk_rods *r, const hk_rod_batch *b, size_t lane, size_t k) {
  const hk_rod_rows *w = &r->rows;
  size_t first = b->first * LANES + lane, at = first + k * LANES, count = b->count[lane];
  size_t node = (b->first + b->number + k) * LANES + lane;
  double t[3], area[3];
  const double *t0 = frame_of(r, w->edge[at])->tangent;
  row_vector(w->t, at, t);
  hk_cross(area, t0, t);
  if (area[0] == 0 && area[1] == 0 && area[2] == 0) return;
  double slope = -torque_on(r, b, lane, k) * w->inverse[at] / fmax(1 + hk_dot(t0, t), HK_ROD_FOLD);
  size_t next = b->ring && k + 1 == count ? node + LANES - count * LANES : node + LANES;
  for (int c = 0; c < 3; c++) {
    w->f[c][node] += slope * area[c];
    w->f[c][next] -= slope * area[c];
  }
}

static void move_clamps(const hk_rods *r, const hk_rod_batch *b) {
  for (size_t lane = 0; lane < LANES; lane++)
    for (size_t k = 0; k < b->count[lane]; k++)
      if (r->rows.held[(b->first + k) * LANES + lane] != 0) move_clamp(r, b, lane, k);
}

/* ---- all batches ---- */

typedef struct task {
  hk_rods *rods;
  const hk_view *view;
  double *F;
} task;

static void evaluate_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  const hk_rods *r = t->rods;
  (void)chunk;
  for (size_t q = first; q < end; q++) {
    hk_rod_batch *b = &r->batch[q];
    r->path.gather(&r->rows, b, t->view->x);
    bool found = !b->framed || find_angles(r, t->view, b);
    r->sums[q] = !found ? NAN : b->framed ? r->path.forces(&r->rows, b) : r->path.plain(&r->rows, b);
    if (found && b->framed) move_clamps(r, b);
  }
}

static hk_status no_angles(const hk_rods *r, const hk_view *view) {
  const char *finite = "its twist has no equilibrium that Newton's method finds: a shorter step";
  for (size_t q = 0; q < r->batches; q++)
    if (isnan(r->sums[q])) {
      uint32_t e = r->rows.edge[r->batch[q].first * LANES];
      return r->host->fail(r->host, HK_NOT_CONVERGED,
                           "rod that begins at particle %u, or one of the three after it, at t = %g s: %s may help",
                           frame_of(r, e)->id[0], view->t, finite);
    }
  return HK_OK;
}

hk_status hk_rods_evaluate(hk_rods *r, const hk_view *view, double *energy) {
  task t = {r, view, NULL};
  if (memcmp(r->pin, view->model->pin, view->n) != 0) hk_rod_rows_fill(r, view);
  view->host->parallel_for(view->host, r->batches, GRAIN, evaluate_chunk, &t);
  double sum = 0;
  for (size_t q = 0; q < r->batches; q++) sum += r->sums[q];
  if (energy) *energy = sum;
  return isnan(sum) ? no_angles(r, view) : HK_OK;
}

static void scatter_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  const hk_rod_rows *w = &t->rods->rows;
  (void)chunk;
  for (size_t q = first; q < end; q++) {
    const hk_rod_batch *b = &t->rods->batch[q];
    for (size_t lane = 0; lane < LANES; lane++) {
      size_t at = (b->first + b->number) * LANES + lane;
      for (size_t k = 0; b->count[lane] && k < b->count[lane] + !b->ring; k++, at += LANES)
        for (size_t c = 0; c < 3; c++) t->F[3 * (size_t)w->node[at] + c] += w->f[c][at];
    }
  }
}

/* On the particles that are angles. */
static void scatter_torques(const hk_rods *r, double *F) {
  for (size_t q = 0; q < r->batches; q++)
    for (size_t lane = 0; r->batch[q].framed && lane < LANES; lane++)
      for (size_t k = 0; k < r->batch[q].count[lane]; k++) {
        size_t e = r->rows.edge[(r->batch[q].first + k) * LANES + lane];
        F[3 * (size_t)r->spins.index[e]] -= torque_on(r, &r->batch[q], lane, k) / r->radius;
      }
}

/* Rods that share particles are added one after the other. */
void hk_rods_scatter(const hk_rods *r, const hk_host *host, double *F) {
  task t = {(hk_rods *)(uintptr_t)r, NULL, F};
  if (r->shared)
    scatter_chunk(&t, 0, r->batches, 0);
  else
    host->parallel_for(host, r->batches, GRAIN, scatter_chunk, &t);
  if (r->spins.count) scatter_torques(r, F);
}

/* ---- accepted steps ---- */

/* rad, by which the rod's shape has turned the directors against a section that is held, or against each other where a
 * ring closes, since the last accepted step: known up to whole turns, so that pi says nothing. */
static double turned_by_shape(const hk_rods *r, const hk_view *view, const hk_rod_batch *b, size_t lane, size_t k) {
  const hk_rod_rows *w = &r->rows;
  size_t at = (b->first + k) * LANES + lane;
  const hk_rod_frame *f = frame_of(r, w->edge[at]);
  double closing = b->ring && k + 1 == b->edges ? w->offset[at] - r->turn - f->offset : 0;
  double held = k > 0 && w->held[at] != 0 ? w->angle[at] - f->angle - spun(r, view, w->edge[at]) : 0;
  if (b->turned[lane] == k) held -= r->turn - r->turned;
  return fmax(fabs(closing), k > 0 ? fabs(held) : 0);
}

/* Returns false where the number of turns is in doubt. */
static bool keep_lane(hk_rods *r, const hk_view *view, const hk_rod_batch *b, size_t lane) {
  const hk_rod_rows *w = &r->rows;
  size_t at = b->first * LANES + lane;
  bool sure = true;
  for (size_t k = 0; k < b->count[lane]; k++, at += LANES) {
    hk_rod_frame *f = frame_of(r, w->edge[at]);
    sure &= turned_by_shape(r, view, b, lane, k) < MOST_TURN;
    f->angle = w->angle[at];
    if (r->spins.count) f->spin = view->x[3 * (size_t)r->spins.index[w->edge[at]]];
    f->offset = b->ring && k + 1 == b->edges ? w->offset[at] - r->turn : 0;
    row_vector(w->t, at, f->tangent);
    row_vector(w->a, at, f->director);
  }
  return sure;
}

/* Whether the last evaluation was here. */
static bool known(const hk_rods *r, const hk_view *view, const hk_rod_batch *b) {
  if (!b->found || b->turn != r->turn || r->spins.count) return false;
  size_t begin = (b->first + b->number) * LANES, end = begin + (b->edges + 1) * LANES;
  for (size_t at = begin; at < end; at++)
    for (size_t c = 0; c < 3; c++)
      if (r->rows.x[c][at] != view->x[3 * (size_t)r->rows.node[at] + c]) return false;
  return true;
}

static void keep_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  hk_rods *r = t->rods;
  (void)chunk;
  for (size_t q = first; q < end; q++) {
    hk_rod_batch *b = &r->batch[q];
    bool here = b->framed && known(r, t->view, b);
    if (!here) r->path.gather(&r->rows, b, t->view->x);
    r->sums[q] = r->path.sound(&r->rows, b) ? 0 : 1;
    if (!b->framed || r->sums[q] != 0) continue;
    if (!here && !find_angles(r, t->view, b))
      r->sums[q] = NAN;
    else
      for (size_t lane = 0; lane < LANES; lane++)
        if (!keep_lane(r, t->view, b, lane)) r->sums[q] = UNSURE;
    b->found = false; /* the next angles are found from these */
  }
}

/* Names the joint at fault in a batch. */
static hk_status not_sound(const hk_rods *r, const hk_rod_batch *b, const hk_view *view) {
  for (size_t lane = 0; lane < LANES; lane++)
    for (size_t k = 0; k + !b->ring < b->count[lane]; k++) {
      const uint32_t *edge = r->rows.edge + b->first * LANES + lane;
      const uint32_t *one = hk_tuple(&r->edges, edge[k * LANES]),
                     *two = hk_tuple(&r->edges, edge[(k + 1 < b->count[lane] ? k + 1 : 0) * LANES]);
      double d[3], e[3];
      hk_subtract(d, view->x + 3 * (size_t)one[1], view->x + 3 * (size_t)one[0]);
      hk_subtract(e, view->x + 3 * (size_t)two[1], view->x + 3 * (size_t)two[0]);
      double size = hk_length(d) * hk_length(e);
      const uint32_t *id = view->model->id;
      if (!(size > 1e-150))
        return r->host->fail(
            r->host, HK_FAILED,
            "an edge at particle %u has no length at t = %g s, so the rod has no direction there: keep "
            "its length by springs or bars",
            id[one[1]], view->t);
      if (!(size + hk_dot(d, e) > HK_ROD_FOLD * size))
        return r->host->fail(r->host, HK_FAILED,
                             "the rod is folded back on itself at particle %u at t = %g s, where its curvature is "
                             "infinite: take shorter steps, or more and shorter edges",
                             id[one[1]], view->t);
    }
  return HK_OK;
}

static hk_status not_sure(const hk_rods *r, const hk_rod_batch *b, const hk_view *view) {
  uint32_t first = frame_of(r, r->rows.edge[b->first * LANES])->id[0];
  return r->host->fail(
      r->host, HK_FAILED,
      "the rod that begins at particle %u, or one of three beside it, has wound about itself by nearly "
      "half a turn in one step, at t = %g s: its number of turns would be a guess; take shorter steps",
      first, view->t);
}

hk_status hk_rods_accept(hk_rods *r, const hk_view *view) {
  task t = {r, view, NULL};
  if (memcmp(r->pin, view->model->pin, view->n) != 0) hk_rod_rows_fill(r, view);
  view->host->parallel_for(view->host, r->batches, GRAIN, keep_chunk, &t);
  r->turned = r->turn;
  for (size_t q = 0; q < r->batches; q++) {
    hk_status status = isnan(r->sums[q])      ? no_angles(r, view)
                       : r->sums[q] == UNSURE ? not_sure(r, &r->batch[q], view)
                       : r->sums[q] != 0      ? not_sound(r, &r->batch[q], view)
                                              : HK_OK;
    if (status != HK_OK) return status;
  }
  return HK_OK;
}
