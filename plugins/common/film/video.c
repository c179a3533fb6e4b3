#include "plugins/common/film/video.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

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

/* Reads until the other end closes the pipe; keeps the last line. */
static void last_line(int pipe, char *line, size_t size) {
  char tail[2048];
  size_t kept = 0;
  for (;;) {
    if (kept > sizeof tail / 2) {
      memmove(tail, tail + kept - sizeof tail / 4, sizeof tail / 4);
      kept = sizeof tail / 4;
    }
    ssize_t got = read(pipe, tail + kept, sizeof tail - 1 - kept);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    kept += (size_t)got;
  }
  while (kept && (tail[kept - 1] == '\n' || tail[kept - 1] == '\r')) kept--;
  tail[kept] = 0;
  const char *start = strrchr(tail, '\n');
  snprintf(line, size, "%s", start ? start + 1 : tail);
}

static int spawn(const char *const arguments[], const int out[2], pid_t *child) {
  posix_spawn_file_actions_t actions;
  int error = posix_spawn_file_actions_init(&actions);
  if (error) return error;
  error = posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  if (!error) error = posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  if (!error) error = posix_spawn_file_actions_adddup2(&actions, out[1], 2);
  if (!error) error = posix_spawnp(child, "ffmpeg", &actions, NULL, (char *const *)arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

static hk_video_result run(const char *const arguments[], char *why, size_t size) {
  int out[2], status = 0;
  pid_t child;
  if (pipe(out) != 0) {
    snprintf(why, size, "%s", strerror(errno));
    return HK_VIDEO_FAILED;
  }
  for (int k = 0; k < 2; k++) fcntl(out[k], F_SETFD, FD_CLOEXEC);
  int error = spawn(arguments, out, &child);
  close(out[1]);
  if (error) snprintf(why, size, "%s", strerror(error));
  if (!error) last_line(out[0], why, size);
  close(out[0]);
  if (error) return error == ENOENT ? HK_VIDEO_NO_PROGRAM : HK_VIDEO_FAILED;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return HK_VIDEO_MADE;
  if (!*why) snprintf(why, size, "it ended with status %d", status);
  return HK_VIDEO_FAILED;
}

hk_video_result hk_video_make(const char *folder, size_t count, double fps, const char *file, char *why, size_t size) {
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
  return run(arguments, why, size);
}
