/* See barrier_friction.h. */
#include "plugins/common/contact/barrier/barrier_friction.h"
#include "plugins/common/contact/barrier/friction_slopes.h"
#include "plugins/kit/vector3.h"

/* A contact that rubs. */
typedef struct rub {
  const hk_barrier_pair *pair;
  const hk_barrier_value *value;
  hk_pair_frame frame;
  double load;         /* l, N */
  double u[3], size;   /* m/s, the velocity across the normal */
  double ratio, slope; /* N s/m: mu l f/|u|, and the derivative of mu l f by |u| */
} rub;

/* The velocity across the normal. */
static void find_slip(rub *r, const double *v) {
  double along = 0;
  for (size_t c = 0; c < 3; c++) {
    r->u[c] = 0;
    for (int a = 0; a < 4; a++) r->u[c] += r->frame.w[a] * v[3 * (size_t)r->pair->pair.vertex[a] + c];
  }
  along = hk_dot(r->u, r->frame.n);
  hk_add_scaled(r->u, -along, r->frame.n);
  r->size = hk_length(r->u);
}

static rub rub_of(const hk_barrier_friction *f, const hk_barrier_contacts *c, size_t k, const double *v) {
  const hk_barrier_value *value = hk_barrier_acting(c, k);
  rub r = {.pair = (const hk_barrier_pair *)c->near.item + value->near, .value = value};
  r.frame = hk_pair_frame_of(&value->nearest);
  r.load = hk_barrier_load(value);
  find_slip(&r, v);
  double y = r.size / f->speed, most = f->coefficient * r.load;
  r.ratio = most * (y < 1 ? (2 - y) / f->speed : 1 / r.size);
  r.slope = y < 1 ? 2 * most * (1 - y) / f->speed : 0;
  return r;
}

static size_t rubbing(const hk_barrier_friction *f, hk_barrier_contacts *c, const hk_view *view) {
  if (!(f->coefficient > 0)) return 0;
  hk_barrier_values_at(c, view);
  return c->acting_count;
}

double hk_friction_add(const hk_barrier_friction *f, hk_barrier_contacts *c, const hk_view *view, double *F) {
  size_t count = rubbing(f, c, view);
  double power = 0;
  for (size_t k = 0; k < count; k++) {
    rub r = rub_of(f, c, k, view->v);
    for (int a = 0; a < 4; a++) hk_add_scaled(F + 3 * (size_t)r.pair->pair.vertex[a], -r.ratio * r.frame.w[a], r.u);
    power -= r.ratio * r.size * r.size;
  }
  return power;
}

double hk_friction_power(const hk_barrier_friction *f, hk_barrier_contacts *c, const hk_view *view) {
  size_t count = rubbing(f, c, view);
  double power = 0;
  for (size_t k = 0; k < count; k++) {
    rub r = rub_of(f, c, k, view->v);
    power -= r.ratio * r.size * r.size;
  }
  return power;
}

/* -dF/dv: r (P - e e^T) + s e e^T, P the projection across the normal, e = u/|u|, s the slope of the force. */
static void add_damping(const rub *r, const size_t *slot, double *to) {
  double D[9];
  for (int p = 0; p < 9; p++) {
    double ee = r->size > 0 ? r->u[p / 3] * r->u[p % 3] / (r->size * r->size) : 0;
    D[p] = r->ratio * ((p % 4 == 0) - r->frame.n[p / 3] * r->frame.n[p % 3] - ee) + r->slope * ee;
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

void hk_friction_blocks(const hk_barrier_friction *f, hk_barrier_contacts *c, const hk_view *view,
                        const hk_blocks *into) {
  size_t count = rubbing(f, c, view);
  for (size_t k = 0; k < count; k++) {
    rub r = rub_of(f, c, k, view->v);
    const size_t *slot = into->slot + 16 * (size_t)r.pair->name;
    if (into->want & HK_WANT_DEFINITE) r.slope = r.ratio;
    add_damping(&r, slot, into->D);
    if (into->want & (HK_WANT_SYMMETRIC | HK_WANT_DEFINITE)) continue;
    hk_friction_slopes slopes;
    hk_friction_slopes_of(r.pair, r.value, view, &slopes);
    add_turning(&r, &slopes, slot, into->K);
  }
}
