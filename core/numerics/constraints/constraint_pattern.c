/* The pattern of the constraints' matrix A = S J W J^T S (constraint_matrix.c): the products of blocks that share a
 * particle are listed once per topology, so assembling A is one pass over them. Particles that are held permanently
 * couple no equations: many bars may hang on one pin. */
#include "core/numerics/constraints/constraints.h"

#include <stdlib.h>
#include <string.h>

void hk_constraint_matrix_free(hk_constraints *c) {
  free(c->equation_first);
  free(c->block_first);
  hk_block_matrix_free(&c->list);
  hk_block_matrix_free(&c->matrix);
  hk_rider_blocks_free(&c->riding);
  hk_rigid_groups_close(c);
  void *arrays[] = {c->J,        c->WJ,         c->pin,        c->term,      c->value,   c->full,      c->scale,
                    c->g,        c->c,          c->rhs,        c->solution,  c->place,   c->path_used, c->speed,
                    c->residual, c->moved,      c->correction, c->one_sided, c->implied, c->touches,   c->pushes,
                    c->allowed,  c->held,       c->rests,      c->lambda,    c->kept_x,  c->own,       c->J_end,
                    c->g_start,  c->rate_start, c->met,        c->bounce,    c->entry,   c->impulse};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  hk_releases_close(&c->releases);
  hk_linear_system linear = c->linear, mixed = c->mixed;
  linear.analyzed = mixed.analyzed = false;
  *c = (hk_constraints){.table = c->table,
                        .linear = linear,
                        .mixed = mixed,
                        .unsymmetric = c->unsymmetric,
                        .revision = c->revision + 1,
                        .jumped = c->jumped};
}

static hk_status no_memory(hk_dynamics *d) {
  return hk_error_set(d->error, HK_NO_MEMORY, "no memory for the constraints");
}

/* Numbers the equations of an instance, which start at 0 there, from `base` in the common list. */
typedef struct shifted {
  hk_pattern naming; /* first member */
  hk_block_matrix *list;
  uint32_t base;
  size_t count;
  bool out_of_range;
} shifted;

static void name_shifted(hk_pattern *pattern, uint32_t equation, uint32_t particle) {
  shifted *s = (shifted *)(void *)pattern;
  s->out_of_range |= equation >= s->count;
  s->list->naming.block(&s->list->naming, s->base + equation, particle);
}

static hk_status name_blocks(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  const hk_instances *list = &d->plugins->kind[HK_CONSTRAINT];
  c->equation_first = calloc(list->count + 1, sizeof *c->equation_first);
  c->block_first = calloc(list->count + 1, sizeof *c->block_first);
  if (!c->equation_first || !c->block_first) return no_memory(d);
  for (size_t k = 0; k < list->count; k++) {
    const hk_instance *instance = list->item[k], *outer = hk_enter(instance);
    c->equation_first[k + 1] = c->equation_first[k] + instance->plugin->constraint->count(instance->self);
    hk_leave(instance, outer);
  }
  c->equations = c->equation_first[list->count];
  hk_block_matrix_begin(&c->list, c->equations, d->state->model.n);
  for (size_t k = 0; k < list->count; k++) {
    const hk_instance *instance = list->item[k];
    size_t base = c->equation_first[k];
    shifted s = {{name_shifted}, &c->list, (uint32_t)base, c->equation_first[k + 1] - base, false};
    const hk_instance *outer = hk_enter(instance);
    instance->plugin->constraint->pattern(instance->self, &s.naming);
    hk_leave(instance, outer);
    if (s.out_of_range || c->list.out_of_range)
      return hk_error_set(d->error, HK_FAILED, "constraint '%s' names an equation or particle that is not there",
                          instance->label);
    c->block_first[k + 1] = c->list.named;
  }
  c->blocks = c->list.named;
  c->model = &d->state->model;
  return c->list.no_memory || hk_rider_blocks_spread(d) != HK_OK ? no_memory(d) : HK_OK;
}

