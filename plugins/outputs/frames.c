/* PNG pictures of the scene, and a video of them when ffmpeg is installed: what the script says, checked and handed to
 * plugins/common/film, and the times of births, which the scene does not keep. */
#include "core/plugin.h"
#include "plugins/common/camera/keyframes.h"
#include "plugins/common/film/film.h"
#include "plugins/common/film/solid_list.h"
#include "plugins/common/obstacles/obstacles_service.h"
#include "plugins/common/particle_surface/view_surface.h"
#include "plugins/common/snapshot/births.h"
#include "plugins/common/volume/volume_choice.h"

#include <string.h>

typedef struct frames {
  int64_t width, height, every, sheet;
  hk_appearance_names names;
  const char *unit, *folder, *video_file, *views;
  double from[3], look_at[3], fov, outliers, radius, tube, thickness, least, opacity, obstacle_opacity, fog, streak,
      ground_height, background[3], plain[3];
  hk_numbers range, keyframes, cameras;
  hk_solid_numbers solids;
  hk_frame_solid *solid;
  size_t solid_count;
  int map, up, springs, particles, style, light;
  hk_surface_wanted wanted;
  hk_volume_optics volume_optics;
  bool reverse, log, ground, shadows, obstacles, legend, pictures, video, follow, see_through;

  const hk_host *host;
  const hk_obstacles *all; /* NULL: there is no such service */
  hk_film film;
  hk_view_surface surface;
  bool changed; /* the topology may have changed since the last picture */
  hk_births births;
} frames;

enum { Z_UP, Y_UP };
enum { AUTO_LIGHT, DAY, NIGHT, WHITE };

