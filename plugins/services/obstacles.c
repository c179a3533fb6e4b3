/* The obstacles of a run in one list, so that the corrector handles them together: a particle in a corner meets floor
 * and wall in one step, in the order of time (plugins/common/obstacles/obstacle.h). */
#include "plugins/common/obstacles/obstacles_service.h"

typedef struct obstacles {
  hk_obstacle_set set, shown;
  hk_obstacles table;
  const hk_host *host;
} obstacles;

static void show(void *self, hk_obstacle *o) {
  obstacles *s = self;
  if (s->shown.count < HK_OBSTACLES)
    s->shown.member[s->shown.count++] = o;
  else
    s->host->warn(s->host, "outputs show %d obstacles at most: one is left out", HK_OBSTACLES);
}

static hk_status enter(void *self, hk_obstacle *o) {
  obstacles *s = self;
  if (s->set.count == HK_OBSTACLES)
    return s->host->fail(s->host, HK_BAD_PARAM, "a scene has %d obstacles at most; join them in a mesh", HK_OBSTACLES);
  s->set.member[s->set.count++] = o;
  show(s, o);
  return HK_OK;
}

static hk_status carry(void *self, const bool *const *particles) {
  obstacles *s = self;
  if (s->set.carriers == HK_OBSTACLE_CARRIERS)
    return s->host->fail(s->host, HK_BAD_PARAM, "%d liquids meet obstacles at most: make several of them one",
                         HK_OBSTACLE_CARRIERS);
  s->set.carried[s->set.carriers++] = particles;
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  obstacles *s = self;
  (void)view;
  s->host = host;
  s->table = (hk_obstacles){self, enter, &s->set, show, &s->shown, carry};
  return HK_OK;
}

static const void *table(void *self) { return &((obstacles *)self)->table; }

static const hk_service service = {.size = sizeof(hk_service), .interface = HK_OBSTACLES_INTERFACE, .table = table};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SERVICE,
    .name = "obstacles",
    .summary = "all obstacles of a run, so that a particle meets several in one step in the order of time",
    .reference = "",
    .instance_size = sizeof(obstacles),
    .create = create,
    .service = &service,
};
