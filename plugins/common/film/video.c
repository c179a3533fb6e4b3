#include "plugins/common/film/video.h"
#include "plugins/common/film/yuv_picture.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/wait.h>
#include <unistd.h>

enum { PATIENCE = 100 }; /* ms between two looks whether to stop */

bool hk_video_possible(void) {
  const char *path = getenv("PATH");
  char name[PATH_MAX];
  while (path && *path) {
    int length = (int)strcspn(path, ":");
    if (snprintf(name, sizeof name, "%.*s/ffmpeg", length, path) < (int)sizeof name && access(name, X_OK) == 0)
      return true;
    path += length + (path[length] == ':');
  }
  return false;
}

/* "./" keeps a name from being read as an option or a protocol. */
static bool safe_name(const char *name, char *out, size_t size) {
  return snprintf(out, size, "%s%s", *name == '/' ? "" : "./", name) < (int)size;
}

/* Keeps the last of what the program says. False: there is nothing more to read. */
static bool listen_to(hk_video *v) {
  if (v->length > sizeof v->said / 2) {
    memmove(v->said, v->said + v->length - sizeof v->said / 4, sizeof v->said / 4);
    v->length = sizeof v->said / 4;
  }
  ssize_t got = read(v->errors, v->said + v->length, sizeof v->said - 1 - v->length);
  if (got > 0) v->length += (size_t)got;
  return got > 0 || (got < 0 && (errno == EINTR || errno == EAGAIN));
}

static void last_line(hk_video *v, char *line, size_t size) {
  while (v->length && (v->said[v->length - 1] == '\n' || v->said[v->length - 1] == '\r')) v->length--;
  v->said[v->length] = 0;
  const char *start = strrchr(v->said, '\n');
  snprintf(line, size, "%s", start ? start + 1 : v->said);
}

/* In the child of a vfork, which only makes calls of the system: ffmpeg, which ends with this process, however that
 * ends. The end of `started` is closed by its start; where there is none the cause is written to it. */
static void become(const char *const arguments[], pid_t parent, const int ends[3], int started) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  bool fine = getppid() == parent;
  for (int k = 0; k < 3; k++) fine = fine && dup2(ends[k], k) >= 0;
  if (fine) execvp("ffmpeg", (char *const *)(uintptr_t)arguments);
  int cause = errno;
  ssize_t written = write(started, &cause, sizeof cause);
  _exit(written > 0 ? 127 : 126);
}

/* A pipe that programs started here do not inherit. */
static bool open_pipe(int ends[2]) {
  if (pipe(ends) != 0) return false;
  for (int k = 0; k < 2; k++) fcntl(ends[k], F_SETFD, FD_CLOEXEC);
  return true;
}

/* Starts the program with these as its standard files. The cause of the failure, or 0. */
static int start(const char *const arguments[], const int ends[3], pid_t *child) {
  int started[2], cause = 0;
  pid_t parent = getpid();
  if (!open_pipe(started)) return errno;
  *child = vfork(); /* no handlers of forks: other threads may hold what these would need */
  if (*child == 0) become(arguments, parent, ends, started[1]);
  if (*child < 0) cause = errno;
  close(started[1]);
  ssize_t got;
  do got = *child < 0 ? 0 : read(started[0], &cause, sizeof cause);
  while (got < 0 && errno == EINTR);
  close(started[0]);
  return cause;
}

static void close_if_open(int *file) {
  if (*file >= 0) close(*file);
  *file = -1;
}

/* Starts the program between two pipes, one for pictures and one for what it says. The cause of the failure, or 0. */
static int connect_to(hk_video *v, const char *const arguments[]) {
  int in[2] = {-1, -1}, out[2] = {-1, -1}, nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
  int cause = nothing >= 0 && open_pipe(in) && open_pipe(out) ? 0 : errno;
  if (!cause) cause = start(arguments, (const int[3]){in[0], nothing, out[1]}, &v->child);
  close_if_open(&in[0]), close_if_open(&out[1]), close_if_open(&nothing);
  v->pictures = in[1], v->errors = out[0];
  if (!cause) fcntl(v->pictures, F_SETFL, O_NONBLOCK), fcntl(v->errors, F_SETFL, O_NONBLOCK);
  return cause;
}

