/* sharing: what the services neighbours/1, octree/1 and bvh/1 answer at places made here, against a plain search over
 * all, for `hooke check`. A function of it returns nil, or what is wrong in a sentence; and what was asked. */
#include "tools/native/common/actor.h"
#include "tools/native/common/places.h"
#include "tools/native/common/plain_search.h"

#include <stdlib.h>
#include <string.h>

typedef struct question {
  hk_actor *actor;
  double *x;        /* n x 3 */
  const char *what; /* was asked last */
  hk_places places;
} question;

/* ask(actor, shape, seed): n as the actor's scene has. */
static question ask(lua_State *L) {
  question q = {.actor = hk_actor_at(L, 1), .places = {.shape = luaL_checkoption(L, 2, NULL, hk_places_names)}};
  q.places.seed = (uint64_t)luaL_checkinteger(L, 3);
  q.x = hk_table_memory(L, 3 * q.actor->n);
  hk_places_put(&q.places, q.x, q.actor->n);
  return q;
}

static const void *table_of(const hk_actor *a) { return a->instance->plugin->service->table(a->instance->self); }

/* Leaves nil, or the sentence; and what was asked. */
static int answer(lua_State *L, question *q, hk_status status, const char *wrong) {
  hk_guard_enter(NULL);
  if (status == HK_OK && !wrong)
    lua_pushnil(L);
  else if (status == HK_OK)
    lua_pushstring(L, wrong);
  else {
    hk_actor_push_said(L, q->actor);
    lua_pushfstring(L, "it fails with status %d at finite places: %s", (int)status, lua_tostring(L, -1));
  }
  lua_pushstring(L, q->what);
  return 2;
}

/* Of each place in turn: as they are, after moves that grow, and after one of a single particle. */
enum { MOVES = 8 };
static const char *const move_name[MOVES] = {"first",
                                             "after a move of 0.001 of the radius",
                                             "after 0.03 of the radius",
                                             "after 0.03 of the radius again",
                                             "after 0.1 of the radius",
                                             "after 0.5 of the radius",
                                             "after a move of one particle alone",
                                             "again at the same places"};
static const double move_size[MOVES] = {0, 0.001, 0.03, 0.03, 0.1, 0.5, 0, 0};

static void move(question *q, int k, double radius) {
  q->what = move_name[k];
  hk_places_move(&q->places, q->x, q->actor->n, move_size[k] * radius);
  if (k == 6 && q->actor->n) q->x[3 * (q->actor->n / 2)] += 0.9 * radius;
}

/* ---- neighbours/1 ---- */

/* neighbours(actor, shape, seed, radius): rows of that radius, then after moves, then of a larger one; smaller radii of
 * others change nothing. */
static int neighbours(lua_State *L) {
  question q = ask(L);
  double radius = luaL_checknumber(L, 4);
  hk_guard_enter("reach");
  const hk_neighbours *s = table_of(q.actor);
  hk_neighbour_rows rows = {0};
  hk_kept_rows kept = {0};
  hk_status status = s->reach(s->self, radius);
  const char *wrong = NULL;
  for (int k = 0; k < MOVES + 2 && status == HK_OK && !wrong; k++) {
    if (k < MOVES) move(&q, k, radius);
    if (k == MOVES) q.what = "after a smaller radius of another plugin", status = s->reach(s->self, 0.3 * radius);
    if (k == MOVES + 1) {
      q.what = "after a larger radius of another plugin";
      radius *= 1.6;
      status = s->reach(s->self, radius);
    }
    hk_guard_enter("rows");
    if (status == HK_OK) status = s->rows(s->self, &q.actor->view, q.x, &rows);
    if (status == HK_OK) wrong = hk_compare_rows(&rows, q.x, q.actor->n, radius);
    if (status == HK_OK && !wrong) wrong = hk_compare_with_kept(&kept, &rows);
  }
  hk_kept_rows_free(&kept);
  return answer(L, &q, status, wrong);
}

/* ---- octree/1 ---- */

/* The tree of all, and of two lists of as many, every third from the last on; or backwards, so that the points that
 * were asked for last are asked for again when they have moved. */
static const char *try_trees(question *q, const hk_octrees *s, uint32_t *list, bool backwards, hk_status *status) {
  const char *wrong = NULL;
  size_t n = q->actor->n;
  for (size_t turn = 0; turn < 3 && *status == HK_OK && !wrong; turn++) {
    hk_octree tree = {0};
    size_t some = backwards ? 2 - turn : turn;
    size_t count = some ? n / 3 : n;
    for (size_t k = 0; some && k < count; k++) list[k] = (uint32_t)(n - 3 * k - some);
    hk_guard_enter("tree");
    *status = s->tree(s->self, &q->actor->view, q->x, some ? list : NULL, count, &tree);
    if (*status == HK_OK) wrong = hk_compare_octree(&tree, q->x, some ? list : NULL, count, n);
  }
  return wrong;
}

