/* See zones.h. From the start x_0 of the step, r_i = x_0i - c_0 from the centre of mass, and the mean velocities u_i:
 * the zone turns by the angle |w| h about w = I^-1 sum m_i r_i x u_i and its centre moves as it would have. At the end
 * the velocities are those of a rigid body with the momentum and angular momentum of the free end, about the centre. */
#include "plugins/common/contact/impulses/zones.h"

#include "plugins/common/space/union_find.h"
#include "plugins/kit/vector3.h"

#include <string.h>

/* Of the trace of I: a body on a line has no inertia about it, and no angular momentum along it either. The error of
 * what is solved is as small. */
static const double least_inertia = 1e-13;
/* Of the size of a zone: by how much pinned particles may be off a rigid motion. */
static const double rigid_enough = 1e-9;

hk_status hk_zones_open(hk_zones *z, const hk_host *host, size_t n) {
  host->release(host, z->zone);
  host->release(host, z->next);
  host->release(host, z->member);
  z->n = n;
  z->zone = host->allocate(host, (n + 1) * sizeof *z->zone);
  z->next = host->allocate(host, (n + 1) * sizeof *z->next);
  z->member = host->allocate(host, (n + 1) * sizeof *z->member);
  if (!z->zone || !z->next || !z->member) return host->fail(host, HK_NO_MEMORY, "no memory for %zu particles", n);
  hk_zones_clear(z);
  return HK_OK;
}

void hk_zones_clear(hk_zones *z) {
  for (size_t i = 0; i < z->n; i++) z->zone[i] = (uint32_t)i;
}

void hk_zones_merge(hk_zones *z, const hk_contact_solver *all) {
  for (size_t e = 0; e < all->count; e++)
    for (int i = 1; i < 4; i++) hk_unite(z->zone, all->impact[e].pair.vertex[0], all->impact[e].pair.vertex[i]);
}

/* ---- one zone ---- */

typedef struct zone {
  const uint32_t *member;
  size_t count;
  bool pinned;    /* some members are: these alone count below */
  double mass;    /* kg; of pinned ones, their number */
  double from[3]; /* centres of mass, m */
  double to[3];
  double spin[3]; /* rad, of the step */
  double size;    /* m */
} zone;

static double weight(const zone *s, const hk_zones_move *m, uint32_t i) {
  if (s->pinned) return m->inverse_mass[i] == 0;
  return m->mass[i];
}

static void find_centres(zone *s, const hk_zones_move *m) {
  for (size_t e = 0; e < s->count; e++) s->pinned |= m->inverse_mass[s->member[e]] == 0;
  for (size_t e = 0; e < s->count; e++) {
    double w = weight(s, m, s->member[e]);
    s->mass += w;
    hk_add_scaled(s->from, w, m->x_from + 3 * (size_t)s->member[e]);
    hk_add_scaled(s->to, w, m->x + 3 * (size_t)s->member[e]);
  }
  for (int c = 0; c < 3; c++) s->from[c] /= s->mass, s->to[c] /= s->mass;
}

/* a w = b for a symmetric and definite a. */
static void solve3(double a[3][3], const double b[3], double w[3]) {
  double c[3][3];
  hk_cross(c[0], a[1], a[2]);
  hk_cross(c[1], a[2], a[0]);
  hk_cross(c[2], a[0], a[1]);
  double det = hk_dot(a[0], c[0]);
  for (int k = 0; k < 3; k++) w[k] = det > 0 ? (b[0] * c[0][k] + b[1] * c[1][k] + b[2] * c[2][k]) / det : 0;
}

/* Places of the members: the means of two, which may be the same. */
typedef struct posture {
  const double *a, *b;   /* n x 3 */
  const double *ca, *cb; /* their centres */
} posture;

static void arm(const posture *p, uint32_t i, double r[3]) {
  size_t k = 3 * (size_t)i;
  for (size_t c = 0; c < 3; c++) r[c] = (p->a[k + c] - p->ca[c] + (p->b[k + c] - p->cb[c])) / 2;
}

/* The angular velocity of a rigid body with the angular momentum L. */
static void spin_of(const zone *s, const hk_zones_move *m, const posture *p, const double L[3], double w[3]) {
  double inertia[3][3] = {{0}}, trace = 0, r[3];
  for (size_t e = 0; e < s->count; e++) {
    double mass = weight(s, m, s->member[e]);
    arm(p, s->member[e], r);
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++) inertia[a][b] += mass * ((a == b ? hk_dot(r, r) : 0) - r[a] * r[b]);
  }
  for (int a = 0; a < 3; a++) trace += inertia[a][a];
  for (int a = 0; a < 3; a++) inertia[a][a] += least_inertia * trace;
  solve3(inertia, L, w);
}

/* L = sum m r x (y - z), y and z n x 3; z may be NULL. */
static void angular_momentum(const zone *s, const hk_zones_move *m, const posture *p, const double *y, const double *z,
                             double L[3]) {
  double r[3], u[3], moment[3];
  for (int c = 0; c < 3; c++) L[c] = 0;
  for (size_t e = 0; e < s->count; e++) {
    size_t i = 3 * (size_t)s->member[e];
    arm(p, s->member[e], r);
    hk_copy(u, y + i);
    if (z) hk_add_scaled(u, -1, z + i);
    hk_cross(moment, r, u);
    hk_add_scaled(L, weight(s, m, s->member[e]), moment);
  }
}