static int reap(hk_video *v) {
  int status = 0;
  close_if_open(&v->pictures), close_if_open(&v->errors);
  while (v->child > 0 && waitpid(v->child, &status, 0) < 0 && errno == EINTR) continue;
  v->child = 0;
  free(v->planes);
  v->planes = NULL;
  return status;
}

hk_video_result hk_video_begin(hk_video *v, int width, int height, int lanes, double fps, const char *file, char *why,
                               size_t size) {
  char output[PATH_MAX], rate[32], extent[32];
  *v = (hk_video){.width = width, .height = height, .lanes = lanes, .pictures = -1, .errors = -1};
  if (!safe_name(file, output, sizeof output)) {
    snprintf(why, size, "the name of the file is too long");
    return HK_VIDEO_FAILED;
  }
  memcpy(v->file, output, sizeof v->file);
  snprintf(rate, sizeof rate, "%.9g", fps);
  snprintf(extent, sizeof extent, "%dx%d", width, height);
  const char *const arguments[] = {"ffmpeg",     "-hide_banner", "-loglevel", "error",   "-nostdin",    "-y",
                                   "-f",         "rawvideo",     "-pix_fmt",  "yuv420p", "-video_size", extent,
                                   "-framerate", rate,           "-i",        "pipe:0",  "-c:v",        "libx264",
                                   "-preset",    "veryfast",     "-crf",      "18",      "-pix_fmt",    "yuv420p",
                                   "-movflags",  "+faststart",   output,      NULL};
  v->planes = malloc(hk_yuv_size(width, height));
  int cause = v->planes ? connect_to(v, arguments) : ENOMEM;
  if (!cause) return HK_VIDEO_MADE;
  snprintf(why, size, "%s", strerror(cause));
  reap(v);
  return cause == ENOENT ? HK_VIDEO_NO_PROGRAM : HK_VIDEO_FAILED;
}

bool hk_video_feed(hk_video *v, const unsigned char *rgba) {
  const unsigned char *at = v->planes;
  size_t left = hk_yuv_size(v->width, v->height);
  struct pollfd wait[2] = {{.fd = v->pictures, .events = POLLOUT}, {.fd = v->errors, .events = POLLIN}};
  hk_yuv_picture(v->lanes, v->width, v->height, rgba, v->planes);
  while (left) {
    if (poll(wait, 2, -1) < 0 && errno != EINTR) return false;
    if (wait[1].revents && !listen_to(v)) wait[1].fd = -1;
    if (wait[0].revents == 0) continue;
    ssize_t done = write(v->pictures, at, left);
    if (done < 0 && errno != EINTR && errno != EAGAIN) return false;
    if (done > 0) at += done, left -= (size_t)done;
  }
  return true;
}

void hk_video_kill(const hk_video *v) {
  if (v->child > 0) kill(v->child, SIGKILL);
}

/* Reads until the program closes its end. False: it is to stop. */
static bool wait_for_end(hk_video *v, const hk_stop *stop) {
  struct pollfd wait = {.fd = v->errors, .events = POLLIN};
  for (;;) {
    if (stop->asked(stop->context)) return false;
    if (poll(&wait, 1, PATIENCE) > 0 && !listen_to(v)) return true;
  }
}

void hk_video_abandon(hk_video *v) {
  hk_video_kill(v);
  reap(v);
  unlink(v->file);
}

hk_video_result hk_video_end(hk_video *v, const hk_stop *stop, char *why, size_t size) {
  close_if_open(&v->pictures);
  if (!wait_for_end(v, stop)) {
    hk_video_abandon(v);
    return HK_VIDEO_STOPPED;
  }
  int status = reap(v);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return HK_VIDEO_MADE;
  last_line(v, why, size);
  if (!*why) snprintf(why, size, "it ended with status %d", status);
  return HK_VIDEO_FAILED;
}
