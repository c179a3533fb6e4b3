/* How bodies respond to an impulse: z of (S J W J^T S) z = -S J W p, and then W p + W J^T S z, with the scaled matrix A
 * of constraint_matrix.c. A small body has a dense Cholesky factor of its rows, made when it is first asked for. A row
 * whose pivot is below `dependent` follows from the rows before it and is left out: the response is the same. */
#include "core/numerics/constraints/body_response.h"

#include <string.h>

static const double dependent = 1e-11; /* of a unit diagonal */
static const double opposite = 1e-12;  /* J of two particles that one line joins */

/* Equation k, whose first block is b, as a contact of one particle, or of two that it draws along one line. Its value
 * is per length of J. */
static bool as_contact(const hk_constraints *c, size_t b, size_t blocks, hk_one_sided *out) {
  size_t k = c->list.pair[b][0];
  double size = sqrt(hk_constraint_dot(c->J[b], c->J[b])), sum = 0;
  if (blocks > 2 || !(size > 0)) return false;
  *out = (hk_one_sided){{{c->list.pair[b][1]}, {1}}, {0}, c->g[k] / size, c->speed[k] / size};
  for (size_t a = 0; a < 3; a++) out->n[a] = c->J[b][a] / size;
  if (blocks == 1) return true;
  out->point.particle[1] = c->list.pair[b + 1][1];
  out->point.weight[1] = -1;
  for (size_t a = 0; a < 3; a++) sum += fabs(c->J[b][a] + c->J[b + 1][a]);
  return sum <= opposite * size;
}

static hk_status find_one_sided(hk_body_list *s, double t, const double *x, const double *v) {
  const hk_constraints *c = s->dynamics->constraints;
  s->one_sided = 0;
  if (c->one_sided_count == 0) return HK_OK;
  hk_status status = hk_constraint_value(s->dynamics, t, x, v);
  if (status == HK_OK) status = hk_constraint_speed(s->dynamics, t, x, v);
  for (size_t b = 0, blocks; b < c->blocks && status == HK_OK; b += blocks) {
    for (blocks = 1; b + blocks < c->blocks && c->list.pair[b + blocks][0] == c->list.pair[b][0];) blocks++;
    if (c->one_sided[c->list.pair[b][0]] && as_contact(c, b, blocks, &s->pair[s->one_sided])) s->one_sided++;
  }
  return status;
}

hk_status hk_body_linearise(void *self, double t, const double *x, const double *v) {
  hk_body_list *s = self;
  hk_constraints *c = s->dynamics->constraints;
  hk_status status = hk_body_list_update(s);
  if (status != HK_OK || s->count == 0) return status;
  for (size_t k = 0; k < c->equations; k++) c->rests[k] = c->one_sided[k] || c->implied[k];
  status = hk_constraint_matrix_linearise(s->dynamics, t, x, v);
  if (status != HK_OK) return status;
  hk_constraint_matrix_assemble(c);
  status = find_one_sided(s, t, x, v);
  memset(s->factored, 0, s->count * sizeof *s->factored);
  s->whole_factored = false;
  return status;
}

/* ---- a dense factor: L of A = L L^T ---- */

static void copy_rows(const hk_body_list *s, uint32_t body, double *L, size_t m) {
  const hk_constraints *c = s->dynamics->constraints;
  const uint32_t *row = s->row + s->row_start[body];
  memset(L, 0, m * m * sizeof *L);
  for (size_t r = 0; r < m; r++)
    for (size_t e = c->matrix.row_start[row[r]]; e < c->matrix.row_start[row[r] + 1]; e++)
      L[r * m + s->local[c->matrix.column[e]]] = c->value[e];
}

static void factorize(double *L, size_t m) {
  for (size_t j = 0; j < m; j++) {
    double pivot = L[j * m + j];
    for (size_t k = 0; k < j; k++) pivot -= L[j * m + k] * L[j * m + k];
    double root = pivot > dependent ? sqrt(pivot) : 0;
    L[j * m + j] = root;
    for (size_t r = j + 1; r < m; r++) {
      double sum = L[r * m + j];
      for (size_t k = 0; k < j; k++) sum -= L[r * m + k] * L[j * m + k];
      L[r * m + j] = root > 0 ? sum / root : 0;
    }
  }
}

