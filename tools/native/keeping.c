/* keeping: the services grip/1 and obstacles/1, which keep what they are told, for `hooke check`: at every moment they
 * have to answer what follows from what they were told. A function of it returns nil, or what is wrong in a sentence;
 * and what was asked. */
#include "plugins/common/hand/hand.h"
#include "plugins/common/obstacles/obstacles_service.h"
#include "tools/native/common/actor.h"

#include <string.h>

static const void *table_of(const hk_actor *a) { return a->instance->plugin->service->table(a->instance->self); }

static int answer(lua_State *L, const char *wrong, const char *asked) {
  hk_guard_enter(NULL);
  lua_pushstring(L, wrong); /* nil of NULL */
  lua_pushstring(L, asked);
  return 2;
}

/* ---- grip/1 ---- */

static const double frame = 0.04, strength = 1.5; /* s */

/* What the hand is told at a frame. `id` 0: it lets go; beyond the particles: one that is not there. */
typedef struct told {
  const char *what;
  size_t id;
  double place[3];
} told;

enum { NOBODY = 1000000000 };
static const told script[] = {{"takes particle 1", 1, {1, 2, 3}},
                              {"moves it", 1, {-1, 0, 4}},
                              {"moves it again", 1, {-1, 0.5, 4}},
                              {"takes particle 2 in its place", 2, {5, 5, 5}},
                              {"lets it go", 0, {9, 9, 9}},
                              {"holds nothing", 0, {0, 0, 0}},
                              {"takes a particle that is not there", NOBODY, {1, 1, 1}},
                              {"takes particle 2 again", 2, {0.5, 0.25, 1}}};

static bool near(double a, double b) { return fabs(a - b) <= 1e-12 * fmax(1, fabs(b)); }

static bool at(const double a[3], const double b[3]) {
  return near(a[0], b[0]) && near(a[1], b[1]) && near(a[2], b[2]);
}

/* The way from one frame to the next is even. */
static const char *compare_between(const hk_hand *s, double t, const hk_grip *from, const hk_grip *to) {
  for (int k = 1; k < 4; k++) {
    hk_grip now = s->grip(s->self, t + k * frame / 4);
    double part = k / 4.0, place[3];
    for (int c = 0; c < 3; c++) place[c] = from->place[c] + part * (to->place[c] - from->place[c]);
    if (!at(now.place, place)) return "between two frames it does not move evenly";
    if (!near(now.hold, from->hold + part * (to->hold - from->hold))) return "its hold does not grow or fade evenly";
    if (now.id != from->id) return "between two frames it holds another particle";
  }
  return NULL;
}

/* `before`: at the time of the move, ahead of it. */
static const char *compare_grip(const hk_actor *a, const hk_hand *s, const told *now, double t, const hk_grip *before) {
  hk_grip from = s->grip(s->self, t), to = s->grip(s->self, t + frame), later = s->grip(s->self, t + 3 * frame);
  bool there = now->id >= 1 && now->id <= a->n, other = now->id && now->id != before->id;
  size_t holds = there ? now->id : now->id || before->hold == 0 ? 0 : before->id;
  if (from.id != holds) return "it does not hold the particle that it was told";
  if (holds && !near(from.hold, other ? 0 : before->hold)) return "its hold jumps at a frame";
  if (holds && !at(from.place, other ? a->view.x + 3 * hk_model_find(a->view.model, (uint32_t)holds) : before->place))
    return other ? "it does not take a particle where it is" : "its place jumps at a frame";
  if (!near(to.hold, there))
    return there ? "it does not hold at the next frame" : "it has not let go by the next frame";
  if (there && !at(to.place, now->place)) return "it is not where it was told to be at the next frame";
  if (there && !near(to.strength, strength)) return "its strength is not the one that it was told";
  if (!near(to.frame, frame)) return "its time from frame to frame is not the one that it was told";
  if (!at(later.place, to.place) || !near(later.hold, to.hold)) return "after the next frame it goes on without a word";
  return compare_between(s, t, &from, &to);
}

/* grip(actor): of a scene of two particles or more. */
static int grip(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  const hk_hand *s = table_of(a);
  const char *wrong = NULL, *what = "before it was told of anything";
  hk_guard_enter("grip");
  hk_grip before = s->grip(s->self, 0);
  if (before.id != 0 || before.hold != 0) wrong = "it holds a particle";
  for (size_t k = 0; k < sizeof script / sizeof *script && !wrong; k++) {
    double t = frame * (double)k;
    a->view.t = t;
    what = script[k].what;
    hk_guard_enter("grip");
    before = s->grip(s->self, t);
    hk_guard_enter("move");
    s->move(s->self, &a->view, frame, (uint32_t)script[k].id, script[k].place, strength);
    hk_guard_enter("grip");
    wrong = compare_grip(a, s, &script[k], t, &before);
  }
  return answer(L, wrong, what);
}

/* ---- obstacles/1 ---- */

static bool has(const hk_obstacle_set *set, hk_obstacle *const *list, size_t count) {
  bool same = set->count == count;
  for (size_t k = 0; k < count && same; k++) same = set->member[k] == list[k];
  return same;
}

/* obstacles(actor): every third one is shown only, until there are more than a run may have. */
static int obstacles(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  hk_obstacle *one = lua_newuserdatauv(L, 2 * HK_OBSTACLES * sizeof *one, 0), *entered[HK_OBSTACLES],
              *all[HK_OBSTACLES];
  const hk_obstacles *s = table_of(a);
  const char *wrong = NULL;
  size_t in = 0, shown = 0;
  memset(one, 0, 2 * HK_OBSTACLES * sizeof *one);
  for (size_t k = 0; k < 2 * HK_OBSTACLES && in < HK_OBSTACLES && !wrong; k++) {
    bool enters = k % 3 != 2 || shown == HK_OBSTACLES;
    hk_guard_enter(enters ? "enter" : "show");
    if (!enters)
      s->show(s->self, one + k);
    else if (s->enter(s->self, one + k) != HK_OK)
      wrong = "an obstacle is refused that there is room for";
    if (enters) entered[in++] = one + k;
    if (shown < HK_OBSTACLES) all[shown++] = one + k;
    if (!wrong && !has(s->set, entered, in)) wrong = "its list has not all that were entered, in that order";
    if (!wrong && !has(s->shown, all, shown))
      wrong = "its list for outputs has not all that were entered or shown, in order";
  }
  hk_guard_enter("enter");
  if (!wrong && s->enter(s->self, one) == HK_OK) wrong = "it takes more obstacles than its list has room for";
  if (!wrong && !has(s->set, entered, in)) wrong = "an obstacle that it refuses changes its list";
  hk_guard_enter(NULL);
  hk_actor_push_said(L, a);
  if (!wrong && !*lua_tostring(L, -1)) wrong = "it refuses an obstacle and does not say why";
  return answer(L, wrong, "obstacles entered and shown in turn");
}

__attribute__((visibility("default"))) int luaopen_keeping(lua_State *L);

int luaopen_keeping(lua_State *L) {
  static const luaL_Reg functions[] = {{"grip", grip}, {"obstacles", obstacles}, {NULL, NULL}};
  luaL_newlib(L, functions);
  lua_pushcfunction(L, hk_actor_open);
  lua_setfield(L, -2, "open");
  lua_pushcfunction(L, hk_actor_watch);
  lua_setfield(L, -2, "watch");
  return 1;
}
