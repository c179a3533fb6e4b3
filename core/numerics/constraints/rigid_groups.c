/* Finds the free rigid groups of a scene, and keeps them by the loops of rigid/rigid.c. They are used where all
 * equations of the scene are of such groups: distances (HK_DISTANCES) between two to four particles that nothing pins,
 * all of them kept, and masses that are known; or where all others join groups as trees (rigid_links.c). Otherwise, and
 * where a group does not converge, the equations are solved together (constraint_projection.c), which goes on from
 * where this stopped. */
#include "core/engine/contract/contract.h"
#include "core/numerics/constraints/constraints.h"
#include "core/numerics/rigid/rigid.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 4, GRAIN = 32 }; /* particles of a group; bundles of a chunk */

struct hk_rigid_groups {
  size_t bundles;
  hk_rigid_bundle *bundle;
  hk_rigid_links *links; /* NULL: no equation is of two groups */
};

typedef hk_rigid_group group;

typedef struct search {
  const hk_dynamics *d;
  size_t count, kept_count;
  group *list;
  uint32_t *of; /* n: the group of a particle; UINT32_MAX: none */
  bool *kept;   /* equations: whether it is a distance within a group */
} search;

void hk_rigid_groups_close(hk_constraints *c) {
  if (c->groups) {
    free(c->groups->bundle);
    hk_rigid_links_close(c->groups->links);
  }
  free(c->groups);
  c->groups = NULL;
}

/* The lengths of the equations of constraint k; NULL: it keeps no distances, or they may change. */
static const hk_per_tuple *lengths_of(const hk_dynamics *d, size_t k) {
  const hk_instance *instance = d->plugins->kind[HK_CONSTRAINT].item[k];
  const hk_plugin *plugin = instance->plugin;
  if (!(plugin->constraint->flags & HK_DISTANCES) || instance->spec->timed_count) return NULL;
  for (const hk_param *p = plugin->params; p->name; p++)
    if (p->per_tuple) {
      const hk_per_tuple *lengths = hk_param_in(p, instance->self);
      return lengths->count ? lengths : NULL;
    }
  return NULL;
}

static int place_of(group *g, uint32_t particle) {
  int k = 0;
  while (k < g->size && g->particle[k] != particle) k++;
  if (k == g->size && k < MOST) g->particle[g->size++] = particle;
  return k;
}

static bool join(search *s, group *into, group *from) {
  for (int k = 0; k < from->size; k++) {
    if (place_of(into, from->particle[k]) == MOST) return false;
    s->of[from->particle[k]] = (uint32_t)(into - s->list);
  }
  from->size = 0;
  return true;
}

/* Puts both ends into one group; false: it has too many particles. */
static bool add_ends(search *s, uint32_t i, uint32_t j) {
  uint32_t *a = &s->of[i], *b = &s->of[j];
  if (*a == UINT32_MAX && *b == UINT32_MAX) {
    *a = *b = (uint32_t)s->count;
    s->list[s->count++] = (group){.size = 2, .particle = {i, j}};
    return true;
  }
  if (*a == UINT32_MAX) *a = *b;
  if (*b == UINT32_MAX) *b = *a;
  group *g = &s->list[*a];
  if (*a != *b) return join(s, g, &s->list[*b]);
  return place_of(g, i) < MOST && place_of(g, j) < MOST;
}

static bool is_free(const hk_dynamics *d, uint32_t i) {
  return d->state->pin[i] == HK_FREE && d->state->inverse_mass[i] > 0;
}

/* The pairs of particles of the equations as plugins name them. */
static uint32_t (*named_blocks(const hk_constraints *c, size_t *count, const size_t **first))[2] {
  *count = c->riding.given ? c->riding.given : c->blocks;
  *first = c->riding.given ? c->riding.first : c->block_first;
  return c->riding.given ? c->riding.pair : c->list.pair;
}

/* The equations of constraint k, whose lengths are known, that are between free particles. */
static bool add_pairs(search *s, size_t k) {
  const hk_constraints *c = s->d->constraints;
  const size_t *first, equations = c->equation_first[k + 1] - c->equation_first[k];
  size_t count;
  uint32_t(*pair)[2] = named_blocks(c, &count, &first);
  if (first[k + 1] - first[k] != 2 * equations) return false;
  for (size_t b = first[k], e = c->equation_first[k]; b < first[k + 1]; b += 2, e++) {
    const uint32_t i = pair[b][1], j = pair[b + 1][1];
    if (pair[b][0] != e || pair[b + 1][0] != e || i == j) return false;
    s->kept[e] = is_free(s->d, i) && is_free(s->d, j);
    if (s->kept[e] && !add_ends(s, i, j)) return false;
    s->kept_count += s->kept[e];
  }
  return true;
}

