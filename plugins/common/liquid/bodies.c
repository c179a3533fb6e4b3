/* See bodies.h. A body keeps its angular momentum while it turns in a step: its spin is that of the moments of inertia
 * that it has at the time. */
#include "plugins/common/liquid/bodies.h"
#include "plugins/common/solids/matrix3.h"
#include "plugins/kit/vector3.h"

#include <string.h>

/* ---- the list ---- */

/* In a plane a body is endless across it: the distance to its ends there, half a cell away where it is as deep as a
 * cell, took a part of faces for open that is not, and a block heaved 15 % too fast. n: unit, of the body. */
static void lengthen(double *vertex, size_t count, const double n[3]) {
  double far = 0, reach = 0;
  for (size_t k = 0; k < count; k++) {
    far = fmax(far, fabs(hk_dot(vertex + 3 * k, n)));
    reach = fmax(reach, hk_length(vertex + 3 * k));
  }
  for (size_t k = 0; k < count && far > 0; k++)
    hk_add_scaled(vertex + 3 * k, (2 * reach / far - 1) * hk_dot(vertex + 3 * k, n), n);
}

/* across: of the body, as in hk_liquid_bodies_open. */
static hk_status open_shape(hk_liquid_body *b, const hk_host *host, const hk_body_skin *skin, const double across[3]) {
  size_t vertices = 3 * skin->vertices, corners = 3 * skin->triangles;
  double *corner = host->allocate(host, corners * sizeof *corner);
  double *vertex = host->allocate(host, vertices * sizeof *vertex);
  hk_status status = HK_OK;
  if (!corner || !vertex)
    status = host->fail(host, HK_NO_MEMORY, "no memory for a body of %zu triangles", skin->triangles);
  for (size_t k = 0; k < corners && status == HK_OK; k++) corner[k] = skin->triangle[k / 3][k % 3] + 1;
  if (status == HK_OK) {
    memcpy(vertex, skin->vertex, vertices * sizeof *vertex);
    lengthen(vertex, skin->vertices, across);
    status = hk_surface_open(&b->surface, host, &(hk_numbers){vertices, vertex}, &(hk_numbers){corners, corner},
                             "a rigid body in the liquid");
  }
  for (size_t k = 0; k < skin->vertices && status == HK_OK; k++) b->reach = fmax(b->reach, hk_length(vertex + 3 * k));
  b->vertex = skin->vertex;
  b->shape = (hk_shape){.kind = HK_SHAPE_MESH, .surface = &b->surface};
  host->release(host, corner);
  host->release(host, vertex);
  return status;
}

static void set_frame(hk_body_frame *f, const hk_body_skin *skin, const double *x) {
  memset(f, 0, sizeof *f);
  for (uint32_t k = 0; k < skin->carriers; k++)
    for (int c = 0; c < 3; c++) {
      double place = x[3 * (size_t)skin->carrier[k] + (size_t)c];
      f->origin[c] += skin->origin[k] * place;
      for (int a = 0; a < 3; a++) f->turn[3 * c + a] += skin->axis[a][k] * place;
    }
}

hk_status hk_liquid_bodies_open(hk_liquid_bodies *s, const hk_host *host, const hk_view *view, size_t size,
                                const double across[3]) {
  const hk_model *model = view->model;
  s->host = host;
  if (model->skins == 0) return HK_OK;
  s->service = host->query(host, "bodies/1");
  if (!s->service) return host->fail(host, HK_FAILED, "the host has no service bodies/1: take a newer hooke");
  bool all = (s->body = host->allocate(host, model->skins * sizeof *s->body)) != NULL;
  for (int c = 0; c < 3; c++) all &= (s->owner[c] = host->allocate(host, size * sizeof *s->owner[c])) != NULL;
  all &= (s->beside = host->allocate(host, size * sizeof *s->beside)) != NULL;
  if (!all || model->skins >= UINT16_MAX)
    return host->fail(host, HK_NO_MEMORY, "no memory for %zu bodies in a liquid of %zu cells: take larger ones",
                      model->skins, size);
  hk_status status = HK_OK;
  for (; s->count < model->skins && status == HK_OK; s->count++) {
    hk_body_frame frame;
    double own[3];
    set_frame(&frame, &model->skin[s->count], view->x);
    for (int a = 0; a < 3; a++)
      own[a] = frame.turn[a] * across[0] + frame.turn[3 + a] * across[1] + frame.turn[6 + a] * across[2];
    status = open_shape(&s->body[s->count], host, &model->skin[s->count], own);
  }
  return status;
}