static hk_status allocate(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  size_t m = c->equations + 1, b = c->blocks + 1;
  c->J = calloc(b, sizeof *c->J);
  c->WJ = calloc(b, sizeof *c->WJ);
  c->J_end = calloc(b, sizeof *c->J_end);
  c->pin = malloc(b * sizeof *c->pin);
  c->place = malloc(b * sizeof *c->place);
  c->full = calloc(m, sizeof *c->full);
  c->own = calloc(m, sizeof *c->own);
  c->scale = calloc(m, sizeof *c->scale);
  c->speed = calloc(m, sizeof *c->speed);
  c->lambda = calloc(m, sizeof *c->lambda);
  c->residual = calloc(m, sizeof *c->residual);
  c->correction = calloc(m, sizeof *c->correction);
  c->impulse = calloc(m, sizeof *c->impulse);
  c->moved = calloc(3 * d->state->model.n + 1, sizeof *c->moved);
  c->kept_x = calloc(3 * d->state->model.n + 1, sizeof *c->kept_x);
  bool **sets[] = {&c->one_sided, &c->implied, &c->touches, &c->pushes, &c->allowed, &c->held, &c->rests, &c->met};
  bool fine = true;
  for (size_t k = 0; k < sizeof sets / sizeof *sets; k++) {
    *sets[k] = calloc(m, sizeof **sets[k]);
    fine &= *sets[k] != NULL;
  }
  c->g = calloc(m, sizeof *c->g);
  c->g_start = calloc(m, sizeof *c->g_start);
  c->rate_start = calloc(m, sizeof *c->rate_start);
  c->c = calloc(m, sizeof *c->c);
  c->rhs = calloc(m, sizeof *c->rhs);
  c->solution = calloc(m, sizeof *c->solution);
  c->path_used = calloc(d->pins->count + 1, sizeof *c->path_used);
  fine &= c->J && c->WJ && c->pin && c->place && c->full && c->scale && c->g && c->g_start && c->rate_start && c->c &&
          c->rhs && c->solution;
  fine &= c->speed && c->lambda && c->residual && c->impulse && c->correction && c->moved && c->kept_x && c->own &&
          c->J_end;
  return fine && c->path_used ? hk_releases_open(d) : no_memory(d);
}

static void find_one_sided(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count; k++) {
    const hk_constraint *functions = d->plugins->kind[HK_CONSTRAINT].item[k]->plugin->constraint;
    c->has_speed |= functions->speed != NULL;
    if (!(functions->flags & HK_ONE_SIDED)) continue;
    for (size_t e = c->equation_first[k]; e < c->equation_first[k + 1]; e++) c->one_sided[e] = true;
    c->one_sided_count += c->equation_first[k + 1] - c->equation_first[k];
  }
}

/* Sets pin_of[i] to the pin of particle i and its place there, or UINT32_MAX. */
static void find_pins(hk_dynamics *d, uint32_t (*pin_of)[2]) {
  hk_constraints *c = d->constraints;
  memset(pin_of, 0xff, d->state->model.n * sizeof *pin_of);
  for (size_t k = 0; k < d->pins->count; k++)
    for (size_t j = 0; j < d->pins->item[k].count; j++) {
      uint32_t *at = pin_of[d->pins->item[k].index[j]];
      at[0] = (uint32_t)k;
      at[1] = (uint32_t)j;
    }
  for (size_t b = 0; b < c->blocks; b++) {
    c->pin[b] = pin_of[c->list.pair[b][1]][0];
    c->place[b] = pin_of[c->list.pair[b][1]][1];
    if (c->pin[b] != UINT32_MAX) c->path_used[c->pin[b]] = true;
  }
}

/* Sorts blocks by particle: those of particle i are order[start[i]..start[i+1]]. On entry `start` is n + 2 zeros. */
static void by_particle(const hk_dynamics *d, size_t *start, uint32_t *order) {
  const hk_constraints *c = d->constraints;
  size_t n = d->state->model.n;
  for (size_t b = 0; b < c->blocks; b++)
    if (!hk_constraint_held(d, c->pin[b])) start[c->list.pair[b][1] + 2]++;
  for (size_t i = 0; i < n; i++) start[i + 2] += start[i + 1];
  for (size_t b = 0; b < c->blocks; b++)
    if (!hk_constraint_held(d, c->pin[b])) order[start[c->list.pair[b][1] + 1]++] = (uint32_t)b;
}

static void name_pair(hk_constraints *c, size_t row, size_t column) {
  c->matrix.naming.block(&c->matrix.naming, (uint32_t)row, (uint32_t)column);
}

