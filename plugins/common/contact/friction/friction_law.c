/* See friction.h. */
#include "plugins/common/contact/friction/friction.h"
#include "plugins/kit/vector3.h"

static const double hold = 1.001; /* of Coulomb's force, what keeps a contact that stuck */

/* A contact that rubs. */
typedef struct rub {
  const hk_barrier_pair *pair;
  const hk_barrier_value *value;
  const hk_slip *slip;
  hk_pair_frame frame;
  double load;         /* l, N */
  double by;           /* T/L, s/m */
  double u[3], size;   /* the elastic slip by L */
  double ratio, slope; /* N: c mu l f/|u|, and the derivative of c mu l f by |u| */
} rub;

/* s, T. */
static double since_start(const hk_view *view) { return view->t - view->model->t; }

/* Whether it stuck at the end of the last step. */
static bool held(const hk_slip *slip) { return slip->change > 0 && hk_dot(slip->s, slip->s) < 1 - 1e-9; }

static void find_slip(rub *r, const double *v) {
  hk_copy(r->u, r->slip->s);
  for (int a = 0; a < 4; a++) hk_add_scaled(r->u, r->by * r->frame.w[a], v + 3 * (size_t)r->pair->pair.vertex[a]);
  hk_add_scaled(r->u, -hk_dot(r->u, r->frame.n), r->frame.n);
  r->size = hk_length(r->u);
}

static rub rub_of(const hk_friction *f, const hk_barrier_contacts *c, size_t k, const hk_view *view) {
  const hk_barrier_value *value = hk_barrier_acting(c, k);
  rub r = {.pair = (const hk_barrier_pair *)c->near.item + value->near, .value = value};
  r.slip = hk_friction_slip(f, c, value->near, view->n);
  r.frame = hk_pair_frame_of(&value->nearest);
  r.load = hk_barrier_load(value);
  r.by = since_start(view) / hk_friction_length(f, r.slip, since_start(view));
  find_slip(&r, view->v);
  double y = r.size, most = f->coefficient * r.load * (held(r.slip) ? hold : 1);
  r.ratio = most * (y < 1 ? 2 - y : 1 / y);
  r.slope = y < 1 ? 2 * most * (1 - y) : 0;
  return r;
}

static size_t rubbing(const hk_friction *f, hk_barrier_contacts *c, const hk_view *view) {
  if (!(f->coefficient > 0)) return 0;
  hk_barrier_values_at(c, view);
  return c->acting_count;
}

/* W, of the velocity of its nearest points across the normal. */
static double power_of(const rub *r, const double *v) {
  double sum = 0;
  for (int a = 0; a < 4; a++) sum += r->frame.w[a] * hk_dot(r->u, v + 3 * (size_t)r->pair->pair.vertex[a]);
  return -r->ratio * sum;
}

double hk_friction_add(const hk_friction *f, hk_barrier_contacts *c, const hk_view *view, double *F) {
  size_t count = rubbing(f, c, view);
  double power = 0;
  for (size_t k = 0; k < count; k++) {
    rub r = rub_of(f, c, k, view);
    for (int a = 0; a < 4; a++) hk_add_scaled(F + 3 * (size_t)r.pair->pair.vertex[a], -r.ratio * r.frame.w[a], r.u);
    power += power_of(&r, view->v);
  }
  return power;
}

/* Of a pair whose slope is at most 2 mu l/L: as in barrier_bound.h. */
void hk_friction_bound(const hk_friction *f, hk_barrier_contacts *c, const hk_view *view, double (*block)[6]) {
  size_t count = rubbing(f, c, view);
  for (size_t k = 0; k < count; k++) {
    const hk_barrier_value *v = hk_barrier_acting(c, k);
    const uint32_t *vertex = ((const hk_barrier_pair *)c->near.item)[v->near].pair.vertex;
    double most = 4 * f->coefficient * hk_barrier_load(v) / f->elastic_slip;
    for (int a = 0; a < 4; a++) {
      double *b = block[vertex[a]], k_a = most * fabs(v->nearest.w[a]);
      b[0] += k_a, b[3] += k_a, b[5] += k_a;
    }
  }
}

/* ---- blocks ---- */

/* -dF/dv: T/L (r (P - e e^T) + s e e^T), P the projection across the normal, e = u/|u|, s the slope of the force. */
static void add_damping(const rub *r, const size_t *slot, double *to) {
  double D[9];
  for (int p = 0; p < 9; p++) {
    double ee = r->size > 0 ? r->u[p / 3] * r->u[p % 3] / (r->size * r->size) : 0;
    D[p] = r->by * (r->ratio * ((p % 4 == 0) - r->frame.n[p / 3] * r->frame.n[p % 3] - ee) + r->slope * ee);
  }
  for (size_t b = 0; b < 16; b++)
    for (size_t p = 0; p < 9; p++) to[9 * slot[b] + p] += r->frame.w[b / 4] * r->frame.w[b % 4] * D[p];
}

/* -dF_i/dx = w_i' ratio u + w_i (ratio/l) u l' + w_i (ratio (I - e e^T) + slope e e^T) u'. */
static void add_turning(const rub *r, const hk_friction_slopes *d, const size_t *slot, double *to) {
  double part = r->load > 0 ? r->ratio / r->load : 0, more = r->slope - r->ratio;
  for (int j = 0; j < 12; j++) {
    double du[3] = {d->u[0][j], d->u[1][j], d->u[2][j]};
    double along = r->size > 0 ? hk_dot(r->u, du) / (r->size * r->size) : 0;
    for (int e = 0; e < 12; e++) {
      int i = e / 3, a = e % 3;
      double by = d->w[i][j] * r->ratio * r->u[a] +
                  r->frame.w[i] * (part * d->load[j] * r->u[a] + r->ratio * du[a] + more * along * r->u[a]);
      to[9 * slot[4 * i + j / 3] + 3 * (size_t)a + (size_t)(j % 3)] += by;
    }
  }
}

void hk_friction_blocks(const hk_friction *f, hk_barrier_contacts *c, const hk_view *view, const hk_blocks *into) {
  size_t count = rubbing(f, c, view);
  double way[12];
  for (size_t k = 0; k < count; k++) {
    rub r = rub_of(f, c, k, view);
    const size_t *slot = into->slot + 16 * (size_t)r.pair->name;
    if (into->want & HK_WANT_DEFINITE) r.slope = r.ratio;
    add_damping(&r, slot, into->D);
    if (into->want & (HK_WANT_SYMMETRIC | HK_WANT_DEFINITE)) continue;
    hk_friction_slopes slopes;
    hk_pair_gather(&r.pair->pair, view->v, way);
    for (int e = 0; e < 12; e++) way[e] *= r.by;
    hk_friction_slopes_of(r.pair, r.value, view->x, r.slip->s, way, &slopes);
    add_turning(&r, &slopes, slot, into->K);
  }
}