void hk_liquid_bodies_topology(hk_liquid_bodies *s) { s->known = false; }

/* Whether its centre of mass is moved along every axis by what its mass says: no pin, joint or bar holds it. */
static hk_status find_free(const hk_liquid_bodies *s, const hk_model *model, hk_liquid_body *b) {
  hk_weighted_point centre = {{b->carrier[0], b->carrier[0], b->carrier[0], b->carrier[0]}, {0}};
  hk_status status = HK_OK;
  b->mass = 0;
  b->free = true;
  for (uint32_t k = 0; k < b->carriers; k++) b->mass += b->weight[k];
  for (uint32_t k = 0; k < b->carriers; k++) {
    centre.particle[k] = b->carrier[k];
    centre.weight[k] = b->weight[k] / b->mass;
    b->free &= model->pin[b->carrier[k]] == HK_FREE;
  }
  for (int c = 0; c < 3 && b->free && status == HK_OK; c++) {
    const double n[3] = {c == 0, c == 1, c == 2};
    double mobility = 0;
    status = s->service->mobility(s->service->self, &centre, n, &mobility);
    b->free = fabs(mobility * b->mass - 1) < 1e-6;
  }
  return status;
}

/* Carriers of the present topology; skins keep their order. */
static hk_status find_carriers(hk_liquid_bodies *s, const hk_view *view, const hk_correction *step) {
  const hk_model *model = view->model;
  size_t all, k = 0;
  hk_status status = s->service->count(s->service->self, &all);
  if (status == HK_OK && all > 0) status = s->service->linearise(s->service->self, view->t, step->x, step->v);
  for (size_t i = 0; i < s->count && status == HK_OK; i++) {
    hk_liquid_body *b = &s->body[i];
    b->present = k < model->skins && model->skin[k].vertex == b->vertex;
    if (!b->present) continue;
    const hk_body_skin *skin = &model->skin[k++];
    b->carriers = skin->carriers;
    memcpy(b->carrier, skin->carrier, sizeof b->carrier);
    for (uint32_t c = 0; c < b->carriers; c++) b->weight[c] = model->mass[b->carrier[c]];
    status = find_free(s, model, b);
    if (status != HK_OK || b->free || s->said) continue;
    s->said = true;
    s->host->warn(s->host,
                  "a rigid body in the liquid is joined to others or held, and its pressure does not move it: it is a "
                  "wall that moves as it does; only bodies that are free float");
  }
  s->known = status == HK_OK;
  return status;
}

/* ---- motion ---- */

/* The sum of the carriers' weights times y (n x 3). */
static void mean_of(const hk_liquid_body *b, const double *y, double out[3]) {
  out[0] = out[1] = out[2] = 0;
  for (uint32_t k = 0; k < b->carriers; k++) hk_add_scaled(out, b->weight[k] / b->mass, y + 3 * (size_t)b->carrier[k]);
}

/* Of the carriers at x about their centre; false: they are on a line. */
static bool invert_inertia(const hk_liquid_body *b, const double *x, const double centre[3], double inverse[9]) {
  double I[9] = {0}, r[3], cofactor[9];
  for (uint32_t k = 0; k < b->carriers; k++) {
    hk_subtract(r, x + 3 * (size_t)b->carrier[k], centre);
    for (int c = 0; c < 9; c++) I[c] += b->weight[k] * ((c % 4 == 0 ? hk_dot(r, r) : 0) - r[c / 3] * r[c % 3]);
  }
  double volume = hk_matrix3_cofactor(I, cofactor), size = (I[0] + I[4] + I[8]) / 3;
  if (!(volume > 1e-12 * size * size * size)) return false;
  for (int c = 0; c < 9; c++) inverse[c] = cofactor[c] / volume;
  return true;
}

/* inverse: symmetric. */
static void spin_of(const double inverse[9], const double momentum[3], double spin[3]) {
  for (int c = 0; c < 3; c++) spin[c] = hk_dot(inverse + 3 * c, momentum);
}

/* kg m^2/s, about the centre. */
static void angular_momentum(const hk_liquid_body *b, const double *x, const double *v, double out[3]) {
  double centre[3], r[3], part[3];
  mean_of(b, x, centre);
  out[0] = out[1] = out[2] = 0;
  for (uint32_t k = 0; k < b->carriers; k++) {
    hk_subtract(r, x + 3 * (size_t)b->carrier[k], centre);
    hk_cross(part, r, v + 3 * (size_t)b->carrier[k]);
    hk_add_scaled(out, b->weight[k], part);
  }
}