static const hk_param params[] = {
    {"width", "pixels", "width of the pictures", .integer = HK_AT(frames, width), .initial = {1280},
     .limits = HK_WITHIN(16, 8192)},
    {"height", "pixels", "height of the pictures", .integer = HK_AT(frames, height), .initial = {720},
     .limits = HK_WITHIN(16, 8192)},
    {"every", "frames", "draw every so many frames", .integer = HK_AT(frames, every), .initial = {1},
     .limits = HK_WITHIN(1, 1e9)},
    {"color", "",
     "auto, none, strain, tension (N), stress (N/m or Pa), speed, age, mass, group, or a channel (of three: rgb)",
     .string = HK_AT(frames, names.color), .text = "auto"},
    {"plain", "", "red, green and blue of everything with color = \"none\", 0 to 1; left out: blue",
     .vector = HK_AT(frames, plain), .limits = HK_WITHIN(0, 1), .flags = HK_OPTIONAL},
    {"map", "", "colours of numbers; auto: diverging for strain, tension and stress, inferno for glow, else viridis",
     .choice = HK_AT(frames, map), .choices = "auto|" HK_MAP_NAMES},
    {"reverse", "", "the colours from end to end: what is small gets the last", .boolean = HK_AT(frames, reverse)},
    {"range", "", "smallest and largest number of the colours; left out: chosen from the whole motion",
     .numbers = HK_AT(frames, range), .flags = HK_OPTIONAL},
    {"log", "", "colours by the logarithm of the numbers", .boolean = HK_AT(frames, log)},
    {"unit", "", "unit of a channel, for the legend", .string = HK_AT(frames, unit)},
    {"from", "m", "camera: where it stands; left out: where it sees the whole motion", .vector = HK_AT(frames, from),
     .flags = HK_OPTIONAL | HK_TIMED},
    {"look_at", "m", "target of the camera: what is in the middle of the picture; left out: the middle of the motion",
     .vector = HK_AT(frames, look_at), .flags = HK_OPTIONAL | HK_TIMED},
    {"keyframes", "",
     "the camera's way: t, x, y, z of where it stands and x, y, z of what it looks at, of each; between "
     "them it moves smoothly",
     .numbers = HK_AT(frames, keyframes), .flags = HK_OPTIONAL},
    {"views", "",
     "several in each picture: camera (by from, look_at), front, back, left, right, top, bottom, camera2 ...; "
     "left out: camera",
     .string = HK_AT(frames, views)},
    {"cameras", "m",
     "further ones for views, camera2, camera3 ...: x, y, z of where it stands and x, y, z of what it looks "
     "at, of each",
     .numbers = HK_AT(frames, cameras), .flags = HK_OPTIONAL},
    {"follow", "", "cameras go along with the particles, which fill two thirds of the picture",
     .boolean = HK_AT(frames, follow)},
    {"fov", "degrees", "angle from the bottom to the top of the picture", .number = HK_AT(frames, fov), .initial = {30},
     .limits = HK_WITHIN(1, 150)},
    {"up", "", "the axis that points up", .choice = HK_AT(frames, up), .choices = "z|y"},
    {"outliers", "",
     "share of the particles that a chosen camera may leave out on each side, where they would make "
     "the others small",
     .number = HK_AT(frames, outliers), .initial = {0.005}, .limits = HK_WITHIN(0, 0.2)},
    {"springs", "", "draw springs; auto: those with an end outside all triangles", .choice = HK_AT(frames, springs),
     .choices = "auto|on|off"},
    {"particles", "", "draw particles; auto: those outside all triangles, and pins", .choice = HK_AT(frames, particles),
     .choices = "auto|on|off"},
    {"style", "", "lit spheres, soft discs (smoke) or lights that add up (fire, stars); auto: spheres, soft streaks",
     .choice = HK_AT(frames, style), .choices = "auto|sphere|soft|glow"},
    {"size", "", "auto, same, mass (radii as cube roots) or a channel of radii; auto: the channel radius if no radius",
     .string = HK_AT(frames, names.size), .text = "auto"},
    {"radius", "m", "radius of drawn particles, with size = \"mass\" of the heaviest; left out: chosen",
     .number = HK_AT(frames, radius), .limits = HK_WITHIN(0, 1e30), .flags = HK_OPTIONAL},
    {"tube", "m", "radius of drawn springs and strands; left out: that of contact, else of the strand, else chosen",
     .number = HK_AT(frames, tube), .limits = HK_WITHIN(0, 1e30), .flags = HK_OPTIONAL},
    {"tubes", "",
     "radii of springs and strands, m: of groups, \"rope 0.01, thread 0.002\", or a channel with that at each "
     "particle",
     .string = HK_AT(frames, names.tubes)},
    {"thickness", "m", "of cloth: its sides are drawn on both sides of the particles, half of it away",
     .number = HK_AT(frames, thickness), .limits = HK_WITHIN(0, 1e30)},
    {"least", "pixels", "smallest radius of a particle on the picture", .number = HK_AT(frames, least), .initial = {1},
     .limits = HK_WITHIN(0.25, 100)},
    {"opacity", "", "of particles, of lights their strength; left out: 1, for glow by how bright they are together",
     .number = HK_AT(frames, opacity), .limits = HK_WITHIN(0, 1e6), .flags = HK_OPTIONAL},
    {"fade", "", "a channel that makes particles fainter, from 1 down to 0, which is not seen",
     .string = HK_AT(frames, names.fade)},
    {"streak", "s", "soft and glowing particles leave a streak of this much of their way",
     .number = HK_AT(frames, streak), .limits = HK_WITHIN(0, 1e9)},
    {"fog", "", "share of the background in the colour of the farthest particles", .number = HK_AT(frames, fog),
     .limits = HK_WITHIN(0, 1)},
    {"spheres", "m", "solids to draw: x, y, z and radius of each, one after the other",
     .numbers = HK_AT(frames, solids.spheres), .flags = HK_OPTIONAL},
    {"boxes", "m", "solids to draw: middle and extents of each, x, y, z, a, b, c",
     .numbers = HK_AT(frames, solids.boxes), .flags = HK_OPTIONAL},
    {"planes", "m", "planes to draw: a point of each and a vector normal to it, x, y, z, a, b, c",
     .numbers = HK_AT(frames, solids.planes), .flags = HK_OPTIONAL},
    {"surface", "m",
     "draw the surface of a liquid in the stead of its particles: their radius, half the distance of neighbours; left "
     "out: there is none",
     .number = HK_AT(frames, wanted.radius), .limits = HK_WITHIN(1e-30, 1e30), .flags = HK_OPTIONAL},
    {"surface_of", "", "group of the liquid's particles; left out: all that are in no edge, triangle or element",
     .string = HK_AT(frames, wanted.of)},
    {"surface_cell", "m", "cells of the surface's grid; left out: half the radius",
     .number = HK_AT(frames, wanted.cell), .limits = HK_WITHIN(1e-30, 1e30), .flags = HK_OPTIONAL},
    {"surface_field", "",
     "of the liquid: zhu_bridson, density, or anisotropic: kernels flat along the surface, the flattest",
     .choice = HK_AT(frames, wanted.field), .choices = "zhu_bridson|density|anisotropic"},
    {"surface_reach", "m", "how far a particle is felt; left out: four radii, of anisotropic six",
     .number = HK_AT(frames, wanted.reach), .limits = HK_WITHIN(1e-30, 1e30), .flags = HK_OPTIONAL},
    {"surface_smoothing", "", "rounds of smoothing of the liquid's mesh; 25 take its bumps away and leave drops",
     .integer = HK_AT(frames, wanted.smoothing), .limits = HK_WITHIN(0, 1000)},
    {"surface_cut", "", "the liquid ends at obstacles (but meshes), without bumps of particles there",
     .boolean = HK_AT(frames, wanted.cut)},
    {"surface_look", "",
     "opaque, or water: clear, it mirrors, bends and absorbs light by the laws of Fresnel, Snell, and Beer and "
     "Lambert; the camera is outside",
     .choice = HK_AT(frames, wanted.clear), .choices = "opaque|water"},
    {"surface_index", "", "of refraction, of a clear surface; 1.333 is water, 1.5 glass",
     .number = HK_AT(frames, wanted.index), .initial = {1.333}, .limits = HK_WITHIN(1, 4)},
    {"surface_absorption", "1/m",
     "of a clear surface, of red, green and blue light; left out: pure water at 650, 550 and 450 nm (Pope and Fry "
     "1997), blue in metres",
     .vector = HK_AT(frames, wanted.absorption), .initial = {0.34, 0.0565, 0.00922}, .limits = HK_WITHIN(0, 1e9)},
    {"smoke", "m^2/kg",
     "draw the smoke of gases, which hides by so much a mass; 8700 is taken for soot of flames; left out: "
     "it is not drawn",
     .number = HK_AT(frames, volume_optics.extinction), .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {"glow", "1/m", "with smoke: light of gas of 2000 K in a metre, where 1 is white; cooler gas is redder and darker",
     .number = HK_AT(frames, volume_optics.glow), .limits = HK_AT_LEAST(0)},
    {"obstacles", "", "draw the scene's obstacles (the corrector, penalty, soft_walls) where they are at each frame",
     .boolean = HK_AT(frames, obstacles), .initial = {1}},
    {"obstacle_opacity", "", "of drawn obstacles but planes; 0.2 looks as glass",
     .number = HK_AT(frames, obstacle_opacity), .initial = {1}, .limits = HK_WITHIN(0, 1)},
    {"see_through", "", "obstacles are transparent while they hide more than half of the particles",
     .boolean = HK_AT(frames, see_through), .initial = {1}},
    {"shadows", "", "things cast shadows, on the floor and on each other", .boolean = HK_AT(frames, shadows),
     .initial = {1}},
    {"ground", "", "draw the floor with its grid", .boolean = HK_AT(frames, ground), .initial = {1}},
    {"ground_height", "m", "height of the floor; left out: 0 or just below the motion",
     .number = HK_AT(frames, ground_height), .flags = HK_OPTIONAL},
    {"light", "", "day; night: a dark background; white: a white studio, for print; auto: night for glow, else day",
     .choice = HK_AT(frames, light), .choices = "auto|day|night|white"},
    {"background", "", "red, green and blue of the background, 0 to 1; left out: by the light",
     .vector = HK_AT(frames, background), .limits = HK_WITHIN(0, 1), .flags = HK_OPTIONAL},
    {"legend", "", "draw the bar of colours", .boolean = HK_AT(frames, legend), .initial = {1}},
    {"sheet", "", "so many stills, evenly spaced in time, side by side in sheet.png; 0: none",
     .integer = HK_AT(frames, sheet), .limits = HK_WITHIN(0, 400)},
    {"pictures", "", "write a PNG file of each picture; off: the video alone", .boolean = HK_AT(frames, pictures),
     .initial = {1}},
    {"video", "", "make a video of the pictures, with ffmpeg", .boolean = HK_AT(frames, video), .initial = {1}},
    {"folder", "", "folder of the pictures, inside the output folder", .string = HK_AT(frames, folder),
     .text = "frames"},
    {"video_file", "", "name of the video, inside the output folder", .string = HK_AT(frames, video_file),
     .text = "video.mp4"},
    {0},
};

static const hk_field fields[] = {
    {"seen", .per_particle = HK_AT(frames, births.seen), .width = 1},
    {"birth", .per_particle = HK_AT(frames, births.birth), .width = 1},
    {0},
};

static hk_style style_of(const frames *f) {
  if (f->style) return (hk_style)(f->style - 1);
  return f->streak > 0 ? HK_STYLE_SOFT : HK_STYLE_SPHERE;
}

static void plan_colours(frames *f) {
  hk_film *film = &f->film;
  hk_paint paint = film->appearance.paint;
  film->map = f->map                         ? (hk_colormap)(f->map - 1)
              : hk_paints_elements(paint)    ? HK_MAP_DIVERGING
              : style_of(f) == HK_STYLE_GLOW ? HK_MAP_INFERNO
                                             : HK_MAP_VIRIDIS;
  film->reverse = f->reverse;
  film->framing.centred = film->map == HK_MAP_DIVERGING && !f->log;
  film->framing.counted = paint != HK_PAINT_NONE && paint != HK_PAINT_GROUP && paint != HK_PAINT_RGB;
  film->framing.scale =
      (hk_scale){f->range.count ? f->range.value[0] : NAN, f->range.count ? f->range.value[1] : NAN, f->log};
}

/* Where it is at time t; the parameters `from` and `look_at` are those of this time already. */
static void place_camera(frames *f, double t) {
  double from[3], look_at[3];
  memcpy(from, f->from, sizeof from), memcpy(look_at, f->look_at, sizeof look_at);
  if (f->keyframes.count) hk_keyframes_at(&f->keyframes, t, from, look_at);
  hk_to_z_up(f->up == Y_UP, from, f->film.own.eye);
  hk_to_z_up(f->up == Y_UP, look_at, f->film.own.target);
}

static void plan_camera(frames *f, double t) {
  hk_framing *framing = &f->film.framing;
  framing->fov = f->fov * acos(-1) / 180;
  f->film.follow = f->follow;
  place_camera(f, t);
  framing->floor = f->ground, framing->height = f->ground_height;
  framing->radius = f->radius, framing->tube = f->tube, framing->outliers = f->outliers;
}

static void plan_light(frames *f) {
  static const double colours[][3] = {
      [DAY] = {0.66, 0.705, 0.755}, [NIGHT] = {0.030, 0.036, 0.052}, [WHITE] = {0.93, 0.92, 0.90}};
  hk_view_setup *setup = &f->film.setup;
  int light = f->light != AUTO_LIGHT ? f->light : style_of(f) == HK_STYLE_GLOW ? NIGHT : DAY;
  const double *colour = isnan(f->background[0]) ? colours[light] : f->background;
  for (int c = 0; c < 3; c++) setup->background[c] = setup->sprites.fog_colour[c] = (float)colour[c];
  setup->see_through = f->see_through, setup->obstacle_clearness = 1 - f->obstacle_opacity;
  setup->shadows = f->shadows, setup->thickness = f->thickness;
  setup->sprites.style = style_of(f);
  setup->sprites.opacity = isnan(f->opacity) && style_of(f) != HK_STYLE_GLOW ? 1 : f->opacity;
  setup->sprites.least = f->least, setup->sprites.fog = f->fog;
  setup->streak = f->streak;
  setup->water = (hk_water_optics){.clear = f->wanted.clear, .index = (float)f->wanted.index};
  for (int c = 0; c < 3; c++) setup->water.absorption[c] = (float)f->wanted.absorption[c];
}

static void make_plan(frames *f, double t) {
  f->film.solid = f->solid, f->film.solids = f->solid_count;
  f->film.obstacles = f->obstacles && f->all ? f->all->shown : NULL;
  f->film.width = (int)f->width, f->film.height = (int)f->height;
  f->film.stills = (size_t)f->sheet;
  f->film.legend = f->legend, f->film.unit = f->unit;
  memcpy(f->film.plain, f->plain, sizeof f->plain);
  plan_colours(f);
  plan_camera(f, t);
  plan_light(f);
}

/* Without particles, which are in the liquid, where the script does not ask for them. */
static hk_status choose_surface(frames *f, const hk_model *m) {
  hk_status status = hk_view_surface_choose(&f->surface, f->host, m, &f->wanted);
  if (status != HK_OK || isnan(f->wanted.radius)) return status;
  f->surface.walls = f->wanted.cut && f->all ? f->all->shown : NULL;
  f->film.liquid = &f->surface.solid, f->film.liquid_radius = f->wanted.radius;
  if (f->particles == 0) f->film.appearance.particles = 2; /* none */
  return HK_OK;
}

/* Whether the surface of the liquid is all there is: no particle has a colour then. */
static bool is_all_liquid(const frames *f, const hk_model *m) {
  return !isnan(f->wanted.radius) && !f->wanted.of && f->particles == 0 && m->edges.count == 0 &&
         m->triangles.count == 0 && m->element_lists == 0;
}

static hk_status choose_look(frames *f, const hk_model *m, bool whole) {
  hk_appearance *appearance = &f->film.appearance;
  appearance->springs = f->springs, appearance->particles = f->particles;
  appearance->streak = f->streak, appearance->y_up = f->up == Y_UP;
  hk_appearance_names names = f->names;
  bool one_size = !isnan(f->radius);
  if (strcmp(names.color, "auto") == 0 && is_all_liquid(f, m)) names.color = "none";
  if (one_size && strcmp(names.size, "auto") == 0) names.size = "same";
  if (!isnan(f->tube) && names.tubes)
    return f->host->fail(f->host, HK_BAD_PARAM, "tube: tubes has the radii; leave one of the two out");
  if (!isnan(f->tube)) names.tubes = "";
  hk_status status = hk_appearance_choose(appearance, f->host, m, whole, &names, &f->film.label);
  if (status == HK_OK && one_size && appearance->sizes == HK_SIZE_CHANNEL)
    return f->host->fail(f->host, HK_BAD_PARAM, "radius: the channel '%s' has the radii; leave one of the two out",
                         names.size);
  return status == HK_OK ? choose_surface(f, m) : status;
}

/* A quick look is at half the size, whose width and height are even, as films want it. */
static void choose_size(frames *f) {
  const hk_draft *draft = f->host->query(f->host, "draft/1");
  if (!draft || !*draft) return;
  f->width = (f->width + 3) / 4 * 2, f->height = (f->height + 3) / 4 * 2;
}

static hk_status check_camera(frames *f) {
  hk_status status = hk_viewports_read(f->host, f->views, &f->cameras, f->up == Y_UP, f->film.framing.viewport,
                                       &f->film.framing.viewports);
  if (status != HK_OK || f->keyframes.count == 0) return status;
  if (!isnan(f->from[0]) || !isnan(f->look_at[0]) || f->follow)
    return f->host->fail(f->host, HK_BAD_PARAM, "keyframes: they say where the camera is; leave out %s",
                         f->follow           ? "follow"
                         : isnan(f->from[0]) ? "look_at"
                                             : "from");
  return hk_keyframes_check(f->host, "keyframes", &f->keyframes);
}

/* Checks the colouring at the start of the run; `open` chooses it again, when the forces' elements are known. */
static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  frames *f = self;
  f->host = host;
  f->all = host->query(host, HK_OBSTACLES_INTERFACE);
  choose_size(f);
  if (f->range.count != 0 && (f->range.count != 2 || f->range.value[0] >= f->range.value[1]))
    return host->fail(host, HK_BAD_PARAM, "range: expected two numbers, the smaller first");
  if (f->range.count && f->log && f->range.value[0] <= 0)
    return host->fail(host, HK_BAD_PARAM, "range: %g has no logarithm; give two positive numbers, or log = false",
                      f->range.value[0]);
  if (f->streak > 0 && style_of(f) == HK_STYLE_SPHERE)
    return host->fail(host, HK_BAD_PARAM, "streak: spheres leave none; set style = \"soft\" or \"glow\"");
  if (f->opacity > 1 && style_of(f) != HK_STYLE_GLOW)
    return host->fail(host, HK_BAD_PARAM, "opacity: %g is above 1; only style = \"glow\" can be stronger", f->opacity);
  f->film.files =
      (hk_film_files){.folder = f->folder, .file = f->video ? f->video_file : NULL, .pictures = f->pictures};
  hk_status status = check_camera(f);
  if (status == HK_OK) status = hk_film_files_check(&f->film.files, host, (int)f->width, (int)f->height);
  if (!f->pictures && !f->video && !f->sheet)
    host->warn(host, "pictures, video and sheet are all off: nothing is written");
  if (status == HK_OK) status = hk_solid_list_make(host, &f->solids, f->up == Y_UP, &f->solid, &f->solid_count);
  if (status == HK_OK) status = choose_look(f, view->model, false);
  f->film.volume_optics = f->volume_optics;
  if (status == HK_OK) status = hk_volumes_choose(host, &f->volume_optics, f->up == Y_UP, &f->film.volumes);
  if (status == HK_OK && f->unit && f->film.appearance.paint != HK_PAINT_CHANNEL)
    return host->fail(host, HK_BAD_PARAM, "unit: only the numbers of a channel have none of their own");
  return status;
}