static void solve(const double *L, size_t m, double *z) {
  for (size_t r = 0; r < m; r++) {
    for (size_t k = 0; k < r; k++) z[r] -= L[r * m + k] * z[k];
    z[r] = L[r * m + r] > 0 ? z[r] / L[r * m + r] : 0;
  }
  for (size_t r = m; r-- > 0;) {
    for (size_t k = r + 1; k < m; k++) z[r] -= L[k * m + r] * z[k];
    z[r] = L[r * m + r] > 0 ? z[r] / L[r * m + r] : 0;
  }
}

/* ---- the response ---- */

/* The pin of a particle of the body; UINT32_MAX: none. */
static uint32_t pin_of(const hk_body_list *s, uint32_t body, uint32_t particle) {
  const hk_constraints *c = s->dynamics->constraints;
  for (size_t e = s->block_at[body]; e < s->block_at[body + 1]; e++)
    if (c->list.pair[s->block[e]][1] == particle) return c->pin[s->block[e]];
  return UINT32_MAX;
}

/* The change of the particle's velocity if it were free of equations: W p. Particles in no body do not slide on pins.
 */
static void move_free(const hk_body_list *s, uint32_t particle, double weight, const double impulse[3], double out[3]) {
  const hk_dynamics *d = s->dynamics;
  double change[3];
  memcpy(change, impulse, sizeof change);
  bool slides = d->state->pin[particle] == HK_PIN_LINE || d->state->pin[particle] == HK_PIN_PLANE;
  if (slides && s->count && s->of[particle] != UINT32_MAX)
    hk_pin_project(d->pins->item[pin_of(s, s->of[particle], particle)].spec, change);
  for (int a = 0; a < 3; a++) out[a] += weight * d->state->inverse_mass[particle] * change[a];
}

/* The same of a particle with its weight in a point of the body; of a rider on its carriers. */
static void move_point(const hk_body_list *s, uint32_t particle, double weight, const double impulse[3],
                       double *response) {
  const hk_rider *r =
      s->dynamics->state->pin[particle] == HK_PIN_RIDES ? hk_model_rider(&s->dynamics->state->model, particle) : NULL;
  if (!r) move_free(s, particle, weight, impulse, response + 3 * (size_t)particle);
  for (uint32_t k = 0; r && k < r->carriers; k++)
    move_free(s, r->carrier[k], weight * r->weight[k], impulse, response + 3 * (size_t)r->carrier[k]);
}

/* The riders of the body move with their carriers. */
static void carry_riders(const hk_body_list *s, uint32_t body, double *response) {
  const hk_state *state = s->dynamics->state;
  const hk_rider *next = state->model.rider, *end = next + state->model.riders; /* behind the last that was found */
  for (size_t e = s->member_start[body]; e < s->member_start[body + 1] && state->model.riders; e++) {
    uint32_t i = s->member[e];
    const hk_rider *r = NULL;
    if (state->pin[i] == HK_PIN_RIDES) {
      r = next < end && next->particle == i ? next : hk_model_rider(&state->model, i);
      next = r ? r + 1 : next;
    }
    double *out = response + 3 * (size_t)i;
    if (r) out[0] = out[1] = out[2] = 0;
    for (uint32_t k = 0; r && k < r->carriers; k++)
      if (s->of[r->carrier[k]] == body)
        for (int a = 0; a < 3; a++) out[a] += r->weight[k] * response[3 * (size_t)r->carrier[k] + (size_t)a];
  }
}

/* z: the scaled right-hand side on entry and the solution on return, by the equations of the body in their order. */
static hk_status solve_body(hk_body_list *s, uint32_t body, double *z) {
  hk_dynamics *d = s->dynamics;
  hk_constraints *c = d->constraints;
  size_t m = s->row_start[body + 1] - s->row_start[body];
  const uint32_t *row = s->row + s->row_start[body];
  if (m <= HK_DENSE_BODY) {
    double *L = s->factor + s->factor_start[body];
    if (!s->factored[body]) {
      copy_rows(s, body, L, m);
      factorize(L, m);
      s->factored[body] = true;
    }
    solve(L, m, z);
    return HK_OK;
  }
  hk_status status = s->whole_factored ? HK_OK : hk_constraint_matrix_factorize(d);
  s->whole_factored = status == HK_OK;
  memset(c->rhs, 0, c->equations * sizeof *c->rhs);
  for (size_t r = 0; r < m; r++)
    if (c->scale[row[r]] > 0) c->rhs[row[r]] = z[r] / c->scale[row[r]];
  if (status == HK_OK) status = hk_constraint_matrix_solve(d);
  for (size_t r = 0; r < m; r++) z[r] = c->scale[row[r]] > 0 ? c->solution[row[r]] / c->scale[row[r]] : 0;
  return status;
}

