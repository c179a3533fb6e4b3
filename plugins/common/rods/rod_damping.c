/* Damping that is the stiffness times a time, by Kelvin and Voigt: moments follow k + retardation dk/dt, so that in a
 * step of the joints of a rod
 *     2 R = retardation sum (bend_1 k_1'^2 + bend_2 k_2'^2 + twist m'^2)
 * is lost. Seen from the section, the rates of a joint's curvature and twist (notation of rod_loops.h) are
 *     k_1' = g_1.e' + k_2 s,     k_2' = g_2.e' - k_1 s,     m' = m_e.e' + s1 - s0,     s = (s0 + s1)/2
 * with the rates e' of its edges and s0, s1 at which their sections turn about them, beside the transport with the
 * edges. Sections have no inertia: they turn as costs the least, a tridiagonal system for each rod, with a corner for a
 * ring; those of clamps go with their edges (s = 0), those that are particles are given. So a rod that moves as a rigid
 * body loses nothing, momentum and angular momentum are kept, and the power, -2 R, is never positive. Whether a section
 * without stiffness in twist turns would be undetermined where a rod is straight: against rates of twist it has that of
 * bending.
 *
 * A rod of stiffness EI that bends in its modes of frequencies w has the damping rates retardation w^2. */
#include "plugins/common/rods/rod_joint.h"
#include "plugins/common/rods/rods.h"

enum { LANES = HK_ROD_LANES, GRAIN = 8 };

static const double POOR = 1e-12; /* of a pivot, relative to the largest diagonal: that section turns freely */

/* One joint and its rates while no section turns beside its edge. */
typedef struct motion {
  hk_rod_joint joint;    /* bend and twist: those of the damping, J s */
  double g[2][6], m[6];  /* of edge vectors */
  double bend[2], twist; /* 1/s: rates of k_1, k_2, and of the twist */
  size_t at[2];          /* rows of its edges */
  size_t node[3];        /* rows of its nodes */
} motion;

static void find_motion(const hk_rods *r, const hk_view *view, const hk_rod_batch *b, size_t lane, size_t k,
                        motion *q) {
  size_t first = b->first * LANES + lane, node = (b->first + b->number) * LANES + lane, count = b->count[lane];
  q->at[0] = first + k * LANES, q->at[1] = first + (k + 1 < count ? k + 1 : 0) * LANES;
  for (size_t c = 0; c < 3; c++) q->node[c] = node + (b->ring ? (k + c) % count : k + c) * LANES;
  hk_rod_joint_at(r, b, lane, k, &q->joint);
  hk_rod_joint_gradients(&q->joint, q->g, q->m);
  hk_rod_joint_damping(r, q->at[0], &q->joint);
  q->bend[0] = q->bend[1] = q->twist = 0;
  for (size_t c = 0; c < 6; c++) {
    const uint32_t *particle = r->rows.node;
    double rate = view->v[3 * (size_t)particle[q->node[c / 3 + 1]] + c % 3] -
                  view->v[3 * (size_t)particle[q->node[c / 3]] + c % 3];
    q->bend[0] += q->g[0][c] * rate, q->bend[1] += q->g[1][c] * rate, q->twist += q->m[c] * rate;
  }
}

static void turn_sections(motion *q, double s0, double s1) {
  q->bend[0] += q->joint.k[1] * (s0 + s1) / 2;
  q->bend[1] -= q->joint.k[0] * (s0 + s1) / 2;
  q->twist += s1 - s0;
}

/* dR/ds of its two sections. */
static void torques_of(const motion *q, double torque[2]) {
  const hk_rod_joint *j = &q->joint;
  double half = (j->bend[0] * q->bend[0] * j->k[1] - j->bend[1] * q->bend[1] * j->k[0]) / 2;
  torque[0] = half - j->twist * q->twist;
  torque[1] = half + j->twist * q->twist;
}

/* ---- the rates of the sections, in `right` ---- */

static bool is_clamp(const hk_rods *r, const hk_view *view, size_t row) {
  const uint32_t *pair = hk_tuple(&r->edges, r->rows.edge[row]);
  for (int c = 0; c < 2; c++)
    if (view->model->pin[pair[c]] != HK_PIN_FIXED && view->model->pin[pair[c]] != HK_PIN_PATH) return false;
  return true;
}

/* Diagonals in `pivot`, what couples an edge to the next in `lower` (of a ring the last to the first), minus the slope
 * of R in `right`. */
static void assemble(const hk_rods *r, const hk_view *view, const hk_rod_batch *b, size_t lane) {
  const hk_rod_rows *w = &r->rows;
  size_t first = b->first * LANES + lane, end = first + b->count[lane] * LANES;
  for (size_t at = first; at < end; at += LANES) w->pivot[at] = w->right[at] = w->lower[at] = 0;
  for (size_t k = 0; k < hk_rod_joints(b, lane); k++) {
    motion q;
    double torque[2];
    find_motion(r, view, b, lane, k, &q);
    torques_of(&q, torque);
    const hk_rod_joint *j = &q.joint;
    double h = (j->bend[0] * j->k[1] * j->k[1] + j->bend[1] * j->k[0] * j->k[0]) / 4;
    for (int e = 0; e < 2; e++) w->pivot[q.at[e]] += h + j->twist, w->right[q.at[e]] -= torque[e];
    w->lower[q.at[0]] += h - j->twist;
  }
  for (size_t at = first; at < end; at += LANES) {
    if (!is_clamp(r, view, at)) continue;
    size_t before = at > first ? at - LANES : end - LANES;
    w->pivot[at] = w->right[at] = w->lower[at] = w->lower[before] = 0;
  }
}

