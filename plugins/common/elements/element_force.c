/* Forces made of elements: E = 1/2 sum k C^2 and damping -c (dC/dt) grad C, over the tuples whose members are all
 * active. With g = grad C, H its Hessian and u = g.v, and z = k C + c u,
 *     F = -z g,      -dF/dx = k g g^T + z H + c g (H v)^T,      -dF/dv = c g g^T.
 * The last term of dF/dx is the rotation of the damping's direction and is not symmetric: HK_WANT_SYMMETRIC omits it.
 * HK_WANT_DEFINITE omits z H as well: k g g^T, the Gauss-Newton matrix, has no negative eigenvalue.
 * Invariant: `acting` holds its own copies, in the order of the lists they were copied from. */
#include "plugins/common/elements/element_force.h"

#include <string.h>

enum { MOST = 12 }; /* most coordinates of a tuple */

typedef struct element {
  double C[HK_ELEMENT_VALUES], g[HK_ELEMENT_VALUES][MOST], v[MOST], k, c;
} element;

static bool acts(const hk_view *view, const uint32_t *member, unsigned arity) {
  bool all = true;
  for (unsigned a = 0; a < arity && view->is_active; a++) all = all && view->is_active[member[a]];
  return all;
}

static double value_of(const hk_per_tuple *p, size_t k) { return p && p->count ? hk_tuple_value(p, k) : 0; }

static hk_status measure_rest(hk_element_force *f, const hk_view *view, const hk_tuples *node, hk_per_tuple *rest) {
  const hk_host *host = view->host;
  double zero = 0, dC[4 * HK_ELEMENT_VALUES][3], *C = host->allocate(host, (node->count + 1) * sizeof *C);
  if (!C) return host->fail(host, HK_NO_MEMORY, "no memory for %zu rest values", node->count);
  f->acting.node = *node;
  f->acting.rest = (hk_per_tuple){1, &zero};
  for (size_t k = 0; k < node->count; k++) f->acting.evaluate(f->acting.self, view->x, k, k + 1, C + k, dC);
  *rest = (hk_per_tuple){node->count, C};
  f->acting.node = (hk_tuples){0, node->arity, NULL};
  f->acting.rest = (hk_per_tuple){0, NULL};
  return HK_OK;
}

static hk_status reserve(hk_element_force *f, const hk_host *host, const hk_tuples *node) {
  hk_elements *a = &f->acting;
  host->release(host, (void *)(uintptr_t)a->node.index);
  host->release(host, a->stiffness.value);
  host->release(host, a->damping.value);
  host->release(host, a->rest.value);
  uint32_t *index = host->allocate(host, (node->count * node->arity + 1) * sizeof *index);
  a->node = (hk_tuples){0, node->arity, index};
  a->stiffness.value = host->allocate(host, (node->count + 1) * sizeof(double));
  a->damping.value = host->allocate(host, (node->count + 1) * sizeof(double));
  a->rest.value = host->allocate(host, (node->count + 1) * sizeof(double));
  if (index && a->stiffness.value && a->damping.value && a->rest.value) return HK_OK;
  return host->fail(host, HK_NO_MEMORY, "no memory for %zu elements", node->count);
}

hk_status hk_element_force_take(hk_element_force *f, const hk_view *view, const hk_tuples *node,
                                const hk_per_tuple *stiffness, const hk_per_tuple *damping, hk_per_tuple *rest) {
  hk_elements *a = &f->acting;
  hk_status status = HK_OK;
  if (rest && rest->count == 0 && node->count > 0 && !a->node.index) status = measure_rest(f, view, node, rest);
  if (status == HK_OK) status = reserve(f, view->host, node);
  if (status != HK_OK) return status;
  uint32_t *index = (uint32_t *)(uintptr_t)a->node.index;
  size_t kept = 0;
  for (size_t k = 0; k < node->count; k++) {
    if (!acts(view, hk_tuple(node, k), node->arity)) continue;
    memcpy(index + node->arity * kept, hk_tuple(node, k), node->arity * sizeof *index);
    a->stiffness.value[kept] = value_of(stiffness, k);
    a->damping.value[kept] = value_of(damping, k);
    a->rest.value[kept++] = value_of(rest, k);
  }
  a->node.count = a->stiffness.count = a->damping.count = kept;
  a->rest.count = rest ? kept : 0;
  return HK_OK;
}