static hk_status respond_body(hk_body_list *s, uint32_t body, const hk_weighted_point *p, const double impulse[3],
                              double *response) {
  const hk_constraints *c = s->dynamics->constraints;
  double *z = s->room;
  for (size_t e = s->member_start[body]; e < s->member_start[body + 1]; e++)
    memset(response + 3 * (size_t)s->member[e], 0, 3 * sizeof *response);
  for (int k = 0; k < 4; k++) {
    uint32_t i = p->particle[k];
    if (p->weight[k] != 0 && s->of[i] == body) move_point(s, i, p->weight[k], impulse, response);
  }
  memset(z, 0, (s->row_start[body + 1] - s->row_start[body]) * sizeof *z);
  for (size_t e = s->block_at[body]; e < s->block_at[body + 1]; e++) {
    uint32_t b = s->block[e], k = c->list.pair[b][0], i = c->list.pair[b][1];
    if (s->of[i] == body) z[s->local[k]] -= c->scale[k] * hk_constraint_dot(c->J[b], response + 3 * (size_t)i);
  }
  hk_status status = solve_body(s, body, z);
  for (size_t e = s->block_at[body]; e < s->block_at[body + 1]; e++) {
    uint32_t b = s->block[e], k = c->list.pair[b][0], i = c->list.pair[b][1];
    if (s->of[i] != body) continue;
    for (int a = 0; a < 3; a++) response[3 * (size_t)i + (size_t)a] += c->scale[k] * z[s->local[k]] * c->WJ[b][a];
  }
  carry_riders(s, body, response);
  return status;
}

/* Whether the point's k-th particle is the first of its body there. */
static bool is_first(const hk_body_list *s, const hk_weighted_point *p, int k) {
  uint32_t body = p->weight[k] != 0 ? s->of[p->particle[k]] : UINT32_MAX;
  bool first = body != UINT32_MAX;
  for (int j = 0; j < k; j++) first &= p->weight[j] == 0 || s->of[p->particle[j]] != body;
  return first;
}

hk_status hk_body_respond(void *self, const hk_weighted_point *p, const double impulse[3], double *response) {
  hk_body_list *s = self;
  hk_status status = HK_OK;
  for (int k = 0; k < 4 && status == HK_OK && s->count; k++)
    if (is_first(s, p, k)) status = respond_body(s, s->of[p->particle[k]], p, impulse, response);
  return status;
}

static bool is_free(const hk_body_list *s, uint32_t particle) { return !s->count || s->of[particle] == UINT32_MAX; }

hk_status hk_body_mobility(void *self, const hk_weighted_point *p, const double n[3], double *mobility) {
  hk_body_list *s = self;
  *mobility = 0;
  hk_status status = hk_body_respond(s, p, n, s->response);
  for (int k = 0; k < 4; k++) {
    uint32_t i = p->particle[k];
    if (p->weight[k] == 0) continue;
    *mobility += is_free(s, i) ? p->weight[k] * p->weight[k] * s->dynamics->state->inverse_mass[i]
                               : p->weight[k] * hk_constraint_dot(n, s->response + 3 * (size_t)i);
  }
  return status;
}

hk_status hk_body_push(void *self, const hk_weighted_point *p, const double impulse[3], double *v) {
  hk_body_list *s = self;
  hk_status status = hk_body_respond(s, p, impulse, s->response);
  for (int k = 0; k < 4 && status == HK_OK; k++) {
    uint32_t i = p->particle[k];
    if (p->weight[k] != 0 && is_free(s, i)) move_free(s, i, p->weight[k], impulse, v + 3 * (size_t)i);
    if (!is_first(s, p, k)) continue;
    const uint32_t *member = s->member + s->member_start[s->of[i]], *end = s->member + s->member_start[s->of[i] + 1];
    for (; member < end; member++)
      for (size_t a = 0; a < 3; a++) v[3 * (size_t)*member + a] += s->response[3 * (size_t)*member + a];
  }
  return status;
}