static bool find_groups(search *s) {
  const hk_constraints *c = s->d->constraints;
  for (size_t e = 0; e < c->equations; e++)
    if (c->implied[e]) return false;
  for (size_t k = 0; k < s->d->plugins->kind[HK_CONSTRAINT].count; k++)
    if (lengths_of(s->d, k) && !add_pairs(s, k)) return false;
  return s->kept_count > 0;
}

static void swap(uint32_t *a, uint32_t *b) {
  uint32_t kept = *a;
  *a = *b, *b = kept;
}

static void sort_particles(group *g) {
  for (int i = 1; i < g->size; i++)
    for (int j = i; j > 0 && g->particle[j] < g->particle[j - 1]; j--) swap(&g->particle[j], &g->particle[j - 1]);
}

static bool take_length(search *s, size_t e, uint32_t (*pair)[2], double length) {
  group *g = &s->list[s->of[pair[0][1]]];
  int i = place_of(g, pair[0][1]), j = place_of(g, pair[1][1]);
  if (g->square[i][j] > 0) return false; /* given twice */
  g->square[i][j] = g->square[j][i] = length * length;
  g->equation[i][j] = g->equation[j][i] = (uint32_t)e;
  g->pairs++;
  return true;
}

static bool take_lengths(search *s) {
  const hk_constraints *c = s->d->constraints;
  const size_t *first;
  size_t count;
  uint32_t(*pair)[2] = named_blocks(c, &count, &first);
  for (size_t g = 0; g < s->count; g++) sort_particles(&s->list[g]);
  for (size_t k = 0; k < s->d->plugins->kind[HK_CONSTRAINT].count; k++) {
    const hk_per_tuple *lengths = lengths_of(s->d, k);
    for (size_t e = c->equation_first[k]; e < c->equation_first[k + 1]; e++) {
      size_t at = e - c->equation_first[k];
      if (s->kept[e] && !take_length(s, e, pair + first[k] + 2 * at, hk_tuple_value(lengths, at))) return false;
    }
  }
  for (size_t g = 0; g < s->count; g++)
    if (s->list[g].pairs != s->list[g].size * (s->list[g].size - 1) / 2) return false;
  return true;
}

static bool fill_lane(const hk_dynamics *d, hk_rigid_bundle *b, int lane, const group *g) {
  int p = 0;
  for (int j = 0; j < g->size; j++) {
    b->particle[j][lane] = g->particle[j];
    b->weight[j][lane] = d->state->inverse_mass[g->particle[j]];
    for (int i = 0; i < j; i++) b->equation[p++][lane] = g->equation[i][j];
  }
  return hk_rigid_bundle_factorize(b, lane, (const double(*)[MOST])g->square);
}

static bool fill(const search *s, hk_rigid_groups *into) {
  bool fine = true;
  for (int size = 2; size <= MOST; size++) {
    hk_rigid_bundle *b = NULL;
    for (size_t g = 0; g < s->count && fine; g++) {
      if (s->list[g].size != size) continue;
      if (!b || b->used == HK_RIGID_BUNDLE) b = &into->bundle[into->bundles++];
      b->size = size;
      for (int lane = b->used; lane < HK_RIGID_BUNDLE && fine; lane++) fine = fill_lane(s->d, b, lane, &s->list[g]);
      b->used++;
    }
  }
  return fine;
}

/* Free particles of other equations are groups by themselves. */
static void add_singles(search *s) {
  const hk_constraints *c = s->d->constraints;
  const size_t *first;
  size_t count;
  uint32_t(*pair)[2] = named_blocks(c, &count, &first);
  for (size_t b = 0; b < count; b++) {
    uint32_t i = pair[b][1];
    if (s->of[i] != UINT32_MAX || !is_free(s->d, i)) continue;
    s->of[i] = (uint32_t)s->count;
    s->list[s->count++] = (group){.size = 1, .particle = {i}};
  }
}