/* octree(actor, shape, seed) */
static int octree(lua_State *L) {
  question q = ask(L);
  uint32_t *list = lua_newuserdatauv(L, (q.actor->n + 1) * sizeof *list, 0);
  hk_guard_enter("tree");
  const hk_octrees *s = table_of(q.actor);
  hk_status status = HK_OK;
  const char *wrong = NULL;
  for (int k = 0; k < MOVES && status == HK_OK && !wrong; k++) {
    move(&q, k, 0.1);
    wrong = try_trees(&q, s, list, k % 2 == 1, &status);
  }
  return answer(L, &q, status, wrong);
}

/* lost(actor): the status with a particle that is nowhere, and what is said. */
static int lost(lua_State *L) {
  hk_actor *a = hk_actor_at(L, 1);
  double *x = hk_table_memory(L, 3 * a->n);
  const char *interface = a->instance->plugin->service->interface;
  hk_places places = {.shape = 0, .seed = 5};
  hk_status status = HK_OK;
  hk_places_put(&places, x, a->n);
  x[3 * (a->n / 2) + 1] = NAN;
  hk_guard_enter(interface);
  if (strcmp(interface, "neighbours/1") == 0) {
    hk_neighbour_rows rows;
    const hk_neighbours *s = table_of(a);
    status = s->reach(s->self, 0.1);
    if (status == HK_OK) status = s->rows(s->self, &a->view, x, &rows);
  } else {
    hk_octree tree;
    const hk_octrees *s = table_of(a);
    status = s->tree(s->self, &a->view, x, NULL, a->n, &tree);
  }
  hk_guard_enter(NULL);
  lua_pushinteger(L, status);
  hk_actor_push_said(L, a);
  return 2;
}

/* ---- bvh/1 ---- */

static void boxes_at(hk_box *box, const double *x, size_t n) {
  for (size_t i = 0; i < n; i++)
    for (size_t c = 0; c < 3; c++) {
      double half = 0.01 + 0.02 * (double)((i + c) % 5);
      box[i].low[c] = x[3 * i + c] - half;
      box[i].high[c] = x[3 * i + c] + half;
    }
}

/* bvh(actor, shape, seed): boxes about the places, and a tree that is built once and then moved; in the end it is built
 * anew with fewer. */
static int bvh(lua_State *L) {
  question q = ask(L);
  size_t n = q.actor->n;
  hk_box *box = lua_newuserdatauv(L, (n + 1) * sizeof *box, 0);
  hk_guard_enter("build");
  const hk_bvh_service *s = table_of(q.actor);
  hk_bvh *tree = NULL;
  hk_status status = HK_OK;
  const char *wrong = NULL;
  memset(box, 0, (n + 1) * sizeof *box);
  for (int k = 0; k <= MOVES && status == HK_OK && !wrong; k++) {
    if (k < MOVES) move(&q, k, 0.3);
    if (k == MOVES) q.what = "built anew with fewer boxes", n = n / 2;
    boxes_at(box, q.x, n);
    hk_guard_enter(k == 0 || k == MOVES ? "build" : "move");
    status = k == 0 || k == MOVES ? s->build(s->self, box, n, &tree) : s->move(s->self, box, tree);
    if (status == HK_OK) wrong = hk_compare_bvh(tree, box, n);
  }
  return answer(L, &q, status, wrong);
}

/* shapes() -> the names of the places. */
static int shapes(lua_State *L) {
  lua_newtable(L);
  for (int k = 0; hk_places_names[k]; k++) {
    lua_pushstring(L, hk_places_names[k]);
    lua_rawseti(L, -2, k + 1);
  }
  return 1;
}

__attribute__((visibility("default"))) int luaopen_sharing(lua_State *L);

int luaopen_sharing(lua_State *L) {
  static const luaL_Reg functions[] = {{"neighbours", neighbours}, {"octree", octree}, {"bvh", bvh}, {"lost", lost},
                                       {"shapes", shapes},         {NULL, NULL}};
  luaL_newlib(L, functions);
  lua_pushcfunction(L, hk_actor_open);
  lua_setfield(L, -2, "open");
  lua_pushcfunction(L, hk_actor_watch);
  lua_setfield(L, -2, "watch");
  return 1;
}