/* Lists the entries of A, and sorts the terms by them, otherwise as they are; `start` and `mirror`: scratch, for each
 * place in the values and one more, `start` zeros. */
static void sort_terms(hk_constraints *c, size_t *start, size_t *mirror, uint32_t (*sorted)[2]) {
  const size_t *place = c->matrix.slot + c->equations; /* of each term, and of its mirror */
  size_t places = c->matrix.row_start[c->equations];
  for (size_t e = 0; e < c->terms; e++) start[place[2 * e] + 1]++, mirror[place[2 * e]] = place[2 * e + 1];
  for (size_t p = 0; p < places; p++) {
    if (start[p + 1] > 0) c->entry[c->entries++] = (hk_constraint_entry){p, mirror[p], start[p]};
    start[p + 1] += start[p];
  }
  c->entry[c->entries].first = c->terms;
  for (size_t e = 0; e < c->terms; e++) memcpy(sorted[start[place[2 * e]]++], c->term[e], sizeof *sorted);
}

static bool make_entries(hk_constraints *c) {
  size_t places = c->matrix.row_start[c->equations] + 1;
  size_t *start = calloc(places, sizeof *start), *mirror = malloc(places * sizeof *mirror);
  uint32_t(*sorted)[2] = malloc((c->terms + 1) * sizeof *sorted);
  c->entry = malloc(places * sizeof *c->entry);
  bool fine = start && mirror && sorted && c->entry;
  if (fine) {
    sort_terms(c, start, mirror, sorted);
    free(c->term);
    c->term = sorted;
  } else {
    free(sorted);
  }
  free(start);
  free(mirror);
  return fine;
}

/* Both places of a product in A, as it and its mirror are the same number. */
static hk_status name_terms(hk_dynamics *d, const size_t *start, const uint32_t *order) {
  hk_constraints *c = d->constraints;
  size_t n = d->state->model.n, count = 0;
  for (size_t i = 0; i < n; i++) c->terms += (start[i + 1] - start[i]) * (start[i + 1] - start[i] - 1) / 2;
  c->term = malloc((c->terms + 1) * sizeof *c->term);
  if (!c->term) return no_memory(d);
  hk_block_matrix_begin(&c->matrix, c->equations, c->equations);
  for (size_t k = 0; k < c->equations; k++) name_pair(c, k, k);
  for (size_t i = 0; i < n; i++)
    for (size_t p = start[i]; p < start[i + 1]; p++)
      for (size_t q = p + 1; q < start[i + 1]; q++, count++) {
        bool rising = c->list.pair[order[p]][0] <= c->list.pair[order[q]][0];
        c->term[count][0] = order[rising ? p : q];
        c->term[count][1] = order[rising ? q : p];
        name_pair(c, c->list.pair[c->term[count][0]][0], c->list.pair[c->term[count][1]][0]);
        name_pair(c, c->list.pair[c->term[count][1]][0], c->list.pair[c->term[count][0]][0]);
      }
  if (hk_block_matrix_build(&c->matrix) != HK_OK || !make_entries(c)) return no_memory(d);
  c->value = calloc(c->matrix.row_start[c->equations] + 1, sizeof *c->value);
  return c->value ? HK_OK : no_memory(d);
}

hk_status hk_constraint_matrix_build(hk_dynamics *d) {
  size_t n = d->state->model.n;
  hk_constraint_matrix_free(d->constraints);
  hk_status status = name_blocks(d);
  if (status == HK_OK) status = allocate(d);
  if (status != HK_OK) return status;
  find_one_sided(d);
  status = hk_restitution_open(d);
  if (status != HK_OK) return status;
  uint32_t(*pin_of)[2] = malloc((n + 1) * sizeof *pin_of);
  uint32_t *order = malloc((d->constraints->blocks + 1) * sizeof *order);
  size_t *start = calloc(n + 2, sizeof *start);
  status = HK_NO_MEMORY;
  if (pin_of && order && start) {
    find_pins(d, pin_of);
    by_particle(d, start, order);
    status = name_terms(d, start, order);
  }
  free(pin_of);
  free(order);
  free(start);
  d->constraints->table.equations = d->constraints->equations;
  d->constraints->table.holonomic = d->constraints->equations > 0 && d->constraints->one_sided_count == 0;
  return status == HK_OK ? HK_OK : no_memory(d);
}