static hk_status make_links(search *s) {
  const hk_constraints *c = s->d->constraints;
  if (s->kept_count == c->equations) return HK_OK;
  hk_status status =
      hk_rigid_links_find(s->d, s->list, s->count, s->of, s->kept, c->groups->bundles, &c->groups->links);
  if (!c->groups->links) hk_rigid_groups_close(s->d->constraints);
  return status;
}

/* The bundles of the groups that were found; without groups there are none. */
static hk_status make_bundles(search *s) {
  hk_constraints *c = s->d->constraints;
  if (!find_groups(s) || !take_lengths(s)) return HK_OK;
  add_singles(s);
  c->groups = calloc(1, sizeof *c->groups);
  if (c->groups) c->groups->bundle = calloc(s->count / HK_RIGID_BUNDLE + MOST, sizeof *c->groups->bundle);
  if (!c->groups || !c->groups->bundle) return HK_NO_MEMORY;
  if (!fill(s, c->groups)) hk_rigid_groups_close(c);
  return c->groups ? make_links(s) : HK_OK;
}

/* Equations that hold with equality and do not change with time. */
static bool is_constant(const hk_dynamics *d) {
  const hk_constraints *c = d->constraints;
  bool constant = c->one_sided_count == 0 && !c->has_speed && !d->pins->has_paths && !d->pins->has_slides;
  for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count; k++)
    constant &= d->plugins->kind[HK_CONSTRAINT].item[k]->spec->timed_count == 0;
  return constant;
}

hk_status hk_rigid_groups_find(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  hk_rigid_groups_close(c);
  if (c->equations == 0 || !is_constant(d)) return HK_OK;
  search s = {.d = d, .list = calloc(c->equations + d->state->model.n + 1, sizeof *s.list)};
  s.of = malloc((d->state->model.n + 1) * sizeof *s.of);
  s.kept = calloc(c->equations + 1, sizeof *s.kept);
  if (s.of) memset(s.of, 0xff, d->state->model.n * sizeof *s.of);
  hk_status status = s.list && s.of && s.kept ? make_bundles(&s) : HK_NO_MEMORY;
  free(s.list);
  free(s.of);
  free(s.kept);
  return status == HK_OK ? HK_OK : hk_error_set(d->error, status, "no memory for the rigid groups of the constraints");
}

/* ---- the corrections ---- */

typedef struct work {
  const hk_rigid_groups *groups;
  int lanes;
  double h, *from, *x, *v, *lambda;
  bool failed;
} work;

static void shake_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  work *w = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++)
    if (!hk_rigid_bundle_shake(w->lanes, &w->groups->bundle[k], w->from, w->h, w->x, w->v))
      __atomic_store_n(&w->failed, true, __ATOMIC_RELAXED);
}

static void rattle_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const work *w = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++)
    hk_rigid_bundle_rattle(w->lanes, &w->groups->bundle[k], w->x, 2 / w->h, w->v, w->lambda);
}

static bool shake_groups(hk_dynamics *d, double *from, double h, double *x, double *v) {
  work w = {d->constraints->groups, d->shared->lanes, h, from, x, v, NULL, false};
  hk_threads_for(d->shared->threads, w.groups->bundles, GRAIN, shake_chunk, &w);
  hk_riders_follow(d->constraints->model, x);
  hk_riders_follow(d->constraints->model, v);
  return !w.failed;
}

static void rattle_groups(hk_dynamics *d, double *x, double h, double *v) {
  work w = {d->constraints->groups, d->shared->lanes, h, NULL, x, v, d->constraints->lambda, false};
  hk_threads_for(d->shared->threads, w.groups->bundles, GRAIN, rattle_chunk, &w);
  hk_riders_follow(d->constraints->model, v);
}

bool hk_rigid_groups_shake(hk_dynamics *d, double t_from, double *from, double t, double h, double *x, double *v) {
  const hk_rigid_groups *g = d->constraints->groups;
  if (!g->links) return shake_groups(d, from, h, x, v);
  return hk_rigid_links_shake(d, g->links, g->bundle, g->bundles, &(hk_rattle_step){t_from, t, h, from, x, v});
}

bool hk_rigid_groups_rattle(hk_dynamics *d, double t, double *x, double h, double *v) {
  if (d->constraints->groups->links) return hk_rigid_links_rattle(d, d->constraints->groups->links, t, x, v);
  rattle_groups(d, x, h, v);
  return true;
}
