/* A turn A is that of I A = sum (x_i - x_G) x m_i a_i, I the inertia tensor, about the centre of mass of a free body.
 * With one pin it is a rotation about that point; with pins on a line, about that axis; with pins that are not on one
 * line, none. A body whose particles lie on a line has no inertia about it: eigenvalues of I below `small` times the
 * trace count as 0. */
#include "plugins/common/turns/body_turns.h"
#include "plugins/common/solids/matrix3.h"
#include "plugins/kit/vector3.h"

static const double small = 1e-12;    /* relative to the trace of I: a body with a thickness of 1e-6 of its length */
static const double one_point = 1e-9; /* relative to the body's size: closer pins are one point, or on one line */

hk_status hk_body_turns_reserve(hk_body_turns *m, const hk_host *host, size_t n, size_t edges) {
  host->release(host, m->body);
  host->release(host, m->label);
  host->release(host, m->anchor);
  m->body = host->allocate(host, (n + 1) * sizeof *m->body);
  m->label = host->allocate(host, (n + 1) * sizeof *m->label);
  m->anchor = host->allocate(host, (edges + 1) * sizeof *m->anchor);
  return m->body && m->label && m->anchor ? HK_OK : HK_NO_MEMORY;
}

static uint32_t root(uint32_t *parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/* The root of a set is its smallest index, so the loop that numbers the bodies reaches it first. */
void hk_body_turns_arrange(hk_body_turns *m, const hk_element_edges *e) {
  uint32_t *label = m->label;
  m->n = e->n;
  m->bodies = m->anchors = 0;
  for (uint32_t i = 0; i < e->n; i++) label[i] = i;
  for (size_t q = 0; q < e->count; q++) {
    uint32_t i = e->pair[q][0], j = e->pair[q][1];
    if (e->pin[i] != HK_FREE || e->pin[j] != HK_FREE) continue;
    i = root(label, i), j = root(label, j);
    label[i > j ? i : j] = i > j ? j : i;
  }
  for (uint32_t i = 0; i < e->n; i++) label[i] = root(label, i);
  for (uint32_t i = 0; i < e->n; i++)
    label[i] = e->pin[i] != HK_FREE ? HK_NO_BODY : label[i] == i ? (uint32_t)m->bodies++ : label[label[i]];
  for (size_t q = 0; q < 2 * e->count; q++) {
    uint32_t i = e->pair[q / 2][q % 2], j = e->pair[q / 2][1 - q % 2];
    if (e->pin[i] != HK_FREE || e->pin[j] == HK_FREE) continue;
    m->anchor[m->anchors][0] = label[i];
    m->anchor[m->anchors++][1] = j;
  }
}

static void find_centres(hk_body_turns *m, const double *mass, const double *x, const double *a) {
  for (size_t b = 0; b < m->bodies; b++) m->body[b] = (hk_turning_body){.pin = HK_NO_BODY, .far = HK_NO_BODY};
  for (size_t k = 0; k < m->anchors; k++) {
    hk_turning_body *b = &m->body[m->anchor[k][0]];
    if (b->pin == HK_NO_BODY) b->pin = m->anchor[k][1];
  }
  for (size_t i = 0; i < m->n; i++) {
    if (m->label[i] == HK_NO_BODY) continue;
    hk_turning_body *b = &m->body[m->label[i]];
    b->mass += mass[i];
    for (int c = 0; c < 3; c++) {
      b->centre[c] += mass[i] * x[3 * i + c];
      b->drift[c] += mass[i] * a[3 * i + c];
    }
  }
  for (size_t k = 0; k < m->bodies; k++) {
    hk_turning_body *b = &m->body[k];
    for (int c = 0; c < 3; c++) {
      b->centre[c] = b->pin == HK_NO_BODY ? b->centre[c] / b->mass : x[3 * b->pin + c];
      b->drift[c] = b->pin == HK_NO_BODY ? b->drift[c] / b->mass : a[3 * b->pin + c];
    }
  }
}

static void from_centre(const hk_turning_body *b, const double *x, double r[3]) {
  for (int c = 0; c < 3; c++) r[c] = x[c] - b->centre[c];
}

static void find_moments(hk_body_turns *m, const double *mass, const double *x, const double *a) {
  for (size_t i = 0; i < m->n; i++) {
    double r[3], w[3], t[3];
    if (m->label[i] == HK_NO_BODY) continue;
    hk_turning_body *b = &m->body[m->label[i]];
    from_centre(b, x + 3 * i, r);
    for (int c = 0; c < 3; c++) w[c] = a[3 * i + c] - b->drift[c];
    hk_cross(t, r, w);
    double r2 = hk_dot(r, r);
    for (int c = 0; c < 3; c++) b->torque[c] += mass[i] * t[c];
    for (int p = 0, k = 0; p < 3; p++)
      for (int q = p; q < 3; q++, k++) b->inertia[k] += mass[i] * ((p == q ? r2 : 0) - r[p] * r[q]);
    if (r2 > b->radius2) b->radius2 = r2;
  }
}

/* Determines for each body whether its pins lie at one point, on a line or neither. */
static void find_pins(hk_body_turns *m, const double *x) {
  double r[3], along[3], off[3];
  for (size_t k = 0; k < m->anchors; k++) {
    hk_turning_body *b = &m->body[m->anchor[k][0]];
    from_centre(b, x + 3 * m->anchor[k][1], r);
    if (hk_dot(r, r) > one_point * one_point * b->radius2 && hk_dot(r, r) > b->far2) {
      b->far = m->anchor[k][1];
      b->far2 = hk_dot(r, r);
    }
  }
  for (size_t k = 0; k < m->anchors; k++) {
    hk_turning_body *b = &m->body[m->anchor[k][0]];
    if (b->far == HK_NO_BODY) continue;
    from_centre(b, x + 3 * m->anchor[k][1], r);
    from_centre(b, x + 3 * b->far, along);
    hk_cross(off, along, r);
    if (hk_dot(off, off) > one_point * one_point * b->far2 * fmax(b->far2, b->radius2)) b->fixed = true;
  }
}

/* A = I^-1 torque, about the axes with inertia. */
static void turn_freely(hk_turning_body *b) {
  const double *t = b->inertia, trace = t[0] + t[3] + t[5];
  const double tensor[9] = {t[0], t[1], t[2], t[1], t[3], t[4], t[2], t[4], t[5]};
  double value[3], Q[9];
  hk_matrix3_eigen(tensor, value, Q);
  for (int k = 0; k < 3; k++) {
    const double axis[3] = {Q[k], Q[3 + k], Q[6 + k]};
    if (value[k] > small * trace) hk_add_scaled(b->turn, hk_dot(axis, b->torque) / value[k], axis);
  }
}

static void turn_about(hk_turning_body *b, const double *x) {
  double e[3], I_e[3];
  const double *tensor = b->inertia;
  from_centre(b, x + 3 * b->far, e);
  for (int c = 0; c < 3; c++) e[c] /= sqrt(b->far2);
  I_e[0] = tensor[0] * e[0] + tensor[1] * e[1] + tensor[2] * e[2];
  I_e[1] = tensor[1] * e[0] + tensor[3] * e[1] + tensor[4] * e[2];
  I_e[2] = tensor[2] * e[0] + tensor[4] * e[1] + tensor[5] * e[2];
  double inertia = hk_dot(e, I_e), trace = tensor[0] + tensor[3] + tensor[5];
  for (int c = 0; c < 3 && inertia > small * trace; c++) b->turn[c] = e[c] * hk_dot(e, b->torque) / inertia;
}

void hk_body_turns_find(hk_body_turns *m, const double *mass, const double *x, const double *a) {
  find_centres(m, mass, x, a);
  find_moments(m, mass, x, a);
  find_pins(m, x);
  for (size_t k = 0; k < m->bodies; k++) {
    hk_turning_body *b = &m->body[k];
    if (b->far == HK_NO_BODY)
      turn_freely(b);
    else if (!b->fixed)
      turn_about(b, x);
  }
}

void hk_body_turns_remove(hk_body_turns *m, const double *mass, const double *x, double *a) {
  hk_body_turns_find(m, mass, x, a);
  for (size_t i = 0; i < m->n; i++) {
    double r[3], t[3];
    if (m->label[i] == HK_NO_BODY) continue;
    from_centre(&m->body[m->label[i]], x + 3 * i, r);
    hk_cross(t, m->body[m->label[i]].turn, r);
    for (int c = 0; c < 3; c++) a[3 * i + c] -= t[c];
  }
}
