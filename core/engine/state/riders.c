/* Riders: points that are fixed linear combinations of particles (hk_rider). With all riders r = T x of the others, the
 * forces F_r on them are T^T F_r on their carriers, so that power and energy are those of the points; a matrix of
 * second derivatives goes over as T^T K T, and a bound of it by blocks as follows: for one rider, with s = sum |w_k|,
 *     (sum w_k u_k) . B (sum w_k u_k) <= s sum |w_k| u_k . B u_k
 * by Cauchy's inequality. Accelerations of riders are those combinations, too: whatever method adds them up leaves the
 * riders where they belong, up to rounding, which imposing them removes. All loops run in the order of the riders, in
 * one thread: results do not depend on the number of threads. */
#include "core/engine/state/state.h"

#include <stdlib.h>
#include <string.h>

static uint32_t index_of(const hk_state *s, uint32_t id) { return s->by_id ? s->by_id[id - 1] : id - 1; }

static int by_particle(const void *a, const void *b) {
  const hk_rider *p = a, *q = b;
  return (p->particle > q->particle) - (p->particle < q->particle);
}

/* What carries others is inside of its body, and so are points that do not touch. */
static void mark_inside(hk_state *s, const hk_rider *r) {
  s->inside[r->particle] = !r->touches;
  for (uint32_t c = 0; c < r->carriers; c++) s->inside[r->carrier[c]] = true;
}

/* The surfaces of bodies; those without triangles say only what their body is made of. */
static void open_skins(hk_state *s, const hk_particles *p) {
  for (size_t k = 0; k < p->skins; k++) {
    hk_body_skin *skin = &s->skin[s->model.skins];
    *skin = p->skin[k];
    for (uint32_t c = 0; c < skin->carriers; c++) {
      skin->carrier[c] = index_of(s, skin->carrier[c]);
      s->inside[skin->carrier[c]] = true;
    }
    s->model.skins += skin->triangles > 0;
  }
}

hk_status hk_riders_open(hk_state *s, hk_error *error) {
  const hk_particles *p = s->start;
  if (p->riders + p->skins == 0) return HK_OK;
  s->rider = malloc((p->riders + 1) * sizeof *s->rider);
  s->skin = malloc((p->skins + 1) * sizeof *s->skin);
  s->insides = s->model.n;
  s->inside = calloc(s->insides + 1, sizeof *s->inside);
  if (!s->rider || !s->skin || !s->inside)
    return hk_error_set(error, HK_NO_MEMORY, "no memory for %zu riders", p->riders);
  for (size_t k = 0; k < p->riders; k++) {
    hk_rider *r = &s->rider[k];
    *r = p->rider[k];
    r->particle = index_of(s, r->particle);
    for (uint32_t c = 0; c < r->carriers; c++) r->carrier[c] = index_of(s, r->carrier[c]);
    for (uint32_t c = r->carriers; c < HK_CARRIERS; c++) r->carrier[c] = r->carrier[0], r->weight[c] = 0;
    s->pin[r->particle] = HK_PIN_RIDES;
    mark_inside(s, r);
  }
  qsort(s->rider, p->riders, sizeof *s->rider, by_particle);
  open_skins(s, p);
  s->model.riders = p->riders;
  hk_state_refresh(s);
  return HK_OK;
}

/* x of each rider becomes the combination of its carriers'. Carriers beyond its own weigh nothing. */
void hk_riders_follow(const hk_model *m, double *x) {
  for (const hk_rider *r = m->rider, *end = r + m->riders; r < end; r++) {
    const double *a = x + 3 * (size_t)r->carrier[0], *b = x + 3 * (size_t)r->carrier[1], *w = r->weight;
    const double *c = x + 3 * (size_t)r->carrier[2], *d = x + 3 * (size_t)r->carrier[3];
    double sum[3];
    for (int e = 0; e < 3; e++) sum[e] = w[0] * a[e] + w[1] * b[e] + w[2] * c[e] + w[3] * d[e];
    memcpy(x + 3 * (size_t)r->particle, sum, sizeof sum);
  }
}

void hk_riders_gather(const hk_model *m, double *F) {
  for (size_t k = 0; k < m->riders; k++) {
    const hk_rider *r = &m->rider[k];
    double *own = F + 3 * (size_t)r->particle;
    if (own[0] == 0 && own[1] == 0 && own[2] == 0) continue;
    for (uint32_t c = 0; c < r->carriers; c++) {
      double *at = F + 3 * (size_t)r->carrier[c];
      for (int e = 0; e < 3; e++) at[e] += r->weight[c] * own[e];
    }
    own[0] = own[1] = own[2] = 0;
  }
}

void hk_riders_gather_bounds(const hk_model *m, double (*block)[6]) {
  for (size_t k = 0; k < m->riders; k++) {
    const hk_rider *r = &m->rider[k];
    double *own = block[r->particle], all = 0;
    for (uint32_t c = 0; c < r->carriers; c++) all += fabs(r->weight[c]);
    for (uint32_t c = 0; c < r->carriers; c++)
      for (int e = 0; e < 6; e++) block[r->carrier[c]][e] += all * fabs(r->weight[c]) * own[e];
    memset(own, 0, 6 * sizeof *own);
  }
}

static bool has_lost(const uint32_t *map, uint32_t carriers, uint32_t *carrier) {
  bool lost = false;
  for (uint32_t c = 0; c < carriers; c++) {
    carrier[c] = map[carrier[c]];
    lost |= carrier[c] == UINT32_MAX;
  }
  return lost;
}

/* To the present particles; the newborn are in no body. */
static hk_status remap_inside(hk_state *s, const uint32_t *map, hk_error *error) {
  if (!s->inside) return HK_OK;
  bool *inside = calloc(s->model.n + 1, sizeof *inside);
  if (!inside) return hk_error_set(error, HK_NO_MEMORY, "no memory for %zu particles", s->model.n);
  for (size_t i = 0; i < s->insides; i++)
    if (map[i] != UINT32_MAX) inside[map[i]] = s->inside[i];
  free(s->inside);
  s->model.inside = s->inside = inside;
  s->insides = s->model.n;
  return HK_OK;
}

hk_status hk_riders_remap(hk_state *s, const uint32_t *map, hk_error *error) {
  size_t kept = 0;
  for (size_t k = 0; k < s->model.riders; k++) {
    hk_rider r = s->rider[k];
    r.particle = map[r.particle];
    if (r.particle == UINT32_MAX) continue;
    if (has_lost(map, HK_CARRIERS, r.carrier))
      return hk_error_set(error, HK_FAILED,
                          "particle %u is a point of a rigid body of which a source has removed a part: remove all of "
                          "the body, or nothing",
                          s->id[r.particle]);
    s->rider[kept++] = r;
  }
  s->model.riders = kept;
  kept = 0;
  for (size_t k = 0; k < s->model.skins; k++) {
    hk_body_skin skin = s->skin[k];
    if (!has_lost(map, skin.carriers, skin.carrier)) s->skin[kept++] = skin;
  }
  s->model.skins = kept;
  return remap_inside(s, map, error);
}
