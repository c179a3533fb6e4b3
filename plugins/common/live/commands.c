#include "plugins/common/live/commands.h"

#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void hold(hk_live_commands *c, const char *line) {
  double place[3], strength;
  unsigned id;
  if (sscanf(line, "hold %u %lf %lf %lf %lf", &id, &place[0], &place[1], &place[2], &strength) != 5) return;
  for (int k = 0; k < 3; k++)
    if (!isfinite(place[k])) return;
  if (!(strength > 0 && isfinite(strength))) return;
  c->held = id;
  c->strength = strength;
  memcpy(c->place, place, sizeof place);
}

/* A line that means nothing here changes nothing. */
static void obey(hk_live_commands *c, const char *line) {
  double pace;
  hold(c, line);
  if (strcmp(line, "release") == 0) c->held = 0;
  if (strcmp(line, "keep") == 0) c->keep = true;
  if (strcmp(line, "pause") == 0) c->paused = true;
  if (strcmp(line, "go") == 0) c->paused = false;
  if (strcmp(line, "pause") == 0 || strcmp(line, "go") == 0) c->steps = 0;
  if (strcmp(line, "step") == 0) c->paused = true, c->steps++;
  if (sscanf(line, "pace %lf", &pace) == 1 && pace >= 0 && isfinite(pace)) c->pace = pace;
}

static void take(hk_live_commands *c, const char *bytes, size_t count) {
  for (size_t k = 0; k < count; k++) {
    if (bytes[k] != '\n') {
      if (c->length + 1 < sizeof c->text) c->text[c->length++] = bytes[k];
      continue;
    }
    c->text[c->length] = 0;
    c->length = 0;
    obey(c, c->text);
  }
}

static bool readable(int fd, double seconds) {
  struct pollfd p = {.fd = fd, .events = POLLIN};
  return poll(&p, 1, (int)ceil(1e3 * seconds)) > 0;
}

void hk_live_read(hk_live_commands *c, double seconds) {
  char bytes[512];
  while (!c->closed && readable(c->fd, seconds)) {
    ssize_t count = read(c->fd, bytes, sizeof bytes);
    if (count <= 0) {
      c->closed = true;
      c->held = 0;
    } else
      take(c, bytes, (size_t)count);
    seconds = 0;
  }
}
