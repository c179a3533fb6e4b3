#include "plugins/common/camera/viewport.h"

#include "plugins/common/snapshot/appearance.h"

#include <stdlib.h>
#include <string.h>

enum { PLACE = 6 }; /* numbers of a further camera */

static const struct {
  const char *name;
  double direction[3];
} sides[] = {
    {"front", {0, -1, 0}}, {"back", {0, 1, 0}}, {"left", {-1, 0, 0}},
    {"right", {1, 0, 0}},  {"top", {0, 0, 1}},  {"bottom", {0, 0, -1}},
};

static void forget(hk_camera_place *place) {
  for (int c = 0; c < 3; c++) place->eye[c] = place->target[c] = NAN;
}

/* camera2 is the first of `more`. */
static bool find_camera(const char *name, const hk_numbers *more, bool y_up, hk_viewport *port) {
  if (strncmp(name, "camera", 6) != 0) return false;
  port->own = name[6] == 0;
  if (port->own) return true;
  char *end;
  size_t number = strtoul(name + 6, &end, 10);
  if (*end || number < 2 || (number - 1) * PLACE > more->count) return false;
  const double *row = more->value + (number - 2) * PLACE;
  hk_to_z_up(y_up, row, port->given.eye);
  hk_to_z_up(y_up, row + 3, port->given.target);
  port->direction[0] = NAN;
  return true;
}

static bool find_side(const char *name, hk_viewport *port) {
  for (size_t k = 0; k < sizeof sides / sizeof *sides; k++)
    if (strcmp(name, sides[k].name) == 0) {
      memcpy(port->direction, sides[k].direction, sizeof port->direction);
      return true;
    }
  return false;
}

static hk_status read_one(const hk_host *host, const char *name, size_t length, const hk_numbers *more, bool y_up,
                          hk_viewport *port) {
  *port = (hk_viewport){0};
  forget(&port->given);
  if (length < sizeof port->name) memcpy(port->name, name, length);
  if (find_side(port->name, port) || find_camera(port->name, more, y_up, port)) return HK_OK;
  return host->fail(host, HK_BAD_PARAM, "views: '%.*s' is not one of camera, front, back, left, right, top, bottom%s",
                    (int)length, name,
                    strncmp(name, "camera", 6) == 0 ? "; camera2 and so on are the rows of cameras" : "");
}

hk_status hk_viewports_read(const hk_host *host, const char *names, const hk_numbers *more, bool y_up,
                            hk_viewport port[HK_VIEWPORTS], size_t *count) {
  static const char between[] = ", ";
  *count = 0;
  if (more->count % PLACE != 0)
    return host->fail(host, HK_BAD_PARAM,
                      "cameras: expected x, y, z of where it stands and of what it looks at for each");
  for (const char *at = names ? names + strspn(names, between) : ""; *at;) {
    size_t length = strcspn(at, between);
    if (*count == HK_VIEWPORTS) return host->fail(host, HK_BAD_PARAM, "views: a picture has %d at most", HK_VIEWPORTS);
    hk_status status = read_one(host, at, length, more, y_up, port + (*count)++);
    if (status != HK_OK) return status;
    at += length, at += strspn(at, between);
  }
  if (*count > 0) return HK_OK;
  port[0] = (hk_viewport){.own = true};
  forget(&port[0].given);
  *count = 1;
  return HK_OK;
}
