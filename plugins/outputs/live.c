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
 *     keep                       write a checkpoint at the next frame, and end there: another run goes on from it
 *     hold ID X Y Z STRENGTH     the user's hand holds a particle and draws it there (m); release: it lets go
 * A pipe that is closed at its other end is no failure: the run goes on alone. */
#include "plugins/common/frame_data/gatherer.h"
#include "plugins/common/hand/hand.h"
#include "plugins/common/live/commands.h"
#include "plugins/common/live/messages.h"

#include <limits.h>
#include <sys/stat.h>
#include <time.h>

typedef struct live {
  int64_t messages_fd, commands_fd;
  bool forces;
  double origin[3]; /* m, of positions in messages; NAN: the middle of the start */

  const hk_host *host;
  const hk_hand *hand;
  const hk_interruption *interruption;
  const hk_checkpoints *checkpoints;
  hk_gatherer gatherer;
  hk_live_messages out;
  hk_live_commands in;
  double began_wall, began; /* s: clock and run, where the pace was set last */
  double pace;
  bool left_out; /* of the present frame its numbers alone were told */
  bool stopped;  /* and the reader knows it */
} live;

static const hk_param params[] = {
    {"messages", "", "descriptor of the pipe to which the messages are written; 0: none are",
     .integer = HK_AT(live, messages_fd), .limits = HK_WITHIN(0, 1 << 20)},
    {"commands", "", "descriptor of the pipe from which the commands are read; 0: none are",
     .integer = HK_AT(live, commands_fd), .limits = HK_WITHIN(0, 1 << 20)},
    {"forces", "", "whether frames have each force by itself, tension and stress: evaluations more per frame",
     .boolean = HK_AT(live, forces)},
    {"x", "m", "origin of the positions in messages; left out: the middle of the start",
     .number = HK_AT(live, origin[0]), .flags = HK_OPTIONAL},
    {"y", "m", "see x", .number = HK_AT(live, origin[1]), .flags = HK_OPTIONAL},
    {"z", "m", "see x", .number = HK_AT(live, origin[2]), .flags = HK_OPTIONAL},
    {0},
};

static double wall(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  live *l = self;
  l->host = host;
  l->hand = host->query(host, HK_HAND_INTERFACE);
  l->interruption = host->query(host, "interruption/1");
  l->checkpoints = host->query(host, "checkpoint/1");
  if (!l->checkpoints) return host->fail(host, HK_FAILED, "this hooke has no checkpoints for outputs");
  return l->hand ? hk_gatherer_choose(&l->gatherer, host, view->model, NULL) : HK_FAILED;
}

/* A scene may name this output, too: it must not reach the run's own files. */
static bool is_pipe(int64_t fd) {
  struct stat info;
  return fd == 0 || (fstat((int)fd, &info) == 0 && S_ISFIFO(info.st_mode));
}

/* Forces are evaluated for a frame that will be sent. */
static hk_status tell_state(live *l, const hk_view *view, const hk_frame *frame) {
  hk_status status = hk_gatherer_forces(&l->gatherer, view, frame);
  if (status == HK_OK) hk_live_send_state(&l->out, &l->gatherer.data, frame);
  return status;
}

static hk_status tell_frame(live *l, const hk_view *view, const hk_frame *frame) {
  l->left_out = false;
  if (l->out.queue.broken) return HK_OK;
  hk_status status = hk_gatherer_frame(&l->gatherer, view, frame, &(hk_tuples){0});
  if (status != HK_OK) return status;
  if (l->gatherer.changed) hk_live_send_topology(&l->out, &l->gatherer.data);
  l->left_out = !hk_live_send_numbers(&l->out, &l->gatherer.data, frame);
  return l->left_out ? HK_OK : tell_state(l, view, frame);
}

