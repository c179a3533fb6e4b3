/* Products of a force's Jacobian of its own (core/plugin/facets/implicit.h), at the state of the subject. */
#include "tools/native/common/subject.h"

#include "core/numerics/sensitivity/force_slopes.h"

/* The lists of a force's parameters: derivatives by them, and a direction in them. */
typedef struct lists {
  hk_force_slopes slopes;
  const double **row;
  double *mass, *numbers;
} lists;

static size_t rows_of(const hk_instance *force) {
  size_t rows = 0;
  while (force->plugin->params && force->plugin->params[rows].name) rows++;
  return rows;
}

static double direction(size_t k) { return sin(1.7 * (double)k) + 0.3; }

/* A direction in all numbers by which the force gives derivatives, and in the masses. */
static bool open_lists(lists *l, lua_State *L, hk_subject *s) {
  const hk_dynamics *d = &s->run->dynamics;
  size_t rows = rows_of(s->instance), at = 0;
  if (hk_force_slopes_open(&l->slopes, d, NULL) != HK_OK || !l->slopes.force[s->index]) return false;
  l->row = (const double **)lua_newuserdatauv(L, (rows + 1) * sizeof *l->row, 0);
  l->mass = hk_table_memory(L, s->n);
  for (size_t i = 0; i < s->n; i++) l->mass[i] = direction(i);
  for (size_t r = 0; r < rows; r++) {
    size_t count = hk_force_row_numbers(s->instance, &s->instance->plugin->params[r]);
    bool given = count > 0 && !(r < 64 && s->force->implicit.not_by >> r & 1);
    double *list = hk_table_memory(L, count);
    for (size_t k = 0; k < count; k++) list[k] = direction(at++);
    l->row[r] = given ? list : NULL;
  }
  return true;
}

static double product(const double *a, const double *b, size_t count) {
  double sum = 0;
  for (size_t k = 0; k < count; k++) sum += a[k] * b[k];
  return sum;
}

int hk_subject_transposed(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  if (!s->force->implicit.transposed) return 0;
  double start = luaL_optnumber(L, 3, 0), *u = hk_table_memory(L, s->size), *into = hk_table_memory(L, 2 * s->size);
  hk_table_read(L, 2, u, s->size);
  for (size_t k = 0; k < 2 * s->size; k++) into[k] = start;
  hk_subject_enter(s, "transposed");
  hk_status status =
      s->force->implicit.transposed(s->instance->self, &s->view, u, &(hk_transposed){.x = into, .v = into + s->size});
  hk_subject_leave(s);
  for (size_t k = 0; k < 2 * s->size; k++) into[k] -= start;
  hk_table_push(L, into, s->size);
  hk_table_push(L, into + s->size, s->size);
  lua_pushboolean(L, status == HK_OK);
  return 3;
}

/* Twice at once: the second time backwards, so that a force that goes along the first one alone is found. */
int hk_subject_along(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  if (!s->force->implicit.along) return 0;
  size_t size = s->size;
  double start = luaL_optnumber(L, 4, 0), *x = hk_table_memory(L, 4 * size), *into = hk_table_memory(L, 2 * size);
  hk_table_read(L, 2, x, size);
  hk_table_read(L, 3, x + size, size);
  for (size_t k = 0; k < 2 * size; k++) x[2 * size + k] = -x[k], into[k] = start;
  const hk_tangent two[] = {{.x = x, .v = x + size, .force = into},
                            {.x = x + 2 * size, .v = x + 3 * size, .force = into + size}};
  hk_subject_enter(s, "along");
  hk_status status = s->force->implicit.along(s->instance->self, &s->view, two, 2);
  hk_subject_leave(s);
  for (size_t k = 0; k < 2 * size; k++) into[k] -= start;
  hk_table_push(L, into, size);
  hk_table_push(L, into + size, size);
  lua_pushboolean(L, status == HK_OK);
  return 3;
}

int hk_subject_pair(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  const hk_implicit_facet *f = &s->force->implicit;
  size_t size = s->size;
  lists l = {.row = NULL};
  if (!f->along || !f->transposed) return 0;
  double *u = hk_table_memory(L, 6 * size), *w = u + size, *by = w + 2 * size, *force = by + 2 * size, left = 0,
         sum = 0;
  hk_table_read(L, 2, u, size);
  hk_table_read(L, 3, w, size);
  hk_table_read(L, 4, w + size, size);
  bool parameters = open_lists(&l, L, s);
  double *const *row = parameters ? (double *const *)l.slopes.force[s->index] : NULL;
  hk_subject_enter(s, "along");
  hk_status status =
      f->along(s->instance->self, &s->view,
               &(hk_tangent){w, w + size, parameters ? l.row : NULL, parameters ? l.mass : NULL, force}, 1);
  hk_subject_enter(s, "transposed");
  if (status == HK_OK)
    status = f->transposed(s->instance->self, &s->view, u,
                           &(hk_transposed){by, by + size, row, parameters ? l.slopes.mass : NULL});
  hk_subject_leave(s);
  for (size_t k = 0; k < size; k++) sum += fabs(u[k] * force[k]);
  for (size_t k = 0; k < 2 * size; k++) sum += fabs(by[k] * w[k]);
  left = product(u, force, size) - product(by, w, 2 * size);
  for (size_t r = 0; parameters && r < rows_of(s->instance); r++) {
    size_t count = hk_force_row_numbers(s->instance, &s->instance->plugin->params[r]);
    if (l.row[r]) left -= product(row[r], l.row[r], count), sum += fabs(product(row[r], l.row[r], count));
  }
  if (parameters) left -= product(l.slopes.mass, l.mass, s->n);
  hk_force_slopes_close(&l.slopes, &s->run->dynamics);
  lua_pushnumber(L, status == HK_OK ? left : NAN);
  lua_pushnumber(L, sum);
  return 2;
}

int hk_subject_bilinear(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  if (!s->force->implicit.bilinear) return 0;
  size_t size = s->size;
  double start = luaL_optnumber(L, 7, 0), *u = hk_table_memory(L, 2 * size), *by = hk_table_memory(L, 2 * size);
  hk_table_read(L, 3, u, size);
  hk_table_read(L, 4, u + size, size);
  for (size_t k = 0; k < 2 * size; k++) by[k] = start;
  const hk_bilinear form = {.want = (unsigned)luaL_checkinteger(L, 2),
                            .by_x = luaL_checknumber(L, 5),
                            .by_v = luaL_checknumber(L, 6),
                            .u = u,
                            .w = u + size};
  hk_subject_enter(s, "bilinear");
  hk_status status =
      s->force->implicit.bilinear(s->instance->self, &s->view, &form, &(hk_transposed){.x = by, .v = by + size});
  hk_subject_leave(s);
  for (size_t k = 0; k < 2 * size; k++) by[k] -= start;
  hk_table_push(L, by, size);
  hk_table_push(L, by + size, size);
  lua_pushboolean(L, status == HK_OK);
  return 3;
}