/* The last edge is coupled to all that are not yet eliminated, by `column`. Pivots become their inverses, 0 where a
 * section is held, or turns freely. */
static void eliminate(const hk_rod_rows *w, size_t first, size_t last) {
  double most = 0;
  for (size_t at = first; at <= last; at += LANES) most = fmax(most, w->pivot[at]), w->column[at] = 0;
  w->column[first] += w->lower[last];
  w->column[last - LANES] += w->lower[last - LANES];
  for (size_t at = first; at <= last; at += LANES) {
    double inverse = w->pivot[at] > POOR * most ? 1 / w->pivot[at] : 0;
    w->pivot[at] = inverse;
    if (at == last) break;
    size_t next = at + LANES;
    if (next < last) {
      w->pivot[next] -= inverse * w->lower[at] * w->lower[at];
      w->right[next] -= inverse * w->lower[at] * w->right[at];
      w->column[next] -= inverse * w->lower[at] * w->column[at];
    }
    w->pivot[last] -= inverse * w->column[at] * w->column[at];
    w->right[last] -= inverse * w->column[at] * w->right[at];
  }
}

static void substitute(const hk_rod_rows *w, size_t first, size_t last) {
  w->right[last] *= w->pivot[last];
  for (size_t at = last; at > first;) {
    at -= LANES;
    double next = at + LANES < last ? w->lower[at] * w->right[at + LANES] : 0;
    w->right[at] = w->pivot[at] * (w->right[at] - next - w->column[at] * w->right[last]);
  }
}

static void find_rates(const hk_rods *r, const hk_view *view, const hk_rod_batch *b, size_t lane) {
  const hk_rod_rows *w = &r->rows;
  size_t first = b->first * LANES + lane, last = first + (b->count[lane] - 1) * LANES;
  for (size_t at = first; r->spins.count && at <= last; at += LANES)
    w->right[at] = view->v[3 * (size_t)r->spins.index[w->edge[at]]] / r->radius;
  if (r->spins.count) return;
  assemble(r, view, b, lane);
  eliminate(w, first, last);
  substitute(w, first, last);
}

/* ---- forces on the rows of nodes, and torques in `column` ---- */

static void add_force(const hk_rods *r, const motion *q) {
  const hk_rod_joint *j = &q->joint;
  for (size_t c = 0; c < 6; c++) {
    double slope =
        j->bend[0] * q->bend[0] * q->g[0][c] + j->bend[1] * q->bend[1] * q->g[1][c] + j->twist * q->twist * q->m[c];
    r->rows.f[c % 3][q->node[c / 3]] += slope;
    r->rows.f[c % 3][q->node[c / 3 + 1]] -= slope;
  }
}

static double damp(const hk_rods *r, const hk_view *view, const hk_rod_batch *b, size_t lane) {
  const hk_rod_rows *w = &r->rows;
  double power = 0;
  find_rates(r, view, b, lane);
  for (size_t k = 0; k < b->count[lane]; k++) w->column[(b->first + k) * LANES + lane] = 0;
  for (size_t k = 0; k < hk_rod_joints(b, lane); k++) {
    motion q;
    double torque[2];
    find_motion(r, view, b, lane, k, &q);
    turn_sections(&q, w->right[q.at[0]], w->right[q.at[1]]);
    torques_of(&q, torque);
    add_force(r, &q);
    for (int e = 0; e < 2; e++) w->column[q.at[e]] -= torque[e];
    power -= (q.joint.bend[0] * q.bend[0] * q.bend[0] + q.joint.bend[1] * q.bend[1] * q.bend[1] +
              q.joint.twist * q.twist * q.twist);
  }
  return power;
}

typedef struct task {
  hk_rods *rods;
  const hk_view *view;
} task;

static void damp_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t q = first; q < end; q++) {
    const hk_rod_batch *b = &t->rods->batch[q];
    t->rods->sums[q] = 0;
    for (size_t lane = 0; lane < LANES; lane++)
      if (b->count[lane]) t->rods->sums[q] += damp(t->rods, t->view, b, lane);
  }
}

double hk_rod_damping_add(hk_rods *r, const hk_view *view) {
  task t = {r, view};
  double power = 0;
  view->host->parallel_for(view->host, r->batches, GRAIN, damp_chunk, &t);
  for (size_t q = 0; q < r->batches; q++) power += r->sums[q];
  return power;
}

void hk_rod_damping_turn(const hk_rods *r, double *F) {
  if (r->spins.count == 0) return;
  for (size_t q = 0; q < r->batches; q++)
    for (size_t lane = 0; lane < LANES; lane++)
      for (size_t k = 0; k < r->batch[q].count[lane]; k++) {
        size_t at = (r->batch[q].first + k) * LANES + lane;
        F[3 * (size_t)r->spins.index[r->rows.edge[at]]] += r->rows.column[at] / r->radius;
      }
}