void hk_liquid_body_push(hk_liquid_body *b, const double impulse[6]) {
  double turn[3];
  spin_of(b->inverse_inertia, impulse + 3, turn);
  hk_add_scaled(b->velocity, 1 / b->mass, impulse);
  hk_add_scaled(b->spin, 1, turn);
}

hk_status hk_liquid_bodies_begin(hk_liquid_bodies *s, const hk_view *view, const hk_correction *step) {
  hk_status status = s->known || s->count == 0 ? HK_OK : find_carriers(s, view, step);
  size_t k = 0;
  s->h = step->h;
  for (size_t i = 0; i < s->count && status == HK_OK; i++) {
    hk_liquid_body *b = &s->body[i];
    double momentum[3];
    if (!b->present) continue;
    set_frame(&b->frame, &view->model->skin[k++], step->x_before);
    b->wet = false;
    mean_of(b, step->x_before, b->centre);
    mean_of(b, step->v, b->velocity);
    angular_momentum(b, step->x, step->v, momentum);
    b->free &= invert_inertia(b, step->x_before, b->centre, b->inverse_inertia);
    spin_of(b->inverse_inertia, momentum, b->spin);
  }
  return status;
}

/* r turned by the spin for h: Rodrigues' formula. */
static void turn(double r[3], const double spin[3], double h) {
  double rate = hk_length(spin), across[3], twice[3], axis[3];
  if (!(rate > 0)) return;
  for (int c = 0; c < 3; c++) axis[c] = spin[c] / rate;
  hk_cross(across, axis, r);
  hk_cross(twice, axis, across);
  hk_add_scaled(r, sin(rate * h), across);
  hk_add_scaled(r, 1 - cos(rate * h), twice);
}

/* The carriers of a wet body at the end of the step. */
static void move(const hk_liquid_body *b, const double *x_before, double *x, double *v, double h) {
  double centre[3], momentum[3], inverse[9], spin[3], r[3];
  for (uint32_t k = 0; k < b->carriers; k++) { /* as they turn, with the spin of the start, to have its momentum */
    double *to = v + 3 * (size_t)b->carrier[k];
    hk_subtract(r, x_before + 3 * (size_t)b->carrier[k], b->centre);
    hk_cross(to, b->spin, r);
  }
  angular_momentum(b, x_before, v, momentum);
  for (int c = 0; c < 3; c++) centre[c] = b->centre[c] + h * b->velocity[c];
  for (uint32_t k = 0; k < b->carriers; k++) {
    double *to = x + 3 * (size_t)b->carrier[k];
    hk_subtract(r, x_before + 3 * (size_t)b->carrier[k], b->centre);
    turn(r, b->spin, h);
    for (int c = 0; c < 3; c++) to[c] = centre[c] + r[c];
  }
  if (!invert_inertia(b, x, centre, inverse)) return;
  spin_of(inverse, momentum, spin);
  for (uint32_t k = 0; k < b->carriers; k++) {
    double *to = v + 3 * (size_t)b->carrier[k];
    hk_subtract(r, x + 3 * (size_t)b->carrier[k], centre);
    hk_cross(to, spin, r);
    hk_add_scaled(to, 1, b->velocity);
  }
}

bool hk_liquid_bodies_end(hk_liquid_bodies *s, const hk_view *view, hk_correction *step) {
  size_t k = 0;
  bool moved = false;
  for (size_t i = 0; i < s->count; i++) {
    hk_liquid_body *b = &s->body[i];
    if (!b->present) continue;
    if (b->free && b->wet) move(b, step->x_before, step->x, step->v, s->h);
    moved |= b->free && b->wet;
    set_frame(&b->frame, &view->model->skin[k++], step->x);
  }
  return moved;
}

/* ---- the liquid's questions ---- */

double hk_liquid_body_distance(const hk_liquid_body *b, const double x[3], double near, double n[3]) {
  double p[3], own[3];
  hk_body_point(&b->frame, x, p);
  double bound = hk_length(p) - b->reach;
  if (bound > near) return bound;
  double distance = hk_shape_distance(&b->shape, p, own);
  hk_body_direction(&b->frame, own, n);
  return distance;
}

void hk_liquid_body_velocity(const hk_liquid_body *b, const double x[3], double u[3]) {
  double r[3];
  hk_subtract(r, x, b->centre);
  hk_cross(u, b->spin, r);
  hk_add_scaled(u, 1, b->velocity);
}
