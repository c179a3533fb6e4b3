/* A run that somebody watches and drives: it tells what happens through one pipe, and is told what to do through
 * another. tools/watch.lua is at their other ends.
 *
 * Out go messages, each a letter in 4 bytes, the length of what follows in 4 bytes, and that (little-endian, in
 * plugins/common/live/messages.h): what the run has, its topology where that has changed, the numbers of every frame,
 * the frame itself. They are written by a thread of its own, so that the run never waits for the reader: where that is
 * slow, frames are left out, and the latest one that fits is next.
 *
 * In come lines, read at frames:
 *     pause | go | step          stop at the next frame; go on; go on for one frame
 *     pace X                     at most X s of the run in a second of the clock; 0: as fast as it can
 *     hold ID X Y Z STRENGTH     the user's hand holds a particle and draws it there (m); release: it lets go
 * A pipe that is closed at its other end is no failure: the run goes on alone. */
#include "plugins/common/film/obstacle_solids.h"
#include "plugins/common/hand/hand.h"
#include "plugins/common/live/commands.h"
#include "plugins/common/live/messages.h"
#include "plugins/common/obstacles/obstacles_service.h"

#include <sys/stat.h>
#include <time.h>

typedef struct live {
  int64_t messages_fd, commands_fd;
  bool forces;

  const hk_host *host;
  const hk_hand *hand;
  const hk_interruption *interruption;
  const hk_obstacles *all;
  hk_solid *solid;
  hk_mark_lists marks;
  hk_live_messages out;
  hk_live_commands in;
  bool told;                /* the topology as it is */
  double began_wall, began; /* s: clock and run, where the pace was set last */
  double pace;
} live;

/* clang-format off */
static const hk_param params[] = {
    {"messages", "", "descriptor of the pipe to which the messages are written; 0: none are", HK_INTEGER, {0}, 0, 1 << 20,
     offsetof(live, messages_fd), 0, NULL},
    {"commands", "", "descriptor of the pipe from which the commands are read; 0: none are", HK_INTEGER, {0}, 0, 1 << 20,
     offsetof(live, commands_fd), 0, NULL},
    {"forces", "", "whether frames have each force by itself, which costs an evaluation of it", HK_BOOLEAN, {0}, 0, 0,
     offsetof(live, forces), 0, NULL},
    {0},
};
/* clang-format on */

static double wall(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  live *l = self;
  (void)view;
  l->host = host;
  l->hand = host->query(host, HK_HAND_INTERFACE);
  l->interruption = host->query(host, "interruption/1");
  l->all = host->query(host, HK_OBSTACLES_INTERFACE);
  return l->hand && l->all ? HK_OK : HK_FAILED;
}

/* A scene may name this output, too: it must not reach the run's own files. */
static bool is_pipe(int64_t fd) {
  struct stat info;
  return fd == 0 || (fstat((int)fd, &info) == 0 && S_ISFIFO(info.st_mode));
}

/* All obstacles are known when outputs are opened. */
static hk_status find_surroundings(live *l, const hk_frame *frame) {
  size_t solids = l->all->shown->count;
  l->solid = l->host->allocate(l->host, (solids + 1) * sizeof *l->solid);
  if (!l->solid) return l->host->fail(l->host, HK_NO_MEMORY, "no memory for %zu obstacles", solids);
  hk_obstacle_solids(l->all->shown, false, l->solid);
  l->out.around = (hk_live_surroundings){solids, l->solid, &l->marks};
  return hk_marks_open(&l->marks, l->host, frame);
}

static hk_status tell_frame(live *l, const hk_view *view, const hk_frame *frame) {
  if (!l->told) hk_live_tell_topology(&l->out, view);
  l->told = true;
  hk_obstacle_solids(l->all->shown, false, l->solid);
  hk_status status = hk_marks_take(&l->marks, view, frame);
  if (status == HK_OK) hk_live_tell_frame(&l->out, view, frame);
  return status;
}

static hk_status open(void *self, const hk_view *view, const hk_frame *frame) {
  live *l = self;
  l->in = (hk_live_commands){.fd = (int)l->commands_fd, .strength = 1, .closed = l->commands_fd == 0};
  if (!is_pipe(l->messages_fd) || !is_pipe(l->commands_fd))
    return l->host->fail(l->host, HK_BAD_PARAM, "messages, commands: not a pipe: hooke run --watch opens them");
  if (l->messages_fd == 0) return HK_OK;
  if (!hk_live_open(&l->out, (int)l->messages_fd))
    return l->host->fail(l->host, HK_NO_MEMORY, "no memory, or no thread, for the messages");
  hk_status status = find_surroundings(l, frame);
  if (status == HK_OK) hk_live_tell_run(&l->out, view, frame, l->forces);
  return status;
}

static hk_status topology(void *self, const hk_view *view) {
  live *l = self;
  (void)view;
  l->told = false;
  return HK_OK;
}

static bool interrupted(const live *l) { return l->interruption && l->interruption->again(l->interruption->self); }

/* s until the clock has reached the run's time; a pace that was changed counts from now on. */
static double ahead(live *l, double t) {
  if (l->pace != l->in.pace) {
    l->pace = l->in.pace;
    l->began_wall = wall();
    l->began = t;
  }
  return l->pace > 0 ? (t - l->began) / l->pace - (wall() - l->began_wall) : 0;
}

/* Waits while the user has stopped the run, and for the clock. */
static void wait_for_user(live *l, double t) {
  static const double look = 0.1; /* s: a signal that came before the wait is seen after so much */
  hk_live_read(&l->in, 0);
  for (double left; !l->in.closed && !interrupted(l) && ((left = ahead(l, t)) > 0 || hk_live_stopped(&l->in));) {
    bool stopped = hk_live_stopped(&l->in);
    hk_live_read(&l->in, stopped || left > look ? look : left);
    if (stopped) l->pace = -1; /* the time that it stood still does not count */
  }
  if (l->in.steps > 0) l->in.steps--;
}

static hk_status frame(void *self, const hk_view *view, const hk_frame *frame) {
  live *l = self;
  hk_status status = l->out.queue.open ? tell_frame(l, view, frame) : HK_OK;
  if (status != HK_OK) return status;
  wait_for_user(l, view->t);
  l->hand->move(l->hand->self, view, 1 / frame->fps, l->in.held, l->in.place, l->in.strength);
  return HK_OK;
}

static hk_status close(void *self, hk_verdict verdict) {
  live *l = self;
  (void)verdict; /* the summary has it */
  hk_live_close(&l->out);
  return HK_OK;
}

static void destroy(void *self, const hk_host *host) {
  live *l = self;
  hk_live_close(&l->out);
  hk_marks_free(&l->marks);
  host->release(host, l->solid);
}

static const hk_output output = {.size = sizeof(hk_output), .open = open, .frame = frame, .close = close};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_OUTPUT,
    .name = "live",
    .summary = "tells what happens through a pipe, and is driven through another (hooke run --watch)",
    .reference = "",
    .instance_size = sizeof(live),
    .params = params,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .output = &output,
};