static hk_status open(void *self, const hk_view *view, const hk_frame *frame) {
  frames *f = self;
  hk_status status = choose_look(f, view->model, true);
  if (status != HK_OK) return status;
  make_plan(f, view->t);
  f->film.skins = view->model->skins;
  hk_births_note_first(&f->births, view, f->film.appearance.paint == HK_PAINT_AGE);
  f->film.files.fps = frame->fps / (double)f->every;
  f->changed = true;
  status = hk_film_open(&f->film, view->host);
  return status == HK_OK ? hk_volumes_check(f->host, f->film.volumes, f->film.waiting) : status;
}

static hk_status frame(void *self, const hk_view *view, const hk_frame *now) {
  frames *f = self;
  hk_births_note(&f->births, view, (f->births.last + view->t) / 2);
  if (now->index % (size_t)f->every != 0) return HK_OK;
  place_camera(f, view->t);
  hk_status status = f->film.liquid ? hk_view_surface_take(&f->surface, view, f->up == Y_UP) : HK_OK;
  f->film.liquid_normal = f->surface.smooth && f->surface.surface.normal ? f->surface.surface.normal[0] : NULL;
  if (status == HK_OK) status = hk_film_add(&f->film, view, now, f->births.birth, f->changed);
  if (status == HK_OK) f->changed = false;
  return status;
}

/* For any verdict. */
static hk_status close(void *self, hk_verdict verdict) {
  frames *f = self;
  hk_status status = hk_film_finish(&f->film, verdict);
  hk_film_free(&f->film); /* some hundred megabytes that a run may outlive */
  hk_view_surface_free(&f->surface, f->host);
  return status;
}

static void destroy(void *self, const hk_host *host) {
  frames *f = self;
  hk_film_free(&f->film);
  hk_view_surface_free(&f->surface, host);
}

static hk_status topology(void *self, const hk_view *view) {
  frames *f = self;
  (void)view;
  f->changed = true;
  return HK_OK;
}

static const hk_output output = {.size = sizeof(hk_output), .open = open, .frame = frame, .close = close};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_OUTPUT,
    .name = "frames",
    .summary = "PNG pictures of the scene, and a video of them",
    .reference = "",
    .instance_size = sizeof(frames),
    .params = params,
    .fields = fields,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .output = &output,
};
