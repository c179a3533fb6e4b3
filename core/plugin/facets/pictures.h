/* Facet of forces for pictures and recordings. Both functions are called at frames and change nothing. */
#ifndef HK_PLUGIN_PICTURES_H
#define HK_PLUGIN_PICTURES_H

#include "core/plugin/contact.h"
#include "core/plugin/force.h"

#define HK_PICTURES_ID "pictures/1"
#define HK_PICTURES_FACET(...) HK_FACET(HK_PICTURES_ID, hk_pictures_facet, __VA_ARGS__)

typedef struct hk_pictures_facet {
  size_t size;
  /* For a force of a medium that moves: its velocity u (count x 3, m/s) at the places x (count x 3, m) at view->t.
   * NULL: there is no such medium. */
  void (*flow)(const void *self, const hk_view *view, const double *x, size_t count, double *u);
  /* For contact of any kind: adds the places where something touches at `view`. NULL: nothing ever does. */
  void (*contact_points)(const void *self, const hk_view *view, const hk_contact_points *points);
} hk_pictures_facet;

#endif
