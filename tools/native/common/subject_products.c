/* Products of a force's Jacobian of its own (core/plugin/facets/implicit.h), at the state of the subject. */
#include "tools/native/common/subject.h"

/* Of a force's parameters and the masses: derivatives by them, and a direction in them, NULL where there are none. */
typedef struct lists {
  double **by;
  const double **along;
  size_t *count, rows;
  double *by_mass, *mass;
} lists;

/* How many derivatives a row has (facets/implicit.h, hk_transposed). */
static size_t numbers_of(const hk_instance *force, const hk_param *p) {
  hk_type type = hk_param_type(p);
  if (type == HK_PER_TUPLE) {
    const hk_tuples *list = hk_param_in(hk_param_list(force->plugin, p->list), force->self);
    return list->count > 0 ? list->count : 1;
  }
  return type == HK_NUMBER ? 1 : type == HK_VECTOR ? 3 : 0;
}

static double direction(size_t k) { return sin(1.7 * (double)k) + 0.3; }

/* In all numbers by which the force gives derivatives. */
static lists lists_of(lua_State *L, const hk_subject *s) {
  const hk_param *params = s->instance->plugin->params;
  lists l = {.by_mass = hk_table_memory(L, s->n), .mass = hk_table_memory(L, s->n)};
  size_t at = 0;
  while (params && params[l.rows].name) l.rows++;
  l.by = lua_newuserdatauv(L, (l.rows + 1) * sizeof *l.by, 0);
  l.along = lua_newuserdatauv(L, (l.rows + 1) * sizeof *l.along, 0);
  l.count = lua_newuserdatauv(L, (l.rows + 1) * sizeof *l.count, 0);
  for (size_t i = 0; i < s->n; i++) l.mass[i] = direction(i);
  for (size_t r = 0; r < l.rows; r++) {
    size_t count = l.count[r] = numbers_of(s->instance, &params[r]);
    double *list = hk_table_memory(L, count);
    for (size_t k = 0; k < count; k++) list[k] = direction(at++);
    l.by[r] = count > 0 ? hk_table_memory(L, count) : NULL;
    l.along[r] = count > 0 && !(r < 64 && s->force->implicit.not_by >> r & 1) ? list : NULL;
  }
  return l;
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
  if (!f->along || !f->transposed) return 0;
  double *u = hk_table_memory(L, 6 * size), *w = u + size, *by = w + 2 * size, *force = by + 2 * size, sum = 0;
  hk_table_read(L, 2, u, size);
  hk_table_read(L, 3, w, size);
  hk_table_read(L, 4, w + size, size);
  const lists l = lists_of(L, s);
  hk_subject_enter(s, "along");
  hk_status status = f->along(s->instance->self, &s->view, &(hk_tangent){w, w + size, l.along, l.mass, force}, 1);
  hk_subject_enter(s, "transposed");
  if (status == HK_OK)
    status = f->transposed(s->instance->self, &s->view, u, &(hk_transposed){by, by + size, l.by, l.by_mass});
  hk_subject_leave(s);
  for (size_t k = 0; k < size; k++) sum += fabs(u[k] * force[k]);
  for (size_t k = 0; k < 2 * size; k++) sum += fabs(by[k] * w[k]);
  double off = product(u, force, size) - product(by, w, 2 * size) - product(l.by_mass, l.mass, s->n);
  for (size_t r = 0; r < l.rows; r++) {
    double part = l.along[r] ? product(l.by[r], l.along[r], l.count[r]) : 0;
    off -= part;
    sum += fabs(part);
  }
  lua_pushnumber(L, status == HK_OK ? off : NAN);
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