static hk_status open(void *self, const hk_view *view, const hk_frame *frame) {
  live *l = self;
  l->in = (hk_live_commands){.fd = (int)l->commands_fd, .strength = 1, .closed = l->commands_fd == 0};
  if (!is_pipe(l->messages_fd) || !is_pipe(l->commands_fd))
    return l->host->fail(l->host, HK_BAD_PARAM, "messages, commands: not a pipe: hooke run --watch opens them");
  if (l->messages_fd == 0) return HK_OK;
  if (!hk_live_open(&l->out, (int)l->messages_fd, l->origin))
    return l->host->fail(l->host, HK_NO_MEMORY, "no memory, or no thread, for the messages");
  hk_status status = hk_gatherer_open(&l->gatherer, view, frame, &(hk_tuples){0}, l->forces);
  if (status == HK_OK) hk_live_send_run(&l->out, &l->gatherer.data, frame);
  l->gatherer.dirty = true; /* its topology is told with its first frame */
  return status;
}

static hk_status topology(void *self, const hk_view *view) {
  live *l = self;
  (void)view;
  l->gatherer.dirty = true;
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

/* Tells whether the run stands still. The reader has the frame at which it does, also where it was too slow for it. */
static hk_status tell_doing(live *l, const hk_view *view, const hk_frame *frame, bool stopped) {
  if (!l->out.queue.open) return HK_OK;
  hk_status status = stopped && l->left_out ? tell_state(l, view, frame) : HK_OK;
  if (l->stopped != stopped) hk_live_send_doing(&l->out, stopped);
  l->left_out = false;
  l->stopped = stopped;
  return status;
}

/* Waits while the user has stopped the run, and for the clock. */
static hk_status wait_for_user(live *l, const hk_view *view, const hk_frame *frame) {
  static const double look = 0.1; /* s: a signal that came before the wait is seen after so much */
  double t = view->t;
  hk_status status = HK_OK;
  hk_live_read(&l->in, 0);
  for (double left;
       !l->in.closed && !l->in.keep && !interrupted(l) && ((left = ahead(l, t)) > 0 || hk_live_stopped(&l->in));) {
    bool stopped = hk_live_stopped(&l->in);
    if (stopped) status = tell_doing(l, view, frame, true);
    if (status != HK_OK) return status;
    hk_live_read(&l->in, stopped || left > look ? look : left);
    if (stopped) l->pace = -1; /* the time that it stood still does not count */
  }
  if (l->in.steps > 0) l->in.steps--;
  return l->in.paused ? HK_OK : tell_doing(l, view, frame, false);
}

/* The checkpoint is written once the frame is done with, and the reader, who knows its path by then, ends the run.
 * Frame 0 is none to go on from: the run begins with it. */
static hk_status keep(live *l, const hk_frame *frame) {
  static const double look = 0.1; /* s */
  char path[PATH_MAX];
  if (!l->in.keep || frame->index == 0) return HK_OK;
  l->in.keep = false;
  hk_status status = l->host->path(l->host, "changed.checkpoint", path, sizeof path);
  if (status == HK_OK) status = l->checkpoints->ask(l->checkpoints->self, path);
  if (status != HK_OK) return status;
  hk_live_send_kept(&l->out, path);
  while (!l->in.closed && !interrupted(l)) hk_live_read(&l->in, look);
  return HK_OK;
}

static hk_status frame(void *self, const hk_view *view, const hk_frame *frame) {
  live *l = self;
  hk_status status = l->out.queue.open ? tell_frame(l, view, frame) : HK_OK;
  if (status == HK_OK) status = wait_for_user(l, view, frame);
  if (status == HK_OK) status = keep(l, frame);
  if (status == HK_OK) l->hand->move(l->hand->self, view, 1 / frame->fps, l->in.held, l->in.place, l->in.strength);
  return status;
}

static hk_status close(void *self, hk_verdict verdict) {
  live *l = self;
  (void)verdict; /* the summary has it */
  hk_live_close(&l->out);
  return HK_OK;
}

static void destroy(void *self, const hk_host *host) {
  live *l = self;
  (void)host;
  hk_live_close(&l->out);
  hk_gatherer_free(&l->gatherer);
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
