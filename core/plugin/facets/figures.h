/* Facet of forces that have figures of their own in the summary, as correctors may. */
#ifndef HK_PLUGIN_FIGURES_H
#define HK_PLUGIN_FIGURES_H

#include "core/plugin/corrector.h"
#include "core/plugin/force.h"

#define HK_FIGURES_ID "figures/1"
#define HK_FIGURES_FACET(...) HK_FACET(HK_FIGURES_ID, hk_figures_facet, __VA_ARGS__)

typedef struct hk_figures_facet {
  size_t size;
  /* Fills figures of the run so far, at most HK_OWN_FIGURES, and returns how many; it changes nothing. Required. */
  size_t (*list)(void *self, const hk_view *view, hk_own_figure *figure);
  /* What would bring a figure below its limit, for the verdict's sentence: constant words that go on behind it, "try a
   * smaller dt". NULL: not known; since minor 3. */
  const char *(*remedy)(void *self, const hk_view *view);
} hk_figures_facet;

#endif