/* C, its gradients and the members' velocities for tuple k. */
static element evaluate(const hk_element_force *f, const hk_view *view, size_t k) {
  const hk_elements *a = &f->acting;
  const uint32_t *member = hk_tuple(&a->node, k);
  double dC[4 * HK_ELEMENT_VALUES][3];
  element e = {.k = a->stiffness.value[k], .c = a->damping.value[k]};
  a->evaluate(a->self, view->x, k, k + 1, e.C, dC);
  for (unsigned q = 0; q < a->values; q++) memcpy(e.g[q], dC[a->node.arity * q], a->node.arity * sizeof dC[0]);
  for (unsigned b = 0; b < a->node.arity; b++) memcpy(e.v + 3 * b, view->v + 3 * (size_t)member[b], sizeof dC[0]);
  return e;
}

static double dot(const double *a, const double *b, unsigned count) {
  double sum = 0;
  for (unsigned k = 0; k < count; k++) sum += a[k] * b[k];
  return sum;
}

void hk_element_force_add(const hk_element_force *f, const hk_view *view, double *F) {
  unsigned arity = f->acting.node.arity;
  for (size_t k = 0; k < f->acting.node.count; k++) {
    const uint32_t *member = hk_tuple(&f->acting.node, k);
    element e = evaluate(f, view, k);
    for (unsigned q = 0; q < f->acting.values; q++) {
      double u = dot(e.g[q], e.v, 3 * arity), z = e.k * e.C[q] + e.c * u;
      for (unsigned b = 0; b < 3 * arity; b++) F[3 * (size_t)member[b / 3] + b % 3] -= z * e.g[q][b];
      if (view->power) *view->power -= e.c * u * u;
    }
  }
}

double hk_element_force_energy(const hk_element_force *f, const hk_view *view) {
  double sum = 0;
  for (size_t k = 0; k < f->acting.node.count; k++) {
    element e = evaluate(f, view, k);
    for (unsigned q = 0; q < f->acting.values; q++) sum += e.k * e.C[q] * e.C[q] / 2;
  }
  return sum;
}

void hk_element_force_pattern(const hk_element_force *f, hk_pattern *pattern) {
  unsigned arity = f->acting.node.arity;
  for (size_t k = 0; k < f->acting.node.count; k++)
    for (unsigned b = 0; b < arity * arity; b++)
      pattern->block(pattern, hk_tuple(&f->acting.node, k)[b / arity], hk_tuple(&f->acting.node, k)[b % arity]);
}

/* Adds K and D of the q-th number C of an element, (3 arity) x (3 arity). */
static void matrices(const hk_element_force *f, const double *x, size_t k, unsigned q, const element *e, unsigned want,
                     double *K, double *D) {
  unsigned m = 3 * f->acting.node.arity;
  const double *g = e->g[q];
  if (!f->hessian) { /* C is linear */
    for (unsigned r = 0; r < m; r++)
      for (unsigned s = 0; s < m && g[r] != 0; s++) {
        K[m * r + s] += e->k * g[r] * g[s];
        D[m * r + s] += e->c * g[r] * g[s];
      }
    return;
  }
  double H[MOST * MOST] = {0}, Hv[MOST], z = e->k * e->C[q] + e->c * dot(g, e->v, m);
  bool turns = e->c != 0 && !(want & (HK_WANT_SYMMETRIC | HK_WANT_DEFINITE));
  if (!(want & HK_WANT_DEFINITE)) f->hessian(f->acting.self, x, k, q, H);
  for (unsigned r = 0; r < m; r++) Hv[r] = turns ? dot(H + m * r, e->v, m) : 0;
  for (unsigned r = 0; r < m; r++)
    for (unsigned s = 0; s < m; s++) {
      K[m * r + s] += e->k * g[r] * g[s] + z * H[m * r + s] + e->c * g[r] * Hv[s];
      D[m * r + s] += e->c * g[r] * g[s];
    }
}

static void add_block(const double *from, unsigned apart, double *to) {
  for (unsigned r = 0; r < 3; r++)
    for (unsigned s = 0; s < 3; s++) to[3 * r + s] += from[apart * r + s];
}

void hk_element_force_jacobian(const hk_element_force *f, const hk_view *view, const hk_blocks *into, size_t *next) {
  unsigned arity = f->acting.node.arity, m = 3 * arity;
  for (size_t k = 0; k < f->acting.node.count; k++, *next += arity * arity) {
    double K[MOST * MOST] = {0}, D[MOST * MOST] = {0};
    const size_t *slot = into->slot + *next;
    element e = evaluate(f, view, k);
    for (unsigned q = 0; q < f->acting.values; q++) matrices(f, view->x, k, q, &e, into->want, K, D);
    for (unsigned a = 0; a < arity; a++)
      for (unsigned b = 0; b < arity; b++) {
        add_block(K + 3 * m * a + 3 * b, m, into->K + 9 * slot[arity * a + b]);
        if (e.c != 0) add_block(D + 3 * m * a + 3 * b, m, into->D + 9 * slot[arity * a + b]);
      }
  }
}
