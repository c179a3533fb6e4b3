/* See warm_start.h. */
#include "plugins/common/contact/impulses/warm_start.h"

#include "plugins/kit/vector3.h"

#include <string.h>

/* Of the impulses of the last step: with all of them what the sweeps leave stays from step to step, and three sheets
 * that lie on each other keep a kinetic energy of 1e-6 J, with nine tenths of them 2.4e-7 J. Where sweeps leave less,
 * the more of them is given, in the end all: a tenth of the weight of ten layers takes more sweeps than there are. What
 * is left out falls with the square of what sweeps leave: in proportion to it, it would be motion as large as that. */
static double part_of(const hk_contact_solver *s) { return 1 - 0.1 * (1 - s->calm) * (1 - s->calm); }

enum { LEAST = 64 /* places; a power of two, as are all sizes */ };

/* The features of a pair, in either order of its edges. */
static hk_warm_pair name_of(const hk_feature_pair *pair) {
  const uint32_t *v = pair->vertex;
  hk_warm_pair to = {.first = {v[0], v[1]}, .kind = (uint32_t)pair->kind, .present = 1};
  uint64_t one = (uint64_t)v[0] << 32 | v[1], other = (uint64_t)v[2] << 32 | v[3];
  bool swap = pair->kind == HK_EDGE_EDGE && other < one;
  to.key[0] = swap ? other : one, to.key[1] = swap ? one : other;
  return to;
}

static size_t hash_of(const hk_warm_pair *p) {
  uint64_t h = p->key[0] * 0x9e3779b97f4a7c15u + p->key[1];
  h = (h ^ h >> 29) * 0xbf58476d1ce4e5b9u + p->kind;
  return (size_t)((h ^ h >> 32) * 0x94d049bb133111ebu >> 20);
}

/* The place of a pair, or a free one: of `size` places one is free at least. */
static size_t place_of(const hk_warm_pair *table, size_t size, const hk_warm_pair *p) {
  size_t at = hash_of(p) & (size - 1);
  for (size_t k = 0; k < size && table[at].present; k++, at = (at + 1) & (size - 1))
    if (table[at].key[0] == p->key[0] && table[at].key[1] == p->key[1] && table[at].kind == p->kind) break;
  return at;
}

/* The impulse of a known pair, N, for `scale` s or s^2, with its slide across the normal of now. A checkpoint may be
 * damaged: what is not finite is not taken. */
static void give(hk_impact *k, hk_impact_level *level, double push, const double slide[3], double scale) {
  if (!(push > 0 && push + hk_length(slide) < INFINITY)) return;
  level->push = scale * push;
  for (int c = 0; c < 3; c++) level->slide[c] = scale * slide[c];
  hk_add_scaled(level->slide, -hk_dot(level->slide, k->frame.n), k->frame.n);
}

void hk_warm_start_give(const hk_array *known, const hk_contact_solver *s, const hk_step_move *m, bool bodies) {
  const hk_warm_pair *table = known->item;
  double part = bodies ? 1 : part_of(s), h = m->h;
  if (known->count == 0 || (known->count & (known->count - 1)) != 0) return;
  for (size_t e = 0; e < s->count; e++) {
    hk_impact *k = &s->impact[e];
    if (!(k->mobility > 0) && !bodies) continue;
    hk_warm_pair name = name_of(&k->pair);
    const hk_warm_pair *found = &table[place_of(table, known->count, &name)];
    if (!found->present || found->key[0] != name.key[0] || found->key[1] != name.key[1] || found->kind != name.kind)
      continue;
    bool same = found->first[0] == name.first[0] && found->first[1] == name.first[1];
    double turned[2][3];
    for (int c = 0; c < 6; c++) turned[c / 3][c % 3] = same ? found->slide[c / 3][c % 3] : -found->slide[c / 3][c % 3];
    give(k, &k->place, found->push[0], turned[0], part * h * h);
    give(k, &k->speed, found->push[1], turned[1], part * h);
    if (!(s->calm > 0 && k->place.push > 0)) continue;
    k->rested = hk_impact_last(k, m, s->near) || (k->part < 1 && k->speed_then == 0);
  }
}

hk_status hk_warm_start_keep(hk_array *known, const hk_host *host, const hk_contact_solver *s, double h) {
  size_t pushing = 0, size = LEAST;
  for (size_t e = 0; e < s->count; e++) pushing += s->impact[e].place.push > 0;
  while (size < 2 * pushing) size *= 2;
  hk_status status = size > known->count ? host->resize(host, known, size) : HK_OK;
  if (status != HK_OK) return status;
  size = known->count;
  hk_warm_pair *table = known->item;
  memset(table, 0, size * sizeof *table);
  for (size_t e = 0; e < s->count; e++) {
    const hk_impact *k = &s->impact[e];
    if (!(k->place.push > 0)) continue;
    hk_warm_pair p = name_of(&k->pair);
    p.push[0] = k->place.push / (h * h), p.push[1] = k->speed.push / h;
    for (int c = 0; c < 3; c++) p.slide[0][c] = k->place.slide[c] / (h * h), p.slide[1][c] = k->speed.slide[c] / h;
    table[place_of(table, size, &p)] = p;
  }
  return HK_OK;
}
