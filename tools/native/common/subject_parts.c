/* The parts of a force, one by one. While a part is added, positions and velocities of all blocks that it says it does
 * not touch are NaN, as they may not have been computed yet in a run, and nothing may be added there. */
#include "tools/native/common/subject.h"

#include <string.h>

typedef struct trial {
  hk_subject *s;
  hk_front front;
  double *x, *v, *before; /* n x 3 */
  double *whole;  /* n x 3, the force with all positions known: where it is not finite nothing follows from parts */
  size_t written; /* a particle outside of its part that was written to; n: none */
  size_t used;    /* one whose force is not finite, as others were used for it that a part has not; n: none */
} trial;

/* Whether part `part` touches block b. */
static bool touches(const trial *t, size_t part, size_t b) {
  const hk_front *w = &t->front;
  if (part >= w->partition.blocks) return w->deferred[b];
  return b == part || (w->lowest[part] <= b && b < part);
}

static void show(trial *t, size_t part) {
  const hk_subject *s = t->s;
  const double *x = s->x.at, *v = s->v.at;
  for (size_t i = 0; i < s->n; i++) {
    bool seen = touches(t, part, i >> t->front.partition.bits);
    for (size_t c = 3 * i; c < 3 * i + 3; c++) {
      t->x[c] = seen ? x[c] : NAN;
      t->v[c] = seen ? v[c] : NAN;
    }
  }
}

static bool is_finite(const double f[3]) { return isfinite(f[0]) && isfinite(f[1]) && isfinite(f[2]); }

static void look(trial *t, size_t part) {
  const double *F = t->s->F.at;
  for (size_t i = 0; i < t->s->n; i++) {
    bool has = touches(t, part, i >> t->front.partition.bits);
    if (!has && memcmp(F + 3 * i, t->before + 3 * i, 3 * sizeof *F) != 0) t->written = i;
    if (has && !is_finite(F + 3 * i) && is_finite(t->before + 3 * i) && is_finite(t->whole + 3 * i)) t->used = i;
  }
}

static void add_all(trial *t, double *power) {
  hk_subject *s = t->s;
  hk_view view = s->view;
  view.x = t->x, view.v = t->v, view.power = power;
  size_t parts = s->force->parts.touch ? t->front.partition.parts : t->front.partition.blocks;
  for (size_t part = parts; part-- > 0;) {
    show(t, part);
    memcpy(t->before, s->F.at, s->size * sizeof *t->before);
    hk_subject_enter(s, "add_part");
    s->force->own.add_part(s->instance->self, &view, part, s->F.at);
    hk_subject_leave(s);
    look(t, part);
  }
}

static void add_whole(trial *t) {
  hk_subject *s = t->s;
  double power = 0;
  hk_view view = s->view;
  view.power = &power;
  memset(s->F.at, 0, s->F.bytes);
  hk_subject_enter(s, "add");
  bool fine = hk_force_add(s->instance, &view, s->F.at) == HK_OK; /* one with parts may have no `add` */
  hk_subject_leave(s);
  if (fine) memcpy(t->whole, s->F.at, s->size * sizeof *t->whole);
}

int hk_subject_parts(lua_State *L) {
  hk_subject *s = hk_subject_at(L, 1);
  trial t = {.s = s, .written = s->n, .used = s->n};
  double power = 0;
  if (!s->force->own.add_part) return 0;
  t.x = hk_table_memory(L, s->size);
  t.v = hk_table_memory(L, s->size);
  t.before = hk_table_memory(L, s->size);
  t.whole = hk_table_memory(L, s->size);
  if (!hk_front_begin(&t.front, s->view.model->partition)) return luaL_error(L, "no memory");
  hk_part_use use = hk_front_use(&t.front);
  hk_subject_enter(s, "parts");
  if (s->force->parts.touch) s->force->parts.touch(s->instance->self, &s->view, &use);
  hk_subject_leave(s);
  add_whole(&t);
  memset(s->F.at, 0, s->F.bytes);
  add_all(&t, &power);
  hk_front_close(&t.front);
  hk_table_push(L, s->F.at, s->size);
  lua_pushnumber(L, power);
  lua_pushinteger(L, t.written < s->n ? (lua_Integer)t.written + 1 : 0);
  lua_pushinteger(L, t.used < s->n ? (lua_Integer)t.used + 1 : 0);
  return 4;
}