/* r turned by the vector a (Rodrigues). */
static void turn(const double a[3], const double r[3], double out[3]) {
  double angle = hk_length(a), axis[3], across[3];
  hk_copy(out, r);
  if (angle == 0) return;
  for (int c = 0; c < 3; c++) axis[c] = a[c] / angle;
  hk_cross(across, axis, r);
  double along = hk_dot(axis, r);
  for (int c = 0; c < 3; c++) out[c] = cos(angle) * r[c] + sin(angle) * across[c] + (1 - cos(angle)) * along * axis[c];
}

/* The place of member i when the zone has moved. */
static void place(const zone *s, const hk_zones_move *m, uint32_t i, double out[3]) {
  double r[3];
  hk_subtract(r, m->x_from + 3 * (size_t)i, s->from);
  turn(s->spin, r, out);
  hk_add_scaled(out, 1, s->to);
}

/* Pins that turn by the angle a about the unit vector n move by 2 tan(a/2) n x (the mean of both ends), exactly. */
static void find_turn(zone *s, const hk_zones_move *m) {
  double L[3];
  posture start = {m->x_from, m->x_from, s->from, s->from}, middle = {m->x_from, m->x, s->from, s->to};
  const posture *p = s->pinned ? &middle : &start;
  angular_momentum(s, m, p, m->x, m->x_from, L);
  spin_of(s, m, p, L, s->spin);
  double size = hk_length(s->spin);
  if (!s->pinned || size == 0) return;
  for (int c = 0; c < 3; c++) s->spin[c] *= 2 * atan(size / 2) / size;
}

static bool is_rigid(const zone *s, const hk_zones_move *m) {
  double off = 0, size = 0, p[3], d[3];
  for (size_t e = 0; e < s->count; e++) {
    uint32_t i = s->member[e];
    if (m->inverse_mass[i] > 0) continue;
    place(s, m, i, p);
    hk_subtract(d, p, m->x + 3 * (size_t)i);
    off = fmax(off, hk_length(d));
    hk_subtract(d, m->x + 3 * (size_t)i, s->to);
    size = fmax(size, hk_length(d) + hk_length(m->x + 3 * (size_t)i));
  }
  return off <= rigid_enough * size;
}

static void set_places(const zone *s, const hk_zones_move *m) {
  for (size_t e = 0; e < s->count; e++) {
    double p[3];
    place(s, m, s->member[e], p);
    if (m->inverse_mass[s->member[e]] > 0) hk_copy(m->x + 3 * (size_t)s->member[e], p);
  }
}

/* L: of the free end about `to`, or of the pinned ones. */
static void set_speeds(const zone *s, const hk_zones_move *m, const double L[3]) {
  double mean[3] = {0}, w[3], r[3], turned[3];
  for (size_t e = 0; e < s->count; e++)
    hk_add_scaled(mean, weight(s, m, s->member[e]) / s->mass, m->v + 3 * (size_t)s->member[e]);
  spin_of(s, m, &(posture){m->x, m->x, s->to, s->to}, L, w);
  for (size_t e = 0; e < s->count; e++) {
    size_t i = 3 * (size_t)s->member[e];
    if (m->inverse_mass[s->member[e]] == 0) continue;
    hk_subtract(r, m->x + i, s->to);
    hk_cross(turned, w, r);
    for (int c = 0; c < 3; c++) m->v[i + (size_t)c] = mean[c] + turned[c];
  }
}

static bool move_zone(const hk_zones_move *m, const uint32_t *member, size_t count) {
  zone s = {.member = member, .count = count};
  double L[3];
  find_centres(&s, m);
  find_turn(&s, m);
  if (s.pinned && !is_rigid(&s, m)) return false;
  angular_momentum(&s, m, &(posture){m->x, m->x, s.to, s.to}, m->v, NULL, L);
  set_places(&s, m);
  set_speeds(&s, m, L);
  return true;
}

/* ---- all of them ---- */

/* Chains the members of each zone behind its least one, in rising order. */
static void chain(hk_zones *z) {
  for (size_t i = 0; i < z->n; i++) {
    z->zone[i] = hk_root_of(z->zone, (uint32_t)i);
    z->next[i] = UINT32_MAX;
  }
  for (size_t i = z->n; i-- > 0;) {
    uint32_t first = z->zone[i];
    if (first == i) continue;
    z->next[i] = z->next[first];
    z->next[first] = (uint32_t)i;
  }
}

bool hk_zones_apply(hk_zones *z, const hk_zones_move *m) {
  bool rigid = true;
  chain(z);
  for (size_t i = 0; i < z->n && rigid; i++) {
    size_t count = 0;
    if (z->zone[i] != i || z->next[i] == UINT32_MAX) continue;
    for (uint32_t k = (uint32_t)i; k != UINT32_MAX; k = z->next[k]) z->member[count++] = k;
    rigid = move_zone(m, z->member, count);
  }
  return rigid;
}
