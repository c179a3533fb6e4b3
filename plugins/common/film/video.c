#include "plugins/common/film/video.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
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

/* "./" keeps a name from being read as an option or a protocol; with `pattern`, % is written as %%. */
static bool safe_name(const char *name, bool pattern, const char *tail, char *out, size_t size) {
  size_t at = 0;
  if (*name != '/') out[at++] = '.', out[at++] = '/';
  for (; *name && at + 2 < size; name++) {
    if (pattern && *name == '%') out[at++] = '%';
    out[at++] = *name;
  }
  return !*name && at < size && snprintf(out + at, size - at, "%s", tail) < (int)(size - at);
}

/* Reads until the other end closes the pipe; keeps the last line. False: it is to stop. */
static bool last_line(int pipe, const hk_video_stop *stop, char *line, size_t size) {
  char tail[2048];
  size_t kept = 0;
  for (;;) {
    if (stop->asked(stop->context)) return false;
    if (kept > sizeof tail / 2) {
      memmove(tail, tail + kept - sizeof tail / 4, sizeof tail / 4);
      kept = sizeof tail / 4;
    }
    struct pollfd wait = {.fd = pipe, .events = POLLIN};
    if (poll(&wait, 1, PATIENCE) <= 0) continue;
    ssize_t got = read(pipe, tail + kept, sizeof tail - 1 - kept);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    kept += (size_t)got;
  }
  while (kept && (tail[kept - 1] == '\n' || tail[kept - 1] == '\r')) kept--;
  tail[kept] = 0;
  const char *start = strrchr(tail, '\n');
  snprintf(line, size, "%s", start ? start + 1 : tail);
  return true;
}

/* In the child: ffmpeg, which ends with this process, however that ends. The end of `started` is closed by its start;
 * where there is none the cause is written to it. */
static void become(const char *const arguments[], pid_t parent, int errors, int started) {
  int nothing = open("/dev/null", O_RDWR);
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  bool fine = getppid() == parent && dup2(nothing, 0) >= 0 && dup2(nothing, 1) >= 0 && dup2(errors, 2) >= 0;
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

/* The cause of the failure, or 0. */
static int start(const char *const arguments[], int errors, pid_t *child) {
  int started[2], cause = 0;
  pid_t parent = getpid();
  if (!open_pipe(started)) return errno;
  *child = fork();
  if (*child == 0) become(arguments, parent, errors, started[1]);
  if (*child < 0) cause = errno;
  close(started[1]);
  ssize_t got;
  do got = *child < 0 ? 0 : read(started[0], &cause, sizeof cause);
  while (got < 0 && errno == EINTR);
  close(started[0]);
  return cause;
}

static hk_video_result run(const char *const arguments[], const hk_video_stop *stop, char *why, size_t size) {
  int errors[2], status = 0;
  pid_t child = -1;
  if (!open_pipe(errors)) {
    snprintf(why, size, "%s", strerror(errno));
    return HK_VIDEO_FAILED;
  }
  int cause = start(arguments, errors[1], &child);
  close(errors[1]);
  if (cause) snprintf(why, size, "%s", strerror(cause));
  bool whole = cause || last_line(errors[0], stop, why, size);
  close(errors[0]);
  if (!whole) kill(child, SIGKILL);
  while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (cause) return cause == ENOENT ? HK_VIDEO_NO_PROGRAM : HK_VIDEO_FAILED;
  if (!whole) return HK_VIDEO_STOPPED;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return HK_VIDEO_MADE;
  if (!*why) snprintf(why, size, "it ended with status %d", status);
  return HK_VIDEO_FAILED;
}

hk_video_result hk_video_make(const char *folder, size_t count, double fps, const char *file, const hk_video_stop *stop,
                              char *why, size_t size) {
  char input[PATH_MAX], output[PATH_MAX], rate[32], frames[32];
  if (!safe_name(folder, true, "/%06d.png", input, sizeof input) ||
      !safe_name(file, false, "", output, sizeof output)) {
    snprintf(why, size, "the name of the file is too long");
    return HK_VIDEO_FAILED;
  }
  snprintf(rate, sizeof rate, "%.9g", fps);
  snprintf(frames, sizeof frames, "%zu", count);
  const char *const arguments[] = {
      "ffmpeg",  "-hide_banner", "-loglevel",  "error",     "-nostdin", "-y",  "-framerate",
      rate,      "-i",           input,        "-frames:v", frames,     "-vf", "crop=trunc(iw/2)*2:trunc(ih/2)*2",
      "-c:v",    "libx264",      "-preset",    "veryfast",  "-crf",     "18",  "-pix_fmt",
      "yuv420p", "-movflags",    "+faststart", output,      NULL};
  hk_video_result result = run(arguments, stop, why, size);
  if (result == HK_VIDEO_STOPPED) unlink(file);
  return result;
}
